//! False colours for errors.
//!
//! The scale is logarithmic, because errors span decades: everything up to [`LogScale::low`] is dark
//! violet, then come blue, teal and green, and everything from [`LogScale::high`] is light yellow.
//! Colours that are not on the scale mark what is not a matter of degree:
//!
//! | colour | meaning |
//! |---|---|
//! | red ([`WRONG_OBJECT`]) | another object than the true one |
//! | white ([`UNDEFINED`]) | no physical answer; not judged |
//! | black ([`DRY`]) | no water; not judged |
//!
//! Lightness rises evenly along the scale, so equal factors of error look equally far apart, in black
//! and white too, and to people who tell few colours apart.

use crate::{MeasureError, Verdict, linear_to_srgb};

/// Pixels that show another object than the true one, 8-bit sRGB.
pub const WRONG_OBJECT: [u8; 3] = [230, 20, 40];
/// Pixels without a physical answer, 8-bit sRGB.
pub const UNDEFINED: [u8; 3] = [255, 255, 255];
/// Pixels without water, 8-bit sRGB.
pub const DRY: [u8; 3] = [0, 0, 0];

/// The range of errors that a false-colour picture tells apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LogScale {
    low: f64,
    high: f64,
}

impl LogScale {
    /// Position errors from a hundredth of a pixel to a hundred pixels.
    pub const PIXELS: Self = Self {
        low: 0.01,
        high: 100.0,
    };

    /// A scale from `low` to `high`, in the unit of the errors.
    ///
    /// # Errors
    /// [`MeasureError::Value`] unless `0 < low < high` and both are finite.
    pub fn new(low: f64, high: f64) -> Result<Self, MeasureError> {
        if low > 0.0 && low < high && high.is_finite() {
            Ok(Self { low, high })
        } else {
            Err(MeasureError::value(
                "range of false colours",
                format!("{low} to {high}: both must be positive, the second larger"),
            ))
        }
    }

    /// The error of the darkest colour and of everything below.
    pub fn low(&self) -> f64 {
        self.low
    }

    /// The error of the lightest colour and of everything above.
    pub fn high(&self) -> f64 {
        self.high
    }

    /// Where on the scale an error lies, `0 ..= 1`; a NaN at the high end.
    pub fn place(&self, error: f64) -> f64 {
        if error.is_nan() {
            return 1.0;
        }
        let decades = (self.high / self.low).ln();
        ((error.max(self.low) / self.low).ln() / decades).min(1.0)
    }

    /// The 8-bit sRGB colour of an error.
    pub fn colour(&self, error: f64) -> [u8; 3] {
        ramp(self.place(error))
    }

    /// What the colours of a picture mean, in one line.
    pub fn legend(&self) -> String {
        format!(
            "dark violet: up to {}; through blue, teal and green, logarithmic; light yellow: {} and \
             more; red: wrong object; white: undefined; black: no water",
            self.low, self.high
        )
    }
}

/// The colour at `t` (`0 ..= 1`) of the ramp, 8-bit sRGB.
///
/// A path through Oklab (Ottosson 2020): lightness rises linearly from 0.22 to 0.96, the hue turns
/// from violet to yellow, and the chroma is what the sRGB gamut allows along the way.
pub fn ramp(t: f64) -> [u8; 3] {
    linear_ramp(t.clamp(0.0, 1.0)).map(|c| (255.0 * linear_to_srgb(c)).round() as u8)
}

fn linear_ramp(t: f64) -> [f64; 3] {
    let lightness = 0.22 + 0.74 * t;
    let hue = (300.0 - 195.0 * t).to_radians();
    // Small at both ends, where the gamut is narrow.
    let chroma = 0.088 + 0.04 * t * t;
    oklab_to_linear([lightness, chroma * hue.cos(), chroma * hue.sin()])
}

