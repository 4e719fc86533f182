//! `f32` with random rounding: the scatter of repeated runs shows how much rounding matters.
//!
//! Parker 1997, "Monte Carlo arithmetic".

use super::{Elementary, Scalar, Whole, wgsl_power};

/// An `f32` whose results are rounded up or down by chance, with the chances that make the
/// expected value exact.
#[derive(Debug, Clone, Copy, Default, PartialEq, PartialOrd)]
pub struct Stochastic(pub f32);

impl Stochastic {
    /// Restarts this thread's chances, so that a run can be repeated.
    pub fn seed(seed: u64) {
        fastrand::seed(seed);
    }

    fn rounded(exact: f64) -> Self {
        let nearest = exact as f32;
        let rest = exact - f64::from(nearest);
        if rest == 0.0 || !nearest.is_finite() || !exact.is_finite() {
            return Self(nearest);
        }
        let other = if rest > 0.0 {
            nearest.next_up()
        } else {
            nearest.next_down()
        };
        let step = f64::from(other) - f64::from(nearest);
        Self(if fastrand::f64() < rest / step {
            other
        } else {
            nearest
        })
    }
}

impl Scalar for Stochastic {
    const NAME: &'static str = "stochastic";

    fn from_f32(value: f32) -> Self {
        Self(value)
    }
    fn from_f64(value: f64) -> Self {
        Self(value as f32)
    }
    fn to_f32(self) -> f32 {
        self.0
    }
    fn to_f64(self) -> f64 {
        f64::from(self.0)
    }
    fn plus(self, other: Self) -> Self {
        Self::rounded(self.to_f64() + other.to_f64())
    }
    fn minus(self, other: Self) -> Self {
        Self::rounded(self.to_f64() - other.to_f64())
    }
    fn times(self, other: Self) -> Self {
        Self::rounded(self.to_f64() * other.to_f64())
    }
    fn over(self, other: Self) -> Self {
        Self::rounded(self.to_f64() / other.to_f64())
    }
    fn negated(self) -> Self {
        Self(-self.0)
    }
    fn fused(self, factor: Self, summand: Self) -> Self {
        Self::rounded(self.to_f64().mul_add(factor.to_f64(), summand.to_f64()))
    }
    fn root(self) -> Self {
        Self::rounded(self.to_f64().sqrt())
    }
    fn magnitude(self) -> Self {
        Self(self.0.abs())
    }
    fn smaller(self, other: Self) -> Self {
        Self(self.0.min(other.0))
    }
    fn larger(self, other: Self) -> Self {
        Self(self.0.max(other.0))
    }
    fn whole(self, to: Whole) -> Self {
        Self(self.0.whole(to))
    }
    fn sign(self) -> Self {
        Self(self.0.sign())
    }
    fn elementary(self, function: Elementary) -> Self {
        Self::rounded(function.of(self.to_f64()))
    }
    fn power(self, exponent: Self) -> Self {
        Self::rounded(wgsl_power(self.to_f64(), exponent.to_f64()))
    }
    fn angle(self, other: Self) -> Self {
        Self::rounded(self.to_f64().atan2(other.to_f64()))
    }
    fn is_less(self, other: Self) -> bool {
        self.0 < other.0
    }
    fn is_equal(self, other: Self) -> bool {
        self.0 == other.0
    }
}
