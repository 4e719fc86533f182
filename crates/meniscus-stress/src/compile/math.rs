//! Built-in functions, written out as WGSL's accuracy table defines them.

use naga::{Expression, Handle, MathFunction as Math};

use super::builder::{Builder, Result};
use crate::number::{Elementary, Whole};
use crate::op::{Compare, Float1, Float2, Int1, Leaf, Op, Register};
use crate::shape::Kind;

pub(super) type Arguments<'a> = &'a [Option<Handle<Expression>>; 4];

impl Builder<'_> {
    pub(super) fn math(
        &mut self,
        fun: Math,
        arguments: Arguments<'_>,
        whole: Handle<Expression>,
    ) -> Result<Vec<Leaf>> {
        let Some(first) = arguments[0] else {
            return self.wrong();
        };
        if let Some(leaves) = self.packing(fun, first, arguments[1])? {
            return Ok(leaves);
        }
        match self.type_of(first) {
            naga::TypeInner::Matrix { columns, rows, .. } => {
                let (columns, rows) = (*columns as usize, *rows as usize);
                let m = self.floats(first)?;
                return self.matrix_math(fun, &m, columns, rows);
            }
            _ if self.kind_of(first)? != Kind::Float => return self.int_math(fun, arguments),
            _ => {}
        }
        let mut operands = Vec::new();
        for argument in arguments.iter().flatten() {
            operands.push(*argument);
        }
        if fun == Math::Ldexp {
            return self.scale(operands[0], operands.get(1).copied());
        }
        let operands: Vec<_> = operands
            .into_iter()
            .map(|o| self.floats(o))
            .collect::<Result<_>>()?;
        if let Some(leaves) = self.geometry(fun, &operands)? {
            return Ok(leaves);
        }
        if matches!(fun, Math::Modf | Math::Frexp) {
            return self.split(fun, &operands[0], whole);
        }
        let mut leaves = Vec::with_capacity(operands[0].len());
        for i in 0..operands[0].len() {
            let one = |o: &Vec<Register>| o.get(i).or(o.first()).copied();
            let Some(numbers) = operands.iter().map(one).collect::<Option<Vec<_>>>() else {
                return self.wrong();
            };
            leaves.push(Leaf::Float(self.number_math(fun, &numbers)?));
        }
        Ok(leaves)
    }

    /// Functions of single numbers.
    fn number_math(&mut self, fun: Math, of: &[Register]) -> Result<Register> {
        if let Some(f) = simple1(fun) {
            return Ok(self.float1(f, of[0]));
        }
        let zero = self.float_constant(0.0);
        let one = self.float_constant(1.0);
        Ok(match (fun, of) {
            (Math::Min, &[a, b]) => self.float2(Float2::Smaller, a, b),
            (Math::Max, &[a, b]) => self.float2(Float2::Larger, a, b),
            (Math::Pow, &[a, b]) => self.float2(Float2::Power, a, b),
            (Math::Atan2, &[a, b]) => self.float2(Float2::Angle, a, b),
            (Math::Clamp, &[x, low, high]) => self.clamp(x, low, high),
            (Math::Saturate, &[x]) => self.clamp(x, zero, one),
            (Math::Fract, &[x]) => {
                let floor = self.float1(Float1::Whole(Whole::Floor), x);
                self.float2(Float2::Minus, x, floor)
            }
            (Math::Radians, &[x]) => {
                let factor = self.float_constant(std::f64::consts::PI / 180.0);
                self.float2(Float2::Times, x, factor)
            }
            (Math::Degrees, &[x]) => {
                let factor = self.float_constant(180.0 / std::f64::consts::PI);
                self.float2(Float2::Times, x, factor)
            }
            (Math::Fma, &[a, b, c]) => self.fma(a, b, c),
            (Math::Mix, &[a, b, t]) => {
                let rest = self.float2(Float2::Minus, one, t);
                let left = self.float2(Float2::Times, a, rest);
                let right = self.float2(Float2::Times, b, t);
                self.float2(Float2::Plus, left, right)
            }
            (Math::Step, &[edge, x]) => {
                let condition = self.compare(Compare::LessEqual, edge, x);
                let to = self.float();
                self.push(Op::SelectFloat {
                    to,
                    condition,
                    yes: one,
                    no: zero,
                });
                to
            }
            (Math::SmoothStep, &[low, high, x]) => {
                let above = self.float2(Float2::Minus, x, low);
                let width = self.float2(Float2::Minus, high, low);
                let t = self.float2(Float2::Over, above, width);
                let t = self.clamp(t, zero, one);
                let square = self.float2(Float2::Times, t, t);
                let (two, three) = (self.float_constant(2.0), self.float_constant(3.0));
                let twice = self.float2(Float2::Times, two, t);
                let rest = self.float2(Float2::Minus, three, twice);
                self.float2(Float2::Times, square, rest)
            }
            _ => return self.unsupported(format!("the built-in function {fun:?}")),
        })
    }

    fn fma(&mut self, a: Register, b: Register, c: Register) -> Register {
        if self.context.settings.fused {
            let to = self.float();
            self.push(Op::Fused { to, a, b, c });
            return to;
        }
        let product = self.float2(Float2::Times, a, b);
        self.float2(Float2::Plus, product, c)
    }

    fn clamp(&mut self, x: Register, low: Register, high: Register) -> Register {
        let raised = self.float2(Float2::Larger, x, low);
        self.float2(Float2::Smaller, raised, high)
    }

    pub(super) fn dot(&mut self, a: &[Register], b: &[Register]) -> Result<Register> {
        self.sum_of_products(a.iter().copied().zip(b.iter().copied()))
    }

    fn length(&mut self, v: &[Register]) -> Result<Register> {
        if let [x] = v {
            return Ok(self.float1(Float1::Magnitude, *x));
        }
        let square = self.dot(v, v)?;
        Ok(self.float1(Float1::Root, square))
    }

    fn minus(&mut self, a: &[Register], b: &[Register]) -> Vec<Register> {
        a.iter()
            .zip(b)
            .map(|(&a, &b)| self.float2(Float2::Minus, a, b))
            .collect()
    }

    fn scaled(&mut self, v: &[Register], by: Register) -> Vec<Register> {
        v.iter()
            .map(|&x| self.float2(Float2::Times, by, x))
            .collect()
    }

    /// Functions of whole vectors; none for the others.
    fn geometry(&mut self, fun: Math, of: &[Vec<Register>]) -> Result<Option<Vec<Leaf>>> {
        let registers = match (fun, of) {
            (Math::Dot, [a, b]) => vec![self.dot(a, b)?],
            (Math::Length, [v]) => vec![self.length(v)?],
            (Math::Distance, [a, b]) => {
                let between = self.minus(a, b);
                vec![self.length(&between)?]
            }
            (Math::Cross, [a, b]) if a.len() == 3 && b.len() == 3 => {
                let mut cross = Vec::with_capacity(3);
                for (i, j) in [(1, 2), (2, 0), (0, 1)] {
                    let left = self.float2(Float2::Times, a[i], b[j]);
                    let right = self.float2(Float2::Times, a[j], b[i]);
                    cross.push(self.float2(Float2::Minus, left, right));
                }
                cross
            }
            (Math::Normalize, [v]) => {
                let length = self.length(v)?;
                v.iter()
                    .map(|&x| self.float2(Float2::Over, x, length))
                    .collect()
            }
            (Math::FaceForward, [n, incident, reference]) => {
                let dot = self.dot(incident, reference)?;
                let zero = self.float_constant(0.0);
                let condition = self.compare(Compare::Less, dot, zero);
                let mut faced = Vec::with_capacity(n.len());
                for &yes in n {
                    let no = self.float1(Float1::Negate, yes);
                    let to = self.float();
                    self.push(Op::SelectFloat {
                        to,
                        condition,
                        yes,
                        no,
                    });
                    faced.push(to);
                }
                faced
            }
            (Math::Reflect, [incident, normal]) => {
                let dot = self.dot(normal, incident)?;
                let two = self.float_constant(2.0);
                let twice = self.float2(Float2::Times, two, dot);
                let across = self.scaled(normal, twice);
                self.minus(incident, &across)
            }
            (Math::Refract, [incident, normal, ratio]) => {
                self.refract(incident, normal, ratio[0])?
            }
            (Math::Outer, [a, b]) => {
                let mut matrix = Vec::with_capacity(a.len() * b.len());
                for &column in b {
                    let scaled = self.scaled(a, column);
                    matrix.extend(scaled);
                }
                matrix
            }
            _ => return Ok(None),
        };
        Ok(Some(registers.into_iter().map(Leaf::Float).collect()))
    }

    /// `k = 1 − η²(1 − (n·i)²)`; 0 where k < 0, else `η i − (η n·i + √k) n`.
    fn refract(
        &mut self,
        incident: &[Register],
        normal: &[Register],
        ratio: Register,
    ) -> Result<Vec<Register>> {
        let (zero, one) = (self.float_constant(0.0), self.float_constant(1.0));
        let cos = self.dot(normal, incident)?;
        let cos_square = self.float2(Float2::Times, cos, cos);
        let sin_square = self.float2(Float2::Minus, one, cos_square);
        let ratio_square = self.float2(Float2::Times, ratio, ratio);
        let across = self.float2(Float2::Times, ratio_square, sin_square);
        let k = self.float2(Float2::Minus, one, across);
        let total = self.compare(Compare::Less, k, zero);
        let along = self.float2(Float2::Times, ratio, cos);
        let root = self.float1(Float1::Root, k);
        let along = self.float2(Float2::Plus, along, root);
        let kept = self.scaled(incident, ratio);
        let turned = self.scaled(normal, along);
        let refracted = self.minus(&kept, &turned);
        let select = |&no: &Register| {
            let to = self.float();
            self.push(Op::SelectFloat {
                to,
                condition: total,
                yes: zero,
                no,
            });
            to
        };
        Ok(refracted.iter().map(select).collect())
    }

    fn matrix_math(
        &mut self,
        fun: Math,
        m: &[Register],
        columns: usize,
        rows: usize,
    ) -> Result<Vec<Leaf>> {
        match fun {
            Math::Transpose => {
                let at = |i: usize| Leaf::Float(m[i % columns * rows + i / columns]);
                Ok((0..m.len()).map(at).collect())
            }
            Math::Determinant if columns == rows => {
                let all: Vec<_> = (0..columns).collect();
                Ok(vec![Leaf::Float(self.determinant(m, columns, 0, &all)?)])
            }
            _ => self.unsupported(format!("the built-in function {fun:?} of a matrix")),
        }
    }

    /// Of the part of an n × n matrix right of `column`, in the rows given; by the first column.
    fn determinant(
        &mut self,
        m: &[Register],
        n: usize,
        column: usize,
        rows: &[usize],
    ) -> Result<Register> {
        if let [row] = rows {
            return Ok(m[column * n + row]);
        }
        let mut total = None;
        for (i, &row) in rows.iter().enumerate() {
            let rest: Vec<_> = rows.iter().copied().filter(|&r| r != row).collect();
            let minor = self.determinant(m, n, column + 1, &rest)?;
            let term = self.float2(Float2::Times, m[column * n + row], minor);
            total = Some(match total {
                None => term,
                Some(total) if i % 2 == 1 => self.float2(Float2::Minus, total, term),
                Some(total) => self.float2(Float2::Plus, total, term),
            });
        }
        match total {
            Some(total) => Ok(total),
            None => self.wrong(),
        }
    }

    fn scale(
        &mut self,
        of: Handle<Expression>,
        exponent: Option<Handle<Expression>>,
    ) -> Result<Vec<Leaf>> {
        let Some(exponent) = exponent else {
            return self.wrong();
        };
        let (numbers, exponents) = (self.floats(of)?, self.ints(exponent)?);
        let one = |(&a, &exponent): (&Register, &Register)| {
            let to = self.float();
            self.push(Op::Scale { to, a, exponent });
            Leaf::Float(to)
        };
        Ok(numbers.iter().zip(&exponents).map(one).collect())
    }

    /// `modf` and `frexp`: the fractions, then the whole parts or exponents.
    fn split(
        &mut self,
        fun: Math,
        of: &[Register],
        whole: Handle<Expression>,
    ) -> Result<Vec<Leaf>> {
        let (mut fractions, mut others) = (Vec::new(), Vec::new());
        for &a in of {
            if fun == Math::Modf {
                let trunc = self.float1(Float1::Whole(Whole::Trunc), a);
                fractions.push(Leaf::Float(self.float2(Float2::Minus, a, trunc)));
                others.push(Leaf::Float(trunc));
            } else {
                let exponent = self.int();
                self.push(Op::Exponent { to: exponent, a });
                let back = self.int1(Int1::Negate, exponent);
                let to = self.float();
                self.push(Op::Scale {
                    to,
                    a,
                    exponent: back,
                });
                fractions.push(Leaf::Float(to));
                others.push(Leaf::Int(exponent));
            }
        }
        fractions.extend(others);
        let expected = self.kinds(self.type_of(whole))?.len();
        if fractions.len() == expected {
            Ok(fractions)
        } else {
            self.wrong()
        }
    }
}

