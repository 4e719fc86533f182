//! Whether numbers drift over the course of a run.

use crate::median;

/// A drift of a series of samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Trend {
    /// Standard normal score of the test; beyond ±2.58 a drift is there with 99 % confidence.
    pub score: f64,
    /// Change from the first sample to the last, in the unit of the samples.
    pub change: f64,
}

/// Samples beyond this are thinned out before the test, which compares all pairs.
const MOST_SAMPLES: usize = 500;

/// Mann and Kendall's test for a monotone drift, with the slope of Theil and Sen.
///
/// Ranks only, so that single slow frames do not count for more than others.
/// `None` for fewer than ten samples.
pub(crate) fn trend(samples: &[f64]) -> Option<Trend> {
    if samples.len() < 10 {
        return None;
    }
    let stride = samples.len().div_ceil(MOST_SAMPLES);
    let series: Vec<f64> = samples.chunks(stride).filter_map(median).collect();
    let n = series.len();
    let mut sum = 0.0;
    let mut slopes = Vec::with_capacity(n * (n - 1) / 2);
    for i in 0..n {
        for j in i + 1..n {
            let rise = series[j] - series[i];
            sum += if rise == 0.0 { 0.0 } else { rise.signum() };
            slopes.push(rise / (j - i) as f64);
        }
    }
    let m = n as f64;
    // Variance without drift, less what ties take away.
    let spread = |t: f64| t * (t - 1.0) * (2.0 * t + 5.0) / 18.0;
    let sorted = crate::statistics::ascending(&series);
    let ties: f64 = sorted
        .chunk_by(|a, b| a == b)
        .map(|tied| spread(tied.len() as f64))
        .sum();
    let deviation = (spread(m) - ties).max(0.0).sqrt();
    // One step towards zero: the continuity correction.
    let score = if deviation == 0.0 {
        0.0
    } else {
        (f64::abs(sum) - 1.0).max(0.0).copysign(sum) / deviation
    };
    Some(Trend {
        score,
        change: median(&slopes)? * (m - 1.0),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    fn noisy(n: usize, seed: u64, at: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut random = SplitMix64(seed);
        (0..n)
            .map(|i| at(i as f64 / (n - 1) as f64) + 0.1 * random.unit())
            .collect()
    }

    #[test]
    fn a_steady_series_rarely_drifts() {
        let alarms = (0..400)
            .filter(|seed| trend(&noisy(40, *seed, |_| 1.0)).unwrap().score.abs() > 2.58)
            .count();
        // One in a hundred is what the score promises.
        assert!(alarms <= 12, "{alarms} of 400");
    }

    #[test]
    fn a_drift_is_found_with_its_size_and_sign() {
        for (n, change) in [(20, 0.5), (200, -0.5), (3000, -0.2)] {
            let found = trend(&noisy(n, 7, |t| 1.0 + change * t)).unwrap();
            assert!(found.score * change.signum() > 2.58);
            assert!((found.change - change).abs() < 0.08, "{found:?}");
        }
    }

    #[test]
    fn one_slow_frame_is_no_drift() {
        let mut samples = noisy(30, 3, |_| 1.0);
        samples[0] = 100.0;
        let found = trend(&samples).unwrap();
        assert!(
            found.score.abs() < 2.58 && found.change.abs() < 0.1,
            "{found:?}"
        );
    }

    #[test]
    fn equal_samples_do_not_drift_and_few_say_nothing() {
        assert_eq!(
            trend(&[2.0; 30]),
            Some(Trend {
                score: 0.0,
                change: 0.0
            })
        );
        assert_eq!(trend(&[1.0; 9]), None);
    }
}
