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

/// A row of texels as four words each: bits of single precision, or unsigned integers as they are;
/// absent channels are 0, 0 and 1.
pub(crate) fn words(format: Format, row: &[u8], out: &mut Vec<[u32; 4]>) {
    if let Format::R32Uint | Format::Rgba32Uint = format {
        for texel in row.chunks_exact(texel_bytes(format) as usize) {
            let mut words = [0, 0, 0, 1];
            for (word, bytes) in words.iter_mut().zip(texel.chunks_exact(4)) {
                *word = u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
            }
            out.push(words);
        }
        return;
    }
    let mut numbers = Vec::with_capacity(row.len());
    decode(format, row, &mut numbers);
    for texel in numbers.chunks_exact(channels(format)) {
        let mut words = [0, 0, 0, 1.0_f32.to_bits()];
        for (word, number) in words.iter_mut().zip(texel) {
            *word = number.to_bits();
        }
        out.push(words);
    }
}

/// The bytes of texels that are given as [`words`] tells them.
pub(crate) fn encode(format: Format, texels: &[[u32; 4]]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(texels.len() * texel_bytes(format) as usize);
    for &word in texels.iter().flat_map(|texel| &texel[..channels(format)]) {
        let number = f32::from_bits(word);
        match format {
            // What is no number becomes 0 in the conversion to integers.
            Format::Rgba8Unorm => bytes.push((number.clamp(0.0, 1.0) * 255.0).round() as u8),
            Format::Rgba16Float => bytes.extend(half::f16::from_f32(number).to_le_bytes()),
            _ => bytes.extend(word.to_le_bytes()),
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texels_go_there_and_back() {
        for format in [
            Format::R32Float,
            Format::Rg32Float,
            Format::R32Uint,
            Format::Rgba8Unorm,
            Format::Rgba16Float,
            Format::Rgba32Float,
            Format::Rgba32Uint,
        ] {
            let bytes: Vec<u8> = (0..texel_bytes(format) * 5)
                .map(|i| (i as u8).wrapping_mul(7))
                .collect();
            let mut texels = Vec::new();
            words(format, &bytes, &mut texels);
            assert_eq!(texels.len(), 5, "{format:?}");
            assert_eq!(encode(format, &texels), bytes, "{format:?}");
        }
    }
}
