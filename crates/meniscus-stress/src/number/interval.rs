//! Enclosures: every operation rounds outward, so the exact result lies inside.

use super::{Elementary, Scalar, Whole};

/// All real numbers from `low` to `high`, both included.
///
/// What is undefined (a root of a negative number, 0/0) is the whole line.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Interval {
    /// Lower bound.
    pub low: f64,
    /// Upper bound.
    pub high: f64,
}

impl Interval {
    /// Everything: nothing is known.
    pub const WHOLE: Self = Self {
        low: f64::NEG_INFINITY,
        high: f64::INFINITY,
    };

    /// From its bounds; the whole line where they are out of order or NaN.
    #[must_use]
    pub fn new(low: f64, high: f64) -> Self {
        if low <= high {
            Self { low, high }
        } else {
            Self::WHOLE
        }
    }

    /// Whether a number lies inside.
    #[must_use]
    pub fn contains(self, x: f64) -> bool {
        self.low <= x && x <= self.high
    }

    /// Width, `high − low`.
    #[must_use]
    pub fn width(self) -> f64 {
        self.high - self.low
    }

    /// Bounds that were rounded to nearest, moved out by one `f64`.
    fn widened(low: f64, high: f64) -> Self {
        Self::new(low.next_down(), high.next_up())
    }

    /// Bounds from a mathematical library, which is good to an ulp or two.
    fn loosened(low: f64, high: f64) -> Self {
        Self::new(
            low.next_down().next_down().next_down(),
            high.next_up().next_up().next_up(),
        )
    }

    fn over_corners(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let corners = [
            f(self.low, other.low),
            f(self.low, other.high),
            f(self.high, other.low),
            f(self.high, other.high),
        ];
        if corners.iter().any(|c| c.is_nan()) {
            return Self::WHOLE;
        }
        let low = corners.iter().copied().fold(f64::INFINITY, f64::min);
        let high = corners.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Self::widened(low, high)
    }

    /// Of a function that increases.
    fn increasing(self, f: impl Fn(f64) -> f64) -> Self {
        Self::loosened(f(self.low), f(self.high))
    }

    /// sin or cos, whose crests lie at `first_crest` + 2πk.
    fn wave(self, f: impl Fn(f64) -> f64, first_crest: f64) -> Self {
        use std::f64::consts::{PI, TAU};
        if !self.width().is_finite() || self.width() >= TAU {
            return Self::new(-1.0, 1.0);
        }
        // A crest that is only nearly inside counts too: the bound stays right, if not tight.
        let slack = 1e-15 * (1.0 + self.low.abs().max(self.high.abs()));
        let has = |at: f64| {
            ((self.high + slack - at) / TAU).floor() > ((self.low - slack - at) / TAU).floor()
        };
        let ends = [f(self.low), f(self.high)];
        let high = if has(first_crest) {
            1.0
        } else {
            ends[0].max(ends[1])
        };
        let low = if has(first_crest + PI) {
            -1.0
        } else {
            ends[0].min(ends[1])
        };
        let bounds = Self::loosened(low, high);
        Self::new(bounds.low.max(-1.0), bounds.high.min(1.0))
    }

    fn clipped(self, low: f64, high: f64) -> Option<Self> {
        let (a, b) = (self.low.max(low), self.high.min(high));
        (a <= b).then_some(Self { low: a, high: b })
    }
}

impl Scalar for Interval {
    const NAME: &'static str = "interval";
    const MAY_BE_UNDECIDED: bool = true;

