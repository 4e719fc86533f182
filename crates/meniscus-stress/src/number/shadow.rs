//! An `f32` with the `f64` that should have been there: shows where the two part.

use super::{Elementary, Scalar, Whole};

/// The same computation in `f32` and in `f64`, side by side; `f32` decides the branches.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Shadow {
    /// As a GPU computes.
    pub single: f32,
    /// With 53 bits.
    pub double: f64,
}

impl Shadow {
    /// From both.
    #[must_use]
    pub const fn new(single: f32, double: f64) -> Self {
        Self { single, double }
    }

    /// How far the two are apart, in ulps of `f32` at the `f64` value; infinite where one of them
    /// alone is NaN or infinite.
    #[must_use]
    pub fn ulps(self) -> f64 {
        crate::ulp::ulps(self.single, self.double)
    }

    fn both(self, single: impl Fn(f32) -> f32, double: impl Fn(f64) -> f64) -> Self {
        Self::new(single(self.single), double(self.double))
    }
}

impl Scalar for Shadow {
    const NAME: &'static str = "shadow";
    const MAY_BE_UNDECIDED: bool = true;

    fn from_f32(value: f32) -> Self {
        Self::new(value, f64::from(value))
    }
    fn from_f64(value: f64) -> Self {
        Self::new(value as f32, value)
    }
    fn to_f32(self) -> f32 {
        self.single
    }
    fn to_f64(self) -> f64 {
        self.double
    }
    fn plus(self, other: Self) -> Self {
        Self::new(self.single + other.single, self.double + other.double)
    }
    fn minus(self, other: Self) -> Self {
        Self::new(self.single - other.single, self.double - other.double)
    }
    fn times(self, other: Self) -> Self {
        Self::new(self.single * other.single, self.double * other.double)
    }
    fn over(self, other: Self) -> Self {
        Self::new(self.single / other.single, self.double / other.double)
    }
    fn negated(self) -> Self {
        Self::new(-self.single, -self.double)
    }
    fn fused(self, factor: Self, summand: Self) -> Self {
        Self::new(
            self.single.mul_add(factor.single, summand.single),
            self.double.mul_add(factor.double, summand.double),
        )
    }
    fn root(self) -> Self {
        self.both(f32::sqrt, f64::sqrt)
    }
    fn magnitude(self) -> Self {
        self.both(f32::abs, f64::abs)
    }
    fn smaller(self, other: Self) -> Self {
        Self::new(self.single.min(other.single), self.double.min(other.double))
    }
    fn larger(self, other: Self) -> Self {
        Self::new(self.single.max(other.single), self.double.max(other.double))
    }
    fn whole(self, to: Whole) -> Self {
        self.both(|x| x.whole(to), |x| x.whole(to))
    }
    fn sign(self) -> Self {
        self.both(Scalar::sign, Scalar::sign)
    }
    fn elementary(self, function: Elementary) -> Self {
        self.both(|x| x.elementary(function), |x| x.elementary(function))
    }
    fn power(self, exponent: Self) -> Self {
        Self::new(
            self.single.power(exponent.single),
            self.double.power(exponent.double),
        )
    }
    fn angle(self, other: Self) -> Self {
        Self::new(
            self.single.angle(other.single),
            self.double.angle(other.double),
        )
    }
    fn is_less(self, other: Self) -> bool {
        self.single < other.single
    }
    fn is_equal(self, other: Self) -> bool {
        self.single == other.single
    }
    fn is_undecided(self, other: Self) -> bool {
        self.single.partial_cmp(&other.single) != self.double.partial_cmp(&other.double)
    }
    fn to_i32(self) -> i32 {
        self.single.to_i32()
    }
    fn to_u32(self) -> u32 {
        self.single.to_u32()
    }
}
