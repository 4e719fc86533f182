//! What textures keep of the numbers that are written to them.

use half::f16;
use meniscus_pipeline::Format;
use meniscus_stress::Kind;

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

/// A texel as it comes back from a format; halves are rounded to nearest, ties to even, which GPUs
/// are free not to do. Absent channels are 0, 0 and 1.
pub(crate) fn kept(format: Format, texel: [u32; 4]) -> [u32; 4] {
    let one = 1.0_f32.to_bits();
    match format {
        Format::Rgba32Float | Format::Rgba32Uint => texel,
        Format::R32Uint => [texel[0], 0, 0, 1],
        Format::R32Float | Format::Depth32Float => [texel[0], 0, 0, one],
        Format::Rg32Float => [texel[0], texel[1], 0, one],
        Format::Rgba16Float => {
            texel.map(|bits| f16::from_f32(f32::from_bits(bits)).to_f32().to_bits())
        }
        Format::Rgba8Unorm => texel.map(|bits| {
            let x = f32::from_bits(bits);
            // A NaN is stored as 0.
            let steps = if x.is_nan() {
                0.0
            } else {
                (x.clamp(0.0, 1.0) * 255.0).round_ties_even()
            };
            (steps / 255.0).to_bits()
        }),
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
