//! The textures and buffers between passes.

use std::collections::BTreeMap;

use meniscus_pipeline::{Format, Plan, Size};
use meniscus_stress::{Buffer, Texture};

use crate::coding;

/// A texture: four words a texel, row by row from the top. Floating-point numbers (depth and
/// normalised ones included) are the bits of `f32`s; absent channels are 0, 0 and 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Texels {
    /// Width and height.
    pub size: [u32; 2],
    /// What a texel is.
    pub format: Format,
    /// The texels.
    pub words: Vec<[u32; 4]>,
}

/// What lies between the passes of a plan.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Store {
    /// Textures by name.
    pub textures: BTreeMap<String, Texels>,
    /// Buffers by name, in words of four bytes.
    pub buffers: BTreeMap<String, Vec<u32>>,
}

impl Texels {
    /// A texture in which nothing was written yet.
    #[must_use]
    pub fn empty(format: Format, size: [u32; 2]) -> Self {
        let count = size[0] as usize * size[1] as usize;
        Self {
            size,
            format,
            words: vec![coding::empty(format); count],
        }
    }

    pub(crate) fn to_texture(&self) -> Texture {
        let [width, height] = self.size;
        Texture::from_words(coding::kind(self.format), [width, height, 1], &self.words)
    }
}

impl Store {
    /// What a plan starts with: empty textures, and buffers of zeros. `size` gives the width and
    /// height of textures, pixels.
    #[must_use]
    pub fn new(plan: &Plan, size: impl Fn(Size) -> [u32; 2]) -> Self {
        let textures = plan.textures.iter();
        let [width, height] = size(Size::Frame);
        let pixels = u64::from(width) * u64::from(height);
        let words = |b: &meniscus_pipeline::Buffer| {
            (b.bytes + b.bytes_per_pixel * pixels).div_ceil(4) as usize
        };
        Self {
            textures: textures
                .map(|(name, texture)| {
                    (
                        name.clone(),
                        Texels::empty(texture.format, size(texture.size)),
                    )
                })
                .collect(),
            buffers: plan
                .buffers
                .iter()
                .map(|(name, buffer)| (name.clone(), vec![0; words(buffer)]))
                .collect(),
        }
    }

    pub(crate) fn buffer(&self, name: &str) -> Option<Buffer> {
        self.buffers
            .get(name)
            .map(|words| Buffer::from_words(words))
    }
}
