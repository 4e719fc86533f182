//! The machine's own numbers.

use num_traits::Float;

use super::{Elementary, Scalar, Whole, wgsl_power};

/// `f32` and `f64`: what they do not do alike.
pub trait Native:
    Float + From<f32> + Into<f64> + Default + Send + Sync + std::fmt::Debug + 'static
{
    /// See [`Scalar::NAME`].
    const NAME: &'static str;
    /// The number next to an `f64`.
    fn nearest(value: f64) -> Self;
    /// The nearest `f32`.
    fn single(self) -> f32;
}

/// As a GPU computes, with correctly rounded division, roots and transcendental functions.
impl Native for f32 {
    const NAME: &'static str = "f32";
    #[inline]
    fn nearest(value: f64) -> Self {
        value as f32
    }
    #[inline]
    fn single(self) -> f32 {
        self
    }
}

/// The same formulas with 53 bits: what is left of an error is not rounding.
impl Native for f64 {
    const NAME: &'static str = "f64";
    #[inline]
    fn nearest(value: f64) -> Self {
        value
    }
    #[inline]
    fn single(self) -> f32 {
        self as f32
    }
}

impl<T: Native> Scalar for T {
    const NAME: &'static str = <T as Native>::NAME;

    #[inline]
    fn from_f32(value: f32) -> Self {
        <T as From<f32>>::from(value)
    }
    #[inline]
    fn from_f64(value: f64) -> Self {
        T::nearest(value)
    }
    #[inline]
    fn to_f32(self) -> f32 {
        self.single()
    }
    #[inline]
    fn to_f64(self) -> f64 {
        self.into()
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
        // Exact: whole numbers next to an `f32` are `f32`s.
        T::nearest(to.of(self.into()))
    }
    #[inline]
    fn sign(self) -> Self {
        if self > T::zero() {
            T::one()
        } else if self < T::zero() {
            -T::one()
        } else {
            self
        }
    }
    fn elementary(self, function: Elementary) -> Self {
        T::nearest(function.of(self.into()))
    }
    fn power(self, exponent: Self) -> Self {
        T::nearest(wgsl_power(self.into(), exponent.into()))
    }
    fn angle(self, other: Self) -> Self {
        let (y, x): (f64, f64) = (self.into(), other.into());
        T::nearest(y.atan2(x))
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
