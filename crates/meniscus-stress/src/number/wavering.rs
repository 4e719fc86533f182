//! `f64` whose decisions waver: what is compared, or rounded to a whole number, is moved by a few ulps of
//! `f32` first, and nothing else is.
//!
//! So decisions come out as they may in `f32` where both sides of them are exact to these few ulps, and only
//! there: a difference that has lost its digits is moved by ulps of what is left of it.

use std::cell::Cell;

use super::{Elementary, Scalar, Whole};
use crate::ulp::ulp;

/// How far decisions waver, in ulps of `f32`.
const REACH: f64 = 4.0;

thread_local! {
    static SEED: Cell<u64> = const { Cell::new(0) };
}

/// An `f64` whose decisions waver.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Wavering(f64);

impl Wavering {
    /// Chooses another way for this thread's decisions to waver; equal seeds waver alike.
    pub(crate) fn seed(seed: u64) {
        SEED.set(seed);
    }

    /// The number as decisions see it. Equal numbers are seen alike, so that what is asked twice is
    /// answered alike; 0 and what is not finite stay.
    fn seen(self) -> f64 {
        let Self(x) = self;
        if x == 0.0 || !x.is_finite() {
            return x;
        }
        // Steele, Lea, Flood 2014, "Fast splittable pseudorandom number generators", the mixer.
        let mut word = x.to_bits() ^ SEED.get().wrapping_mul(0x9E37_79B9_7F4A_7C15);
        word = (word ^ (word >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        word = (word ^ (word >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        word ^= word >> 31;
        let share = (word >> 11) as f64 / f64::exp2(52.0) - 1.0;
        x + share * REACH * ulp(x)
    }
}

impl Scalar for Wavering {
    const NAME: &'static str = "wavering";

    fn from_f32(value: f32) -> Self {
        Self(f64::from(value))
    }
    fn from_f64(value: f64) -> Self {
        Self(value)
    }
    fn to_f32(self) -> f32 {
        self.0 as f32
    }
    fn to_f64(self) -> f64 {
        self.0
    }
    fn plus(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
    fn minus(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
    fn times(self, other: Self) -> Self {
        Self(self.0 * other.0)
    }
    fn over(self, other: Self) -> Self {
        Self(self.0 / other.0)
    }
    fn negated(self) -> Self {
        Self(-self.0)
    }
    fn fused(self, factor: Self, summand: Self) -> Self {
        Self(self.0.mul_add(factor.0, summand.0))
    }
    fn root(self) -> Self {
        Self(self.0.sqrt())
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
        Self(to.of(self.seen()))
    }
    fn sign(self) -> Self {
        Self(Scalar::sign(self.0))
    }
    fn elementary(self, function: Elementary) -> Self {
        Self(function.of(self.0))
    }
    fn power(self, exponent: Self) -> Self {
        Self(self.0.power(exponent.0))
    }
    fn angle(self, other: Self) -> Self {
        Self(self.0.atan2(other.0))
    }
    fn is_less(self, other: Self) -> bool {
        self.seen() < other.seen()
    }
    fn is_equal(self, other: Self) -> bool {
        self.0 == other.0
    }
    fn to_i32(self) -> i32 {
        self.cut().to_i32()
    }
    fn to_u32(self) -> u32 {
        self.cut().to_u32()
    }
}

impl Wavering {
    /// As it is cut to an integer: what is whole already was decided before.
    fn cut(self) -> f64 {
        if self.0.fract() == 0.0 {
            self.0
        } else {
            self.seen()
        }
    }
}
