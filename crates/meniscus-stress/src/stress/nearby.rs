//! Second looks: errors that a change of the inputs by a few ulps accounts for.
//!
//! Condition numbers by differentiation know nothing of what the host says, and nothing of decisions:
//! which texel is fetched, whether a ray still meets something. So inputs that look bad are tried again
//! nearby: every argument, block and texel moved by up to [`NEARBY`] ulps. How far the exact results
//! then lie apart, in units of as many ulps of the result, is a condition number that holds for both.
//!
//! A run decides at many places, each by its own rounding, and an adversary finds inputs at which several
//! decisions hang in the balance at once. No input nearby may tip them all the same way. So what is still bad
//! is tried again with decisions that waver, each by itself: whatever is compared or rounded to a whole
//! number is moved by up to [`NEARBY`] ulps, and nothing that is computed. That accounts for the rounding of
//! what is compared, and not for digits that a difference lost before.
//!
//! A component of a point or a direction that happens to be next to 0 is a difference of large
//! numbers, of which nobody can know all digits. So where a component by itself is not accounted for,
//! its error is measured by the longest component of its vector, and [`Verdict::whole`] tells.

use std::ops::Range;

use fastrand::Rng;

use super::domain::Input;
use super::verdict::{Subject, Verdict};
use crate::error::Trap;
use crate::number::{DoubleDouble, Scalar, Wavering};
use crate::shape::{Column, Lanes, Shape};
use crate::ulp::ulp;

/// How far inputs are moved, in ulps; and the error / (1 + condition) from which on they are.
pub const NEARBY: i64 = 4;
/// Inputs tried near one, in rounds, until one accounts for its error; and whether decisions waver.
const ROUNDS: [(bool, Range<u64>); 4] = [
    (false, 0..16),
    (true, 16..48),
    (true, 48..128),
    (true, 128..640),
];

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
        let mut looks: Vec<Look> = (0..inputs.len())
            .filter(|&lane| doubtful(&verdicts[lane]))
            .map(|lane| Look::new(lane, single, exact))
            .collect();
        let vectors = self.function.result().map(Shape::vectors);
        let vectors = vectors.unwrap_or_default();
        for (waver, attempts) in ROUNDS {
            for attempt in attempts {
                match waver {
                    false => self.try_nearby::<f64>(attempt, inputs, single, &mut looks)?,
                    true => {
                        Wavering::seed(attempt);
                        self.try_nearby::<Wavering>(attempt, inputs, single, &mut looks)?;
                    }
                }
            }
            for Look { lane, hull } in &looks {
                let known = |leaf: usize| conditions[leaf][*lane];
                let results = Results {
                    single,
                    exact,
                    lane: *lane,
                    vectors: &vectors,
                };
                verdicts[*lane].reconsider(hull, &results, known);
            }
            looks.retain(|look| verdicts[look.lane].scaled > NEARBY as f64);
        }
        Ok(())
    }

    /// Runs inputs near those of some lanes and adds what comes out to their hulls. Most attempts move
    /// everything; some what the function is given alone.
    fn try_nearby<S: Scalar>(
        &self,
        attempt: u64,
        inputs: &[Input],
        single: &Lanes<f32>,
        looks: &mut [Look],
    ) -> Result<(), Trap> {
        if looks.is_empty() {
            return Ok(());
        }
        let mut rng = Rng::with_seed(attempt);
        let moved: Vec<Input> = looks
            .iter()
            .map(|look| self.domain.moved(&inputs[look.lane], NEARBY, &mut rng))
            .collect();
        let arguments = self.domain.lanes(self.function, &moved);
        let numbers: Vec<Lanes<S>> = arguments.iter().map(Lanes::converted).collect();
        let sets = self.nearby.len() as u64 + 1;
        let resources = match (attempt % sets) as usize {
            0 => self.resources,
            index => &self.nearby[index - 1],
        };
        let found = self.function.call(&numbers, looks.len(), resources)?;
        for (index, look) in looks.iter_mut().enumerate() {
            look.hull.add(single, look.lane, &found, index);
        }
        Ok(())
    }
}

/// A lane that is judged again.
struct Look {
    lane: usize,
    hull: Hull,
}

impl Look {
    fn new(lane: usize, single: &Lanes<f32>, exact: &Lanes<DoubleDouble>) -> Self {
        let mut hull = Hull {
            bounds: vec![(f64::INFINITY, f64::NEG_INFINITY); single.columns.len()],
            alike: false,
        };
        hull.add(single, lane, exact, lane);
        Self { lane, hull }
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

/// What came out of a lane.
struct Results<'a> {
    single: &'a Lanes<f32>,
    exact: &'a Lanes<DoubleDouble>,
    lane: usize,
    /// The vector that each number is part of.
    vectors: &'a [Range<usize>],
}

impl Verdict {
    fn reconsider(&mut self, hull: &Hull, results: &Results<'_>, known: impl Fn(usize) -> f64) {
        if !hull.alike {
            (self.scaled, self.rounding) = (f64::INFINITY, f64::INFINITY);
            self.total = f64::INFINITY;
            return;
        }
        let lane = results.lane;
        let found = |leaf: usize| results.single.columns[leaf].as_f64(lane);
        // Against the exact result, or the nearest one of those that decide alike.
        let right = |leaf: usize| {
            let (low, high) = hull.bounds[leaf];
            match self.same_branch {
                true => results.exact.columns[leaf].as_f64(lane),
                false if low <= high => found(leaf).clamp(low, high),
                false => f64::NAN,
            }
        };
        let (mut worst, mut whole, mut rounding) = ((0.0, 0.0), false, 0.0_f64);
        for (leaf, &(low, high)) in hull.bounds.iter().enumerate() {
            let exact = right(leaf);
            let is_float = matches!(results.single.columns[leaf], Column::Float(_));
            if !is_float || low > high || !exact.is_finite() {
                continue;
            }
            let spread = (high - exact).max(exact - low).max(0.0);
            let error = (found(leaf) - exact).abs();
            let derived = if self.same_branch { known(leaf) } else { 0.0 };
            let judge = |size: f64| {
                let condition = derived.max(spread / size / NEARBY as f64);
                (error / size / (1.0 + condition), condition)
            };
            let mut judged = judge(ulp(exact));
            if judged.0 > NEARBY as f64 {
                let vector = results.vectors.get(leaf).cloned().unwrap_or(leaf..leaf + 1);
                let longest = vector.map(|i| right(i).abs()).fold(0.0, f64::max);
                let as_a_whole = judge(ulp(longest));
                if as_a_whole.0 < judged.0 {
                    (judged, whole) = (as_a_whole, true);
                }
            }
            if judged.0 >= worst.0 {
                worst = judged;
            }
            rounding = rounding.max(error / ulp(exact));
        }
        (self.scaled, self.condition) = worst;
        self.whole = whole;
        if !self.same_branch {
            (self.rounding, self.total) = (rounding, rounding);
        }
    }
}
