//! The number systems in which a module can be evaluated.

mod double_double;
mod dual;
mod interval;
mod native;
mod shadow;
mod stochastic;
mod wavering;

pub use double_double::DoubleDouble;
pub use dual::Dual;
pub use interval::Interval;
pub use shadow::Shadow;
pub use stochastic::Stochastic;
pub(crate) use wavering::Wavering;

/// A number that stands for WGSL's `f32`.
///
/// Everything that WGSL defines by a formula (`dot`, `mix`, `refract`, …) is written out in these
/// operations by the compiler, so that a number system needs no more than what is here.
pub trait Scalar: Copy + Default + Send + Sync + std::fmt::Debug + 'static {
    /// What the number system is called, as on the command line.
    const NAME: &'static str;
    /// Whether comparisons may be undecided, so that the evaluator keeps count of them.
    const MAY_BE_UNDECIDED: bool = false;

    /// The number that an `f32` is, exactly.
    fn from_f32(value: f32) -> Self;
    /// The number next to an `f64`.
    fn from_f64(value: f64) -> Self;
    /// The nearest `f32`.
    fn to_f32(self) -> f32;
    /// The nearest `f64`.
    fn to_f64(self) -> f64;

    /// `self + other`
    fn plus(self, other: Self) -> Self;
    /// `self − other`
    fn minus(self, other: Self) -> Self;
    /// `self · other`
    fn times(self, other: Self) -> Self;
    /// `self / other`
    fn over(self, other: Self) -> Self;
    /// `−self`
    fn negated(self) -> Self;
    /// `self · factor + summand`, rounded once.
    fn fused(self, factor: Self, summand: Self) -> Self;
    /// The square root.
    fn root(self) -> Self;
    /// `1 / √self`; two roundings unless a number system knows better.
    fn inverse_root(self) -> Self {
        Self::from_f32(1.0).over(self.root())
    }
    /// The absolute value.
    fn magnitude(self) -> Self;
    /// The smaller of two; the other one where one is NaN.
    fn smaller(self, other: Self) -> Self;
    /// The larger of two; the other one where one is NaN.
    fn larger(self, other: Self) -> Self;
    /// To a whole number.
    fn whole(self, to: Whole) -> Self;
    /// −1, 0 or 1.
    fn sign(self) -> Self;
    /// A transcendental function.
    fn elementary(self, function: Elementary) -> Self;
    /// `self` to the power of `exponent`; NaN where `self` is negative, as on most GPUs.
    fn power(self, exponent: Self) -> Self;
    /// The angle of the point (x: `other`, y: `self`).
    fn angle(self, other: Self) -> Self;

    /// `self < other`
    fn is_less(self, other: Self) -> bool;
    /// `self == other`
    fn is_equal(self, other: Self) -> bool;
    /// Whether `self` and `other` cannot be told apart with certainty.
    fn is_undecided(self, _other: Self) -> bool {
        false
    }

    /// The number that an integer is.
    fn from_i32(value: i32) -> Self {
        Self::from_f64(f64::from(value))
    }
    /// The number that an unsigned integer is.
    fn from_u32(value: u32) -> Self {
        Self::from_f64(f64::from(value))
    }
    /// Towards zero and into the range of the `f32`s that are `i32`s, as WGSL converts; 0 for NaN.
    fn to_i32(self) -> i32 {
        self.to_f64().clamp(-2_147_483_648.0, 2_147_483_520.0) as i32
    }
    /// Towards zero and into the range of the `f32`s that are `u32`s, as WGSL converts; 0 for NaN.
    fn to_u32(self) -> u32 {
        self.to_f64().clamp(0.0, 4_294_967_040.0) as u32
    }
}

/// Ways to a whole number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Whole {
    /// Down.
    Floor,
    /// Up.
    Ceil,
    /// To the nearest, halves to even.
    Round,
    /// Towards zero.
    Trunc,
}

impl Whole {
    /// Of an `f64`.
    #[must_use]
    pub fn of(self, x: f64) -> f64 {
        match self {
            Self::Floor => x.floor(),
            Self::Ceil => x.ceil(),
            Self::Round => x.round_ties_even(),
            Self::Trunc => x.trunc(),
        }
    }
}

/// Transcendental functions of one number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "mathematics' own names")]
pub enum Elementary {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Asinh,
    Acosh,
    Atanh,
    Exp,
    Exp2,
    Log,
    Log2,
}

impl Elementary {
    /// All of them.
    pub const ALL: [Self; 16] = [
        Self::Sin,
        Self::Cos,
        Self::Tan,
        Self::Asin,
        Self::Acos,
        Self::Atan,
        Self::Sinh,
        Self::Cosh,
        Self::Tanh,
        Self::Asinh,
        Self::Acosh,
        Self::Atanh,
        Self::Exp,
        Self::Exp2,
        Self::Log,
        Self::Log2,
    ];

    /// Of an `f64`, to about 1 ulp.
    #[must_use]
    pub fn of(self, x: f64) -> f64 {
        match self {
            Self::Sin => x.sin(),
            Self::Cos => x.cos(),
            Self::Tan => x.tan(),
            Self::Asin => x.asin(),
            Self::Acos => x.acos(),
            Self::Atan => x.atan(),
            Self::Sinh => x.sinh(),
            Self::Cosh => x.cosh(),
            Self::Tanh => x.tanh(),
            Self::Asinh => x.asinh(),
            Self::Acosh => x.acosh(),
            Self::Atanh => x.atanh(),
            Self::Exp => x.exp(),
            Self::Exp2 => x.exp2(),
            Self::Log => x.ln(),
            Self::Log2 => x.log2(),
        }
    }

    /// The derivative at an `f64`.
    #[must_use]
    pub fn slope(self, x: f64) -> f64 {
        let ln_2 = std::f64::consts::LN_2;
        match self {
            Self::Sin => x.cos(),
            Self::Cos => -x.sin(),
            Self::Tan => 1.0 / (x.cos() * x.cos()),
            Self::Asin => 1.0 / ((1.0 - x) * (1.0 + x)).sqrt(),
            Self::Acos => -1.0 / ((1.0 - x) * (1.0 + x)).sqrt(),
            Self::Atan => 1.0 / (1.0 + x * x),
            Self::Sinh => x.cosh(),
            Self::Cosh => x.sinh(),
            Self::Tanh => 1.0 / (x.cosh() * x.cosh()),
            Self::Asinh => 1.0 / (1.0 + x * x).sqrt(),
            Self::Acosh => 1.0 / ((x - 1.0) * (x + 1.0)).sqrt(),
            Self::Atanh => 1.0 / ((1.0 - x) * (1.0 + x)),
            Self::Exp => x.exp(),
            Self::Exp2 => x.exp2() * ln_2,
            Self::Log => 1.0 / x,
            Self::Log2 => 1.0 / (x * ln_2),
        }
    }
}

/// `base` to the power of `exponent` as WGSL has it: NaN for a negative base.
fn wgsl_power(base: f64, exponent: f64) -> f64 {
    if base < 0.0 {
        f64::NAN
    } else {
        base.powf(exponent)
    }
}
