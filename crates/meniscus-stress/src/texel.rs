//! What textures keep of the texels that are written to them.

use naga::StorageFormat as F;

/// A texel as it comes back from a format: four words, floating-point numbers as the bits of `f32`s,
/// absent channels 0, 0 and 1.
///
/// Halves and steps are rounded to the nearest, ties to even, which GPUs are free not to do; numbers
/// outside of a format's range go to its ends, NaN to 0 where it has none.
#[must_use]
pub fn stored_texel(format: F, texel: [u32; 4]) -> [u32; 4] {
    let (channels, coding) = coding(format);
    let absent = if matches!(coding, Coding::Uint(_) | Coding::Sint(_)) {
        [0, 0, 0, 1]
    } else {
        [0, 0, 0, 1.0_f32.to_bits()]
    };
    std::array::from_fn(|i| {
        if i >= channels {
            return absent[i];
        }
        let x = f32::from_bits(texel[i]);
        match coding {
            Coding::Float(32) => texel[i],
            Coding::Float(_) => half::f16::from_f32(x).to_f32().to_bits(),
            Coding::Unorm(bits) => {
                // The alpha of a 10-10-10-2 format has two bits.
                normalised(
                    x.clamp(0.0, 1.0),
                    if bits == 10 && i == 3 { 2 } else { bits },
                )
            }
            Coding::Snorm(bits) => normalised(x.clamp(-1.0, 1.0), bits - 1),
            Coding::Uint(10) => texel[i].min(if i == 3 { 3 } else { 1023 }),
            Coding::Uint(bits) => texel[i].min(u32::MAX >> (32 - bits)),
            Coding::Sint(bits) => {
                let most = i32::MAX >> (32 - bits);
                (texel[i] as i32).clamp(-most - 1, most) as u32
            }
            Coding::Small => small_float(x, if i == 2 { 5 } else { 6 }).to_bits(),
        }
    })
}

#[derive(Clone, Copy)]
enum Coding {
    Float(u32),
    Unorm(u32),
    Snorm(u32),
    Uint(u32),
    Sint(u32),
    /// Unsigned floats of 11, 11 and 10 bits.
    Small,
}

fn normalised(x: f32, bits: u32) -> u32 {
    let scale = f64::exp2(f64::from(bits)) - 1.0;
    // NaN is stored as 0.
    let steps = if x.is_nan() {
        0.0
    } else {
        (f64::from(x) * scale).round_ties_even()
    };
    ((steps / scale) as f32).to_bits()
}

/// A float with 5 bits of exponent and no sign, rounded towards zero.
fn small_float(x: f32, mantissa: u32) -> f32 {
    if x.is_nan() || x.is_infinite() {
        return x.max(0.0);
    }
    let largest = (2.0 - f32::exp2(-(mantissa as f32))) * f32::exp2(15.0);
    let x = x.clamp(0.0, largest);
    let step = f32::exp2((x.max(f32::exp2(-14.0)).log2().floor()) - mantissa as f32);
    (x / step).trunc() * step
}

fn coding(format: F) -> (usize, Coding) {
    match format {
        F::R8Unorm => (1, Coding::Unorm(8)),
        F::R8Snorm => (1, Coding::Snorm(8)),
        F::R8Uint => (1, Coding::Uint(8)),
        F::R8Sint => (1, Coding::Sint(8)),
        F::R16Uint => (1, Coding::Uint(16)),
        F::R16Sint => (1, Coding::Sint(16)),
        F::R16Float => (1, Coding::Float(16)),
        F::Rg8Unorm => (2, Coding::Unorm(8)),
        F::Rg8Snorm => (2, Coding::Snorm(8)),
        F::Rg8Uint => (2, Coding::Uint(8)),
        F::Rg8Sint => (2, Coding::Sint(8)),
        F::R32Uint | F::R64Uint => (1, Coding::Uint(32)),
        F::R32Sint => (1, Coding::Sint(32)),
        F::R32Float => (1, Coding::Float(32)),
        F::Rg16Uint => (2, Coding::Uint(16)),
        F::Rg16Sint => (2, Coding::Sint(16)),
        F::Rg16Float => (2, Coding::Float(16)),
        F::Rgba8Unorm | F::Bgra8Unorm => (4, Coding::Unorm(8)),
        F::Rgba8Snorm => (4, Coding::Snorm(8)),
        F::Rgba8Uint => (4, Coding::Uint(8)),
        F::Rgba8Sint => (4, Coding::Sint(8)),
        F::Rgb10a2Uint => (4, Coding::Uint(10)),
        F::Rgb10a2Unorm => (4, Coding::Unorm(10)),
        F::Rg11b10Ufloat => (3, Coding::Small),
        F::Rg32Uint => (2, Coding::Uint(32)),
        F::Rg32Sint => (2, Coding::Sint(32)),
        F::Rg32Float => (2, Coding::Float(32)),
        F::Rgba16Uint => (4, Coding::Uint(16)),
        F::Rgba16Sint => (4, Coding::Sint(16)),
        F::Rgba16Float => (4, Coding::Float(16)),
        F::Rgba32Uint => (4, Coding::Uint(32)),
        F::Rgba32Sint => (4, Coding::Sint(32)),
        F::Rgba32Float => (4, Coding::Float(32)),
        F::R16Unorm => (1, Coding::Unorm(16)),
        F::R16Snorm => (1, Coding::Snorm(16)),
        F::Rg16Unorm => (2, Coding::Unorm(16)),
        F::Rg16Snorm => (2, Coding::Snorm(16)),
        F::Rgba16Unorm => (4, Coding::Unorm(16)),
        F::Rgba16Snorm => (4, Coding::Snorm(16)),
    }
}
