//! What is found out about single inputs.

use rayon::prelude::*;

use super::domain::{Domain, Input};
use crate::error::Trap;
use crate::function::Function;
use crate::number::{DoubleDouble, Dual, Interval, Scalar};
use crate::resources::Resources;
use crate::shape::{Column, Lanes};
use crate::ulp::{ulp, ulps};

/// A solution that shares nothing with the module: all numbers of an input in, all numbers of the
/// result out. NaN stands for "no opinion".
pub type Truth<'a> = dyn Fn(&[f64]) -> Vec<f64> + Sync + 'a;

/// Calls the function in `f32` in as many lanes: a GPU instead of the evaluator.
pub type Elsewhere<'a> = dyn Fn(&[Lanes<f32>], usize) -> Result<Lanes<f32>, Trap> + Sync + 'a;

/// What is put under stress.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// The function.
    pub function: &'a Function,
    /// Where its inputs lie.
    pub domain: &'a Domain,
    /// What it reads.
    pub resources: &'a Resources<'a>,
    /// What it reads, moved by a few ulps, each in another way; may be none.
    pub nearby: &'a [Resources<'a>],
    /// What is right, where that is known independently.
    pub truth: Option<&'a Truth<'a>>,
    /// What computes in `f32`; the evaluator where none is given.
    pub elsewhere: Option<&'a Elsewhere<'a>>,
}

/// What one input shows. Errors are the worst over the numbers of the result, in ulps of `f32`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Verdict {
    /// `f32` against the same formulas with 31 digits.
    pub rounding: f64,
    /// The formulas with 31 digits against the truth; 0 where there is none.
    pub method: f64,
    /// The largest of `method` / (1 + condition) over the numbers of the result, the condition being
    /// that of the arguments.
    pub method_scaled: f64,
    /// `f32` against the truth, or against 31 digits where there is none.
    pub total: f64,
    /// Relative change of the result for a relative change of the inputs, of the number that
    /// `scaled` is of: of the arguments, by differentiation; where that does not account for the
    /// error, of arguments and host values together, by trying inputs nearby.
    pub condition: f64,
    /// The largest of `rounding` / (1 + condition) over the numbers of the result.
    pub scaled: f64,
    /// Whether all numbers of the `f32` result are finite.
    pub finite: bool,
    /// Whether `f64` and 31 digits agree to 2⁻⁴⁰, so that the arithmetic behind this is to be
    /// trusted.
    pub trusted: bool,
    /// Whether integers or truth values of the result come out as with 31 digits; where they do
    /// not, errors are those against inputs nearby at which they do, and infinite where there is
    /// none.
    pub same_branch: bool,
    /// Whether a component of a vector was judged by the vector's length.
    pub whole: bool,
    /// A bound on `rounding` proven by intervals; infinite where they cannot decide.
    pub proven: f64,
}

/// Inputs that are judged at a time, by one thread.
const BATCH: usize = 1024;

