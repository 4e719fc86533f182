//! Hunting the worst inputs of a function: random ones, special ones, and an adversary.

mod domain;
mod draw;
mod exhaust;
mod nearby;
mod picture;
mod verdict;

use std::time::{Duration, Instant};

use fastrand::Rng;

pub use domain::{Domain, Input, Place, Range, Relation};
pub use exhaust::Exhausted;
pub use nearby::NEARBY;
pub use picture::Picture;
pub use verdict::{Elsewhere, Subject, Truth, Verdict};

pub(crate) use draw::nudged;

use crate::error::Trap;

/// Inputs kept for the regression files.
pub const WORST_KEPT: usize = 16;

/// How hard to look.
#[derive(Debug, Clone)]
pub struct Effort {
    /// Random inputs.
    pub random: usize,
    /// Inputs of special numbers, at most.
    pub special: usize,
    /// Steps of the adversarial search, at least.
    pub climb: usize,
    /// Goes on searching until this long after the start.
    pub time: Duration,
    /// Equal seeds give equal findings, unless time decides.
    pub seed: u64,
}

impl Default for Effort {
    /// 2²⁰ random inputs, 65,536 special ones and as many steps of search.
    fn default() -> Self {
        Self {
            random: 1 << 20,
            special: 1 << 16,
            climb: 1 << 16,
            time: Duration::ZERO,
            seed: 1,
        }
    }
}

/// Middle, tail and end of a collection of errors.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Spread {
    /// Half are at most this.
    pub median: f64,
    /// 99 of 100 are at most this.
    pub p99: f64,
    /// The largest; infinite where a result is not finite but should be.
    pub max: f64,
}

impl Spread {
    const NOTHING: Self = Self {
        median: 0.0,
        p99: 0.0,
        max: 0.0,
    };

    fn of(mut errors: Vec<f64>) -> Self {
        errors.sort_unstable_by(f64::total_cmp);
        let at = |share: f64| {
            let last = errors.len().saturating_sub(1);
            errors
                .get((last as f64 * share).round() as usize)
                .copied()
                .unwrap_or(0.0)
        };
        Self {
            median: at(0.5),
            p99: at(0.99),
            max: at(1.0),
        }
    }

    fn raise(&mut self, error: f64) {
        self.max = self.max.max(error);
    }

    /// The worse of both, number by number.
    fn or_worse(&mut self, other: &Self) {
        self.median = self.median.max(other.median);
        self.p99 = self.p99.max(other.p99);
        self.max = self.max.max(other.max);
    }
}

/// A bad input, as kept in a regression file.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Case {
    /// The input.
    pub input: Input,
    /// Its rounding error in ulps / (1 + condition) when it was found; none where the result was
    /// not finite, or infinitely wrong.
    pub scaled: Option<f64>,
    /// Its rounding error in ulps when it was found; none where infinite.
    pub rounding: Option<f64>,
}

/// What a hunt has found. Median and p99 are of the random inputs, the largest is of all inputs;
/// all errors are in ulps of `f32`.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Findings {
    /// Inputs that were judged.
    pub inputs: usize,
    /// `f32` against the same formulas with 31 digits.
    pub rounding: Spread,
    /// The formulas against the truth; none where there is no truth.
    pub method: Option<Spread>,
    /// The same / (1 + condition).
    pub method_scaled: Option<Spread>,
    /// `f32` against the truth, or against 31 digits where there is none.
    pub total: Spread,
    /// Condition numbers.
    pub condition: Spread,
    /// Rounding error / (1 + condition).
    pub scaled: Spread,
    /// Results that are not finite.
    pub non_finite: usize,
    /// Inputs where `f64` and 31 digits disagree by more than 2⁻⁴⁰.
    pub untrusted: usize,
    /// Inputs where integers or truth values of the result depend on rounding.
    pub branches: usize,
    /// Inputs where a component of a vector was judged by the vector's length.
    pub whole: usize,
    /// Random inputs whose error is bounded by intervals, as a share of them.
    pub enclosed: f64,
    /// The largest bound proven by intervals, where they could decide.
    pub proven: f64,
    /// The worst by error / (1 + condition), worst first, at most [`WORST_KEPT`].
    #[serde(skip)]
    pub worst: Vec<Case>,
}

impl Findings {
    /// Of no input.
    pub(crate) const NOTHING: Self = Self {
        inputs: 0,
        rounding: Spread::NOTHING,
        method: None,
        method_scaled: None,
        total: Spread::NOTHING,
        condition: Spread::NOTHING,
        scaled: Spread::NOTHING,
        non_finite: 0,
        untrusted: 0,
        branches: 0,
        whole: 0,
        enclosed: 1.0,
        proven: 0.0,
        worst: Vec::new(),
    };

    /// Takes in what was found elsewhere: counts of both, the worse of all else. The worst inputs of
    /// the other are left out, since they are not of the same place.
    pub(crate) fn absorb(&mut self, other: &Self) {
        self.inputs += other.inputs;
        self.rounding.or_worse(&other.rounding);
        for (known, found) in [
            (&mut self.method, &other.method),
            (&mut self.method_scaled, &other.method_scaled),
        ] {
            if let Some(found) = found {
                known.get_or_insert(Spread::NOTHING).or_worse(found);
            }
        }
        self.total.or_worse(&other.total);
        self.condition.or_worse(&other.condition);
        self.scaled.or_worse(&other.scaled);
        self.non_finite += other.non_finite;
        self.untrusted += other.untrusted;
        self.branches += other.branches;
        self.whole += other.whole;
        self.enclosed = self.enclosed.min(other.enclosed);
        self.proven = self.proven.max(other.proven);
    }
}

