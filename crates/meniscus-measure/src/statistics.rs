//! Quantiles and the four figures by which a set of errors is told.

use serde::{Deserialize, Serialize};

/// The `q`-quantile (`0 ..= 1`) of values in ascending order.
///
/// Linear interpolation between the order statistics (type 7 of Hyndman and Fan 1996, NumPy's
/// default), so that a stranger's script gets the same number. `None` without values.
pub fn quantile(ascending: &[f64], q: f64) -> Option<f64> {
    let last = ascending.len().checked_sub(1)?;
    let place = q.clamp(0.0, 1.0) * last as f64;
    let below = place.floor() as usize;
    let above = place.ceil() as usize;
    let (low, high) = (ascending[below], ascending[above]);
    // Equal neighbours need no interpolation, and two infinities cannot bear one.
    Some(if low == high {
        low
    } else {
        low + (high - low) * (place - below as f64)
    })
}

/// The median of values in any order; `None` without values.
pub fn median(values: &[f64]) -> Option<f64> {
    quantile(&ascending(values), 0.5)
}

pub(crate) fn ascending(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted
}

/// How large a set of errors is, in the unit of the errors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Arithmetic mean.
    #[serde(serialize_with = "crate::results::finite")]
    pub mean: f64,
    /// Half of the errors are at most this.
    #[serde(serialize_with = "crate::results::finite")]
    pub median: f64,
    /// 95 % of the errors are at most this.
    #[serde(serialize_with = "crate::results::finite")]
    pub p95: f64,
    /// 99 % of the errors are at most this.
    #[serde(serialize_with = "crate::results::finite")]
    pub p99: f64,
}

impl Summary {
    /// The figures of `values`, in any order; `None` without values. See [`quantile`].
    pub fn of(values: &[f64]) -> Option<Self> {
        let sorted = ascending(values);
        Some(Self {
            // Summed in ascending order: the result does not depend on the order of the pixels.
            mean: sorted.iter().sum::<f64>() / sorted.len().max(1) as f64,
            median: quantile(&sorted, 0.5)?,
            p95: quantile(&sorted, 0.95)?,
            p99: quantile(&sorted, 0.99)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn nothing_has_no_quantile() {
        assert_eq!(quantile(&[], 0.5), None);
        assert_eq!(Summary::of(&[]), None);
    }

    proptest! {
        #[test]
        fn a_quantile_parts_the_values_by_count(
            values in prop::collection::vec(-1e6f64..1e6, 1..200), q in 0.0f64..=1.0,
        ) {
            let x = quantile(&ascending(&values), q).unwrap();
            let n = values.len() as f64;
            let below = values.iter().filter(|v| **v < x).count() as f64;
            let above = values.iter().filter(|v| **v > x).count() as f64;
            // At most q of the gaps lie below the quantile, at most 1 - q above it.
            prop_assert!(below <= q * (n - 1.0) + 1.0);
            prop_assert!(above <= (1.0 - q) * (n - 1.0) + 1.0);
        }

        #[test]
        fn a_summary_ignores_the_order(
            (values, shuffled) in prop::collection::vec(0.0f64..1e3, 1..100)
                .prop_flat_map(|v| (Just(v.clone()), Just(v).prop_shuffle())),
        ) {
            prop_assert_eq!(Summary::of(&values), Summary::of(&shuffled));
        }

        #[test]
        fn a_summary_is_ordered_and_scales(
            values in prop::collection::vec(0.0f64..1e3, 1..100),
        ) {
            let s = Summary::of(&values).unwrap();
            prop_assert!(s.median <= s.p95 && s.p95 <= s.p99);
            let doubled: Vec<f64> = values.iter().map(|v| 2.0 * v).collect();
            let d = Summary::of(&doubled).unwrap();
            prop_assert_eq!((d.mean, d.p99), (2.0 * s.mean, 2.0 * s.p99));
        }
    }

    #[test]
    fn quantiles_of_a_ramp_are_linear() {
        let ramp: Vec<f64> = (0..=100).map(f64::from).collect();
        for percent in 0..=100 {
            let q = quantile(&ramp, f64::from(percent) / 100.0).unwrap();
            assert!((q - f64::from(percent)).abs() < 1e-12);
        }
    }
}
