//! Operations on floating-point numbers.

use super::{Column, Machine};
use crate::number::Scalar;
use crate::op::{Axis, Compare, Float1, Float2, LANES, Op, Register};

/// A result and what comes before it: operands have lower numbers than results.
fn before<T>(columns: &mut [Column<T>], to: Register) -> (&[Column<T>], &mut Column<T>) {
    let (below, above) = columns.split_at_mut(to as usize);
    (below, &mut above[0])
}

#[inline]
fn each1<S: Scalar>(columns: &mut [Column<S>], to: Register, a: Register, f: impl Fn(S) -> S) {
    let (below, to) = before(columns, to);
    let a = &below[a as usize];
    for i in 0..LANES {
        to[i] = f(a[i]);
    }
}

#[inline]
fn each2<S: Scalar>(
    columns: &mut [Column<S>],
    to: Register,
    a: Register,
    b: Register,
    f: impl Fn(S, S) -> S,
) {
    let (below, to) = before(columns, to);
    let (a, b) = (&below[a as usize], &below[b as usize]);
    for i in 0..LANES {
        to[i] = f(a[i], b[i]);
    }
}

impl<S: Scalar> Machine<'_, S> {
    pub(super) fn float(&mut self, op: &Op) {
        match *op {
            Op::Float1 { f, to, a } => self.float1(f, to, a),
            Op::Float2 { f, to, a, b } => self.float2(f, to, a, b),
            Op::Fused { to, a, b, c } => {
                let (below, to) = before(&mut self.floats, to);
                let (a, b, c) = (&below[a as usize], &below[b as usize], &below[c as usize]);
                for i in 0..LANES {
                    to[i] = a[i].fused(b[i], c[i]);
                }
            }
            Op::Compare { f, to, a, b } => self.compare(f, to, a, b),
            Op::IsNan { to, a } => self.measure(to, a, |x| u32::from(x.to_f64().is_nan())),
            Op::IsInfinite { to, a } => {
                self.measure(to, a, |x| u32::from(x.to_f64().is_infinite()));
            }
            Op::SelectFloat {
                to,
                condition,
                yes,
                no,
            } => {
                let condition = &self.ints[condition as usize];
                let (below, to) = before(&mut self.floats, to);
                let (yes, no) = (&below[yes as usize], &below[no as usize]);
                for i in 0..LANES {
                    to[i] = if condition[i] != 0 { yes[i] } else { no[i] };
                }
            }
            Op::MoveFloat { to, from } => self.floats[to as usize] = self.floats[from as usize],
            Op::StoreFloat { to, from } => self.store_float(to, from),
            Op::PickFloat { to, index, list } => {
                let list = &self.code.lists[list as usize];
                let index = &self.ints[index as usize];
                let (below, to) = before(&mut self.floats, to);
                for (lane, (to, &index)) in to.iter_mut().zip(index).enumerate() {
                    let place = (index as usize).min(list.len() - 1);
                    *to = below[list[place] as usize][lane];
                }
            }
            Op::PutFloat { list, index, from } => {
                let list = &self.code.lists[list as usize];
                for i in self.active_lanes() {
                    let place = (self.ints[index as usize][i] as usize).min(list.len() - 1);
                    self.floats[list[place] as usize][i] = self.floats[from as usize][i];
                }
            }
            Op::FloatToSigned { to, a } => self.measure(to, a, |x| x.to_i32() as u32),
            Op::FloatToUnsigned { to, a } => self.measure(to, a, Scalar::to_u32),
            Op::FloatBits { to, a } => self.measure(to, a, |x| x.to_f32().to_bits()),
            Op::HalfBits { to, a } => {
                self.measure(to, a, |x| {
                    u32::from(half::f16::from_f32(x.to_f32()).to_bits())
                });
            }
            Op::Exponent { to, a } => self.measure(to, a, |x| exponent(x.to_f64()) as u32),
            Op::SignedToFloat { to, a } => self.make(to, a, |n| S::from_i32(n as i32)),
            Op::UnsignedToFloat { to, a } => self.make(to, a, S::from_u32),
            Op::BitsFloat { to, a } => self.make(to, a, |n| S::from_f32(f32::from_bits(n))),
            Op::BitsHalf { to, a } => {
                self.make(to, a, |n| {
                    S::from_f32(half::f16::from_bits(n as u16).to_f32())
                });
            }
            Op::Scale { to, a, exponent } => {
                let exponents = &self.ints[exponent as usize];
                let (below, to) = before(&mut self.floats, to);
                let a = &below[a as usize];
                for i in 0..LANES {
                    // In two steps: 2^n alone may be out of range where a·2^n is not.
                    let n = (exponents[i] as i32).clamp(-400, 400);
                    let power = |n: i32| S::from_f64(f64::exp2(f64::from(n)));
                    to[i] = a[i].times(power(n / 2)).times(power(n - n / 2));
                }
            }
            Op::Derivative {
                axis,
                coarse,
                to,
                a,
            } => self.derivative(axis, coarse, to, a),
            // The others are not of floating-point numbers.
            _ => {}
        }
    }

    fn float1(&mut self, f: Float1, to: Register, a: Register) {
        let columns = &mut self.floats;
        match f {
            Float1::Negate => each1(columns, to, a, S::negated),
            Float1::Magnitude => each1(columns, to, a, S::magnitude),
            Float1::Sign => each1(columns, to, a, S::sign),
            Float1::Root => each1(columns, to, a, S::root),
            Float1::InverseRoot => each1(columns, to, a, S::inverse_root),
            Float1::Quantize => each1(columns, to, a, |x| {
                S::from_f32(half::f16::from_f32(x.to_f32()).to_f32())
            }),
            Float1::Whole(way) => each1(columns, to, a, |x| x.whole(way)),
            Float1::Elementary(function) => each1(columns, to, a, |x| x.elementary(function)),
        }
    }

    fn float2(&mut self, f: Float2, to: Register, a: Register, b: Register) {
        let columns = &mut self.floats;
        match f {
            Float2::Plus => each2(columns, to, a, b, S::plus),
            Float2::Minus => each2(columns, to, a, b, S::minus),
            Float2::Times => each2(columns, to, a, b, S::times),
            Float2::Over => each2(columns, to, a, b, S::over),
            Float2::Smaller => each2(columns, to, a, b, S::smaller),
            Float2::Larger => each2(columns, to, a, b, S::larger),
            Float2::Power => each2(columns, to, a, b, S::power),
            Float2::Angle => each2(columns, to, a, b, S::angle),
        }
    }

    fn compare(&mut self, f: Compare, to: Register, a: Register, b: Register) {
        let (a, b) = (&self.floats[a as usize], &self.floats[b as usize]);
        let to = &mut self.ints[to as usize];
        match f {
            Compare::Less => {
                for i in 0..LANES {
                    to[i] = u32::from(a[i].is_less(b[i]));
                }
            }
            Compare::LessEqual => {
                for i in 0..LANES {
                    to[i] = u32::from(a[i].is_less(b[i]) | a[i].is_equal(b[i]));
                }
            }
            Compare::Equal => {
                for i in 0..LANES {
                    to[i] = u32::from(a[i].is_equal(b[i]));
                }
            }
            Compare::NotEqual => {
                for i in 0..LANES {
                    to[i] = u32::from(!a[i].is_equal(b[i]));
                }
            }
        }
        if S::MAY_BE_UNDECIDED {
            let undecided = (0..LANES).filter(|&i| a[i].is_undecided(b[i]));
            let lanes = undecided.fold(0, |lanes, i| lanes | 1 << i);
            self.undecided |= lanes & self.active;
        }
    }

    fn measure(&mut self, to: Register, a: Register, f: impl Fn(S) -> u32) {
        let (a, to) = (&self.floats[a as usize], &mut self.ints[to as usize]);
        for i in 0..LANES {
            to[i] = f(a[i]);
        }
    }

    fn make(&mut self, to: Register, a: Register, f: impl Fn(u32) -> S) {
        let (a, to) = (&self.ints[a as usize], &mut self.floats[to as usize]);
        for i in 0..LANES {
            to[i] = f(a[i]);
        }
    }

    fn store_float(&mut self, to: Register, from: Register) {
        if self.active == self.launched {
            self.floats[to as usize] = self.floats[from as usize];
            return;
        }
        self.active_words();
        let words = &self.active_words;
        let from = self.floats[from as usize];
        let to = &mut self.floats[to as usize];
        for i in 0..LANES {
            to[i] = if words[i] != 0 { from[i] } else { to[i] };
        }
    }

    /// Differences within each four lanes, which are 2 × 2 pixels.
    fn derivative(&mut self, axis: Axis, coarse: bool, to: Register, a: Register) {
        let (below, to) = before(&mut self.floats, to);
        let a = &below[a as usize];
        for (i, to) in to.iter_mut().enumerate() {
            let quad = i & !3;
            let row = if coarse { 0 } else { i & 2 };
            let column = if coarse { 0 } else { i & 1 };
            let across = || a[quad + row + 1].minus(a[quad + row]);
            let down = || a[quad + column + 2].minus(a[quad + column]);
            *to = match axis {
                Axis::X => across(),
                Axis::Y => down(),
                Axis::Width => across().magnitude().plus(down().magnitude()),
            };
        }
    }
}

/// The exponent e for which |x| / 2^e is in [½, 1); 0 of 0 and of what is not finite.
fn exponent(x: f64) -> i32 {
    if x == 0.0 || !x.is_finite() {
        return 0;
    }
    let bits = ((x.to_bits() >> 52) & 0x7FF) as i32;
    if bits == 0 {
        exponent(x * f64::exp2(64.0)) - 64
    } else {
        bits - 1022
    }
}
