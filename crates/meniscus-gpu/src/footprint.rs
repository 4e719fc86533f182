//! How much memory a frame takes between its passes, told without an adapter.

use glam::UVec2;
use meniscus_pipeline::{Plan, Size};
use meniscus_scene::Scene;

use crate::host_scene::HostScene;
use crate::parts::Skipping;
use crate::{resources, scene_buffers};

/// What a frame allocates for what lies between its passes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Footprint {
    /// Width and height of textures with a guard band, pixels.
    pub guarded: UVec2,
    /// Bytes of textures and buffers; what shares memory counts once.
    pub bytes: u64,
}

impl Footprint {
    /// Of a frame of `size` pixels that shows a scene as it is now.
    pub fn new(plan: &Plan, scene: &Scene, size: UVec2, skipping: Skipping) -> Self {
        let views = HostScene::new(scene).views(size, scene_buffers::heights(scene));
        let (textures, memories) = resources::placed(plan, &views, skipping.sharing);
        let each = textures.iter().zip(&memories).enumerate();
        // Textures of one memory are alike.
        let first = each.filter(|(index, (_, memory))| !memories[..*index].contains(memory));
        let textures = first.map(|(_, (texture, _))| resources::kind_bytes(texture.kind));
        let buffers = plan.buffers.values();
        let buffers = buffers.map(|buffer| {
            let bytes = resources::buffer_bytes(buffer, views.size(Size::Frame));
            bytes.unwrap_or(u64::MAX)
        });
        Self {
            guarded: views.size(Size::Guarded),
            bytes: textures.chain(buffers).fold(0, u64::saturating_add),
        }
    }
}
