//! The perceptual metric of Yee 2004, "A Perceptual Metric for Production Testing", journal of graphics
//! tools 9(4), doi 10.1080/10867651.2004.10504900; a simplification of Ramasubramanian, Pattanaik and
//! Greenberg 1999.
//!
//! Per pixel: how bright a difference has to be to be seen at the luminance that the eye is adapted to
//! (Ward Larson et al. 1997), raised where the picture is of frequencies that the eye resolves badly
//! (Barten 1989) or busy enough to mask the difference (Daly 1993). A pixel is seen to differ where its
//! luminance differs by more than that, or its colour by more than the raise.

use super::filter::{Kernel, filtered};
use super::flip_colour::Spaces;
use super::{Difference, Image, Pair, narrowed};
use crate::MeasureError;

/// How the pictures are looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viewing {
    /// Horizontal angle that the picture fills, in degrees, above 0 and below 180.
    pub field_of_view: f64,
    /// Luminance of white in cd/m².
    pub white: f64,
    /// How much colour matters beside luminance: 1 as in the paper, 0 not at all.
    pub colour_weight: f64,
}

impl Default for Viewing {
    /// 45° of view, white at 100 cd/m².
    fn default() -> Self {
        Self {
            field_of_view: 45.0,
            white: 100.0,
            colour_weight: 1.0,
        }
    }
}

/// What the metric found.
#[derive(Debug, Clone, PartialEq)]
pub struct Yee {
    /// Pixels that are seen to differ.
    pub visible_pixels: u64,
    /// Which ones, row by row.
    pub visible: Vec<bool>,
}

impl Yee {
    /// Pixels that must be seen to differ before two pictures count as different, where nobody says
    /// otherwise: fewer are easily overlooked.
    pub const DEFAULT_LIMIT: u64 = 100;

    /// The share of the visible pixels, and a map of 0 and 1.
    pub fn difference(&self) -> Difference {
        let map: Vec<f64> = self
            .visible
            .iter()
            .map(|v| f64::from(u8::from(*v)))
            .collect();
        Difference {
            value: self.visible_pixels as f64 / self.visible.len().max(1) as f64,
            map: narrowed(&map),
        }
    }
}

/// Levels of the pyramid; each has half the frequency of the one before.
const LEVELS: usize = 8;
/// Bands whose contrast is judged: each needs the level two below as its surroundings.
const BANDS: usize = LEVELS - 2;
/// Burt and Adelson's generating kernel with a = 0.4.
const GENERATING: [f64; 5] = [0.05, 0.25, 0.4, 0.25, 0.05];
/// Luminance in cd/m² for which the frequency part of the raise is computed.
const FREQUENCY_LUMINANCE: f64 = 100.0;
/// Frequency of the highest contrast sensitivity there, in cycles per degree.
const BEST_FREQUENCY: f64 = 3.248;
/// A threshold is raised at most this much.
const LARGEST_RAISE: f64 = 10.0;
/// Less contrast than this, summed over the bands, is none.
const LEAST_CONTRAST: f64 = 1e-5;
/// Stands for the raise of bands so fine that the sensitivity to them is no number above 0.
const UNSEEN: f64 = 1e12;
/// Below this luminance in cd/m² the eye loses colour.
const COLOUR_VISION_FROM: f64 = 10.0;
/// Luminances below are treated as this, in cd/m².
const DARKEST: f64 = 1e-5;

/// Marks the pixels at which a viewer can see that two pictures differ.
///
/// Colours are clamped to `[0, 1]`; the pictures may be exchanged.
///
/// # Errors
/// [`MeasureError::Value`] when the pictures differ in size or `viewing` makes no sense.
pub fn yee(reference: &Image, test: &Image, viewing: &Viewing) -> Result<Yee, MeasureError> {
    check(viewing)?;
    let pair = Pair::of(reference, test)?.clamped(1.0);
    let spaces = Spaces::new();
    let pyramids = [&pair.reference, &pair.test].map(|image| {
        let luminance = image
            .iter()
            .map(|c| viewing.white * spaces.luminance(*c))
            .collect();
        pyramid(luminance, pair.size)
    });
    let bands = Bands::new(viewing, pair.size[0]);
    let visible: Vec<bool> = (0..pair.broken.len())
        .map(|i| {
            if pair.broken[i] {
                return true;
            }
            let (a, b) = (&pyramids[0], &pyramids[1]);
            let adapted =
                f64::midpoint(a[bands.adaptation][i], b[bands.adaptation][i]).max(DARKEST);
            let raise = bands.raise(a, b, i, adapted);
            if (a[0][i] - b[0][i]).abs() > raise * threshold_versus_intensity(adapted) {
                return true;
            }
            let [p, q] = [&pair.reference, &pair.test].map(|image| spaces.lab(image[i]));
            let chroma = (p[1] - q[1]).powi(2) + (p[2] - q[2]).powi(2);
            chroma * colour_weight(viewing, adapted) > raise
        })
        .collect();
    Ok(Yee {
        visible_pixels: visible.iter().filter(|v| **v).count() as u64,
        visible,
    })
}