/// Functions that are an operation of their own.
fn simple1(fun: Math) -> Option<Float1> {
    Some(match fun {
        Math::Abs => Float1::Magnitude,
        Math::Sign => Float1::Sign,
        Math::Sqrt => Float1::Root,
        Math::InverseSqrt => Float1::InverseRoot,
        Math::QuantizeToF16 => Float1::Quantize,
        Math::Ceil => Float1::Whole(Whole::Ceil),
        Math::Floor => Float1::Whole(Whole::Floor),
        Math::Round => Float1::Whole(Whole::Round),
        Math::Trunc => Float1::Whole(Whole::Trunc),
        Math::Cos => Float1::Elementary(Elementary::Cos),
        Math::Cosh => Float1::Elementary(Elementary::Cosh),
        Math::Sin => Float1::Elementary(Elementary::Sin),
        Math::Sinh => Float1::Elementary(Elementary::Sinh),
        Math::Tan => Float1::Elementary(Elementary::Tan),
        Math::Tanh => Float1::Elementary(Elementary::Tanh),
        Math::Acos => Float1::Elementary(Elementary::Acos),
        Math::Asin => Float1::Elementary(Elementary::Asin),
        Math::Atan => Float1::Elementary(Elementary::Atan),
        Math::Asinh => Float1::Elementary(Elementary::Asinh),
        Math::Acosh => Float1::Elementary(Elementary::Acosh),
        Math::Atanh => Float1::Elementary(Elementary::Atanh),
        Math::Exp => Float1::Elementary(Elementary::Exp),
        Math::Exp2 => Float1::Elementary(Elementary::Exp2),
        Math::Log => Float1::Elementary(Elementary::Log),
        Math::Log2 => Float1::Elementary(Elementary::Log2),
        _ => return None,
    })
}
