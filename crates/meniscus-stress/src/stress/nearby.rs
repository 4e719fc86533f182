//! Second looks: errors that a change of the inputs by a few ulps accounts for.
//!
//! Condition numbers by differentiation know nothing of what the host says, and nothing of decisions:
//! which texel is fetched, whether a ray still meets something. So inputs that look bad are tried again
//! nearby: every argument, block and texel moved by up to [`NEARBY`] ulps. How far the exact results
//! then lie apart, in units of as many ulps of the result, is a condition number that holds for both.

use fastrand::Rng;

use super::domain::Input;
use super::verdict::{Subject, Verdict};
use crate::error::Trap;
use crate::number::{DoubleDouble, Scalar};
use crate::shape::{Column, Lanes};
use crate::ulp::ulp;

/// How far inputs are moved, in ulps; and the error / (1 + condition) from which on they are.
pub const NEARBY: i64 = 4;
/// Inputs tried near one.
const TRIES: u64 = 48;

/// Exact results near an input: the bounds of each number, over the tries whose integers and truth
/// values are those that were found.
struct Hull {
    bounds: Vec<(f64, f64)>,
    alike: bool,
}

impl Subject<'_> {
    /// Judges again what looks bad, and what decided otherwise than with 31 digits.
    pub(super) fn look_again(
        &self,
        inputs: &[Input],
        single: &Lanes<f32>,
        exact: &Lanes<DoubleDouble>,
        conditions: &[Vec<f64>],
        verdicts: &mut [Verdict],
    ) -> Result<(), Trap> {
        let doubtful = |v: &Verdict| v.finite && (!v.same_branch || v.scaled > NEARBY as f64);
        let lanes: Vec<usize> = (0..inputs.len())
            .filter(|&lane| doubtful(&verdicts[lane]))
            .collect();
        if lanes.is_empty() {
            return Ok(());
        }
        let leaves = single.columns.len();
        let empty = || Hull {
            bounds: vec![(f64::INFINITY, f64::NEG_INFINITY); leaves],
            alike: false,
        };
        let mut hulls: Vec<Hull> = lanes.iter().map(|_| empty()).collect();
        for (hull, &lane) in hulls.iter_mut().zip(&lanes) {
            hull.add(single, lane, exact, lane);
        }
        for attempt in 0..TRIES {
            let mut rng = Rng::with_seed(attempt);
            let moved: Vec<Input> = lanes
                .iter()
                .map(|&lane| self.domain.moved(&inputs[lane], NEARBY, &mut rng))
                .collect();
            let arguments = self.domain.lanes(self.function, &moved);
            let doubles: Vec<Lanes<f64>> = arguments.iter().map(Lanes::converted).collect();
            // Most tries move everything; some what the function is given alone.
            let sets = self.nearby.len() as u64 + 1;
            let resources = match (attempt % sets) as usize {
                0 => self.resources,
                index => &self.nearby[index - 1],
            };
            let found = self.function.call(&doubles, lanes.len(), resources)?;
            for (index, (hull, &lane)) in hulls.iter_mut().zip(&lanes).enumerate() {
                hull.add(single, lane, &found, index);
            }
        }
        for (hull, &lane) in hulls.iter().zip(&lanes) {
            let known = |leaf: usize| conditions[leaf][lane];
            verdicts[lane].reconsider(hull, single, exact, lane, known);
        }
        Ok(())
    }
}

impl Hull {
    fn add<S: Scalar>(&mut self, single: &Lanes<f32>, lane: usize, found: &Lanes<S>, at: usize) {
        let decided = |column: &Column<f32>| column.as_f64(lane);
        let pairs = || single.columns.iter().zip(&found.columns);
        let alike = pairs().all(|(ours, theirs)| {
            matches!(ours, Column::Float(_)) || decided(ours) == theirs.as_f64(at)
        });
        if !alike {
            return;
        }
        self.alike = true;
        for ((low, high), (_, theirs)) in self.bounds.iter_mut().zip(pairs()) {
            let value = theirs.as_f64(at);
            if value.is_finite() {
                (*low, *high) = (low.min(value), high.max(value));
            }
        }
    }
}

impl Verdict {
    fn reconsider(
        &mut self,
        hull: &Hull,
        single: &Lanes<f32>,
        exact: &Lanes<DoubleDouble>,
        lane: usize,
        known: impl Fn(usize) -> f64,
    ) {
        if !hull.alike {
            (self.scaled, self.rounding) = (f64::INFINITY, f64::INFINITY);
            self.total = f64::INFINITY;
            return;
        }
        self.scaled = 0.0;
        for (leaf, &(low, high)) in hull.bounds.iter().enumerate() {
            let Some(found) = single.floats(leaf).map(|c| f64::from(c[lane])) else {
                continue;
            };
            if low > high {
                continue;
            }
            // Against the exact result, or the nearest one of those that decide alike.
            let right = match self.same_branch {
                true => exact.columns[leaf].as_f64(lane),
                false => found.clamp(low, high),
            };
            if !right.is_finite() {
                continue;
            }
            let size = ulp(right);
            let spread = (high - right).max(right - low).max(0.0) / size;
            let rounding = (found - right).abs() / size;
            let derived = if self.same_branch { known(leaf) } else { 0.0 };
            let condition = derived.max(spread / NEARBY as f64);
            let scaled = rounding / (1.0 + condition);
            if scaled >= self.scaled {
                (self.scaled, self.condition) = (scaled, condition);
            }
            if !self.same_branch {
                self.rounding = self.rounding.max(rounding);
                self.total = self.total.max(rounding);
            }
        }
    }
}
