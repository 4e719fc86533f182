//! Numbers of about 31 digits: unevaluated sums of two `f64`s.
//!
//! Dekker 1971, "A floating-point technique for extending the available precision"; Hida, Li and
//! Bailey 2001, "Algorithms for quad-double precision floating point arithmetic".

use super::{Elementary, Scalar, Whole};

/// `high + low`, with |low| at most half an ulp of `high`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct DoubleDouble {
    /// The nearest `f64`.
    pub high: f64,
    /// What is missing.
    pub low: f64,
}

const LN_2: DoubleDouble = DoubleDouble::new(std::f64::consts::LN_2, 2.319_046_813_846_299_6e-17);
const HALF_PI: DoubleDouble =
    DoubleDouble::new(std::f64::consts::FRAC_PI_2, 6.123_233_995_736_766e-17);
const ONE: DoubleDouble = DoubleDouble::new(1.0, 0.0);

impl DoubleDouble {
    /// From its two parts, which must not overlap.
    #[must_use]
    pub const fn new(high: f64, low: f64) -> Self {
        Self { high, low }
    }

    /// The sum of any two numbers; infinities and NaN stay what they are.
    fn sum(a: f64, b: f64) -> Self {
        let high = a + b;
        if !high.is_finite() {
            return Self::new(high, 0.0);
        }
        let rest = high - a;
        Self::new(high, (a - (high - rest)) + (b - rest))
    }

    /// The product of any two numbers.
    fn product(a: f64, b: f64) -> Self {
        let high = a * b;
        if !high.is_finite() {
            return Self::new(high, 0.0);
        }
        Self::new(high, a.mul_add(b, -high))
    }

    fn scaled(self, power_of_two: f64) -> Self {
        Self::new(self.high * power_of_two, self.low * power_of_two)
    }

    fn is_finite(self) -> bool {
        self.high.is_finite()
    }

    fn exp(self) -> Self {
        if self.high > 709.0 || self.high < -709.0 || !self.is_finite() {
            return Self::new(self.high.exp(), 0.0);
        }
        // e^x = 2^k · (e^(r/512))^512 with |r| ≤ ln 2 / 2; expm1 is squared up, so that the small
        // number never drowns beside 1.
        let k = (self.high / std::f64::consts::LN_2).round();
        let r = self
            .minus(LN_2.times(Self::new(k, 0.0)))
            .scaled(1.0 / 512.0);
        let mut term = r;
        let mut total = r;
        for n in 2..12 {
            term = term.times(r).over(Self::new(f64::from(n), 0.0));
            total = total.plus(term);
        }
        for _ in 0..9 {
            total = total.scaled(2.0).plus(total.times(total));
        }
        // 2^k in two factors: k may be just outside the exponents of normal numbers.
        let half = (k / 2.0).trunc();
        total
            .plus(ONE)
            .scaled(half.exp2())
            .scaled((k - half).exp2())
    }

    fn ln(self) -> Self {
        if self.high <= 0.0 || !self.is_finite() {
            return Self::new(self.high.ln(), 0.0);
        }
        let mut y = Self::new(self.high.ln(), 0.0);
        for _ in 0..2 {
            y = y.plus(self.times(y.negated().exp()).minus(ONE));
        }
        y
    }

    fn sin_cos(self) -> (Self, Self) {
        if !self.is_finite() {
            let nan = Self::new(f64::NAN, 0.0);
            return (nan, nan);
        }
        let k = (self.high / std::f64::consts::FRAC_PI_2).round();
        let r = self.minus(HALF_PI.times(Self::new(k, 0.0)));
        let square = r.times(r).negated();
        let (mut sin, mut cos) = (r, ONE);
        let (mut sin_term, mut cos_term) = (r, ONE);
        for n in 1..16 {
            let n = f64::from(n);
            cos_term = cos_term
                .times(square)
                .over(Self::new((2.0 * n - 1.0) * (2.0 * n), 0.0));
            sin_term = sin_term
                .times(square)
                .over(Self::new((2.0 * n) * (2.0 * n + 1.0), 0.0));
            cos = cos.plus(cos_term);
            sin = sin.plus(sin_term);
        }
        match k.rem_euclid(4.0) as u8 {
            0 => (sin, cos),
            1 => (cos, sin.negated()),
            2 => (sin.negated(), cos.negated()),
            _ => (cos.negated(), sin),
        }
    }

