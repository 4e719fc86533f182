//! What textures keep of the numbers that are written to them.

use meniscus_pipeline::Format;
use meniscus_stress::{Kind, stored_texel};

/// Words of a texel where nothing was ever written: 0, with −1 in place of the object id that the
/// fourth number of a position is.
pub(crate) fn empty(format: Format) -> [u32; 4] {
    match format {
        Format::Rgba32Float => [0.0, 0.0, 0.0, -1.0_f32].map(f32::to_bits),
        _ => kept(format, [0; 4]),
    }
}

/// Whether texels are whole numbers.
pub(crate) fn kind(format: Format) -> Kind {
    match format {
        Format::R32Uint | Format::Rgba32Uint => Kind::Uint,
        _ => Kind::Float,
    }
}

/// A texel as it comes back from a format; a depth keeps its first number.
pub(crate) fn kept(format: Format, texel: [u32; 4]) -> [u32; 4] {
    match format.storage_format() {
        Some(format) => stored_texel(format, texel),
        None => [texel[0], 0, 0, 1.0_f32.to_bits()],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_kept_is_kept_unchanged() {
        let texels = [[0.1, -3.0, 7e4, 1e-9], [0.5, 1.0, 2.0, f32::NAN], [0.0; 4]];
        for format in [
            Format::R32Float,
            Format::Rg32Float,
            Format::R32Uint,
            Format::Rgba8Unorm,
            Format::Rgba16Float,
            Format::Rgba32Float,
            Format::Rgba32Uint,
            Format::Depth32Float,
        ] {
            for texel in texels {
                let once = kept(format, texel.map(f32::to_bits));
                let again = kept(format, once);
                let same = |(a, b): (u32, u32)| a == b || f32::from_bits(a).is_nan();
                assert!(
                    once.into_iter().zip(again).all(same),
                    "{format:?}: {texel:?}"
                );
            }
        }
    }

    #[test]
    fn an_empty_position_belongs_to_no_object() {
        assert_eq!(f32::from_bits(empty(Format::Rgba32Float)[3]), -1.0);
        assert_eq!(empty(Format::Rgba16Float), [0; 4]);
    }
}
