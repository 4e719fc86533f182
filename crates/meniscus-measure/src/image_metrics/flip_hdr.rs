//! FLIP for high dynamic range: Andersson, Nilsson, Shirley, Akenine-Möller 2021,
//! "Visualizing Errors in Rendered High Dynamic Range Images", doi 10.2312/egs.20211015.
//!
//! A viewer of such a picture turns its exposure up and down, so an error counts as much as it does at
//! the exposure that shows it best: the pictures are exposed in steps, tone mapped, compared with FLIP,
//! and the largest difference of each pixel is kept.

use super::flip::{Evaluator, mark_broken};
use super::flip_colour::Spaces;
use super::{Difference, FlipOptions, Image, Pair, mean, narrowed};
use crate::MeasureError;

/// The exposures at which two pictures are compared, in stops (powers of two).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exposures {
    /// The darkest: the brightest part of the reference is just not washed out.
    pub start: f64,
    /// The brightest: half of the reference is washed out.
    pub stop: f64,
    /// How many there are, evenly spaced from `start` to `stop`.
    pub count: u32,
}

/// Narkowicz's fit of the ACES filmic curve with its usual exposure of 0.6 multiplied in, as
/// `(p₂ x² + p₁ x) / (q₂ x² + q₁ x + q₀)`.
const NUMERATOR: [f64; 2] = [0.6 * 0.6 * 2.51, 0.6 * 0.03];
const DENOMINATOR: [f64; 3] = [0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14];
/// Tone-mapped values from here on count as washed out.
const WASHED_OUT: f64 = 0.85;
/// Darker luminances count as this, so that black pictures have exposures too.
const DARKEST: f64 = f32::EPSILON as f64;
/// No more exposures than this, whatever the picture holds.
const MOST_EXPOSURES: u32 = 300;

impl Exposures {
    /// The exposures that a reference asks for.
    ///
    /// From the one at which its largest luminance is tone mapped to 0.85, to the one at which its
    /// median luminance is (of an even number of pixels, the upper of the two in the middle); one per
    /// stop, at least two.
    pub fn of(reference: &Image) -> Self {
        let spaces = Spaces::new();
        let mut luminances: Vec<f64> = reference
            .pixels()
            .iter()
            .filter(|pixel| pixel.iter().all(|c| c.is_finite()))
            .map(|pixel| spaces.luminance(pixel.map(|c| f64::from(c.max(0.0)))))
            .collect();
        luminances.sort_by(f64::total_cmp);
        let median = luminances.get(luminances.len() / 2).copied().unwrap_or(0.0);
        let largest = luminances.last().copied().unwrap_or(0.0);
        let bright = washed_out_from();
        let stops = |luminance: f64| (bright / luminance.max(DARKEST)).log2();
        let (start, stop) = (stops(largest), stops(median));
        Self {
            start,
            stop,
            count: ((stop - start).ceil() as u32).clamp(2, MOST_EXPOSURES),
        }
    }

    fn check(&self) -> Result<(), MeasureError> {
        let usable = |stops: f64| (-300.0..=300.0).contains(&stops);
        if usable(self.start)
            && usable(self.stop)
            && self.start <= self.stop
            && (1..=MOST_EXPOSURES).contains(&self.count)
        {
            return Ok(());
        }
        Err(MeasureError::value(
            "exposures",
            format!(
                "{} from {} to {} stops; there must be 1 to {MOST_EXPOSURES}, from the darker to \
                 the brighter, within 300 stops",
                self.count, self.start, self.stop
            ),
        ))
    }

    fn factors(&self) -> impl Iterator<Item = f64> {
        let Self { start, stop, count } = *self;
        let step = (stop - start) / f64::from(count.saturating_sub(1).max(1));
        (0..count).map(move |i| (start + f64::from(i) * step).exp2())
    }
}

