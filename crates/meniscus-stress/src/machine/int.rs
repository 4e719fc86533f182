//! Operations on integers and truth values.

use super::Machine;
use crate::number::Scalar;
use crate::op::{Int1, Int2, LANES, Op, Register};

impl<S: Scalar> Machine<'_, S> {
    pub(super) fn int(&mut self, op: &Op) {
        match *op {
            Op::Int1 { f, to, a } => self.int1(f, to, a),
            Op::Int2 { f, to, a, b } => self.int2(f, to, a, b),
            Op::Extract {
                signed,
                to,
                a,
                offset,
                count,
            } => {
                let word = |i: usize| {
                    let of = |register: Register| self.ints[register as usize][i];
                    extract(signed, of(a), of(offset), of(count))
                };
                self.ints[to as usize] = std::array::from_fn(word);
            }
            Op::Insert {
                to,
                a,
                b,
                offset,
                count,
            } => {
                let word = |i: usize| {
                    let of = |register: Register| self.ints[register as usize][i];
                    insert(of(a), of(b), of(offset), of(count))
                };
                self.ints[to as usize] = std::array::from_fn(word);
            }
            Op::SelectInt {
                to,
                condition,
                yes,
                no,
            } => {
                let word = |i: usize| {
                    let of = |register: Register| self.ints[register as usize][i];
                    if of(condition) != 0 { of(yes) } else { of(no) }
                };
                self.ints[to as usize] = std::array::from_fn(word);
            }
            Op::MoveInt { to, from } => self.ints[to as usize] = self.ints[from as usize],
            Op::StoreInt { to, from } => {
                if self.active == self.launched {
                    self.ints[to as usize] = self.ints[from as usize];
                    return;
                }
                self.active_words();
                let from = self.ints[from as usize];
                let to = &mut self.ints[to as usize];
                for i in 0..LANES {
                    let mask = self.active_words[i];
                    to[i] = from[i] & mask | to[i] & !mask;
                }
            }
            Op::PickInt { to, index, list } => {
                let list = &self.code.lists[list as usize];
                let word = |i: usize| {
                    let place = (self.ints[index as usize][i] as usize).min(list.len() - 1);
                    self.ints[list[place] as usize][i]
                };
                self.ints[to as usize] = std::array::from_fn(word);
            }
            Op::PutInt { list, index, from } => {
                let list = &self.code.lists[list as usize];
                for i in self.active_lanes() {
                    let place = (self.ints[index as usize][i] as usize).min(list.len() - 1);
                    self.ints[list[place] as usize][i] = self.ints[from as usize][i];
                }
            }
            // The others are not of integers.
            _ => {}
        }
    }

    fn each_int(&mut self, to: Register, a: Register, f: impl Fn(u32) -> u32) {
        let (below, above) = self.ints.split_at_mut(to as usize);
        let (a, to) = (&below[a as usize], &mut above[0]);
        for i in 0..LANES {
            to[i] = f(a[i]);
        }
    }

    fn each_two(&mut self, to: Register, a: Register, b: Register, f: impl Fn(u32, u32) -> u32) {
        let (below, above) = self.ints.split_at_mut(to as usize);
        let (a, b, to) = (&below[a as usize], &below[b as usize], &mut above[0]);
        for i in 0..LANES {
            to[i] = f(a[i], b[i]);
        }
    }

    fn int1(&mut self, f: Int1, to: Register, a: Register) {
        match f {
            Int1::Negate => self.each_int(to, a, u32::wrapping_neg),
            Int1::Not => self.each_int(to, a, |a| !a),
            Int1::LogicalNot => self.each_int(to, a, |a| u32::from(a == 0)),
            Int1::ToBool => self.each_int(to, a, |a| u32::from(a != 0)),
            Int1::Magnitude => self.each_int(to, a, |a| (a as i32).wrapping_abs() as u32),
            Int1::Sign => self.each_int(to, a, |a| (a as i32).signum() as u32),
            Int1::LeadingZeros => self.each_int(to, a, u32::leading_zeros),
            Int1::TrailingZeros => self.each_int(to, a, u32::trailing_zeros),
            Int1::Ones => self.each_int(to, a, u32::count_ones),
            Int1::Reverse => self.each_int(to, a, u32::reverse_bits),
            Int1::FirstTrailing => {
                self.each_int(
                    to,
                    a,
                    |a| if a == 0 { u32::MAX } else { a.trailing_zeros() },
                );
            }
            Int1::FirstLeadingUnsigned => self.each_int(to, a, first_leading),
            Int1::FirstLeadingSigned => {
                self.each_int(to, a, |a| {
                    first_leading(if (a as i32) < 0 { !a } else { a })
                });
            }
        }
    }

    fn int2(&mut self, f: Int2, to: Register, a: Register, b: Register) {
        let signed = |f: fn(i32, i32) -> i32| move |a: u32, b: u32| f(a as i32, b as i32) as u32;
        match f {
            Int2::Plus => self.each_two(to, a, b, u32::wrapping_add),
            Int2::Minus => self.each_two(to, a, b, u32::wrapping_sub),
            Int2::Times => self.each_two(to, a, b, u32::wrapping_mul),
            // WGSL: x / 0 = x, x % 0 = 0, and the smallest i32 / −1 is itself.
            Int2::OverSigned => self.each_two(
                to,
                a,
                b,
                signed(|a, b| if b == 0 { a } else { a.wrapping_div(b) }),
            ),
            Int2::OverUnsigned => self.each_two(to, a, b, |a, b| a.checked_div(b).unwrap_or(a)),
            Int2::RemainderSigned => self.each_two(
                to,
                a,
                b,
                signed(|a, b| if b == 0 { 0 } else { a.wrapping_rem(b) }),
            ),
            Int2::RemainderUnsigned => {
                self.each_two(to, a, b, |a, b| a.checked_rem(b).unwrap_or(0));
            }
            Int2::And => self.each_two(to, a, b, |a, b| a & b),
            Int2::Or => self.each_two(to, a, b, |a, b| a | b),
            Int2::Xor => self.each_two(to, a, b, |a, b| a ^ b),
            // WGSL: shifts are by the amount modulo 32.
            Int2::ShiftLeft => self.each_two(to, a, b, u32::wrapping_shl),
            Int2::ShiftRightUnsigned => self.each_two(to, a, b, u32::wrapping_shr),
            Int2::ShiftRightSigned => {
                self.each_two(to, a, b, |a, b| (a as i32).wrapping_shr(b) as u32);
            }
            Int2::LessSigned => self.each_two(to, a, b, signed(|a, b| i32::from(a < b))),
            Int2::LessUnsigned => self.each_two(to, a, b, |a, b| u32::from(a < b)),
            Int2::LessEqualSigned => self.each_two(to, a, b, signed(|a, b| i32::from(a <= b))),
            Int2::LessEqualUnsigned => self.each_two(to, a, b, |a, b| u32::from(a <= b)),
            Int2::Equal => self.each_two(to, a, b, |a, b| u32::from(a == b)),
            Int2::NotEqual => self.each_two(to, a, b, |a, b| u32::from(a != b)),
            Int2::SmallerSigned => self.each_two(to, a, b, signed(i32::min)),
            Int2::SmallerUnsigned => self.each_two(to, a, b, u32::min),
            Int2::LargerSigned => self.each_two(to, a, b, signed(i32::max)),
            Int2::LargerUnsigned => self.each_two(to, a, b, u32::max),
        }
    }
}

/// Place of the highest bit that is 1; all ones of 0.
fn first_leading(a: u32) -> u32 {
    if a == 0 {
        u32::MAX
    } else {
        31 - a.leading_zeros()
    }
}

/// `count` bits from `offset` on, as far as there are bits.
fn extract(signed: bool, a: u32, offset: u32, count: u32) -> u32 {
    let offset = offset.min(32);
    let count = count.min(32 - offset);
    if count == 0 {
        return 0;
    }
    let top = a << (32 - offset - count);
    if signed {
        ((top as i32) >> (32 - count)) as u32
    } else {
        top >> (32 - count)
    }
}

fn insert(a: u32, b: u32, offset: u32, count: u32) -> u32 {
    let offset = offset.min(32);
    let count = count.min(32 - offset);
    if count == 0 {
        return a;
    }
    let mask = (u32::MAX >> (32 - count)) << offset;
    a & !mask | (b << offset) & mask
}