fn check(viewing: &Viewing) -> Result<(), MeasureError> {
    let Viewing {
        field_of_view,
        white,
        colour_weight,
    } = *viewing;
    if !(field_of_view > 0.0 && field_of_view < 180.0) {
        return Err(MeasureError::value(
            "field of view",
            format!("{field_of_view}°, where more than 0 and less than 180 serve"),
        ));
    }
    if !(white > 0.0 && white <= 1e9) {
        return Err(MeasureError::value(
            "luminance of white",
            format!("{white} cd/m², where a positive luminance is needed"),
        ));
    }
    if !(colour_weight >= 0.0 && colour_weight.is_finite()) {
        return Err(MeasureError::value(
            "weight of colour",
            format!("{colour_weight}, where 0 or more serves"),
        ));
    }
    Ok(())
}

/// Ever smoother copies of a plane, all of its size.
fn pyramid(plane: Vec<f64>, size: [usize; 2]) -> Vec<Vec<f64>> {
    let kernel = Kernel(GENERATING.to_vec());
    let mut levels = vec![plane];
    while levels.len() < LEVELS {
        let next = filtered(&levels[levels.len() - 1], size, &kernel, &kernel);
        levels.push(next);
    }
    levels
}

/// The frequencies of the pyramid's bands as the viewer sees them.
struct Bands {
    /// The level that averages over about a degree, to which the eye adapts.
    adaptation: usize,
    cycles_per_degree: [f64; BANDS],
    /// How much less sensitive the eye is to each band than to the best frequency.
    frequency_raise: [f64; BANDS],
}

impl Bands {
    fn new(viewing: &Viewing, width: usize) -> Self {
        // The screen is flat: so many degrees it would have if all were as wide as the middle one.
        let degrees = 2.0
            * (viewing.field_of_view / 2.0)
                .to_radians()
                .tan()
                .to_degrees();
        let pixels_per_degree = width as f64 / degrees;
        let cycles_per_degree =
            std::array::from_fn(|band| 0.5 * pixels_per_degree / f64::from(1u32 << band));
        let best = contrast_sensitivity(BEST_FREQUENCY, FREQUENCY_LUMINANCE);
        Self {
            adaptation: (0..LEVELS - 1)
                .find(|level| f64::from(1u32 << level) > degrees)
                .unwrap_or(LEVELS - 1),
            cycles_per_degree,
            frequency_raise: cycles_per_degree.map(|cycles| {
                (best / contrast_sensitivity(cycles, FREQUENCY_LUMINANCE)).min(UNSEEN)
            }),
        }
    }

    /// By how much the threshold of a pixel is raised: the mean over the bands, weighted by contrast.
    fn raise(&self, a: &[Vec<f64>], b: &[Vec<f64>], i: usize, adapted: f64) -> f64 {
        let mut total = 0.0;
        let mut raised = 0.0;
        for band in 0..BANDS {
            let detail = |p: &[Vec<f64>]| (p[band][i] - p[band + 1][i]).abs();
            let surroundings = a[band + 2][i].max(b[band + 2][i]).max(DARKEST);
            let contrast = detail(a).max(detail(b)) / surroundings;
            let seen = contrast * contrast_sensitivity(self.cycles_per_degree[band], adapted);
            total += contrast;
            raised += contrast * self.frequency_raise[band] * masking(seen);
        }
        // Without any contrast nothing masks, and nothing is raised.
        (raised / total.max(LEAST_CONTRAST)).clamp(1.0, LARGEST_RAISE)
    }
}

/// In dim light colour matters less, none at all near darkness.
fn colour_weight(viewing: &Viewing, adapted: f64) -> f64 {
    let dim = (adapted / COLOUR_VISION_FROM).min(1.0);
    viewing.colour_weight * dim * dim
}

/// Threshold versus intensity: the smallest visible difference of luminance in cd/m², at an adaptation
/// luminance in cd/m² (Ferwerda et al. 1996 as fitted by Ward Larson, Rushmeier and Piatko 1997).
fn threshold_versus_intensity(adapted: f64) -> f64 {
    let log = adapted.log10();
    let threshold = if log < -3.94 {
        -2.86
    } else if log < -1.44 {
        (0.405 * log + 1.6).powf(2.18) - 2.86
    } else if log < -0.0184 {
        log - 0.395
    } else if log < 1.9 {
        (0.249 * log + 0.65).powf(2.7) - 0.72
    } else {
        log - 1.255
    };
    10f64.powf(threshold)
}

/// Barten's contrast sensitivity to a frequency in cycles per degree at a luminance in cd/m².
fn contrast_sensitivity(cycles: f64, luminance: f64) -> f64 {
    let a = 440.0 * (1.0 + 0.7 / luminance).powf(-0.2);
    let b = 0.3 * (1.0 + 100.0 / luminance).powf(0.15);
    // √(1 + 0.06 e^(bu)) e^(−bu), written so that nothing overflows for fine patterns.
    let decay = (-b * cycles).exp();
    a * cycles * (decay * (decay + 0.06)).sqrt()
}

/// Daly's raise of the threshold by a contrast in units of its own threshold.
fn masking(contrast: f64) -> f64 {
    let a = (392.498 * contrast).powf(0.7);
    (1.0 + (0.0153 * a).powi(4)).powf(0.25)
}

#[cfg(test)]
#[path = "yee_tests.rs"]
mod tests;
