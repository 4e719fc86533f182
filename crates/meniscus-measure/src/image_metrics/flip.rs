//! FLIP: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild 2020,
//! "FLIP: A Difference Evaluator for Alternating Images", doi 10.1145/3406183.
//!
//! What the eye cannot resolve is filtered out, what is left is compared as colours and as edges and
//! points, and the second sharpens the first. Section and equation numbers below are the paper's.

use std::f64::consts::PI;

use super::filter::{Kernel, filtered};
use super::flip_colour::{Spaces, hyab};
use super::{Difference, Image, Pair, mean, narrowed};
use crate::MeasureError;

/// How the pictures are looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlipOptions {
    /// Pixels per degree of visual angle.
    pub pixels_per_degree: f64,
}

impl FlipOptions {
    /// Looking from `distance_m` at a screen `width_m` wide with `width_px` pixels side by side.
    pub fn viewing(distance_m: f64, width_m: f64, width_px: f64) -> Self {
        Self {
            pixels_per_degree: distance_m * (width_px / width_m) * PI / 180.0,
        }
    }
}

impl Default for FlipOptions {
    /// The paper's: 0.7 m from a screen 0.7 m and 3840 pixels wide, 67 pixels per degree.
    fn default() -> Self {
        Self::viewing(0.7, 0.7, 3840.0)
    }
}

/// Contrast sensitivity as Gaussians `a √(π/b) exp(−π² x² / b)`, x in degrees (table 1): achromatic,
/// red–green and blue–yellow; the last is a sum of two.
const SENSITIVITY: [&[[f64; 2]]; 3] = [
    &[[1.0, 0.0047]],
    &[[1.0, 0.0053]],
    &[[34.1, 0.04], [13.5, 0.025]],
];
/// The widest `b` above sets the radius of all filters.
const WIDEST: f64 = 0.04;
/// Compresses large colour differences (section 4.1.3).
const COLOUR_EXPONENT: f64 = 0.7;
/// Colour differences up to this share of the largest …
const KNEE: f64 = 0.4;
/// … take up this share of the range.
const KNEE_VALUE: f64 = 0.95;
/// Width of the feature detectors, in degrees (section 4.2.1).
const FEATURE_WIDTH: f64 = 0.082;
/// Raises small feature differences (section 4.2.2).
const FEATURE_EXPONENT: f64 = 0.5;
/// Beyond this, filters would be wider than any picture.
const MOST_PIXELS_PER_DEGREE: f64 = 10_000.0;

/// The FLIP difference, `0 ..= 1`: the mean over the pixels, and each pixel's own in the map.
///
/// Colours are clamped to `[0, 1]`. `reference` and `test` may be exchanged.
///
/// # Errors
/// [`MeasureError::Value`] when the pictures differ in size, or `options` are not positive and usable.
pub fn flip(
    reference: &Image,
    test: &Image,
    options: &FlipOptions,
) -> Result<Difference, MeasureError> {
    let pair = Pair::of(reference, test)?.clamped(1.0);
    let evaluator = Evaluator::new(options, pair.size)?;
    let mut map = evaluator.map(&pair.reference, &pair.test);
    mark_broken(&mut map, &pair.broken);
    Ok(Difference {
        value: mean(&map),
        map: narrowed(&map),
    })
}

pub(super) fn mark_broken(map: &mut [f64], broken: &[bool]) {
    for (error, _) in map.iter_mut().zip(broken).filter(|(_, broken)| **broken) {
        *error = 1.0;
    }
}

/// FLIP for pictures of one size seen in one way.
pub(super) struct Evaluator {
    size: [usize; 2],
    spaces: Spaces,
    /// Per opponent channel, the Gaussians that add up to its filter: weight and kernel.
    sensitivity: [Vec<(f64, Kernel)>; 3],
    smooth: Kernel,
    slope: Kernel,
    curvature: Kernel,
    largest_colour_error: f64,
}

impl Evaluator {
    pub(super) fn new(options: &FlipOptions, size: [usize; 2]) -> Result<Self, MeasureError> {
        let ppd = options.pixels_per_degree;
        if !(ppd > 0.0 && ppd <= MOST_PIXELS_PER_DEGREE) {
            return Err(MeasureError::value(
                "pixels per degree",
                format!("{ppd}, where more than 0 and at most {MOST_PIXELS_PER_DEGREE} serve"),
            ));
        }
        let spaces = Spaces::new();
        let hunt = |linear| spaces.hunt_lab(linear);
        let green_to_blue = hyab(hunt([0.0, 1.0, 0.0]), hunt([0.0, 0.0, 1.0]));
        let deviation = 0.5 * FEATURE_WIDTH * ppd;
        let radius = (3.0 * deviation).ceil() as usize;
        let bell = move |x: f64| (-x * x / (2.0 * deviation * deviation)).exp();
        Ok(Self {
            size,
            sensitivity: SENSITIVITY.map(|gaussians| sensitivity(gaussians, ppd)),
            smooth: Kernel::sampled(radius, bell).normalised(),
            slope: Kernel::sampled(radius, |x| -x * bell(x)).balanced(),
            curvature: Kernel::sampled(radius, |x| {
                (x * x / (deviation * deviation) - 1.0) * bell(x)
            })
            .balanced(),
            largest_colour_error: green_to_blue.powf(COLOUR_EXPONENT),
            spaces,
        })
    }

