//! Operators: number by number, and the matrix products.

use naga::{BinaryOperator, Expression, Handle, TypeInner, UnaryOperator};

use super::builder::{Builder, Result};
use crate::op::{Compare, Float1, Float2, Int1, Int2, Leaf, Register};
use crate::shape::Kind;

impl Builder<'_> {
    pub(super) fn unary(
        &mut self,
        op: UnaryOperator,
        operand: Handle<Expression>,
    ) -> Result<Vec<Leaf>> {
        let leaves = self.leaves(operand)?;
        let one = |leaf| match (op, leaf) {
            (UnaryOperator::Negate, Leaf::Float(a)) => {
                Ok(Leaf::Float(self.float1(Float1::Negate, a)))
            }
            (UnaryOperator::Negate, Leaf::Int(a)) => Ok(Leaf::Int(self.int1(Int1::Negate, a))),
            (UnaryOperator::LogicalNot, Leaf::Int(a)) => {
                Ok(Leaf::Int(self.int1(Int1::LogicalNot, a)))
            }
            (UnaryOperator::BitwiseNot, Leaf::Int(a)) => Ok(Leaf::Int(self.int1(Int1::Not, a))),
            _ => self.wrong(),
        };
        leaves.into_iter().map(one).collect()
    }

    pub(super) fn binary(
        &mut self,
        op: BinaryOperator,
        left: Handle<Expression>,
        right: Handle<Expression>,
    ) -> Result<Vec<Leaf>> {
        if op == BinaryOperator::Multiply
            && let Some(product) = self.matrix_product(left, right)?
        {
            return Ok(product);
        }
        let kind = match self.type_of(left) {
            TypeInner::Matrix { .. } => Kind::Float,
            _ => self.kind_of(left)?,
        };
        let (a, b) = (self.leaves(left)?, self.leaves(right)?);
        let mut leaves = Vec::with_capacity(a.len().max(b.len()));
        for i in 0..a.len().max(b.len()) {
            // A number beside a vector or matrix stands for all of its numbers.
            let (Some(&a), Some(&b)) = (a.get(i).or(a.first()), b.get(i).or(b.first())) else {
                return self.wrong();
            };
            leaves.push(match (a, b) {
                (Leaf::Float(a), Leaf::Float(b)) => self.float_operator(op, a, b)?,
                (Leaf::Int(a), Leaf::Int(b)) => Leaf::Int(self.int_operator(op, kind, a, b)?),
                _ => return self.wrong(),
            });
        }
        Ok(leaves)
    }

    fn float_operator(&mut self, op: BinaryOperator, a: Register, b: Register) -> Result<Leaf> {
        let simple = match op {
            BinaryOperator::Add => Float2::Plus,
            BinaryOperator::Subtract => Float2::Minus,
            BinaryOperator::Multiply => Float2::Times,
            BinaryOperator::Divide => Float2::Over,
            BinaryOperator::Modulo => return Ok(Leaf::Float(self.remainder(a, b))),
            _ => {
                let (f, a, b) = match op {
                    BinaryOperator::Equal => (Compare::Equal, a, b),
                    BinaryOperator::NotEqual => (Compare::NotEqual, a, b),
                    BinaryOperator::Less => (Compare::Less, a, b),
                    BinaryOperator::LessEqual => (Compare::LessEqual, a, b),
                    BinaryOperator::Greater => (Compare::Less, b, a),
                    BinaryOperator::GreaterEqual => (Compare::LessEqual, b, a),
                    _ => return self.wrong(),
                };
                return Ok(Leaf::Int(self.compare(f, a, b)));
            }
        };
        Ok(Leaf::Float(self.float2(simple, a, b)))
    }

    /// `a − b·trunc(a / b)`, as WGSL defines it.
    fn remainder(&mut self, a: Register, b: Register) -> Register {
        let quotient = self.float2(Float2::Over, a, b);
        let whole = self.float1(Float1::Whole(crate::number::Whole::Trunc), quotient);
        let product = self.float2(Float2::Times, b, whole);
        self.float2(Float2::Minus, a, product)
    }

    fn int_operator(
        &mut self,
        op: BinaryOperator,
        kind: Kind,
        a: Register,
        b: Register,
    ) -> Result<Register> {
        let signed = kind == Kind::Sint;
        let either = |yes, no| if signed { yes } else { no };
        let less = either(Int2::LessSigned, Int2::LessUnsigned);
        let less_equal = either(Int2::LessEqualSigned, Int2::LessEqualUnsigned);
        let (f, a, b) = match op {
            BinaryOperator::Add => (Int2::Plus, a, b),
            BinaryOperator::Subtract => (Int2::Minus, a, b),
            BinaryOperator::Multiply => (Int2::Times, a, b),
            BinaryOperator::Divide => (either(Int2::OverSigned, Int2::OverUnsigned), a, b),
            BinaryOperator::Modulo => {
                (either(Int2::RemainderSigned, Int2::RemainderUnsigned), a, b)
            }
            BinaryOperator::And | BinaryOperator::LogicalAnd => (Int2::And, a, b),
            BinaryOperator::InclusiveOr | BinaryOperator::LogicalOr => (Int2::Or, a, b),
            BinaryOperator::ExclusiveOr => (Int2::Xor, a, b),
            BinaryOperator::ShiftLeft => (Int2::ShiftLeft, a, b),
            BinaryOperator::ShiftRight => (
                either(Int2::ShiftRightSigned, Int2::ShiftRightUnsigned),
                a,
                b,
            ),
            BinaryOperator::Equal => (Int2::Equal, a, b),
            BinaryOperator::NotEqual => (Int2::NotEqual, a, b),
            BinaryOperator::Less => (less, a, b),
            BinaryOperator::LessEqual => (less_equal, a, b),
            BinaryOperator::Greater => (less, b, a),
            BinaryOperator::GreaterEqual => (less_equal, b, a),
        };
        Ok(self.int2(f, a, b))
    }

    /// The products that are not number by number; none for the others.
    fn matrix_product(
        &mut self,
        left: Handle<Expression>,
        right: Handle<Expression>,
    ) -> Result<Option<Vec<Leaf>>> {
        let (left_type, right_type) = (self.type_of(left), self.type_of(right));
        let (inner, rows, columns) = match (left_type, right_type) {
            (
                TypeInner::Matrix {
                    columns: inner,
                    rows,
                    ..
                },
                TypeInner::Matrix { columns, .. },
            ) => (*inner as usize, *rows as usize, *columns as usize),
            (TypeInner::Matrix { columns, rows, .. }, TypeInner::Vector { .. }) => {
                (*columns as usize, *rows as usize, 1)
            }
            (TypeInner::Vector { .. }, TypeInner::Matrix { columns, rows, .. }) => {
                (*rows as usize, 1, *columns as usize)
            }
            _ => return Ok(None),
        };
        let (a, b) = (self.floats(left)?, self.floats(right)?);
        if a.len() != inner * rows || b.len() != inner * columns {
            return self.wrong();
        }
        let mut leaves = Vec::with_capacity(rows * columns);
        for column in 0..columns {
            for row in 0..rows {
                let terms = (0..inner).map(|k| (a[k * rows + row], b[column * inner + k]));
                let terms: Vec<_> = terms.collect();
                leaves.push(Leaf::Float(self.sum_of_products(terms)?));
            }
        }
        Ok(Some(leaves))
    }
}
