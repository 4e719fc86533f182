//! Texel formats: what wgpu calls them, how large they are, what an empty texel holds.

use meniscus_pipeline::Format;

/// wgpu's name of a format.
pub(crate) fn to_wgpu(format: Format) -> wgpu::TextureFormat {
    match format {
        Format::R32Float => wgpu::TextureFormat::R32Float,
        Format::Rg32Float => wgpu::TextureFormat::Rg32Float,
        Format::R32Uint => wgpu::TextureFormat::R32Uint,
        Format::Rgba8Unorm => wgpu::TextureFormat::Rgba8Unorm,
        Format::Rgba16Float => wgpu::TextureFormat::Rgba16Float,
        Format::Rgba32Float => wgpu::TextureFormat::Rgba32Float,
        Format::Rgba32Uint => wgpu::TextureFormat::Rgba32Uint,
        Format::Depth32Float => wgpu::TextureFormat::Depth32Float,
    }
}

/// wgpu's name of naga's storage format; none for formats that no texture of a pipeline has.
pub(crate) fn storage(format: naga::StorageFormat) -> Option<wgpu::TextureFormat> {
    Some(match format {
        naga::StorageFormat::R32Float => wgpu::TextureFormat::R32Float,
        naga::StorageFormat::Rg32Float => wgpu::TextureFormat::Rg32Float,
        naga::StorageFormat::R32Uint => wgpu::TextureFormat::R32Uint,
        naga::StorageFormat::Rgba8Unorm => wgpu::TextureFormat::Rgba8Unorm,
        naga::StorageFormat::Rgba16Float => wgpu::TextureFormat::Rgba16Float,
        naga::StorageFormat::Rgba32Float => wgpu::TextureFormat::Rgba32Float,
        naga::StorageFormat::Rgba32Uint => wgpu::TextureFormat::Rgba32Uint,
        _ => return None,
    })
}

/// Numbers in a texel.
pub(crate) fn channels(format: Format) -> usize {
    match format {
        Format::R32Float | Format::R32Uint | Format::Depth32Float => 1,
        Format::Rg32Float => 2,
        Format::Rgba8Unorm | Format::Rgba16Float | Format::Rgba32Float | Format::Rgba32Uint => 4,
    }
}

/// Bytes of a texel.
pub(crate) fn texel_bytes(format: Format) -> u32 {
    match format {
        Format::R32Float | Format::R32Uint | Format::Depth32Float | Format::Rgba8Unorm => 4,
        Format::Rg32Float | Format::Rgba16Float => 8,
        Format::Rgba32Float | Format::Rgba32Uint => 16,
    }
}

/// Whether it is a depth format.
pub(crate) fn is_depth(format: Format) -> bool {
    format == Format::Depth32Float
}

/// Whether a sampler may blend its texels on every adapter.
pub(crate) fn is_filterable(format: Format) -> bool {
    matches!(format, Format::Rgba8Unorm | Format::Rgba16Float)
}

/// What a texel holds before anything is written: 0, with −1 in place of the object id that the
/// fourth number of a position is.
pub(crate) fn empty(format: Format) -> wgpu::Color {
    let none = if format == Format::Rgba32Float {
        -1.0
    } else {
        0.0
    };
    wgpu::Color {
        r: 0.0,
        g: 0.0,
        b: 0.0,
        a: none,
    }
}

/// The numbers of a row of texels, as single precision; unsigned integers are exact to 2²⁴.
pub(crate) fn decode(format: Format, row: &[u8], out: &mut Vec<f32>) {
    let word = |bytes: &[u8]| [bytes[0], bytes[1], bytes[2], bytes[3]];
    match format {
        Format::Rgba8Unorm => out.extend(row.iter().map(|&b| f32::from(b) / 255.0)),
        Format::Rgba16Float => {
            let halves = row
                .chunks_exact(2)
                .map(|b| half::f16::from_le_bytes([b[0], b[1]]));
            out.extend(halves.map(f32::from));
        }
        Format::R32Uint | Format::Rgba32Uint => {
            out.extend(
                row.chunks_exact(4)
                    .map(|b| u32::from_le_bytes(word(b)) as f32),
            );
        }
        Format::R32Float | Format::Rg32Float | Format::Rgba32Float | Format::Depth32Float => {
            out.extend(row.chunks_exact(4).map(|b| f32::from_le_bytes(word(b))));
        }
    }
}