impl Subject<'_> {
    /// Judges inputs, on all cores.
    ///
    /// # Errors
    ///
    /// The [`Trap`] of a run.
    pub fn judge(&self, inputs: &[Input]) -> Result<Vec<Verdict>, Trap> {
        let found = match self.elsewhere {
            Some(call) if !inputs.is_empty() => {
                let arguments = self.domain.lanes(self.function, inputs);
                Some(call(&arguments, inputs.len())?)
            }
            _ => None,
        };
        let batches = inputs.par_chunks(BATCH).enumerate().map(|(index, batch)| {
            let first = index * BATCH;
            let found = found.as_ref().map(|f| f.part(first..first + batch.len()));
            self.judge_batch(batch, found)
        });
        let batches: Vec<Vec<Verdict>> = batches.collect::<Result<_, Trap>>()?;
        Ok(batches.into_iter().flatten().collect())
    }

    pub(super) fn run<S: Scalar>(
        &self,
        arguments: &[Lanes<f32>],
        count: usize,
    ) -> Result<Lanes<S>, Trap> {
        let arguments: Vec<Lanes<S>> = arguments.iter().map(Lanes::converted).collect();
        self.function.call(&arguments, count, self.resources)
    }

    fn judge_batch(
        &self,
        inputs: &[Input],
        found: Option<Lanes<f32>>,
    ) -> Result<Vec<Verdict>, Trap> {
        let count = inputs.len();
        let arguments = self.domain.lanes(self.function, inputs);
        let single = match found {
            Some(found) => found,
            None => self.function.call(&arguments, count, self.resources)?,
        };
        let double = self.run::<f64>(&arguments, count)?;
        let exact = self.run::<DoubleDouble>(&arguments, count)?;
        let intervals: Vec<Lanes<Interval>> = arguments.iter().map(Lanes::converted).collect();
        let enclosed = self.function.run(&intervals, count, self.resources)?;
        let conditions = self.conditions(&arguments, &exact, count)?;
        let mut verdicts = Vec::with_capacity(count);
        for (lane, input) in inputs.iter().enumerate() {
            let truth = self.truth.map(|truth| truth(&self.domain.numbers(input)));
            let mut verdict = Verdict::GOOD;
            for (leaf, conditions) in conditions.iter().enumerate() {
                let Some(found) = single.floats(leaf) else {
                    verdict.same_branch &=
                        single.columns[leaf].as_f64(lane) == exact.columns[leaf].as_f64(lane);
                    continue;
                };
                let (double, exact) = (at(&double, leaf, lane), at(&exact, leaf, lane));
                let exact_number = exact.to_f64();
                verdict.trusted &= agree(double, exact);
                let right = truth.as_ref().and_then(|t| t.get(leaf)).copied();
                let condition = conditions[lane];
                verdict.take(found[lane], exact_number, right, condition);
                let bounds = at(&enclosed.value, leaf, lane);
                let furthest = (f64::from(found[lane]) - bounds.low)
                    .abs()
                    .max((f64::from(found[lane]) - bounds.high).abs());
                verdict.proven = verdict.proven.max(furthest / ulp(exact_number));
            }
            verdicts.push(verdict);
        }
        for &lane in &enclosed.undecided {
            verdicts[lane].proven = f64::INFINITY;
        }
        for verdict in &mut verdicts {
            verdict.settle();
        }
        self.look_again(inputs, &single, &exact, &conditions, &mut verdicts)?;
        Ok(verdicts)
    }

    /// Σ |xᵢ ∂f/∂xᵢ| / |f| for each number of the result, lane by lane.
    fn conditions(
        &self,
        arguments: &[Lanes<f32>],
        exact: &Lanes<DoubleDouble>,
        count: usize,
    ) -> Result<Vec<Vec<f64>>, Trap> {
        let mut sums = vec![vec![0.0; count]; exact.columns.len()];
        for seeded in self.domain.floats() {
            let mut leaf = 0;
            let mut argument = |given: &Lanes<f32>| {
                let mut column = |column: &Column<f32>| {
                    leaf += 1;
                    match column {
                        Column::Float(c) => {
                            // The slope is in relative changes of the input: ∂f/∂(ln x) = x f′.
                            let relative = |&x: &f32| {
                                let x = f64::from(x);
                                Dual::new(x, if leaf - 1 == seeded { x } else { 0.0 })
                            };
                            Column::Float(c.iter().map(relative).collect())
                        }
                        Column::Sint(c) => Column::Sint(c.clone()),
                        Column::Uint(c) => Column::Uint(c.clone()),
                        Column::Bool(c) => Column::Bool(c.clone()),
                    }
                };
                Lanes {
                    columns: given.columns.iter().map(&mut column).collect(),
                }
            };
            let duals: Vec<Lanes<Dual>> = arguments.iter().map(&mut argument).collect();
            let found = self.function.call(&duals, count, self.resources)?;
            for (leaf, sums) in sums.iter_mut().enumerate() {
                for (lane, sum) in sums.iter_mut().enumerate() {
                    *sum += at(&found, leaf, lane).slope.abs();
                }
            }
        }
        for (leaf, sums) in sums.iter_mut().enumerate() {
            for (lane, sum) in sums.iter_mut().enumerate() {
                let value = at(exact, leaf, lane).to_f64().abs();
                // A result that does not change needs no care, be it 0.
                *sum = if *sum == 0.0 { 0.0 } else { *sum / value };
            }
        }
        Ok(sums)
    }
}

fn at<S: Scalar>(lanes: &Lanes<S>, leaf: usize, lane: usize) -> S {
    lanes
        .floats(leaf)
        .and_then(|c| c.get(lane))
        .copied()
        .unwrap_or_default()
}

/// To 2⁻⁴⁰, or to what a denormal `f32` cannot show.
fn agree(double: f64, exact: DoubleDouble) -> bool {
    let right = exact.to_f64();
    if !right.is_finite() || !double.is_finite() {
        return right.is_finite() == double.is_finite();
    }
    let difference = DoubleDouble::from_f64(double).minus(exact).to_f64().abs();
    difference <= f64::exp2(-40.0) * right.abs() || difference < f64::exp2(-149.0)
}

/// An error / (1 + condition); what is infinitely wrong stays so.
fn conditioned(error: f64, condition: f64) -> f64 {
    if error.is_finite() {
        error / (1.0 + condition)
    } else {
        error
    }
}

impl Verdict {
    const GOOD: Self = Self {
        rounding: 0.0,
        method: 0.0,
        method_scaled: 0.0,
        total: 0.0,
        condition: 0.0,
        scaled: 0.0,
        finite: true,
        trusted: true,
        same_branch: true,
        whole: false,
        proven: 0.0,
    };

    fn take(&mut self, found: f32, exact: f64, right: Option<f64>, condition: f64) {
        self.finite &= found.is_finite();
        if !exact.is_finite() {
            // Outside of what the formulas can do: there is nothing to compare with.
            return;
        }
        let rounding = ulps(found, exact);
        self.rounding = self.rounding.max(rounding);
        let condition = if condition.is_nan() {
            f64::INFINITY
        } else {
            condition
        };
        match right.filter(|r| !r.is_nan()) {
            Some(right) => {
                let method = (exact - right).abs() / ulp(right);
                let method = if method.is_nan() {
                    f64::INFINITY
                } else {
                    method
                };
                self.method = self.method.max(method);
                self.method_scaled = self.method_scaled.max(conditioned(method, condition));
                self.total = self.total.max(ulps(found, right));
            }
            None => self.total = self.total.max(rounding),
        }
        let scaled = conditioned(rounding, condition);
        if scaled >= self.scaled {
            (self.scaled, self.condition) = (scaled, condition);
        }
    }

    fn settle(&mut self) {
        if !self.same_branch && self.finite {
            (self.rounding, self.method, self.total) = (0.0, 0.0, 0.0);
            self.method_scaled = 0.0;
        }
        if self.proven.is_nan() {
            self.proven = f64::INFINITY;
        }
    }

    /// How bad it is: what is not finite is worst.
    #[must_use]
    pub fn badness(&self) -> f64 {
        if self.finite {
            self.scaled
        } else {
            f64::INFINITY
        }
    }
}
