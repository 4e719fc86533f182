//! Values with their derivative: forward differentiation, for condition numbers.

use super::{Elementary, Scalar, Whole, wgsl_power};

/// A value and its derivative in one direction of the inputs, both in `f64`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Dual {
    /// The value.
    pub value: f64,
    /// Its derivative.
    pub slope: f64,
}

impl Dual {
    /// From value and derivative.
    #[must_use]
    pub const fn new(value: f64, slope: f64) -> Self {
        Self { value, slope }
    }
}

impl Scalar for Dual {
    const NAME: &'static str = "dual";

    fn from_f32(value: f32) -> Self {
        Self::new(f64::from(value), 0.0)
    }
    fn from_f64(value: f64) -> Self {
        Self::new(value, 0.0)
    }
    fn to_f32(self) -> f32 {
        self.value as f32
    }
    fn to_f64(self) -> f64 {
        self.value
    }
    fn plus(self, other: Self) -> Self {
        Self::new(self.value + other.value, self.slope + other.slope)
    }
    fn minus(self, other: Self) -> Self {
        Self::new(self.value - other.value, self.slope - other.slope)
    }
    fn times(self, other: Self) -> Self {
        Self::new(
            self.value * other.value,
            self.slope * other.value + self.value * other.slope,
        )
    }
    fn over(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self::new(value, (self.slope - value * other.slope) / other.value)
    }
    fn negated(self) -> Self {
        Self::new(-self.value, -self.slope)
    }
    fn fused(self, factor: Self, summand: Self) -> Self {
        self.times(factor).plus(summand)
    }
    fn root(self) -> Self {
        let value = self.value.sqrt();
        // A constant stays a constant, even at 0 where the root's slope is infinite.
        let slope = if self.slope == 0.0 {
            0.0
        } else {
            self.slope / (2.0 * value)
        };
        Self::new(value, slope)
    }
    fn magnitude(self) -> Self {
        if self.value.is_sign_negative() {
            self.negated()
        } else {
            self
        }
    }
    fn smaller(self, other: Self) -> Self {
        if other.value < self.value || self.value.is_nan() {
            other
        } else {
            self
        }
    }
    fn larger(self, other: Self) -> Self {
        if self.value < other.value || self.value.is_nan() {
            other
        } else {
            self
        }
    }
    fn whole(self, to: Whole) -> Self {
        Self::new(to.of(self.value), 0.0)
    }
    fn sign(self) -> Self {
        Self::new(self.value.sign(), 0.0)
    }
    fn elementary(self, function: Elementary) -> Self {
        let slope = if self.slope == 0.0 {
            0.0
        } else {
            self.slope * function.slope(self.value)
        };
        Self::new(function.of(self.value), slope)
    }
    fn power(self, exponent: Self) -> Self {
        let value = wgsl_power(self.value, exponent.value);
        let mut slope = 0.0;
        if self.slope != 0.0 {
            slope += self.slope * exponent.value * self.value.powf(exponent.value - 1.0);
        }
        if exponent.slope != 0.0 {
            slope += exponent.slope * value * self.value.ln();
        }
        Self::new(value, slope)
    }
    fn angle(self, other: Self) -> Self {
        let square = self.value * self.value + other.value * other.value;
        let slope = (self.slope * other.value - self.value * other.slope) / square;
        Self::new(self.value.atan2(other.value), slope)
    }
    fn is_less(self, other: Self) -> bool {
        self.value < other.value
    }
    fn is_equal(self, other: Self) -> bool {
        self.value == other.value
    }
}
