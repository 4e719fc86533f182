//! Frame times: how long, how certain, and compared with a baseline of the same run.
//!
//! Pipelines are measured frame by frame in turns (rounds), so that whatever slows the machine slows
//! all of them: the ratio of two frames of one round is far steadier than either time.

use std::fmt;

use crate::random::SplitMix64;
use crate::results::{FrameMs, Relative};
use crate::statistics::ascending;
use crate::trend::trend;
use crate::{MeasureError, median, quantile};

/// The frame times of one pipeline, in milliseconds, one per round.
#[derive(Debug, Clone, PartialEq)]
pub struct Timing {
    samples: Vec<f64>,
}

impl Timing {
    /// Takes the samples in the order of the rounds.
    ///
    /// # Errors
    /// [`MeasureError::Value`] when there is none, or one is not a positive number: a timer that
    /// reports no time has not measured, and 0 ms must not be printed.
    pub fn new(samples: Vec<f64>) -> Result<Self, MeasureError> {
        if samples.is_empty() {
            return Err(MeasureError::value("frame times", "there is none"));
        }
        if let Some(i) = samples.iter().position(|s| !(s.is_finite() && *s > 0.0)) {
            return Err(MeasureError::value(
                format!("time of frame {i}"),
                format!(
                    "{} ms is not a time; measure with the wall clock instead",
                    samples[i]
                ),
            ));
        }
        Ok(Self { samples })
    }

    /// The samples in the order of the rounds, in milliseconds.
    pub fn samples(&self) -> &[f64] {
        &self.samples
    }

    /// Median, 10th and 90th percentile and minimum, for the results file.
    ///
    /// Percentiles rather than a standard deviation, because one frame that another program
    /// interrupts would decide the latter.
    pub fn frame_ms(&self) -> FrameMs {
        let sorted = ascending(&self.samples);
        let at = |q| quantile(&sorted, q).unwrap_or(sorted[0]);
        FrameMs {
            median: at(0.5),
            low: at(0.1),
            high: at(0.9),
            min: sorted[0],
            samples: self.samples.clone(),
        }
    }
}

/// How often the rounds are drawn anew for a confidence interval.
const RESAMPLES: usize = 2000;

/// Frame time as a multiple of the baseline's.
///
/// The n-th samples of both come from the same round. The interval holds the median of the rounds'
/// ratios with 95 % confidence (percentile bootstrap, Efron 1979: the rounds are drawn anew with
/// replacement 2,000 times from a fixed seed, so equal samples give equal intervals). The ratio of the
/// minima has no such interval: resampling cannot say how much faster a frame might have been.
///
/// # Errors
/// [`MeasureError::Length`] when the two did not run the same number of rounds.
pub fn relative_time(
    timing: &Timing,
    baseline: &Timing,
    baseline_name: &str,
) -> Result<Relative, MeasureError> {
    MeasureError::check_length(
        "frame times of the baseline",
        baseline.samples.len(),
        timing.samples.len(),
    )?;
    let ratios: Vec<f64> = timing
        .samples
        .iter()
        .zip(&baseline.samples)
        .map(|(a, b)| a / b)
        .collect();
    let (low, high) = median_interval(&ratios);
    Ok(Relative {
        to: baseline_name.to_owned(),
        median: median(&ratios).unwrap_or(1.0),
        low,
        high,
        of_minima: timing.frame_ms().min / baseline.frame_ms().min,
    })
}

fn median_interval(values: &[f64]) -> (f64, f64) {
    let mut random = SplitMix64(0x6D65_6E69_7363_7573);
    let mut drawn = vec![0.0; values.len()];
    let mut medians: Vec<f64> = (0..RESAMPLES)
        .filter_map(|_| {
            for slot in &mut drawn {
                *slot = values[random.below(values.len())];
            }
            median(&drawn)
        })
        .collect();
    medians.sort_by(f64::total_cmp);
    let at = |q| quantile(&medians, q).unwrap_or(values[0]);
    (at(0.025), at(0.975))
}

/// Why frame times deserve little trust, and what to do about it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TimingWarning {
    /// Fewer frames than an interval needs.
    FewSamples {
        /// How many there are.
        count: usize,
    },
    /// The frames differ much from each other.
    WideSpread {
        /// 90th less 10th percentile, as a share of the median.
        share: f64,
    },
    /// The timer's steps are not small against a frame.
    CoarseTimer {
        /// The smallest step seen, in milliseconds.
        step_ms: f64,
        /// That step as a share of the median.
        share: f64,
    },
    /// Frames became faster or slower in the course of the run.
    Drift {
        /// Change from the first frame to the last, as a share of the median; negative: faster.
        share: f64,
    },
}

/// Looks through the frame times of one pipeline for what makes them untrustworthy.
pub fn timing_warnings(timing: &Timing) -> Vec<TimingWarning> {
    let mut warnings = Vec::new();
    let frame = timing.frame_ms();
    let count = timing.samples.len();
    if count < 10 {
        warnings.push(TimingWarning::FewSamples { count });
    }
    let share = (frame.high - frame.low) / frame.median;
    if share > 0.25 {
        warnings.push(TimingWarning::WideSpread { share });
    }
    if let Some(step_ms) = coarse_step(&timing.samples) {
        let share = step_ms / frame.median;
        if share > 0.01 {
            warnings.push(TimingWarning::CoarseTimer { step_ms, share });
        }
    }
    if let Some(drift) = trend(&timing.samples) {
        let share = drift.change / frame.median;
        if drift.score.abs() > 2.58 && share.abs() > 0.05 {
            warnings.push(TimingWarning::Drift { share });
        }
    }
    warnings
}

/// The step of a timer whose readings repeat; `None` where they are all over the place.
///
/// A fine timer hardly gives one reading twice. One that gives every value about twice or more
/// steps, and the smallest distance between its readings is the step.
fn coarse_step(samples: &[f64]) -> Option<f64> {
    let mut readings = ascending(samples);
    // Readings that differ by rounding alone are one reading.
    readings.dedup_by(|a, b| *a - *b <= 1e-9 * *b);
    if samples.len() < 10 || readings.len() * 2 > samples.len() {
        return None;
    }
    if readings.len() == 1 {
        // The reading is a whole number of steps, so the step may be as large as the reading.
        return Some(readings[0]);
    }
    readings
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .min_by(f64::total_cmp)
}

impl fmt::Display for TimingWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::FewSamples { count } => write!(
                f,
                "only {count} frames were timed: measure at least 10, better 30 or more"
            ),
            Self::WideSpread { share } => write!(
                f,
                "frame times spread by {:.0} % of their median: close other programs or measure \
                 more frames, and trust the ratio of the minima rather than the median",
                100.0 * share
            ),
            Self::CoarseTimer { step_ms, share } => write!(
                f,
                "the timer steps by {step_ms:.3} ms, {:.0} % of a frame: render larger frames, or \
                 pick an adapter with finer timestamps",
                100.0 * share
            ),
            Self::Drift { share } if share < 0.0 => write!(
                f,
                "frames became {:.0} % faster during the run, as when clocks are still rising: \
                 warm up for longer and measure again",
                -100.0 * share
            ),
            Self::Drift { share } => write!(
                f,
                "frames became {:.0} % slower during the run, as when a device grows hot or other \
                 programs start: let it cool, close other programs and measure again",
                100.0 * share
            ),
        }
    }
}

#[cfg(test)]
#[path = "timing_tests.rs"]
mod tests;