    fn atan(self) -> Self {
        if !self.is_finite() || self.high.abs() > 1e150 {
            let pole = if self.high > 0.0 {
                HALF_PI
            } else {
                HALF_PI.negated()
            };
            return if self.high.is_nan() { self } else { pole };
        }
        let y = Self::new(self.high.atan(), 0.0);
        let (sin, cos) = y.sin_cos();
        // tan of what is missing; it is so small that it is its own arc tangent.
        y.plus(self.times(cos).minus(sin).over(cos.plus(self.times(sin))))
    }

    fn sinh(self) -> Self {
        if self.high.abs() < 0.3 {
            let square = self.times(self);
            let (mut term, mut total) = (self, self);
            for n in 1..12 {
                let n = f64::from(n);
                term = term
                    .times(square)
                    .over(Self::new((2.0 * n) * (2.0 * n + 1.0), 0.0));
                total = total.plus(term);
            }
            return total;
        }
        let e = self.exp();
        e.minus(ONE.over(e)).scaled(0.5)
    }

    fn cosh(self) -> Self {
        let e = self.exp();
        e.plus(ONE.over(e)).scaled(0.5)
    }

    /// √((1 − x)(1 + x))
    fn co_sine(self) -> Self {
        ONE.minus(self).times(ONE.plus(self)).root()
    }
}

impl Scalar for DoubleDouble {
    const NAME: &'static str = "dd";

