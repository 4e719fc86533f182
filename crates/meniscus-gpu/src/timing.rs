//! How long a frame took, and by whose clock.

/// The clock behind a time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Timer {
    /// The GPU's timestamps.
    Gpu,
    /// From submission to the end of waiting, on the CPU.
    Wall,
}

impl std::fmt::Display for Timer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Gpu => "gpu",
            Self::Wall => "wall",
        })
    }
}

/// One frame's times, milliseconds.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameTiming {
    /// The clock to trust for this frame alone; for a series ask [`Timer::of`].
    pub timer: Timer,
    /// The frame by the GPU's timestamps, from the first pass's begin to the last one's end; none
    /// where the adapter has none that make sense.
    pub gpu_ms: Option<f64>,
    /// From submission to the end of waiting.
    pub wall_ms: f64,
    /// The passes in order.
    pub passes: Vec<PassTiming>,
}

/// One pass's time.
#[derive(Debug, Clone, PartialEq)]
pub struct PassTiming {
    /// The pass's name.
    pub name: String,
    /// Milliseconds by the GPU's timestamps; none where they tell nothing.
    pub ms: Option<f64>,
}

impl FrameTiming {
    /// The frame's time by a clock, milliseconds: by the wall's if the GPU's told nothing.
    pub fn ms(&self, timer: Timer) -> f64 {
        match timer {
            Timer::Gpu => self.gpu_ms.unwrap_or(self.wall_ms),
            Timer::Wall => self.wall_ms,
        }
    }
}

impl Timer {
    /// The clock to trust for a series of frames: the GPU's if every frame has such a time and
    /// nine in ten of them hold up against the wall clock, so that one frame during which
    /// something else ran does not change the clock.
    pub fn of(frames: &[FrameTiming]) -> Self {
        let trusted = frames.iter().filter(|f| f.timer == Self::Gpu).count();
        let told = frames.iter().all(|f| f.gpu_ms.is_some());
        if told && trusted > 0 && 10 * trusted >= 9 * frames.len() {
            Self::Gpu
        } else {
            Self::Wall
        }
    }
}

/// A frame's timestamps: begin and end of every pass in order.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stamps<'a> {
    pub passes: &'a [[u64; 2]],
    /// Nanoseconds of a tick.
    pub period: f64,
}

/// Time that submitting, waking up and waiting take beside a frame, milliseconds.
const OVERHEAD_MS: f64 = 1.0;

/// Judges a frame's timestamps by its wall time.
///
/// The GPU's clock is not trusted where timestamps are missing (0) or run backwards, where the
/// frame is longer than the wall says, or where it covers less than half of the wall time beyond
/// what submission costs: some drivers report nothing for compute passes.
pub(crate) fn judge(stamps: Option<Stamps>, names: &[&str], wall_ms: f64) -> FrameTiming {
    let times = stamps.and_then(times);
    let (gpu_ms, passes) = match times {
        Some((frame, passes)) => (Some(frame), passes),
        None => (None, vec![None; names.len()]),
    };
    let covers = |frame: f64| frame <= 1.1 * wall_ms && frame >= 0.5 * (wall_ms - OVERHEAD_MS);
    let timer = if gpu_ms.is_some_and(covers) {
        Timer::Gpu
    } else {
        Timer::Wall
    };
    let passes = names.iter().zip(passes).map(|(name, ms)| PassTiming {
        name: (*name).to_owned(),
        ms: ms.filter(|_| timer == Timer::Gpu),
    });
    FrameTiming {
        timer,
        gpu_ms,
        wall_ms,
        passes: passes.collect(),
    }
}

