//! Errors that look at one pixel at a time.

use super::{Difference, Image, Pair, mean, narrowed};
use crate::MeasureError;
use crate::colour::psnr_of;

/// Root mean square error over pixels and channels, in linear colour clamped to `[0, 1]`.
///
/// The map holds the root mean square over the channels of each pixel.
///
/// # Errors
/// [`MeasureError::Value`] when the pictures differ in size.
pub fn rmse(reference: &Image, test: &Image) -> Result<Difference, MeasureError> {
    let pair = Pair::of(reference, test)?.clamped(1.0);
    let squares: Vec<f64> = pair
        .reference
        .iter()
        .zip(&pair.test)
        .zip(&pair.broken)
        .map(|((a, b), broken)| {
            if *broken {
                return 1.0;
            }
            a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / 3.0
        })
        .collect();
    let roots: Vec<f64> = squares.iter().map(|s| s.sqrt()).collect();
    Ok(Difference {
        value: mean(&squares).sqrt(),
        map: narrowed(&roots),
    })
}

/// Peak signal-to-noise ratio in dB, in linear colour clamped to `[0, 1]`, with the map of [`rmse`].
///
/// Equal pictures have [`MAX_PSNR_DB`](crate::MAX_PSNR_DB), which no value exceeds.
///
/// # Errors
/// [`MeasureError::Value`] when the pictures differ in size.
pub fn psnr(reference: &Image, test: &Image) -> Result<Difference, MeasureError> {
    let error = rmse(reference, test)?;
    Ok(Difference {
        value: psnr_of(error.value),
        ..error
    })
}