    /// The difference of each pixel of two pictures of linear colours in `[0, 1]`.
    pub(super) fn map(&self, reference: &[[f64; 3]], test: &[[f64; 3]]) -> Vec<f64> {
        let [a, b] = [reference, test].map(|image| self.seen(image));
        let colours = a.colours.iter().zip(&b.colours);
        let features = a.features.iter().zip(&b.features);
        colours
            .zip(features)
            .map(|((p, q), ([edge, point], [other_edge, other_point]))| {
                let colour = self.colour_difference(*p, *q);
                let feature = (edge - other_edge).abs().max((point - other_point).abs());
                let feature = (feature * std::f64::consts::FRAC_1_SQRT_2).powf(FEATURE_EXPONENT);
                // Equation 1. The features are at most 1 but for rounding.
                colour.powf(1.0 - feature.min(1.0))
            })
            .collect()
    }

    /// The colour pipeline's end (section 4.1.3): `0 ..= 1`.
    fn colour_difference(&self, a: [f64; 3], b: [f64; 3]) -> f64 {
        let largest = self.largest_colour_error;
        let error = hyab(a, b).powf(COLOUR_EXPONENT);
        let knee = KNEE * largest;
        if error < knee {
            KNEE_VALUE / knee * error
        } else {
            (KNEE_VALUE + (error - knee) / (largest - knee) * (1.0 - KNEE_VALUE)).min(1.0)
        }
    }

    fn seen(&self, linear: &[[f64; 3]]) -> Seen {
        let opponent: Vec<[f64; 3]> = linear.iter().map(|c| self.spaces.opponent(*c)).collect();
        let channel = |i: usize| -> Vec<f64> { opponent.iter().map(|c| c[i]).collect() };
        let filtered_channels: [Vec<f64>; 3] =
            std::array::from_fn(|i| self.perceived(&channel(i), i));
        let colours = (0..linear.len())
            .map(|i| {
                let rgb = self
                    .spaces
                    .linear(std::array::from_fn(|c| filtered_channels[c][i]));
                self.spaces.hunt_lab(rgb.map(|c| c.clamp(0.0, 1.0)))
            })
            .collect();
        // Features are looked for in the achromatic channel before it is filtered.
        let grey: Vec<f64> = opponent.iter().map(|c| (c[0] + 16.0) / 116.0).collect();
        let edges = self.gradient(&grey, &self.slope);
        let points = self.gradient(&grey, &self.curvature);
        Seen {
            colours,
            features: edges.into_iter().zip(points).map(|(e, p)| [e, p]).collect(),
        }
    }

    fn perceived(&self, plane: &[f64], channel: usize) -> Vec<f64> {
        let mut sum = vec![0.0; plane.len()];
        for (weight, kernel) in &self.sensitivity[channel] {
            let part = filtered(plane, self.size, kernel, kernel);
            for (total, value) in sum.iter_mut().zip(part) {
                *total += weight * value;
            }
        }
        sum
    }

    fn gradient(&self, grey: &[f64], derivative: &Kernel) -> Vec<f64> {
        let along_x = filtered(grey, self.size, derivative, &self.smooth);
        let along_y = filtered(grey, self.size, &self.smooth, derivative);
        along_x
            .iter()
            .zip(&along_y)
            .map(|(x, y)| x.hypot(*y))
            .collect()
    }
}

/// What is left of a picture after the eye: colours in Hunt-adjusted CIELAB, edge and point strength.
struct Seen {
    colours: Vec<[f64; 3]>,
    features: Vec<[f64; 2]>,
}

/// One channel's filter. A sum of two Gaussians is not separable but each of them is, so each gets the
/// share of the whole that it has in two dimensions.
fn sensitivity(gaussians: &[[f64; 2]], ppd: f64) -> Vec<(f64, Kernel)> {
    let radius = (3.0 * (WIDEST / (2.0 * PI * PI)).sqrt() * ppd).ceil() as usize;
    let parts: Vec<(f64, Kernel)> = gaussians
        .iter()
        .map(|[a, b]| {
            let kernel = Kernel::sampled(radius, |x| (-(PI * x / ppd).powi(2) / b).exp());
            let sum: f64 = kernel.0.iter().sum();
            (a * (PI / b).sqrt() * sum * sum, kernel.normalised())
        })
        .collect();
    let total: f64 = parts.iter().map(|(weight, _)| weight).sum();
    parts
        .into_iter()
        .map(|(weight, kernel)| (weight / total, kernel))
        .collect()
}