/// The frame's and the passes' milliseconds; none if the timestamps make no sense as a whole. A
/// pass that claims to have taken no time is unknown, and so is one that claims next to none while
/// all together leave more than a fifth of the frame unexplained.
fn times(stamps: Stamps) -> Option<(f64, Vec<Option<f64>>)> {
    let ms = |[begin, end]: [u64; 2]| {
        end.checked_sub(begin)
            .map(|t| t as f64 * stamps.period * 1e-6)
    };
    if stamps.passes.iter().flatten().any(|&stamp| stamp == 0) {
        return None;
    }
    // Passes may overlap, so that the last one need not be the last to end.
    let begin = stamps.passes.iter().map(|p| p[0]).min()?;
    let end = stamps.passes.iter().map(|p| p[1]).max()?;
    let frame = [begin, end];
    let frame = ms(frame).filter(|&t| t > 0.0 && t.is_finite())?;
    let passes: Vec<f64> = stamps
        .passes
        .iter()
        .map(|&p| ms(p))
        .collect::<Option<_>>()?;
    let explained = passes.iter().sum::<f64>() >= 0.8 * frame;
    // A thousandth of a frame is less than any real pass among few takes.
    let told = |&t: &f64| (t > 0.0 && (explained || t > 1e-3 * frame)).then_some(t);
    Some((frame, passes.iter().map(told).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const NAMES: [&str; 2] = ["one", "two"];

    /// Milliseconds as ticks of a microsecond, after a start that is not 0.
    fn stamps(passes: [[f64; 2]; 2]) -> [[u64; 2]; 2] {
        passes.map(|p| p.map(|ms| 1_000_000 + (ms * 1e3).round() as u64))
    }

    fn timing(passes: &[[u64; 2]], wall_ms: f64) -> FrameTiming {
        let period = 1000.0;
        judge(Some(Stamps { passes, period }), &NAMES, wall_ms)
    }

    #[test]
    fn timestamps_that_fit_the_wall_are_trusted() {
        let timing = timing(&stamps([[0.0, 4.0], [4.5, 9.0]]), 9.8);
        assert_eq!(timing.timer, Timer::Gpu);
        assert!((timing.ms(Timer::Gpu) - 9.0).abs() < 1e-9);
        let passes: Vec<f64> = timing.passes.iter().map(|p| p.ms.unwrap()).collect();
        assert!((passes[0] - 4.0).abs() < 1e-9 && (passes[1] - 4.5).abs() < 1e-9);
    }

    #[test]
    fn a_short_frame_is_trusted_although_submission_takes_longer() {
        let timing = timing(&stamps([[0.0, 0.05], [0.05, 0.1]]), 0.6);
        assert_eq!(timing.timer, Timer::Gpu);
    }

    #[test]
    fn missing_or_senseless_timestamps_fall_back_to_the_wall() {
        let good = stamps([[0.0, 4.0], [4.5, 9.0]]);
        let mut zero = good;
        zero[1] = [0, 0];
        let mut backwards = good;
        backwards[0].reverse();
        for (passes, wall_ms) in [(zero, 9.0), (backwards, 9.0), (good, 5.0), (good, 40.0)] {
            let timing = timing(&passes, wall_ms);
            assert_eq!(timing.timer, Timer::Wall);
            assert_eq!(timing.ms(timing.timer), wall_ms);
            assert!(timing.passes.iter().all(|p| p.ms.is_none()));
        }
        let none = judge(None, &NAMES, 3.0);
        assert_eq!(
            (none.timer, none.gpu_ms, none.passes.len()),
            (Timer::Wall, None, 2)
        );
    }

    #[test]
    fn a_pass_that_claims_to_take_no_time_is_unknown_not_zero() {
        // The second pass's work falls into the gap before the third.
        let names = ["one", "two", "three"];
        let stamps =
            |[a, b, c]: [[f64; 2]; 3]| [stamps([a, b])[0], stamps([b, c])[0], stamps([b, c])[1]];
        let passes = stamps([[0.0, 2.0], [2.0, 2.001], [8.0, 9.0]]);
        let period = 1000.0;
        let timing = judge(
            Some(Stamps {
                passes: &passes,
                period,
            }),
            &names,
            9.5,
        );
        assert_eq!(timing.timer, Timer::Gpu);
        assert!((timing.gpu_ms.unwrap() - 9.0).abs() < 1e-9);
        let told: Vec<bool> = timing.passes.iter().map(|p| p.ms.is_some()).collect();
        assert_eq!(told, [true, false, true]);
        // A short pass in a frame that is explained is believed.
        let passes = stamps([[0.0, 2.0], [2.0, 2.001], [2.1, 9.0]]);
        let timing = judge(
            Some(Stamps {
                passes: &passes,
                period,
            }),
            &names,
            9.5,
        );
        assert!((timing.passes[1].ms.unwrap() - 0.001).abs() < 1e-9);
    }

    #[test]
    fn one_disturbed_frame_does_not_change_the_clock_of_a_series() {
        let good = timing(&stamps([[0.0, 4.0], [4.0, 9.0]]), 9.8);
        let disturbed = timing(&stamps([[0.0, 4.0], [4.0, 9.0]]), 60.0);
        let mut frames = vec![good; 20];
        frames.push(disturbed.clone());
        assert_eq!(Timer::of(&frames), Timer::Gpu);
        frames.extend(vec![disturbed; 10]);
        assert_eq!(Timer::of(&frames), Timer::Wall);
        assert_eq!(Timer::of(&[]), Timer::Wall);
        let untold = judge(None, &NAMES, 9.0);
        frames.truncate(20);
        frames.push(untold);
        assert_eq!(Timer::of(&frames), Timer::Wall);
    }
}
