//! Packing and unpacking: several small numbers in one `u32`.

use naga::{Expression, Handle, MathFunction as Math};

use super::builder::{Builder, Result};
use crate::number::Whole;
use crate::op::{Float1, Float2, Int2, Leaf, Op, Register};

impl Builder<'_> {
    /// Code of a packing function; none for the others.
    pub(super) fn packing(
        &mut self,
        fun: Math,
        first: Handle<Expression>,
        second: Option<Handle<Expression>>,
    ) -> Result<Option<Vec<Leaf>>> {
        Ok(Some(match fun {
            Math::Pack4x8snorm => vec![self.pack_norm(first, 8, true)?],
            Math::Pack4x8unorm => vec![self.pack_norm(first, 8, false)?],
            Math::Pack2x16snorm => vec![self.pack_norm(first, 16, true)?],
            Math::Pack2x16unorm => vec![self.pack_norm(first, 16, false)?],
            Math::Unpack4x8snorm => self.unpack_norm(first, 8, true)?,
            Math::Unpack4x8unorm => self.unpack_norm(first, 8, false)?,
            Math::Unpack2x16snorm => self.unpack_norm(first, 16, true)?,
            Math::Unpack2x16unorm => self.unpack_norm(first, 16, false)?,
            Math::Pack2x16float => {
                let mut halves = Vec::new();
                for a in self.floats(first)? {
                    let to = self.int();
                    self.push(Op::HalfBits { to, a });
                    halves.push(to);
                }
                vec![Leaf::Int(self.packed(&halves, 16))]
            }
            Math::Unpack2x16float => {
                let mut floats = Vec::new();
                for a in self.unpacked(first, 16, false)? {
                    let to = self.float();
                    self.push(Op::BitsHalf { to, a });
                    floats.push(Leaf::Float(to));
                }
                floats
            }
            Math::Pack4xI8 | Math::Pack4xU8 => {
                let numbers = self.ints(first)?;
                vec![Leaf::Int(self.packed(&numbers, 8))]
            }
            Math::Pack4xI8Clamp | Math::Pack4xU8Clamp => {
                let signed = fun == Math::Pack4xI8Clamp;
                let (low, high) = if signed {
                    (-128_i32 as u32, 127)
                } else {
                    (0, 255)
                };
                let (low, high) = (self.int_constant(low), self.int_constant(high));
                let larger = if signed {
                    Int2::LargerSigned
                } else {
                    Int2::LargerUnsigned
                };
                let smaller = if signed {
                    Int2::SmallerSigned
                } else {
                    Int2::SmallerUnsigned
                };
                let mut clamped = Vec::new();
                for number in self.ints(first)? {
                    let raised = self.int2(larger, number, low);
                    clamped.push(self.int2(smaller, raised, high));
                }
                vec![Leaf::Int(self.packed(&clamped, 8))]
            }
            Math::Unpack4xI8 | Math::Unpack4xU8 => {
                let numbers = self.unpacked(first, 8, fun == Math::Unpack4xI8)?;
                numbers.into_iter().map(Leaf::Int).collect()
            }
            Math::Dot4I8Packed | Math::Dot4U8Packed => {
                let signed = fun == Math::Dot4I8Packed;
                let Some(second) = second else {
                    return self.wrong();
                };
                let (a, b) = (
                    self.unpacked(first, 8, signed)?,
                    self.unpacked(second, 8, signed)?,
                );
                let mut total = self.int_constant(0);
                for (a, b) in a.into_iter().zip(b) {
                    let product = self.int2(Int2::Times, a, b);
                    total = self.int2(Int2::Plus, total, product);
                }
                vec![Leaf::Int(total)]
            }
            _ => return Ok(None),
        }))
    }

    /// The low bits of each, the first lowest.
    fn packed(&mut self, numbers: &[Register], bits: u32) -> Register {
        let mask = self.int_constant((1 << bits) - 1);
        let mut word = self.int_constant(0);
        for (i, &number) in (0..).zip(numbers) {
            let low = self.int2(Int2::And, number, mask);
            let shift = self.int_constant(i * bits);
            let placed = self.int2(Int2::ShiftLeft, low, shift);
            word = self.int2(Int2::Or, word, placed);
        }
        word
    }

    fn unpacked(
        &mut self,
        word: Handle<Expression>,
        bits: u32,
        signed: bool,
    ) -> Result<Vec<Register>> {
        let a = self.single_int(word)?;
        let count = self.int_constant(bits);
        let mut numbers = Vec::new();
        for i in 0..32 / bits {
            let offset = self.int_constant(i * bits);
            let to = self.int();
            self.push(Op::Extract {
                signed,
                to,
                a,
                offset,
                count,
            });
            numbers.push(to);
        }
        Ok(numbers)
    }

    /// `⌊½ + scale · clamp(e, −1 or 0, 1)⌋`
    fn pack_norm(&mut self, vector: Handle<Expression>, bits: u32, signed: bool) -> Result<Leaf> {
        let low = self.float_constant(if signed { -1.0 } else { 0.0 });
        let high = self.float_constant(1.0);
        let scale = self.float_constant(largest(bits, signed));
        let half = self.float_constant(0.5);
        let mut numbers = Vec::new();
        for x in self.floats(vector)? {
            let raised = self.float2(Float2::Larger, x, low);
            let clamped = self.float2(Float2::Smaller, raised, high);
            let scaled = self.float2(Float2::Times, clamped, scale);
            let a = self.float2(Float2::Plus, half, scaled);
            let a = self.float1(Float1::Whole(Whole::Floor), a);
            let to = self.int();
            self.push(Op::FloatToSigned { to, a });
            numbers.push(to);
        }
        Ok(Leaf::Int(self.packed(&numbers, bits)))
    }

    /// `max(e / scale, −1)`
    fn unpack_norm(
        &mut self,
        word: Handle<Expression>,
        bits: u32,
        signed: bool,
    ) -> Result<Vec<Leaf>> {
        let scale = self.float_constant(largest(bits, signed));
        let low = self.float_constant(-1.0);
        let mut floats = Vec::new();
        for a in self.unpacked(word, bits, signed)? {
            let to = self.float();
            self.push(Op::SignedToFloat { to, a });
            let quotient = self.float2(Float2::Over, to, scale);
            floats.push(Leaf::Float(self.float2(Float2::Larger, quotient, low)));
        }
        Ok(floats)
    }
}

/// The number that stands for 1.
fn largest(bits: u32, signed: bool) -> f64 {
    f64::exp2(f64::from(bits - u32::from(signed))) - 1.0
}
