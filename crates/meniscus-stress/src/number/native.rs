//! The machine's own numbers.

use super::{Elementary, Scalar, Whole, wgsl_power};

/// As a GPU computes, with correctly rounded division, roots and transcendental functions.
impl Scalar for f32 {
    const NAME: &'static str = "f32";

    #[inline]
    fn from_f32(value: f32) -> Self {
        value
    }
    #[inline]
    fn from_f64(value: f64) -> Self {
        value as f32
    }
    #[inline]
    fn to_f32(self) -> f32 {
        self
    }
    #[inline]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
    #[inline]
    fn plus(self, other: Self) -> Self {
        self + other
    }
    #[inline]
    fn minus(self, other: Self) -> Self {
        self - other
    }
    #[inline]
    fn times(self, other: Self) -> Self {
        self * other
    }
    #[inline]
    fn over(self, other: Self) -> Self {
        self / other
    }
    #[inline]
    fn negated(self) -> Self {
        -self
    }
    #[inline]
    fn fused(self, factor: Self, summand: Self) -> Self {
        self.mul_add(factor, summand)
    }
    #[inline]
    fn root(self) -> Self {
        self.sqrt()
    }
    #[inline]
    fn magnitude(self) -> Self {
        self.abs()
    }
    #[inline]
    fn smaller(self, other: Self) -> Self {
        self.min(other)
    }
    #[inline]
    fn larger(self, other: Self) -> Self {
        self.max(other)
    }
    #[inline]
    fn whole(self, to: Whole) -> Self {
        match to {
            Whole::Floor => self.floor(),
            Whole::Ceil => self.ceil(),
            Whole::Round => self.round_ties_even(),
            Whole::Trunc => self.trunc(),
        }
    }
    #[inline]
    fn sign(self) -> Self {
        if self > 0.0 {
            1.0
        } else if self < 0.0 {
            -1.0
        } else {
            self
        }
    }
    fn elementary(self, function: Elementary) -> Self {
        function.of(f64::from(self)) as f32
    }
    fn power(self, exponent: Self) -> Self {
        wgsl_power(f64::from(self), f64::from(exponent)) as f32
    }
    fn angle(self, other: Self) -> Self {
        f64::from(self).atan2(f64::from(other)) as f32
    }
    #[inline]
    fn is_less(self, other: Self) -> bool {
        self < other
    }
    #[inline]
    fn is_equal(self, other: Self) -> bool {
        self == other
    }
    #[inline]
    fn from_i32(value: i32) -> Self {
        value as f32
    }
    #[inline]
    fn from_u32(value: u32) -> Self {
        value as f32
    }
}

/// The same formulas with 53 bits: what is left of an error is not rounding.
impl Scalar for f64 {
    const NAME: &'static str = "f64";

    #[inline]
    fn from_f32(value: f32) -> Self {
        f64::from(value)
    }
    #[inline]
    fn from_f64(value: f64) -> Self {
        value
    }
    #[inline]
    fn to_f32(self) -> f32 {
        self as f32
    }
    #[inline]
    fn to_f64(self) -> f64 {
        self
    }
    #[inline]
    fn plus(self, other: Self) -> Self {
        self + other
    }
    #[inline]
    fn minus(self, other: Self) -> Self {
        self - other
    }
    #[inline]
    fn times(self, other: Self) -> Self {
        self * other
    }
    #[inline]
    fn over(self, other: Self) -> Self {
        self / other
    }
    #[inline]
    fn negated(self) -> Self {
        -self
    }
    #[inline]
    fn fused(self, factor: Self, summand: Self) -> Self {
        self.mul_add(factor, summand)
    }
    #[inline]
    fn root(self) -> Self {
        self.sqrt()
    }
    #[inline]
    fn magnitude(self) -> Self {
        self.abs()
    }
    #[inline]
    fn smaller(self, other: Self) -> Self {
        self.min(other)
    }
    #[inline]
    fn larger(self, other: Self) -> Self {
        self.max(other)
    }
    #[inline]
    fn whole(self, to: Whole) -> Self {
        to.of(self)
    }
    #[inline]
    fn sign(self) -> Self {
        if self > 0.0 {
            1.0
        } else if self < 0.0 {
            -1.0
        } else {
            self
        }
    }
    fn elementary(self, function: Elementary) -> Self {
        function.of(self)
    }
    fn power(self, exponent: Self) -> Self {
        wgsl_power(self, exponent)
    }
    fn angle(self, other: Self) -> Self {
        self.atan2(other)
    }
    #[inline]
    fn is_less(self, other: Self) -> bool {
        self < other
    }
    #[inline]
    fn is_equal(self, other: Self) -> bool {
        self == other
    }
}
