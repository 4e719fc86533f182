//! Structural similarity: Wang, Bovik, Sheikh, Simoncelli 2004, doi 10.1109/TIP.2003.819861.

use super::filter::{Kernel, filtered};
use super::{Difference, Image, Pair, mean, narrowed};
use crate::{MeasureError, linear_to_srgb};

/// Half the width of the window, in pixels: 11 × 11.
const RADIUS: usize = 5;
/// Standard deviation of the window's Gaussian, in pixels.
const DEVIATION: f64 = 1.5;
/// Keep the quotients finite in black and in even places; the range of the signal is 1.
const STABILISERS: [f64; 2] = [0.01 * 0.01, 0.03 * 0.03];

/// Mean structural similarity of two pictures, -1 … 1, of which 1 means equal.
///
/// On the luma of the sRGB-encoded colours (ITU-R BT.601 weights), in a Gaussian window of 11 × 11
/// pixels; the mean is over the pixels whose window lies inside the picture, as in the authors' own
/// evaluation. The map holds `(1 - similarity) / 2`, beyond that area with the edge pixels repeated.
///
/// # Errors
/// [`MeasureError::Value`] when the pictures differ in size or are smaller than the window.
pub fn ssim(reference: &Image, test: &Image) -> Result<Difference, MeasureError> {
    let pair = Pair::of(reference, test)?;
    let [width, height] = pair.size;
    let window = 2 * RADIUS + 1;
    if width < window || height < window {
        return Err(MeasureError::value(
            "size of the pictures",
            format!("{width}×{height} is less than the {window}×{window} window of this metric"),
        ));
    }
    let kernel =
        Kernel::sampled(RADIUS, |x| (-x * x / (2.0 * DEVIATION * DEVIATION)).exp()).normalised();
    let smooth = |plane: &[f64]| filtered(plane, pair.size, &kernel, &kernel);
    let a: Vec<f64> = pair.reference.iter().map(luma).collect();
    let b: Vec<f64> = pair.test.iter().map(luma).collect();
    let product =
        |x: &[f64], y: &[f64]| -> Vec<f64> { x.iter().zip(y).map(|(x, y)| x * y).collect() };
    let (mean_a, mean_b) = (smooth(&a), smooth(&b));
    let (aa, bb, ab) = (
        smooth(&product(&a, &a)),
        smooth(&product(&b, &b)),
        smooth(&product(&a, &b)),
    );
    let similarity: Vec<f64> = (0..a.len())
        .map(|i| {
            if pair.broken[i] {
                return -1.0;
            }
            let (ma, mb) = (mean_a[i], mean_b[i]);
            let [c1, c2] = STABILISERS;
            let covariance = ab[i] - ma * mb;
            // Differences of large numbers, so they may fall a little below 0.
            let variances = (aa[i] - ma * ma).max(0.0) + (bb[i] - mb * mb).max(0.0);
            let luminance = (2.0 * ma * mb + c1) / (ma * ma + mb * mb + c1);
            let structure = (2.0 * covariance + c2) / (variances + c2);
            (luminance * structure).clamp(-1.0, 1.0)
        })
        .collect();
    let inside: Vec<f64> = (RADIUS..height - RADIUS)
        .flat_map(|y| &similarity[y * width + RADIUS..(y + 1) * width - RADIUS])
        .copied()
        .collect();
    let map: Vec<f64> = similarity.iter().map(|s| (1.0 - s) / 2.0).collect();
    Ok(Difference {
        value: mean(&inside),
        map: narrowed(&map),
    })
}

fn luma(linear: &[f64; 3]) -> f64 {
    let [r, g, b] = linear.map(linear_to_srgb);
    0.299 * r + 0.587 * g + 0.114 * b
}
