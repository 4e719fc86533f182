//! Frames of several pipelines, interleaved.

use std::time::{Duration, Instant};

use meniscus_gpu::{self as gpu, FrameTiming};
use meniscus_measure::{Timing, relative_time};

use crate::ablation::{AblationError, Progress};
use crate::moments::Moments;
use crate::subject::Subject;

/// How often pipelines are rendered.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rounds {
    /// Rounds that are not counted, first.
    pub warm_up: u32,
    /// Rounds that are counted; every pipeline renders one frame a round.
    pub counted: u32,
    /// Go on after those until every ratio to the baseline is known this well.
    pub until: Option<Until>,
}

/// How well ratios are to be known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Until {
    /// The widest 95 % confidence interval of a median ratio that will do, as a share of the ratio.
    pub width: f64,
    /// When to give up, counted from the first frame.
    pub limit: Duration,
}

/// Fewer rounds make no interval to go by.
const LEAST_FOR_AN_INTERVAL: usize = 10;

impl Default for Rounds {
    fn default() -> Self {
        Self {
            warm_up: 2,
            counted: 15,
            until: None,
        }
    }
}

impl Rounds {
    /// Frames of all subjects in turn, in an order that changes from round to round. Where there are
    /// several moments, each round is at the next of them, and the water is uploaded before every
    /// frame.
    pub(crate) fn time(
        &self,
        subjects: &mut [Subject],
        baseline: Option<usize>,
        moments: &mut Moments,
        progress: &Progress,
    ) -> Result<Vec<Vec<FrameTiming>>, AblationError> {
        let start = Instant::now();
        let mut timings: Vec<Vec<FrameTiming>> = subjects.iter().map(|_| Vec::new()).collect();
        let all = self.warm_up + self.counted;
        let mut look_at = LEAST_FOR_AN_INTERVAL.max(self.counted as usize);
        for round in 0.. {
            let counted = timings.first().map_or(0, Vec::len);
            if round >= all {
                let Some(until) = self.until else { break };
                let spent = start.elapsed();
                if spent >= until.limit || subjects.len() < 2 {
                    break;
                }
                if counted >= look_at {
                    if widest_interval(&timings, baseline)? <= until.width {
                        break;
                    }
                    // Intervals narrow slowly: looked at after every tenth part more.
                    look_at = counted + counted.div_ceil(10);
                }
                let part = spent.as_secs_f64() / until.limit.as_secs_f64();
                progress("timing until ratios are known", part);
            } else {
                progress("timing frames", f64::from(round) / f64::from(all.max(1)));
            }
            for index in order(round, subjects.len()) {
                if moments.are_several() {
                    // Counted rounds begin with the first moment.
                    let moment = round + moments.times().len() as u32 * self.warm_up - self.warm_up;
                    subjects[index].frame.update(moments.at(moment as usize))?;
                }
                let timing = subjects[index].frame.render()?;
                if round >= self.warm_up {
                    timings[index].push(timing);
                }
            }
        }
        Ok(timings)
    }
}

/// The widest confidence interval of all ratios to the baseline, as a share of the ratio; without a
/// baseline there is none to wait for.
fn widest_interval(
    timings: &[Vec<FrameTiming>],
    baseline: Option<usize>,
) -> Result<f64, AblationError> {
    let Some(baseline) = baseline else {
        return Ok(0.0);
    };
    let every: Vec<FrameTiming> = timings.iter().flatten().cloned().collect();
    let clock = gpu::Timer::of(&every);
    let timing = |frames: &[FrameTiming]| Timing::new(frames.iter().map(|f| f.ms(clock)).collect());
    let base = timing(&timings[baseline])?;
    let mut widest = 0.0f64;
    for (index, frames) in timings.iter().enumerate() {
        if index != baseline {
            let ratio = relative_time(&timing(frames)?, &base, "")?;
            widest = widest.max((ratio.high - ratio.low) / ratio.median);
        }
    }
    Ok(widest)
}

/// The order of the pipelines in a round: a different one each time, the same in every run.
pub(crate) fn order(round: u32, count: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    let mut state = u64::from(round) ^ 0x9e37_79b9_7f4a_7c15;
    for index in (1..count).rev() {
        // Knuth's linear congruential generator; its high bits choose.
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        order.swap(index, (state >> 33) as usize % (index + 1));
    }
    order
}

#[cfg(test)]
mod tests {
    use super::order;

    #[test]
    fn every_round_renders_all_in_an_order_of_its_own() {
        let rounds: Vec<_> = (0..20).map(|round| order(round, 6)).collect();
        for order in &rounds {
            let mut sorted = order.clone();
            sorted.sort_unstable();
            assert_eq!(sorted, [0, 1, 2, 3, 4, 5]);
        }
        assert!(rounds.iter().any(|o| *o != rounds[0]));
        assert_eq!(rounds[3], order(3, 6));
    }
}
