//! Functions of one `f32`, tried on every one of them.

use rayon::prelude::*;

use super::verdict::Subject;
use crate::error::Trap;
use crate::resources::Resources;
use crate::shape::{Column, Lanes};
use crate::ulp::{at_rank, rank, ulps};

/// What is left to say when nothing was left out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exhausted {
    /// Numbers tried.
    pub inputs: u64,
    /// The largest error of `f32` against `f64`, in ulps.
    pub max: f64,
    /// Where it is.
    pub at: f32,
    /// Results that are not finite.
    pub non_finite: u64,
}

/// Numbers that one thread tries at a time.
const BATCH: i64 = 1 << 16;

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
        let none = Exhausted {
            inputs: 0,
            max: 0.0,
            at: low,
            non_finite: 0,
        };
        (0..batches.max(0)).into_par_iter().map(batch).try_reduce(
            || none,
            |a, b| {
                let worse = if b.max > a.max { b } else { a };
                Ok(Exhausted {
                    inputs: a.inputs + b.inputs,
                    non_finite: a.non_finite + b.non_finite,
                    ..worse
                })
            },
        )
    }

    fn try_all(&self, first: i64, last: i64) -> Result<Exhausted, Trap> {
        let numbers: Vec<f32> = (first..=last).map(at_rank).collect();
        let none: &Resources<'_> = self.resources;
        let single = [Lanes {
            columns: vec![Column::Float(numbers.clone())],
        }];
        let double = [single[0].converted::<f64>()];
        let single = self.function.call(&single, numbers.len(), none)?;
        let double = self.function.call(&double, numbers.len(), none)?;
        let at = numbers.first().copied().unwrap_or(0.0);
        let mut found = Exhausted {
            inputs: numbers.len() as u64,
            max: 0.0,
            at,
            non_finite: 0,
        };
        for leaf in 0..single.columns.len() {
            let (Some(single), Some(double)) = (single.floats(leaf), double.floats(leaf)) else {
                continue;
            };
            for ((&x, &single), &double) in numbers.iter().zip(single).zip(double) {
                found.non_finite += u64::from(!single.is_finite());
                let error = ulps(single, double);
                if error > found.max {
                    (found.max, found.at) = (error, x);
                }
            }
        }
        Ok(found)
    }
}
