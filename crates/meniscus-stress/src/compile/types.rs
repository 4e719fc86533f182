//! naga's types as numbers in registers and words in memory.

use naga::{Module, ScalarKind, TypeInner};

use crate::shape::{Kind, Shape};

/// More numbers than this in one value are refused.
pub(super) const MOST_LEAVES: usize = 1 << 16;

/// How a value lies in shared memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Layout {
    /// As the host sees it: WGSL's offsets and strides.
    Host,
    /// Number after number.
    Packed,
}

pub(super) fn kind(scalar: naga::Scalar) -> Result<Kind, String> {
    match (scalar.kind, scalar.width) {
        (ScalarKind::Float, 4) | (ScalarKind::AbstractFloat, _) => Ok(Kind::Float),
        (ScalarKind::Sint, 4) | (ScalarKind::AbstractInt, _) => Ok(Kind::Sint),
        (ScalarKind::Uint, 4) => Ok(Kind::Uint),
        (ScalarKind::Bool, _) => Ok(Kind::Bool),
        (kind, width) => Err(format!("a {} of {} bits", name(kind), u32::from(width) * 8)),
    }
}

fn name(kind: ScalarKind) -> &'static str {
    match kind {
        ScalarKind::Float | ScalarKind::AbstractFloat => "floating-point number",
        ScalarKind::Sint | ScalarKind::AbstractInt => "signed integer",
        ScalarKind::Uint => "unsigned integer",
        ScalarKind::Bool => "truth value",
    }
}

/// A word for a type that holds no numbers.
fn opaque(inner: &TypeInner) -> String {
    match inner {
        TypeInner::Pointer { .. } | TypeInner::ValuePointer { .. } => "a pointer as a value",
        TypeInner::Image { .. } => "a texture as a value",
        TypeInner::Sampler { .. } => "a sampler as a value",
        TypeInner::AccelerationStructure { .. } => "an acceleration structure",
        TypeInner::RayQuery { .. } => "a ray query",
        TypeInner::BindingArray { .. } => "an array of bindings",
        TypeInner::CooperativeMatrix { .. } => "a cooperative matrix",
        _ => "this type",
    }
    .to_owned()
}

/// Length of an array; `overridden` knows those that an `override` gives.
pub(super) fn length(
    size: naga::ArraySize,
    overridden: &dyn Fn(naga::Handle<naga::Override>) -> Option<u32>,
) -> Result<Option<u32>, String> {
    match size {
        naga::ArraySize::Constant(n) => Ok(Some(n.get())),
        naga::ArraySize::Pending(handle) => overridden(handle)
            .map(Some)
            .ok_or_else(|| "an array of this size".to_owned()),
        naga::ArraySize::Dynamic => Ok(None),
    }
}

/// What the module's types mean for an evaluator.
pub(super) struct Types<'a> {
    pub module: &'a Module,
    pub overridden: &'a dyn Fn(naga::Handle<naga::Override>) -> Option<u32>,
}