    fn from_f32(value: f32) -> Self {
        Self::new(f64::from(value), 0.0)
    }
    fn from_f64(value: f64) -> Self {
        Self::new(value, 0.0)
    }
    fn to_f32(self) -> f32 {
        self.to_f64() as f32
    }
    fn to_f64(self) -> f64 {
        self.high + self.low
    }
    #[inline]
    fn plus(self, other: Self) -> Self {
        let s = Self::sum(self.high, other.high);
        let t = Self::sum(self.low, other.low);
        let s = Self::sum(s.high, s.low + t.high);
        Self::sum(s.high, s.low + t.low)
    }
    #[inline]
    fn minus(self, other: Self) -> Self {
        self.plus(other.negated())
    }
    #[inline]
    fn times(self, other: Self) -> Self {
        let p = Self::product(self.high, other.high);
        Self::sum(
            p.high,
            p.low + (self.high * other.low + self.low * other.high),
        )
    }
    #[inline]
    fn over(self, other: Self) -> Self {
        let first = self.high / other.high;
        if !first.is_finite() || !other.is_finite() || first == 0.0 {
            return Self::new(first, 0.0);
        }
        let rest = self.minus(other.times(Self::new(first, 0.0)));
        let second = rest.high / other.high;
        let rest = rest.minus(other.times(Self::new(second, 0.0)));
        let third = rest.high / other.high;
        Self::sum(first, second).plus(Self::new(third, 0.0))
    }
    #[inline]
    fn negated(self) -> Self {
        Self::new(-self.high, -self.low)
    }
    fn fused(self, factor: Self, summand: Self) -> Self {
        self.times(factor).plus(summand)
    }
    #[inline]
    fn root(self) -> Self {
        let first = self.high.sqrt();
        if !first.is_finite() || first == 0.0 {
            return Self::new(first, 0.0);
        }
        let rest = self.minus(Self::product(first, first));
        let y = Self::sum(first, rest.high / (2.0 * first));
        let rest = self.minus(y.times(y));
        y.plus(Self::new(rest.high / (2.0 * first), 0.0))
    }
    fn magnitude(self) -> Self {
        if self.high.is_sign_negative() {
            self.negated()
        } else {
            self
        }
    }
    fn smaller(self, other: Self) -> Self {
        if other.is_less(self) || self.high.is_nan() {
            other
        } else {
            self
        }
    }
    fn larger(self, other: Self) -> Self {
        if self.is_less(other) || self.high.is_nan() {
            other
        } else {
            self
        }
    }
    fn whole(self, to: Whole) -> Self {
        match to {
            Whole::Trunc if self.high < 0.0 => self.whole(Whole::Ceil),
            Whole::Trunc => self.whole(Whole::Floor),
            Whole::Ceil => self.negated().whole(Whole::Floor).negated(),
            Whole::Floor => {
                let high = self.high.floor();
                if high == self.high {
                    Self::sum(high, self.low.floor())
                } else {
                    Self::new(high, 0.0)
                }
            }
            Whole::Round => {
                let down = self.whole(Whole::Floor);
                let rest = self.minus(down).minus(Self::new(0.5, 0.0)).to_f64();
                let down_is_even = down.to_f64().rem_euclid(2.0) == 0.0;
                if rest < 0.0 || (rest == 0.0 && down_is_even) {
                    down
                } else {
                    down.plus(ONE)
                }
            }
        }
    }
    fn sign(self) -> Self {
        Self::new(self.high.sign(), 0.0)
    }
    fn elementary(self, function: Elementary) -> Self {
        let half = Self::new(0.5, 0.0);
        match function {
            Elementary::Sin => self.sin_cos().0,
            Elementary::Cos => self.sin_cos().1,
            Elementary::Tan => {
                let (sin, cos) = self.sin_cos();
                sin.over(cos)
            }
            Elementary::Asin => self.angle(self.co_sine()),
            Elementary::Acos => self.co_sine().angle(self),
            Elementary::Atan => self.atan(),
            Elementary::Sinh => self.sinh(),
            Elementary::Cosh => self.cosh(),
            Elementary::Tanh if self.high.abs() > 50.0 => self.sign(),
            Elementary::Tanh => self.sinh().over(self.cosh()),
            Elementary::Asinh => {
                let x = self.magnitude();
                let y = x.plus(x.times(x).plus(ONE).root()).ln();
                if self.high < 0.0 { y.negated() } else { y }
            }
            Elementary::Acosh => self.plus(self.minus(ONE).times(self.plus(ONE)).root()).ln(),
            Elementary::Atanh => ONE.plus(self).over(ONE.minus(self)).ln().times(half),
            Elementary::Exp => self.exp(),
            Elementary::Exp2 => self.times(LN_2).exp(),
            Elementary::Log => self.ln(),
            Elementary::Log2 => self.ln().over(LN_2),
        }
    }
    fn power(self, exponent: Self) -> Self {
        if self.high <= 0.0 || !self.is_finite() || !exponent.is_finite() {
            return Self::new(super::wgsl_power(self.high, exponent.high), 0.0);
        }
        exponent.times(self.ln()).exp()
    }
    fn angle(self, other: Self) -> Self {
        if other.high == 0.0 || !self.is_finite() || !other.is_finite() {
            let quarter = match self.high {
                y if y > 0.0 && other.high == 0.0 => HALF_PI,
                y if y < 0.0 && other.high == 0.0 => HALF_PI.negated(),
                y => Self::new(y.atan2(other.high), 0.0),
            };
            return quarter;
        }
        let within = self.over(other).atan();
        if other.high > 0.0 {
            within
        } else if self.high.is_sign_negative() {
            within.minus(HALF_PI.scaled(2.0))
        } else {
            within.plus(HALF_PI.scaled(2.0))
        }
    }
    fn is_less(self, other: Self) -> bool {
        self.high < other.high || (self.high == other.high && self.low < other.low)
    }
    fn is_equal(self, other: Self) -> bool {
        self.high == other.high && self.low == other.low
    }
    fn to_i32(self) -> i32 {
        self.whole(Whole::Trunc).high.to_i32()
    }
    fn to_u32(self) -> u32 {
        self.whole(Whole::Trunc).high.to_u32()
    }
}
