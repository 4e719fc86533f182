//! What the textures and buffers of an explanation take, where it is known how wide guard bands are.

use glam::UVec2;

use crate::explain::Explanation;
use crate::plan::{Plan, Size};

/// What a frame takes in memory, as whoever makes it says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Memory {
    /// Width and height of textures with a guard band, pixels.
    pub guarded: UVec2,
    /// Bytes of textures and buffers; what shares memory counts once.
    pub allocated: u64,
}

/// Bytes of a plan's textures with a guard band, for each of their pixels.
pub(crate) fn guarded_texel(plan: &Plan) -> u64 {
    let guarded = plan.textures.values().filter(|t| t.size == Size::Guarded);
    guarded.map(|texture| texture.format.bytes()).sum()
}

impl Explanation {
    /// The same with textures as large as their guard bands make them.
    #[must_use]
    pub fn with_memory(mut self, memory: Memory) -> Self {
        let pixels = |[x, y]: [u32; 2]| u64::from(x) * u64::from(y);
        let (frame, guarded) = (pixels(self.size), pixels(memory.guarded.to_array()));
        let widened =
            |bytes: u64, texel: u64| (bytes + texel * guarded).saturating_sub(texel * frame);
        for resource in &mut self.resources {
            resource.bytes = widened(resource.bytes, resource.guarded_texel);
        }
        for (total, texel) in self.total.iter_mut().zip(self.guarded_texels) {
            total.bytes = widened(total.bytes, texel);
        }
        self.guarded_texels = [0; 2];
        self.guarded = Some(memory.guarded.to_array());
        self.allocated_bytes = Some(memory.allocated);
        self
    }
}