impl Types<'_> {
    pub(super) fn shape(&self, inner: &TypeInner) -> Result<Shape, String> {
        self.shape_within(inner, 0)
    }

    fn shape_within(&self, inner: &TypeInner, depth: usize) -> Result<Shape, String> {
        if depth > 64 {
            return Err("a type nested deeper than 64".to_owned());
        }
        let shape = match inner {
            TypeInner::Scalar(scalar) | TypeInner::Atomic(scalar) => Shape::Scalar(kind(*scalar)?),
            TypeInner::Vector { size, scalar } => Shape::Vector {
                size: *size as usize,
                kind: kind(*scalar)?,
            },
            TypeInner::Matrix {
                columns,
                rows,
                scalar,
            } => {
                if kind(*scalar)? != Kind::Float {
                    return Err("a matrix of integers".to_owned());
                }
                Shape::Matrix {
                    columns: *columns as usize,
                    rows: *rows as usize,
                }
            }
            TypeInner::Array { base, size, .. } => {
                let of = self.shape_within(&self.module.types[*base].inner, depth + 1)?;
                let length = length(*size, self.overridden)?
                    .ok_or_else(|| "an array of unknown length as a value".to_owned())?;
                Shape::Array {
                    of: Box::new(of),
                    length: length as usize,
                }
            }
            TypeInner::Struct { members, .. } => {
                let member = |(i, m): (usize, &naga::StructMember)| {
                    let name = m.name.clone().unwrap_or_else(|| format!("member_{i}"));
                    let inner = &self.module.types[m.ty].inner;
                    Ok((name, self.shape_within(inner, depth + 1)?))
                };
                Shape::Struct {
                    name: String::new(),
                    members: members
                        .iter()
                        .enumerate()
                        .map(member)
                        .collect::<Result<_, String>>()?,
                }
            }
            other => return Err(opaque(other)),
        };
        if shape.leaf_count() > MOST_LEAVES {
            return Err(format!("a value of more than {MOST_LEAVES} numbers"));
        }
        Ok(shape)
    }

    /// The shape with the structure's name.
    pub(super) fn named_shape(&self, ty: naga::Handle<naga::Type>) -> Result<Shape, String> {
        let ty = &self.module.types[ty];
        let mut shape = self.shape(&ty.inner)?;
        if let (Shape::Struct { name, .. }, Some(given)) = (&mut shape, &ty.name) {
            name.clone_from(given);
        }
        Ok(shape)
    }

    pub(super) fn kinds(&self, inner: &TypeInner) -> Result<Vec<Kind>, String> {
        Ok(self
            .shape(inner)?
            .leaves()
            .into_iter()
            .map(|(_, kind)| kind)
            .collect())
    }

    pub(super) fn leaf_count(&self, inner: &TypeInner) -> Result<usize, String> {
        Ok(self.shape(inner)?.leaf_count())
    }

    /// Words from one element, column or component of a type to the next.
    pub(super) fn stride(&self, inner: &TypeInner, layout: Layout) -> Result<u32, String> {
        Ok(match (inner, layout) {
            (TypeInner::Array { stride, .. }, Layout::Host) => stride / 4,
            (TypeInner::Array { base, .. }, Layout::Packed) => {
                self.leaf_count(&self.module.types[*base].inner)? as u32
            }
            (TypeInner::Matrix { rows, .. }, Layout::Host) => {
                if *rows == naga::VectorSize::Bi {
                    2
                } else {
                    4
                }
            }
            (TypeInner::Matrix { rows, .. }, Layout::Packed) => *rows as u32,
            _ => 1,
        })
    }

    /// Words before a member of a structure.
    pub(super) fn member_offset(
        &self,
        members: &[naga::StructMember],
        index: usize,
        layout: Layout,
    ) -> Result<u32, String> {
        match layout {
            Layout::Host => Ok(members.get(index).map_or(0, |m| m.offset / 4)),
            Layout::Packed => members.iter().take(index).try_fold(0, |sum, m| {
                Ok(sum + self.leaf_count(&self.module.types[m.ty].inner)? as u32)
            }),
        }
    }

    /// Offset in words and kind of every number of a type in memory.
    pub(super) fn words(
        &self,
        inner: &TypeInner,
        layout: Layout,
    ) -> Result<Vec<(u32, Kind)>, String> {
        // Bounds the size before anything is listed.
        self.leaf_count(inner)?;
        let mut found = Vec::new();
        self.walk(inner, layout, 0, &mut found)?;
        Ok(found)
    }

    fn walk(
        &self,
        inner: &TypeInner,
        layout: Layout,
        at: u32,
        found: &mut Vec<(u32, Kind)>,
    ) -> Result<(), String> {
        let stride = self.stride(inner, layout)?;
        match inner {
            TypeInner::Scalar(scalar) | TypeInner::Atomic(scalar) => {
                found.push((at, kind(*scalar)?));
            }
            TypeInner::Vector { size, scalar } => {
                let kind = kind(*scalar)?;
                found.extend((0..*size as u32).map(|i| (at + i, kind)));
            }
            TypeInner::Matrix { columns, rows, .. } => {
                for column in 0..*columns as u32 {
                    let first = at + column * stride;
                    found.extend((0..*rows as u32).map(|row| (first + row, Kind::Float)));
                }
            }
            TypeInner::Array { base, size, .. } => {
                let base = &self.module.types[*base].inner;
                for i in 0..length(*size, self.overridden)?.unwrap_or(0) {
                    self.walk(base, layout, at + i * stride, found)?;
                }
            }
            TypeInner::Struct { members, .. } => {
                for (i, member) in members.iter().enumerate() {
                    let offset = self.member_offset(members, i, layout)?;
                    self.walk(
                        &self.module.types[member.ty].inner,
                        layout,
                        at + offset,
                        found,
                    )?;
                }
            }
            other => return Err(opaque(other)),
        }
        Ok(())
    }
}

/// What a pointer points to.
pub(super) fn pointee(module: &Module, inner: &TypeInner) -> Option<TypeInner> {
    match *inner {
        TypeInner::Pointer { base, .. } => Some(module.types[base].inner.clone()),
        TypeInner::ValuePointer {
            size: Some(size),
            scalar,
            ..
        } => Some(TypeInner::Vector { size, scalar }),
        TypeInner::ValuePointer {
            size: None, scalar, ..
        } => Some(TypeInner::Scalar(scalar)),
        _ => None,
    }
}

/// Number of parts that an index can name, and the type of the part; none of a structure.
pub(super) fn part(
    module: &Module,
    inner: &TypeInner,
    overridden: &dyn Fn(naga::Handle<naga::Override>) -> Option<u32>,
) -> Option<(Option<u32>, TypeInner)> {
    match *inner {
        TypeInner::Vector { size, scalar } => Some((Some(size as u32), TypeInner::Scalar(scalar))),
        TypeInner::Matrix {
            columns,
            rows,
            scalar,
        } => Some((
            Some(columns as u32),
            TypeInner::Vector { size: rows, scalar },
        )),
        TypeInner::Array { base, size, .. } => {
            let length = length(size, overridden).ok()?;
            Some((length, module.types[base].inner.clone()))
        }
        _ => None,
    }
}
