//! How far a frame is from the truth, in figures; over several moments, their mean and the worst.

use serde::{Deserialize, Serialize};

use crate::Summary;
use crate::results::{finite, finite_or_none};

/// How far a row is from the truth over the water pixels that have a physical answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// Distance on the screen in pixels, at most the frame's diagonal.
    pub position_px: Summary,
    /// Distance in the world in metres, at most the scene's diagonal.
    pub position_m: Summary,
    /// Share of the pixels with a position error of at most half a pixel, `0 ..= 1`.
    #[serde(serialize_with = "finite")]
    pub within_half_px: f64,
    /// Share of the pixels that show another object than the true one, `0 ..= 1`.
    #[serde(serialize_with = "finite")]
    pub wrong_object: f64,
    /// Root mean square error of the linear colours clamped to `[0, 1]`.
    #[serde(serialize_with = "finite")]
    pub rmse: f64,
    /// Peak signal-to-noise ratio of the same, in dB; [`crate::MAX_PSNR_DB`] for equal pictures.
    #[serde(serialize_with = "finite")]
    pub psnr: f64,
    /// Mean of FLIP ([`crate::flip`], its usual viewing distance) against the truth's picture,
    /// `0 ..= 1`; none in files of earlier versions.
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        serialize_with = "finite_or_none"
    )]
    pub flip: Option<f64>,
    /// The same figures over the border band; `null` where it holds no pixel to judge.
    pub border: Option<BorderErrors>,
}

/// The figures of [`Errors`] over a part of the frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BorderErrors {
    /// See [`Errors::position_px`].
    pub position_px: Summary,
    /// See [`Errors::position_m`].
    pub position_m: Summary,
    /// See [`Errors::within_half_px`].
    #[serde(serialize_with = "finite")]
    pub within_half_px: f64,
    /// See [`Errors::wrong_object`].
    #[serde(serialize_with = "finite")]
    pub wrong_object: f64,
    /// See [`Errors::rmse`].
    #[serde(serialize_with = "finite")]
    pub rmse: f64,
    /// See [`Errors::psnr`].
    #[serde(serialize_with = "finite")]
    pub psnr: f64,
    /// See [`Errors::flip`].
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        serialize_with = "finite_or_none"
    )]
    pub flip: Option<f64>,
}

/// What becomes of one figure's values at several moments; there is at least one.
type Fold = fn(&[f64]) -> f64;

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn most(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

fn least(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}

impl Errors {
    /// Each figure's mean over several moments; none without a moment.
    pub fn mean(moments: &[Self]) -> Option<Self> {
        Self::folded(moments, [mean, mean])
    }

    /// Each figure's worst value over several moments: the largest, or the smallest where large is
    /// good; none without a moment. The figures may be of different moments.
    pub fn worst(moments: &[Self]) -> Option<Self> {
        Self::folded(moments, [most, least])
    }

    /// The figures over the whole frame.
    pub fn whole(&self) -> BorderErrors {
        BorderErrors {
            position_px: self.position_px,
            position_m: self.position_m,
            within_half_px: self.within_half_px,
            wrong_object: self.wrong_object,
            rmse: self.rmse,
            psnr: self.psnr,
            flip: self.flip,
        }
    }

    /// Errors with these figures over the whole frame.
    pub fn new(whole: BorderErrors, border: Option<BorderErrors>) -> Self {
        Self {
            position_px: whole.position_px,
            position_m: whole.position_m,
            within_half_px: whole.within_half_px,
            wrong_object: whole.wrong_object,
            rmse: whole.rmse,
            psnr: whole.psnr,
            flip: whole.flip,
            border,
        }
    }

    fn folded(moments: &[Self], folds: [Fold; 2]) -> Option<Self> {
        let whole: Vec<BorderErrors> = moments.iter().map(Self::whole).collect();
        let border: Vec<BorderErrors> = moments.iter().filter_map(|m| m.border.clone()).collect();
        let whole = BorderErrors::folded(&whole, folds)?;
        Some(Self::new(whole, BorderErrors::folded(&border, folds)))
    }
}

impl BorderErrors {
    /// Folds for figures of which small ones are good, and for those of which large ones are.
    fn folded(moments: &[Self], [small, large]: [Fold; 2]) -> Option<Self> {
        if moments.is_empty() {
            return None;
        }
        let over = |fold: Fold, figure: &dyn Fn(&Self) -> f64| {
            fold(&moments.iter().map(figure).collect::<Vec<_>>())
        };
        let summary = |part: fn(&Self) -> &Summary| Summary {
            mean: over(small, &|m| part(m).mean),
            median: over(small, &|m| part(m).median),
            p95: over(small, &|m| part(m).p95),
            p99: over(small, &|m| part(m).p99),
        };
        let flips: Vec<f64> = moments.iter().filter_map(|m| m.flip).collect();
        Some(Self {
            position_px: summary(|m| &m.position_px),
            position_m: summary(|m| &m.position_m),
            within_half_px: over(large, &|m| m.within_half_px),
            wrong_object: over(small, &|m| m.wrong_object),
            rmse: over(small, &|m| m.rmse),
            psnr: over(large, &|m| m.psnr),
            flip: (!flips.is_empty()).then(|| small(&flips)),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn errors(size: f64) -> Errors {
        let summary = Summary {
            mean: size,
            median: size / 2.0,
            p95: 2.0 * size,
            p99: 3.0 * size,
        };
        let whole = BorderErrors {
            position_px: summary,
            position_m: summary,
            within_half_px: 1.0 - size / 10.0,
            wrong_object: size / 10.0,
            rmse: size / 5.0,
            psnr: 30.0 - size,
            flip: Some(size / 20.0),
        };
        Errors::new(whole.clone(), Some(whole))
    }

    #[test]
    fn one_moment_is_its_own_mean_and_worst() {
        let one = [errors(3.0)];
        assert_eq!(Errors::mean(&one).as_ref(), Some(&one[0]));
        assert_eq!(Errors::worst(&one).as_ref(), Some(&one[0]));
        assert_eq!(Errors::mean(&[]), None);
    }

    #[test]
    fn the_worst_moment_is_large_where_small_is_good_and_small_where_large_is() {
        let moments = [errors(1.0), errors(3.0)];
        assert_eq!(Errors::worst(&moments), Some(errors(3.0)));
        let mean = Errors::mean(&moments).unwrap();
        assert_eq!((mean.position_px.p99, mean.psnr), (6.0, 28.0));
    }

    #[test]
    fn a_border_that_some_moments_lack_is_that_of_the_others() {
        let mut moments = [errors(1.0), errors(3.0)];
        moments[0].border = None;
        let mean = Errors::mean(&moments).unwrap();
        assert_eq!(mean.border, errors(3.0).border);
        assert_eq!(mean.position_px.mean, 2.0);
    }
}
