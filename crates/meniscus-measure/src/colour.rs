//! Linear and sRGB colour, and the distance between two pictures in linear colour.

use crate::MeasureError;

/// What equal pictures have as their peak signal-to-noise ratio, in decibels.
///
/// Their true value is infinite, which JSON cannot say. Every finite ratio is capped here too, at a
/// root mean square error of 1e-10, which single precision cannot tell from none.
pub const MAX_PSNR_DB: f64 = 200.0;

/// How far a picture is from the true one, in linear colour clamped to `[0, 1]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColourError {
    /// Root mean square error over pixels and channels, `0 ..= 1`.
    pub rmse: f64,
    /// Peak signal-to-noise ratio in dB, `-20 log10(rmse)`, at most [`MAX_PSNR_DB`].
    pub psnr: f64,
}

impl ColourError {
    fn of_mean_square(mean_square: f64) -> Self {
        let rmse = mean_square.sqrt();
        Self {
            rmse,
            psnr: psnr_of(rmse),
        }
    }
}

/// The peak signal-to-noise ratio in dB of a root mean square error whose peak is 1.
pub(crate) fn psnr_of(rmse: f64) -> f64 {
    // log10(0) is minus infinity; `min` turns that into the cap.
    (0.0 - 20.0 * rmse.log10()).min(MAX_PSNR_DB)
}

/// Compares two pictures of linear colours over the pixels for which `inside` is true.
///
/// `None` where there is no such pixel. A channel that is NaN or infinite in either picture counts
/// as the largest error, 1.
///
/// # Errors
/// [`MeasureError::Length`] when the slices differ in length.
pub fn colour_error(
    shown: &[[f32; 3]],
    truth: &[[f32; 3]],
    inside: &[bool],
) -> Result<Option<ColourError>, MeasureError> {
    MeasureError::check_length("colours of the true picture", truth.len(), shown.len())?;
    MeasureError::check_length("mask of the pixels", inside.len(), shown.len())?;
    let mut sum = 0.0;
    let mut count = 0u64;
    for ((a, b), _) in shown.iter().zip(truth).zip(inside).filter(|(_, m)| **m) {
        for (a, b) in a.iter().zip(b) {
            sum += squared_difference(*a, *b);
        }
        count += 3;
    }
    Ok((count > 0).then(|| ColourError::of_mean_square(sum / count as f64)))
}

fn squared_difference(a: f32, b: f32) -> f64 {
    if !(a.is_finite() && b.is_finite()) {
        return 1.0;
    }
    let difference = f64::from(a.clamp(0.0, 1.0)) - f64::from(b.clamp(0.0, 1.0));
    difference * difference
}

/// The sRGB transfer function (IEC 61966-2-1): linear light in `[0, 1]` to the encoded value.
///
/// Below 0 and NaN give 0, above 1 gives 1.
pub fn linear_to_srgb(linear: f64) -> f64 {
    let x = in_unit_range(linear);
    if x <= 0.003_130_8 {
        12.92 * x
    } else {
        1.055 * x.powf(1.0 / 2.4) - 0.055
    }
}

/// The inverse of [`linear_to_srgb`]: an encoded value in `[0, 1]` to linear light.
///
/// Below 0 and NaN give 0, above 1 gives 1.
pub fn srgb_to_linear(encoded: f64) -> f64 {
    let x = in_unit_range(encoded);
    if x <= 0.040_45 {
        x / 12.92
    } else {
        ((x + 0.055) / 1.055).powf(2.4)
    }
}

fn in_unit_range(x: f64) -> f64 {
    if x.is_nan() { 0.0 } else { x.clamp(0.0, 1.0) }
}

/// Linear colours to 8-bit sRGB, rounded to the nearest code, three bytes a pixel.
///
/// NaN and negative values become 0, values above 1 (infinity too) 255.
pub fn to_srgb8(linear: &[[f32; 3]]) -> Vec<u8> {
    linear
        .iter()
        .flatten()
        .map(|c| (255.0 * linear_to_srgb(f64::from(*c))).round() as u8)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(a: &[[f32; 3]], b: &[[f32; 3]]) -> ColourError {
        colour_error(a, b, &vec![true; a.len()]).unwrap().unwrap()
    }

    #[test]
    fn every_code_survives_decoding_and_encoding() {
        for code in 0..=255u8 {
            let linear = srgb_to_linear(f64::from(code) / 255.0) as f32;
            assert_eq!(to_srgb8(&[[linear; 3]]), vec![code; 3]);
        }
    }

    #[test]
    fn encoding_is_monotone_and_bounded() {
        let codes: Vec<f64> = (-10..=1010)
            .map(|i| linear_to_srgb(f64::from(i) / 1000.0))
            .collect();
        assert!(codes.windows(2).all(|w| w[0] <= w[1]));
        assert_eq!(codes[0], 0.0);
        assert!((codes[codes.len() - 1] - 1.0).abs() < 1e-15);
        assert_eq!(to_srgb8(&[[f32::NAN, f32::INFINITY, -1.0]]), [0, 255, 0]);
    }

    #[test]
    fn equal_pictures_have_no_error_and_the_highest_ratio() {
        let a = [[0.1, 0.5, 0.9]; 7];
        assert_eq!(
            error(&a, &a),
            ColourError {
                rmse: 0.0,
                psnr: MAX_PSNR_DB
            }
        );
    }

    #[test]
    fn the_ratio_follows_from_the_root_mean_square() {
        let (a, b) = ([[0.5; 3]; 4], [[0.4; 3]; 4]);
        let e = error(&a, &b);
        assert!((e.rmse - 0.1).abs() < 1e-7);
        assert!((e.psnr - 20.0).abs() < 1e-5);
        assert_eq!(e, error(&b, &a));
    }

    #[test]
    fn black_against_white_is_the_largest_error_even_beyond_the_clamp() {
        let e = error(&[[-3.0; 3]], &[[7.0; 3]]);
        assert_eq!((e.rmse, e.psnr), (1.0, 0.0));
    }

    #[test]
    fn a_nan_is_the_largest_error_of_a_channel() {
        let e = error(&[[f32::NAN, 0.5, 0.5]], &[[0.5; 3]]);
        assert!((e.rmse - (1.0f64 / 3.0).sqrt()).abs() < 1e-12);
        let both = error(&[[f32::NAN; 3]], &[[f32::NAN; 3]]);
        assert_eq!(both.rmse, 1.0);
    }

    #[test]
    fn only_the_pixels_of_the_mask_count() {
        let (a, b) = ([[0.0; 3], [1.0; 3]], [[0.0; 3], [0.0; 3]]);
        assert_eq!(
            colour_error(&a, &b, &[true, false]).unwrap().unwrap().rmse,
            0.0
        );
        assert_eq!(
            colour_error(&a, &b, &[false, true]).unwrap().unwrap().rmse,
            1.0
        );
        assert_eq!(colour_error(&a, &b, &[false, false]).unwrap(), None);
        assert!(colour_error(&a, &b, &[true]).is_err());
    }
}