    fn from_f32(value: f32) -> Self {
        Self::from_f64(f64::from(value))
    }
    fn from_f64(value: f64) -> Self {
        Self::new(value, value)
    }
    fn to_f32(self) -> f32 {
        self.to_f64() as f32
    }
    fn to_f64(self) -> f64 {
        if self.low == self.high {
            self.low
        } else {
            0.5 * self.low + 0.5 * self.high
        }
    }
    fn plus(self, other: Self) -> Self {
        Self::widened(self.low + other.low, self.high + other.high)
    }
    fn minus(self, other: Self) -> Self {
        Self::widened(self.low - other.high, self.high - other.low)
    }
    fn times(self, other: Self) -> Self {
        // 0 · ∞ at a corner is a bound of 0 · (something finite, however large).
        self.over_corners(other, |a, b| if a == 0.0 || b == 0.0 { 0.0 } else { a * b })
    }
    fn over(self, other: Self) -> Self {
        if other.contains(0.0) {
            return Self::WHOLE;
        }
        self.over_corners(other, |a, b| if a == 0.0 { 0.0 } else { a / b })
    }
    fn negated(self) -> Self {
        Self {
            low: -self.high,
            high: -self.low,
        }
    }
    fn fused(self, factor: Self, summand: Self) -> Self {
        self.times(factor).plus(summand)
    }
    fn root(self) -> Self {
        match self.clipped(0.0, f64::INFINITY) {
            None => Self::WHOLE,
            Some(x) => {
                let bounds = Self::widened(x.low.sqrt(), x.high.sqrt());
                Self::new(bounds.low.max(0.0), bounds.high)
            }
        }
    }
    fn magnitude(self) -> Self {
        if self.low >= 0.0 {
            self
        } else if self.high <= 0.0 {
            self.negated()
        } else {
            Self::new(0.0, self.high.max(-self.low))
        }
    }
    fn smaller(self, other: Self) -> Self {
        Self::new(self.low.min(other.low), self.high.min(other.high))
    }
    fn larger(self, other: Self) -> Self {
        Self::new(self.low.max(other.low), self.high.max(other.high))
    }
    fn whole(self, to: Whole) -> Self {
        Self::new(to.of(self.low), to.of(self.high))
    }
    fn sign(self) -> Self {
        Self::new(self.low.sign(), self.high.sign())
    }
    fn elementary(self, function: Elementary) -> Self {
        use std::f64::consts::{FRAC_PI_2, PI};
        let f = |x| function.of(x);
        match function {
            Elementary::Sin => self.wave(f, FRAC_PI_2),
            Elementary::Cos => self.wave(f, 0.0),
            Elementary::Tan => {
                let (sin, cos) = (
                    self.elementary(Elementary::Sin),
                    self.elementary(Elementary::Cos),
                );
                if self.width() < PI && !cos.contains(0.0) {
                    self.increasing(f)
                } else {
                    sin.over(cos)
                }
            }
            Elementary::Asin => self
                .clipped(-1.0, 1.0)
                .map_or(Self::WHOLE, |x| x.increasing(f)),
            Elementary::Acos => self
                .clipped(-1.0, 1.0)
                .map_or(Self::WHOLE, |x| Self::loosened(f(x.high), f(x.low))),
            Elementary::Acosh => self
                .clipped(1.0, f64::INFINITY)
                .map_or(Self::WHOLE, |x| x.increasing(f)),
            Elementary::Atanh => self
                .clipped(-1.0, 1.0)
                .map_or(Self::WHOLE, |x| x.increasing(f)),
            Elementary::Log | Elementary::Log2 => self
                .clipped(0.0, f64::INFINITY)
                .map_or(Self::WHOLE, |x| x.increasing(f)),
            Elementary::Cosh => {
                let x = self.magnitude();
                let bounds = x.increasing(f);
                Self::new(bounds.low.max(1.0), bounds.high)
            }
            Elementary::Exp | Elementary::Exp2 => {
                let bounds = self.increasing(f);
                Self::new(bounds.low.max(0.0), bounds.high)
            }
            Elementary::Atan | Elementary::Sinh | Elementary::Tanh | Elementary::Asinh => {
                self.increasing(f)
            }
        }
    }
    fn power(self, exponent: Self) -> Self {
        if self.low < 0.0 {
            return Self::WHOLE;
        }
        // x^y is monotone in x for every y and in y for every x: its extremes lie at corners.
        let bounds = self.over_corners(exponent, f64::powf);
        let bounds = Self::loosened(bounds.low, bounds.high);
        Self::new(bounds.low.max(0.0), bounds.high)
    }
    fn angle(self, other: Self) -> Self {
        use std::f64::consts::PI;
        if other.low <= 0.0 && self.contains(0.0) {
            return Self::loosened(-PI, PI);
        }
        let bounds = self.over_corners(other, f64::atan2);
        Self::loosened(bounds.low, bounds.high)
    }
    fn is_less(self, other: Self) -> bool {
        if self.is_undecided(other) {
            self.to_f64() < other.to_f64()
        } else {
            self.high < other.low
        }
    }
    fn is_equal(self, other: Self) -> bool {
        self.to_f64() == other.to_f64()
    }
    fn is_undecided(self, other: Self) -> bool {
        let both_are_points =
            self.low == self.high && other.low == other.high && self.low == other.low;
        self.low <= other.high && other.low <= self.high && !both_are_points
    }
}