/// The inputs of a hunt so far.
struct Bag {
    findings: Findings,
    worst: Vec<(f64, Input, Verdict)>,
}

impl Subject<'_> {
    /// Looks for the worst inputs.
    ///
    /// # Errors
    ///
    /// The [`Trap`] of a run, such as an endless loop.
    pub fn hunt(&self, effort: &Effort) -> Result<Findings, Trap> {
        let start = Instant::now();
        let mut rng = Rng::with_seed(effort.seed);
        let random: Vec<Input> = (0..effort.random)
            .map(|_| self.domain.draw(&mut rng))
            .collect();
        let verdicts = self.judge(&random)?;
        let mut bag = self.bag(&verdicts);
        bag.add(&random, &verdicts);
        let special = self.domain.special(effort.special, &mut rng);
        bag.add(&special, &self.judge(&special)?);
        let mut steps = 0;
        while steps < effort.climb || start.elapsed() < effort.time {
            steps += self.climb(&mut bag, &mut rng)?;
        }
        Ok(bag.finished())
    }

    /// Judges inputs that were found before: the regression test.
    ///
    /// # Errors
    ///
    /// The [`Trap`] of a run.
    pub fn again(&self, cases: &[Case]) -> Result<Findings, Trap> {
        let inputs: Vec<Input> = cases.iter().map(|c| c.input.clone()).collect();
        let verdicts = self.judge(&inputs)?;
        let mut bag = self.bag(&verdicts);
        bag.add(&inputs, &verdicts);
        Ok(bag.finished())
    }

    fn bag(&self, random: &[Verdict]) -> Bag {
        let spread = |of: &dyn Fn(&Verdict) -> f64| Spread::of(random.iter().map(of).collect());
        let enclosed = random.iter().filter(|v| v.proven.is_finite()).count();
        Bag {
            findings: Findings {
                rounding: spread(&|v| v.rounding),
                method: self.truth.map(|_| spread(&|v| v.method)),
                method_scaled: self.truth.map(|_| spread(&|v| v.method_scaled)),
                total: spread(&|v| v.total),
                condition: spread(&|v| v.condition),
                scaled: spread(&|v| v.scaled),
                enclosed: enclosed as f64 / random.len().max(1) as f64,
                ..Findings::NOTHING
            },
            worst: Vec::new(),
        }
    }

    /// One round of the adversary: from a bad input, by small and large changes of bits, to worse
    /// ones; gives the number of inputs tried.
    fn climb(&self, bag: &mut Bag, rng: &mut Rng) -> Result<usize, Trap> {
        const TRIES: usize = 256;
        const PATIENCE: usize = 6;
        // In turn by error / (1 + condition), by bare error and by error against the truth.
        let aims: [fn(&Verdict) -> f64; 3] = [Verdict::badness, |v| v.rounding, |v| v.total];
        let aim = aims[rng.usize(0..aims.len())];
        let known = rng.usize(0..=bag.worst.len());
        let mut best = match bag.worst.get(known) {
            Some((_, input, _)) => input.clone(),
            None => self.domain.draw(rng),
        };
        let mut score = aim(&self.judge(std::slice::from_ref(&best))?[0]);
        let (mut tried, mut failures) = (1, 0);
        while failures < PATIENCE && score.is_finite() {
            let inputs: Vec<Input> = (0..TRIES)
                .map(|_| self.domain.changed(&best, rng))
                .collect();
            let verdicts = self.judge(&inputs)?;
            bag.add(&inputs, &verdicts);
            tried += TRIES;
            failures += 1;
            for (input, verdict) in inputs.iter().zip(&verdicts) {
                if aim(verdict) > score {
                    (score, best, failures) = (aim(verdict), input.clone(), 0);
                }
            }
        }
        Ok(tried)
    }
}

impl Bag {
    fn add(&mut self, inputs: &[Input], verdicts: &[Verdict]) {
        let findings = &mut self.findings;
        findings.inputs += inputs.len();
        for (input, verdict) in inputs.iter().zip(verdicts) {
            findings.rounding.raise(verdict.rounding);
            findings.total.raise(verdict.total);
            findings.condition.raise(verdict.condition);
            findings.scaled.raise(verdict.scaled);
            if let Some(method) = &mut findings.method {
                method.raise(verdict.method);
            }
            if let Some(method) = &mut findings.method_scaled {
                method.raise(verdict.method_scaled);
            }
            findings.non_finite += usize::from(!verdict.finite);
            findings.untrusted += usize::from(!verdict.trusted);
            findings.branches += usize::from(!verdict.same_branch);
            findings.whole += usize::from(verdict.whole);
            if verdict.proven.is_finite() {
                findings.proven = findings.proven.max(verdict.proven);
            }
            let badness = verdict.badness();
            let full = self.worst.len() >= WORST_KEPT;
            if full
                && self
                    .worst
                    .last()
                    .is_some_and(|(least, ..)| badness <= *least)
            {
                continue;
            }
            if self.worst.iter().any(|(_, known, _)| known == input) {
                continue;
            }
            let place = self.worst.partition_point(|(b, ..)| *b >= badness);
            self.worst.insert(place, (badness, input.clone(), *verdict));
            self.worst.truncate(WORST_KEPT);
        }
    }

    fn finished(self) -> Findings {
        let finite = |x: f64| x.is_finite().then_some(x);
        let case = |(badness, input, verdict): (f64, Input, Verdict)| Case {
            input,
            scaled: finite(badness),
            rounding: finite(verdict.rounding),
        };
        Findings {
            worst: self.worst.into_iter().map(case).collect(),
            ..self.findings
        }
    }
}