/// The FLIP difference of two pictures of high dynamic range, `0 ..= 1`: the mean over the pixels of the
/// largest difference at any exposure.
///
/// Without `exposures`, those that the reference asks for ([`Exposures::of`]); so, other than with
/// [`flip`](super::flip), exchanging the pictures may change the result. Negative colours count as 0.
///
/// # Errors
/// [`MeasureError::Value`] when the pictures differ in size, or options or exposures cannot be used.
pub fn flip_hdr(
    reference: &Image,
    test: &Image,
    options: &FlipOptions,
    exposures: Option<Exposures>,
) -> Result<Difference, MeasureError> {
    let pair = Pair::of(reference, test)?.clamped(f64::from(f32::MAX));
    let evaluator = Evaluator::new(options, pair.size)?;
    let exposures = exposures.unwrap_or_else(|| Exposures::of(reference));
    exposures.check()?;
    let mut worst = vec![0.0f64; pair.broken.len()];
    for factor in exposures.factors() {
        let [a, b] = [&pair.reference, &pair.test].map(|image| -> Vec<[f64; 3]> {
            image
                .iter()
                .map(|pixel| pixel.map(|c| tone_mapped(factor * c)))
                .collect()
        });
        for (worst, error) in worst.iter_mut().zip(evaluator.map(&a, &b)) {
            *worst = worst.max(error);
        }
    }
    mark_broken(&mut worst, &pair.broken);
    Ok(Difference {
        value: mean(&worst),
        map: narrowed(&worst),
    })
}

fn tone_mapped(x: f64) -> f64 {
    let [p2, p1] = NUMERATOR;
    let [q2, q1, q0] = DENOMINATOR;
    ((p2 * x + p1) * x / ((q2 * x + q1) * x + q0)).clamp(0.0, 1.0)
}

/// Where the tone-mapping curve reaches [`WASHED_OUT`]: the positive root of a quadratic.
fn washed_out_from() -> f64 {
    let [p2, p1] = NUMERATOR;
    let [q2, q1, q0] = DENOMINATOR;
    let a = p2 - WASHED_OUT * q2;
    let b = p1 - WASHED_OUT * q1;
    let c = -WASHED_OUT * q0;
    (-b + (b * b - 4.0 * a * c).sqrt()) / (2.0 * a)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_rises_from_black_and_is_washed_out_where_it_says() {
        let values: Vec<f64> = (0..2000)
            .map(|i| tone_mapped(f64::from(i) / 100.0))
            .collect();
        assert_eq!(values[0], 0.0);
        assert!(values.windows(2).all(|w| w[0] <= w[1]) && values[1999] <= 1.0);
        assert!((tone_mapped(washed_out_from()) - WASHED_OUT).abs() < 1e-12);
    }

    #[test]
    fn a_brighter_reference_asks_for_as_many_stops_less() {
        let pixels: Vec<[f32; 3]> = (1..=35).map(|i| [i as f32 * 0.1; 3]).collect();
        let brighter: Vec<[f32; 3]> = pixels.iter().map(|p| p.map(|c| c * 8.0)).collect();
        let of = |pixels: Vec<[f32; 3]>| Exposures::of(&Image::new([7, 5], pixels).unwrap());
        let (a, b) = (of(pixels), of(brighter));
        assert!((a.start - b.start - 3.0).abs() < 1e-5 && (a.stop - b.stop - 3.0).abs() < 1e-5);
        assert_eq!(a.count, b.count);
    }

    #[test]
    fn black_and_broken_references_have_exposures() {
        for colour in [0.0, f32::NAN, f32::INFINITY, -1.0, f32::MAX] {
            let image = Image::new([2, 2], vec![[colour; 3]; 4]).unwrap();
            assert!(Exposures::of(&image).check().is_ok(), "{colour}");
        }
    }

    #[test]
    fn exposures_run_evenly_from_start_to_stop() {
        let exposures = Exposures {
            start: -2.0,
            stop: 1.0,
            count: 4,
        };
        assert_eq!(
            exposures.factors().collect::<Vec<_>>(),
            [0.25, 0.5, 1.0, 2.0]
        );
        let one = Exposures {
            start: 1.0,
            stop: 1.0,
            count: 1,
        };
        assert_eq!(one.factors().collect::<Vec<_>>(), [2.0]);
        for broken in [
            Exposures {
                start: 1.0,
                stop: 0.0,
                count: 2,
            },
            Exposures {
                start: f64::NAN,
                stop: 0.0,
                count: 2,
            },
            Exposures {
                start: 0.0,
                stop: 1.0,
                count: 0,
            },
        ] {
            assert!(broken.check().is_err());
        }
    }
}
