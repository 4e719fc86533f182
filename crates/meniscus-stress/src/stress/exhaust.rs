//! Functions of one `f32`, tried on every one of them.

use rayon::prelude::*;

use super::verdict::Subject;
use crate::error::Trap;
use crate::number::Dual;
use crate::shape::{Column, Lanes};
use crate::ulp::{at_rank, rank, ulps};

/// What is left to say when nothing was left out.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Exhausted {
    /// Numbers tried.
    pub inputs: u64,
    /// The largest error of `f32` against the truth, or against `f64` where there is none, in ulps.
    pub max: f64,
    /// Where it is.
    pub at: f32,
    /// The largest error / (1 + condition), in ulps.
    pub scaled: f64,
    /// Where it is.
    pub scaled_at: f32,
    /// Results that are not finite.
    pub non_finite: u64,
}

/// Numbers that one thread tries at a time.
const BATCH: i64 = 1 << 16;

impl Exhausted {
    /// Of no number.
    pub const NOTHING: Self = Self {
        inputs: 0,
        max: 0.0,
        at: 0.0,
        scaled: 0.0,
        scaled_at: 0.0,
        non_finite: 0,
    };

    /// The worse of both, over the numbers of both.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        let (max, scaled) = (other.max > self.max, other.scaled > self.scaled);
        Self {
            inputs: self.inputs + other.inputs,
            non_finite: self.non_finite + other.non_finite,
            max: if max { other.max } else { self.max },
            at: if max { other.at } else { self.at },
            scaled: if scaled { other.scaled } else { self.scaled },
            scaled_at: if scaled {
                other.scaled_at
            } else {
                self.scaled_at
            },
        }
    }
}

impl Subject<'_> {
    /// Tries every `f32` from `low` to `high`, NaN left out. All of them take minutes.
    ///
    /// # Errors
    ///
    /// The [`Trap`] of a run; [`Trap::ArgumentCount`] or [`Trap::ArgumentShape`] where the
    /// function does not take one `f32`.
    pub fn exhaust(&self, low: f32, high: f32) -> Result<Exhausted, Trap> {
        let (first, last) = (rank(low), rank(high));
        let batches = (last - first).div_euclid(BATCH) + 1;
        let batch = |i: i64| {
            let start = first + i * BATCH;
            self.try_all(start, (start + BATCH - 1).min(last))
        };
        (0..batches.max(0))
            .into_par_iter()
            .map(batch)
            .try_reduce(|| Exhausted::NOTHING, |a, b| Ok(a.and(b)))
    }

    fn try_all(&self, first: i64, last: i64) -> Result<Exhausted, Trap> {
        let numbers: Vec<f32> = (first..=last).map(at_rank).collect();
        let count = numbers.len();
        let given = [Lanes {
            columns: vec![Column::Float(numbers.clone())],
        }];
        let single = match self.elsewhere {
            Some(call) => call(&given, count)?,
            None => self.function.call(&given, count, self.resources)?,
        };
        let double = self.run::<f64>(&given, count)?;
        let relative = |&x: &f32| Dual::new(f64::from(x), f64::from(x));
        let duals = [Lanes {
            columns: vec![Column::Float(numbers.iter().map(relative).collect())],
        }];
        let duals = self.function.call(&duals, count, self.resources)?;
        let truths: Option<Vec<Vec<f64>>> = self.truth.map(|truth| {
            let numbers = numbers.iter();
            numbers.map(|&x| truth(&[f64::from(x)])).collect()
        });
        let mut found = Exhausted {
            inputs: count as u64,
            at: numbers.first().copied().unwrap_or(0.0),
            ..Exhausted::NOTHING
        };
        for leaf in 0..single.columns.len() {
            let columns = (single.floats(leaf), double.floats(leaf), duals.floats(leaf));
            let (Some(single), Some(double), Some(duals)) = columns else {
                continue;
            };
            for (lane, &x) in numbers.iter().enumerate() {
                let single = single[lane];
                found.non_finite += u64::from(!single.is_finite());
                let truth = truths.as_ref().and_then(|t| t[lane].get(leaf)).copied();
                let right = truth.filter(|t| !t.is_nan()).unwrap_or(double[lane]);
                let error = ulps(single, right);
                if error > found.max {
                    (found.max, found.at) = (error, x);
                }
                let condition = duals[lane].slope.abs() / right.abs();
                let condition = if condition.is_nan() { 0.0 } else { condition };
                let scaled = error / (1.0 + condition);
                if scaled > found.scaled {
                    (found.scaled, found.scaled_at) = (scaled, x);
                }
            }
        }
        Ok(found)
    }
}