fn oklab_to_linear([lightness, a, b]: [f64; 3]) -> [f64; 3] {
    let cube = |x: f64| x * x * x;
    let l = cube(lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b);
    let m = cube(lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b);
    let s = cube(lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b);
    [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ]
}

/// The position errors of a frame as a picture of three bytes a pixel, for [`crate::write_png`].
pub fn error_map(verdicts: &[Verdict], scale: &LogScale) -> Vec<u8> {
    verdicts
        .iter()
        .flat_map(|verdict| match *verdict {
            Verdict::Dry => DRY,
            Verdict::Undefined => UNDEFINED,
            Verdict::Error {
                wrong_object: true, ..
            } => WRONG_OBJECT,
            Verdict::Error { px, .. } => scale.colour(px),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::srgb_to_linear;

    fn lightness(rgb: [u8; 3]) -> f64 {
        let [r, g, b] = rgb.map(|c| srgb_to_linear(f64::from(c) / 255.0));
        let y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        // CIE L*
        if y > 0.008856 {
            116.0 * y.cbrt() - 16.0
        } else {
            903.3 * y
        }
    }

    #[test]
    fn lightness_rises_evenly() {
        let steps: Vec<f64> = (0..=32)
            .map(|i| lightness(ramp(f64::from(i) / 32.0)))
            .collect();
        let mean = (steps[32] - steps[0]) / 32.0;
        assert!(mean > 2.0, "{steps:?}");
        for pair in steps.windows(2) {
            let step = pair[1] - pair[0];
            assert!((0.4 * mean..1.6 * mean).contains(&step), "{step} of {mean}");
        }
    }

    #[test]
    fn the_ramp_stays_inside_the_gamut() {
        for i in 0..=100 {
            let rgb = linear_ramp(f64::from(i) / 100.0);
            for c in rgb {
                assert!((-0.004..=1.004).contains(&c), "{i} %: {rgb:?}");
            }
        }
    }

    #[test]
    fn marks_are_far_from_the_ramp_and_from_each_other() {
        let far = |a: [u8; 3], b: [u8; 3]| {
            a.iter()
                .zip(b)
                .map(|(x, y)| x.abs_diff(y) as u32)
                .sum::<u32>()
                > 90
        };
        let marks = [WRONG_OBJECT, UNDEFINED, DRY];
        for (i, mark) in marks.iter().enumerate() {
            for t in 0..=100 {
                assert!(far(*mark, ramp(f64::from(t) / 100.0)), "{mark:?} at {t} %");
            }
            assert!(marks[i + 1..].iter().all(|other| far(*mark, *other)));
        }
    }

    #[test]
    fn equal_factors_are_equal_distances() {
        let scale = LogScale::PIXELS;
        let step = scale.place(0.1) - scale.place(0.01);
        assert!((scale.place(10.0) - scale.place(1.0) - step).abs() < 1e-12);
        assert_eq!((scale.place(0.0), scale.place(1e9)), (0.0, 1.0));
        assert_eq!((scale.place(f64::NAN), scale.place(-1.0)), (1.0, 0.0));
    }

    #[test]
    fn a_range_that_cannot_be_drawn_is_refused() {
        for (low, high) in [
            (0.0, 1.0),
            (2.0, 1.0),
            (1.0, 1.0),
            (f64::NAN, 1.0),
            (1.0, f64::INFINITY),
        ] {
            assert!(LogScale::new(low, high).is_err());
        }
    }

    #[test]
    fn every_verdict_has_its_colour() {
        let error = |px, wrong_object| Verdict::Error {
            px,
            m: 0.0,
            wrong_object,
        };
        let verdicts = [
            Verdict::Dry,
            Verdict::Undefined,
            error(1.0, true),
            error(1.0, false),
        ];
        let map = error_map(&verdicts, &LogScale::PIXELS);
        assert_eq!(map[..9], [DRY, UNDEFINED, WRONG_OBJECT].concat());
        assert_eq!(map[9..], LogScale::PIXELS.colour(1.0));
    }
}
