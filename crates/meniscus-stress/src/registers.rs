//! Which registers an operation names.

use crate::op::{Address, ImageOp, Leaf, Level, Op, Register};

/// A register in the code, to be moved.
pub(crate) enum LeafMut<'a> {
    Float(&'a mut Register),
    Int(&'a mut Register),
}

type Visit<'v> = &'v mut dyn FnMut(LeafMut<'_>);

pub(crate) fn show(leaf: &mut Leaf, f: Visit<'_>) {
    match leaf {
        Leaf::Float(register) => f(LeafMut::Float(register)),
        Leaf::Int(register) => f(LeafMut::Int(register)),
    }
}

fn floats<const N: usize>(registers: [&mut Register; N], f: Visit<'_>) {
    registers
        .into_iter()
        .for_each(|register| f(LeafMut::Float(register)));
}

fn ints<const N: usize>(registers: [&mut Register; N], f: Visit<'_>) {
    registers
        .into_iter()
        .for_each(|register| f(LeafMut::Int(register)));
}

fn address(at: &mut Address, f: Visit<'_>) {
    f(LeafMut::Int(&mut at.register));
}

impl Op {
    /// Shows every register that is named to `f`, apart from those in lists.
    pub(crate) fn each_register(&mut self, f: Visit<'_>) {
        match self {
            Self::Float1 { to, a, .. } | Self::Derivative { to, a, .. } => floats([to, a], f),
            Self::Float2 { to, a, b, .. } => floats([to, a, b], f),
            Self::Fused { to, a, b, c } => floats([to, a, b, c], f),
            Self::Compare { to, a, b, .. } => {
                ints([to], f);
                floats([a, b], f);
            }
            Self::IsNan { to, a }
            | Self::IsInfinite { to, a }
            | Self::FloatToSigned { to, a }
            | Self::FloatToUnsigned { to, a }
            | Self::FloatBits { to, a }
            | Self::HalfBits { to, a }
            | Self::Exponent { to, a } => {
                ints([to], f);
                floats([a], f);
            }
            Self::SelectFloat {
                to,
                condition,
                yes,
                no,
            } => {
                floats([to, yes, no], f);
                ints([condition], f);
            }
            Self::MoveFloat { to, from } | Self::StoreFloat { to, from } => floats([to, from], f),
            Self::PickFloat { to, index, .. }
            | Self::PutFloat {
                index, from: to, ..
            } => {
                floats([to], f);
                ints([index], f);
            }
            Self::SignedToFloat { to, a }
            | Self::UnsignedToFloat { to, a }
            | Self::BitsFloat { to, a }
            | Self::BitsHalf { to, a } => {
                floats([to], f);
                ints([a], f);
            }
            Self::Scale { to, a, exponent } => {
                floats([to, a], f);
                ints([exponent], f);
            }
            Self::Int1 { to, a, .. } => ints([to, a], f),
            Self::Int2 { to, a, b, .. } => ints([to, a, b], f),
            Self::Extract {
                to,
                a,
                offset,
                count,
                ..
            } => ints([to, a, offset, count], f),
            Self::Insert {
                to,
                a,
                b,
                offset,
                count,
            } => ints([to, a, b, offset, count], f),
            Self::SelectInt {
                to,
                condition,
                yes,
                no,
            } => ints([to, condition, yes, no], f),
            Self::MoveInt { to, from } | Self::StoreInt { to, from } => ints([to, from], f),
            Self::PickInt { to, index, .. }
            | Self::PutInt {
                index, from: to, ..
            } => {
                ints([to, index], f);
            }
            Self::LoadFloat { to, at } | Self::SaveFloat { at, from: to } => {
                floats([to], f);
                address(at, f);
            }
            Self::LoadInt { to, at } | Self::SaveInt { at, from: to } => {
                ints([to], f);
                address(at, f);
            }
            Self::Length { to, .. } => ints([to], f),
            Self::Atomic {
                at,
                value,
                compare,
                to,
                swapped,
                ..
            } => {
                ints([value, compare, to, swapped], f);
                address(at, f);
            }
            Self::If { condition, .. }
            | Self::Enter { condition, .. }
            | Self::BreakIf { condition, .. } => ints([condition], f),
            Self::Image { .. }
            | Self::Else { .. }
            | Self::Join { .. }
            | Self::Leave { .. }
            | Self::Clear { .. }
            | Self::Save { .. }
            | Self::SkipIfNone { .. }
            | Self::LoopStart { .. }
            | Self::LoopHead { .. }
            | Self::Again { .. }
            | Self::Barrier => {}
        }
    }
}

impl ImageOp {
    /// Shows every register that is named to `f`.
    pub(crate) fn each_register(&mut self, f: Visit<'_>) {
        match self {
            Self::Load {
                at,
                layer,
                level,
                to,
                ..
            } => {
                let [x, y, z] = at;
                ints([x, y, z, layer, level], f);
                to.iter_mut().for_each(|leaf| show(leaf, f));
            }
            Self::Store {
                at, layer, from, ..
            } => {
                let [x, y, z] = at;
                ints([x, y, z, layer], f);
                from.iter_mut().for_each(|leaf| show(leaf, f));
            }
            Self::Sample {
                at,
                layer,
                level,
                compare,
                to,
                ..
            } => {
                let [x, y, z] = at;
                floats([x, y, z, compare], f);
                ints([layer], f);
                match level {
                    Level::Zero | Level::Auto => {}
                    Level::Exact(leaf) => show(leaf, f),
                    Level::Bias(bias) => floats([bias], f),
                    Level::Gradient { x, y } => {
                        let ([a, b, c], [d, e, g]) = (x, y);
                        floats([a, b, c, d, e, g], f);
                    }
                }
                to.iter_mut().for_each(|leaf| show(leaf, f));
            }
            Self::Size { level, to, .. } => {
                ints([level], f);
                to.iter_mut().for_each(|register| f(LeafMut::Int(register)));
            }
            Self::Levels { to, .. } | Self::Layers { to, .. } => ints([to], f),
        }
    }
}
