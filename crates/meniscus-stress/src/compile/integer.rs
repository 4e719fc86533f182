//! Built-in functions of integers.

use naga::MathFunction as Math;

use super::builder::{Builder, Result};
use super::math::Arguments;
use crate::op::{Int1, Int2, Leaf, Op, Register};
use crate::shape::Kind;

impl Builder<'_> {
    pub(super) fn int_math(&mut self, fun: Math, arguments: Arguments<'_>) -> Result<Vec<Leaf>> {
        let Some(first) = arguments[0] else {
            return self.wrong();
        };
        let signed = self.kind_of(first)? == Kind::Sint;
        let either = |yes, no| if signed { yes } else { no };
        let operands: Vec<_> = arguments
            .iter()
            .flatten()
            .map(|o| self.ints(*o))
            .collect::<Result<_>>()?;
        if let (Math::Dot, [a, b]) = (fun, &operands[..]) {
            let mut total = self.int_constant(0);
            for (&a, &b) in a.iter().zip(b) {
                let product = self.int2(Int2::Times, a, b);
                total = self.int2(Int2::Plus, total, product);
            }
            return Ok(vec![Leaf::Int(total)]);
        }
        let smaller = either(Int2::SmallerSigned, Int2::SmallerUnsigned);
        let larger = either(Int2::LargerSigned, Int2::LargerUnsigned);
        let mut leaves = Vec::with_capacity(operands[0].len());
        for i in 0..operands[0].len() {
            let one = |o: &Vec<Register>| o.get(i).or(o.first()).copied();
            let Some(of) = operands.iter().map(one).collect::<Option<Vec<_>>>() else {
                return self.wrong();
            };
            let register = match (fun, &of[..]) {
                (Math::Abs, &[a]) if !signed => a,
                (Math::Abs, &[a]) => self.int1(Int1::Magnitude, a),
                (Math::Sign, &[a]) => self.int1(Int1::Sign, a),
                (Math::Min, &[a, b]) => self.int2(smaller, a, b),
                (Math::Max, &[a, b]) => self.int2(larger, a, b),
                (Math::Clamp, &[a, low, high]) => {
                    let raised = self.int2(larger, a, low);
                    self.int2(smaller, raised, high)
                }
                (Math::CountTrailingZeros, &[a]) => self.int1(Int1::TrailingZeros, a),
                (Math::CountLeadingZeros, &[a]) => self.int1(Int1::LeadingZeros, a),
                (Math::CountOneBits, &[a]) => self.int1(Int1::Ones, a),
                (Math::ReverseBits, &[a]) => self.int1(Int1::Reverse, a),
                (Math::FirstTrailingBit, &[a]) => self.int1(Int1::FirstTrailing, a),
                (Math::FirstLeadingBit, &[a]) => {
                    let unsigned = Int1::FirstLeadingUnsigned;
                    self.int1(
                        if signed {
                            Int1::FirstLeadingSigned
                        } else {
                            unsigned
                        },
                        a,
                    )
                }
                (Math::ExtractBits, &[a, offset, count]) => {
                    let to = self.int();
                    self.push(Op::Extract {
                        signed,
                        to,
                        a,
                        offset,
                        count,
                    });
                    to
                }
                (Math::InsertBits, &[a, b, offset, count]) => {
                    let to = self.int();
                    self.push(Op::Insert {
                        to,
                        a,
                        b,
                        offset,
                        count,
                    });
                    to
                }
                _ => return self.unsupported(format!("the built-in function {fun:?} of integers")),
            };
            leaves.push(Leaf::Int(register));
        }
        Ok(leaves)
    }
}
