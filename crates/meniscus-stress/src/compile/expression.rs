//! Expressions.

use naga::{Expression, Handle, Literal, RelationalFunction, ScalarKind, TypeInner};

use super::builder::{Builder, Result, Value};
use super::types;
use crate::op::{Axis, Float2, Int1, Int2, Leaf, Op};
use crate::shape::Kind;

impl Builder<'_> {
    /// Writes down what an expression computes.
    pub(super) fn compute(&mut self, handle: Handle<Expression>) -> Result<Value> {
        let expression = self.expression(handle);
        let leaves = match *expression {
            Expression::Literal(literal) => vec![self.literal(literal)?],
            Expression::Constant(constant) => {
                return self.global_constant(self.module.constants[constant].init);
            }
            Expression::Override(variable) => return self.override_value(variable),
            Expression::ZeroValue(ty) => {
                let kinds = self.kinds(&self.module.types[ty].inner)?;
                kinds.into_iter().map(|kind| self.zero(kind)).collect()
            }
            Expression::Compose { ref components, .. } => {
                let mut leaves = Vec::new();
                for component in components {
                    leaves.extend(self.leaves(*component)?);
                }
                leaves
            }
            Expression::Splat { size, value } => vec![self.single(value)?; size as usize],
            Expression::Swizzle {
                size,
                vector,
                pattern,
            } => {
                let from = self.leaves(vector)?;
                let picked = pattern
                    .iter()
                    .take(size as usize)
                    .map(|c| from.get(*c as usize));
                match picked.map(Option::<&Leaf>::copied).collect() {
                    Some(leaves) => leaves,
                    None => return self.wrong(),
                }
            }
            Expression::Access { base, index } => return self.access(base, index),
            Expression::AccessIndex { base, index } => return self.access_index(base, index),
            Expression::FunctionArgument(index) => {
                return match self.frame()?.arguments.get(index as usize) {
                    Some(value) => Ok(value.clone()),
                    None => self.wrong(),
                };
            }
            Expression::GlobalVariable(variable) => return self.global(variable),
            Expression::LocalVariable(variable) => {
                return match self.frame()?.locals.get(&variable) {
                    Some(leaves) => {
                        let choices = vec![leaves.clone()];
                        Ok(Value::Place(super::builder::Place::Registers {
                            choices,
                            index: None,
                        }))
                    }
                    None => self.wrong(),
                };
            }
            Expression::Load { pointer } => {
                let Value::Place(place) = self.value(pointer)? else {
                    return self.wrong();
                };
                let Some(inner) = types::pointee(self.module, self.type_of(pointer)) else {
                    return self.wrong();
                };
                self.load(&place, &inner)?
            }
            Expression::ImageSample { .. }
            | Expression::ImageLoad { .. }
            | Expression::ImageQuery { .. } => self.image_expression(expression, handle)?,
            Expression::Unary { op, expr } => self.unary(op, expr)?,
            Expression::Binary { op, left, right } => self.binary(op, left, right)?,
            Expression::Select {
                condition,
                accept,
                reject,
            } => {
                let conditions = self.ints(condition)?;
                let (accept, reject) = (self.leaves(accept)?, self.leaves(reject)?);
                let mut leaves = Vec::with_capacity(accept.len());
                for (i, (&yes, &no)) in accept.iter().zip(&reject).enumerate() {
                    let Some(&condition) = conditions.get(i).or(conditions.first()) else {
                        return self.wrong();
                    };
                    leaves.push(self.select(condition, yes, no)?);
                }
                leaves
            }
            Expression::Derivative { axis, ctrl, expr } => {
                let axis = match axis {
                    naga::DerivativeAxis::X => Axis::X,
                    naga::DerivativeAxis::Y => Axis::Y,
                    naga::DerivativeAxis::Width => Axis::Width,
                };
                let coarse = ctrl == naga::DerivativeControl::Coarse;
                let mut leaves = Vec::new();
                for a in self.floats(expr)? {
                    let to = self.float();
                    self.push(Op::Derivative {
                        axis,
                        coarse,
                        to,
                        a,
                    });
                    leaves.push(Leaf::Float(to));
                }
                leaves
            }
            Expression::Relational { fun, argument } => self.relational(fun, argument)?,
            Expression::Math {
                fun,
                arg,
                arg1,
                arg2,
                arg3,
            } => self.math(fun, &[Some(arg), arg1, arg2, arg3], handle)?,
            Expression::As {
                expr,
                kind,
                convert,
            } => self.conversion(expr, kind, convert)?,
            Expression::ArrayLength(pointer) => self.array_length(pointer)?,
            Expression::CallResult(_)
            | Expression::AtomicResult { .. }
            | Expression::WorkGroupUniformLoadResult { .. } => {
                return self.unsupported("a result used before it is there");
            }
            Expression::RayQueryVertexPositions { .. }
            | Expression::RayQueryProceedResult
            | Expression::RayQueryGetIntersection { .. } => {
                return self.unsupported("a ray query");
            }
            Expression::SubgroupBallotResult | Expression::SubgroupOperationResult { .. } => {
                return self.unsupported("a subgroup operation");
            }
            Expression::CooperativeLoad { .. } | Expression::CooperativeMultiplyAdd { .. } => {
                return self.unsupported("a cooperative matrix");
            }
        };
        Ok(Value::Leaves(leaves))
    }

    fn literal(&mut self, literal: Literal) -> Result<Leaf> {
        Ok(match literal {
            Literal::F32(x) => Leaf::Float(self.float_constant(f64::from(x))),
            Literal::AbstractFloat(x) => Leaf::Float(self.float_constant(x)),
            Literal::U32(n) => Leaf::Int(self.int_constant(n)),
            Literal::I32(n) => Leaf::Int(self.int_constant(n as u32)),
            Literal::Bool(b) => Leaf::Int(self.int_constant(u32::from(b))),
            Literal::AbstractInt(n) => match i32::try_from(n) {
                Ok(n) => Leaf::Int(self.int_constant(n as u32)),
                Err(_) => return self.unsupported("an integer of more than 32 bits"),
            },
            Literal::F64(_) => return self.unsupported("a floating-point number of 64 bits"),
            Literal::F16(_) => return self.unsupported("a floating-point number of 16 bits"),
            Literal::U16(_) | Literal::I16(_) => {
                return self.unsupported("an integer of 16 bits");
            }
            Literal::U64(_) | Literal::I64(_) => {
                return self.unsupported("an integer of 64 bits");
            }
        })
    }

    fn relational(
        &mut self,
        fun: RelationalFunction,
        argument: Handle<Expression>,
    ) -> Result<Vec<Leaf>> {
        match fun {
            RelationalFunction::All | RelationalFunction::Any => {
                let f = if fun == RelationalFunction::All {
                    Int2::And
                } else {
                    Int2::Or
                };
                let all = self.ints(argument)?;
                let Some((&first, rest)) = all.split_first() else {
                    return self.wrong();
                };
                let folded = rest
                    .iter()
                    .fold(first, |so_far, &next| self.int2(f, so_far, next));
                Ok(vec![Leaf::Int(folded)])
            }
            RelationalFunction::IsNan | RelationalFunction::IsInf => {
                let mut leaves = Vec::new();
                for a in self.floats(argument)? {
                    let to = self.int();
                    self.push(if fun == RelationalFunction::IsNan {
                        Op::IsNan { to, a }
                    } else {
                        Op::IsInfinite { to, a }
                    });
                    leaves.push(Leaf::Int(to));
                }
                Ok(leaves)
            }
        }
    }

    fn array_length(&mut self, pointer: Handle<Expression>) -> Result<Vec<Leaf>> {
        let Value::Place(super::builder::Place::Memory(at)) = self.value(pointer)? else {
            return self.wrong();
        };
        let Some(inner) = types::pointee(self.module, self.type_of(pointer)) else {
            return self.wrong();
        };
        let stride = self.with_types(|t| t.stride(&inner, types::Layout::Host))?;
        let crate::op::Memory::Buffer(slot) = at.memory else {
            return self.wrong();
        };
        let to = self.int();
        self.push(Op::Length {
            to,
            slot,
            offset: at.offset,
            stride,
        });
        Ok(vec![Leaf::Int(to)])
    }

    fn conversion(
        &mut self,
        operand: Handle<Expression>,
        to: ScalarKind,
        convert: Option<u8>,
    ) -> Result<Vec<Leaf>> {
        let from = match self.type_of(operand) {
            TypeInner::Matrix { .. } => Kind::Float,
            _ => self.kind_of(operand)?,
        };
        let width = convert.unwrap_or(4);
        let to = match types::kind(naga::Scalar { kind: to, width }) {
            Ok(kind) => kind,
            Err(construct) => return self.unsupported(construct),
        };
        let leaves = self.leaves(operand)?;
        let one = |leaf| match convert {
            Some(_) => self.converted(leaf, from, to),
            None => self.reinterpreted(leaf, to),
        };
        leaves.into_iter().map(one).collect()
    }

    fn reinterpreted(&mut self, leaf: Leaf, to: Kind) -> Result<Leaf> {
        Ok(match (leaf, to) {
            (Leaf::Float(a), Kind::Sint | Kind::Uint) => {
                let to = self.int();
                self.push(Op::FloatBits { to, a });
                Leaf::Int(to)
            }
            (Leaf::Int(a), Kind::Float) => {
                let to = self.float();
                self.push(Op::BitsFloat { to, a });
                Leaf::Float(to)
            }
            _ => leaf,
        })
    }

    pub(super) fn converted(&mut self, leaf: Leaf, from: Kind, to: Kind) -> Result<Leaf> {
        Ok(match (leaf, to) {
            (Leaf::Float(_), Kind::Float) => leaf,
            (Leaf::Float(a), Kind::Sint) => {
                let to = self.int();
                self.push(Op::FloatToSigned { to, a });
                Leaf::Int(to)
            }
            (Leaf::Float(a), Kind::Uint) => {
                let to = self.int();
                self.push(Op::FloatToUnsigned { to, a });
                Leaf::Int(to)
            }
            (Leaf::Float(a), Kind::Bool) => {
                let zero = self.float_constant(0.0);
                Leaf::Int(self.compare(crate::op::Compare::NotEqual, a, zero))
            }
            (Leaf::Int(a), Kind::Float) => {
                let to = self.float();
                self.push(if from == Kind::Sint {
                    Op::SignedToFloat { to, a }
                } else {
                    Op::UnsignedToFloat { to, a }
                });
                Leaf::Float(to)
            }
            (Leaf::Int(a), Kind::Bool) => Leaf::Int(self.int1(Int1::ToBool, a)),
            (Leaf::Int(_), Kind::Sint | Kind::Uint) => leaf,
        })
    }

    /// `a · b + …`, the terms added from the left.
    pub(super) fn sum_of_products(
        &mut self,
        terms: impl IntoIterator<Item = (u32, u32)>,
    ) -> Result<u32> {
        let mut total = None;
        for (a, b) in terms {
            let product = self.float2(Float2::Times, a, b);
            total = Some(match total {
                None => product,
                Some(total) => self.float2(Float2::Plus, total, product),
            });
        }
        match total {
            Some(total) => Ok(total),
            None => self.wrong(),
        }
    }
}
