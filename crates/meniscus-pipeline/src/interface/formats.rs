//! What texel formats are to shaders.

use meniscus_shader::Sample;

use crate::plan::Format;

impl Format {
    /// WGSL's name as a storage texture's format, for those that have one.
    pub(crate) fn storage_name(self) -> Option<&'static str> {
        match self {
            Self::R32Float => Some("r32float"),
            Self::Rg32Float => Some("rg32float"),
            Self::R32Uint => Some("r32uint"),
            Self::Rgba8Unorm => Some("rgba8unorm"),
            Self::Rgba16Float => Some("rgba16float"),
            Self::Rgba32Float => Some("rgba32float"),
            Self::Rgba32Uint => Some("rgba32uint"),
            Self::Depth32Float => None,
        }
    }

    /// The format of storage textures that is the same; none for depths.
    pub fn storage_format(self) -> Option<naga::StorageFormat> {
        use naga::StorageFormat as F;
        match self {
            Self::R32Float => Some(F::R32Float),
            Self::Rg32Float => Some(F::Rg32Float),
            Self::R32Uint => Some(F::R32Uint),
            Self::Rgba8Unorm => Some(F::Rgba8Unorm),
            Self::Rgba16Float => Some(F::Rgba16Float),
            Self::Rgba32Float => Some(F::Rgba32Float),
            Self::Rgba32Uint => Some(F::Rgba32Uint),
            Self::Depth32Float => None,
        }
    }

    /// Bytes of a sample as a colour target, by WebGPU's count.
    pub(super) fn target_bytes(self) -> u32 {
        match self {
            Self::R32Float | Self::R32Uint | Self::Depth32Float => 4,
            Self::Rg32Float | Self::Rgba8Unorm | Self::Rgba16Float => 8,
            Self::Rgba32Float | Self::Rgba32Uint => 16,
        }
    }

    pub(super) fn filterable(self) -> bool {
        matches!(self, Self::Rgba8Unorm | Self::Rgba16Float)
    }

    pub(super) fn sample(self) -> Sample {
        match self {
            Self::R32Uint | Self::Rgba32Uint => Sample::Uint,
            Self::Depth32Float => Sample::Depth,
            _ => Sample::Float,
        }
    }

    /// Channels of a texel, and whether they are unsigned integers.
    pub(super) fn channels(self) -> (u8, bool) {
        match self {
            Self::R32Float | Self::Depth32Float => (1, false),
            Self::R32Uint => (1, true),
            Self::Rgba32Uint => (4, true),
            Self::Rg32Float => (2, false),
            _ => (4, false),
        }
    }
}
