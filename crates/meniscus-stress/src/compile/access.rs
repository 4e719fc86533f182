//! Expressions' values and types; parts of values; reading and writing places.

use naga::{Expression, Handle, TypeInner};

use super::builder::{Builder, Frame, Place, Result, Value};
use super::place::layout;
use super::types::{self, Layout};
use crate::op::{Address, Int2, Leaf, Memory, NONE, Op, Register};
use crate::shape::Kind;

impl<'a> Builder<'a> {
    /// The function that is being written out.
    ///
    /// While the module's own constants are computed there is none.
    pub(super) fn frame(&mut self) -> Result<&mut Frame<'a>> {
        if self.frames.is_empty() {
            return self.unsupported("a constant that needs a function");
        }
        let last = self.frames.len() - 1;
        Ok(&mut self.frames[last])
    }

    pub(super) fn expression(&self, handle: Handle<Expression>) -> &'a Expression {
        match self.frames.last() {
            Some(frame) => &frame.function.expressions[handle],
            None => &self.context.module.global_expressions[handle],
        }
    }

    pub(super) fn type_of(&self, handle: Handle<Expression>) -> &'a TypeInner {
        let types = &self.context.module.types;
        match self.frames.last() {
            Some(frame) => frame.info[handle].ty.inner_with(types),
            None => self.context.info[handle].inner_with(types),
        }
    }

    /// What kind of number a scalar, a vector or a matrix is made of.
    pub(super) fn kind_of(&self, handle: Handle<Expression>) -> Result<Kind> {
        match self.type_of(handle).scalar() {
            Some(scalar) => types::kind(scalar).or_else(|construct| self.unsupported(construct)),
            None => self.wrong(),
        }
    }

    /// The value of an expression, computed before or known beforehand.
    pub(super) fn value(&mut self, handle: Handle<Expression>) -> Result<Value> {
        let Some(frame) = self.frames.last() else {
            return self.global_constant(handle);
        };
        if let Some(Some(value)) = frame.values.get(handle.index()) {
            return Ok(value.clone());
        }
        let value = self.compute(handle)?;
        if let Some(slot) = self.frame()?.values.get_mut(handle.index()) {
            *slot = Some(value.clone());
        }
        Ok(value)
    }

    pub(super) fn leaves_of(&mut self, value: Value) -> Result<Vec<Leaf>> {
        match value {
            Value::Leaves(leaves) => Ok(leaves),
            Value::Place(_) => self.unsupported("a pointer as a value"),
            Value::Handle(_) => self.unsupported("a texture or sampler as a value"),
        }
    }

    pub(super) fn leaves(&mut self, handle: Handle<Expression>) -> Result<Vec<Leaf>> {
        let value = self.value(handle)?;
        self.leaves_of(value)
    }

    pub(super) fn floats(&mut self, handle: Handle<Expression>) -> Result<Vec<Register>> {
        let leaves = self.leaves(handle)?;
        leaves.into_iter().map(|leaf| self.as_float(leaf)).collect()
    }

    pub(super) fn ints(&mut self, handle: Handle<Expression>) -> Result<Vec<Register>> {
        let leaves = self.leaves(handle)?;
        leaves.into_iter().map(|leaf| self.as_int(leaf)).collect()
    }

    pub(super) fn as_float(&self, leaf: Leaf) -> Result<Register> {
        match leaf {
            Leaf::Float(register) => Ok(register),
            Leaf::Int(_) => self.wrong(),
        }
    }

    pub(super) fn as_int(&self, leaf: Leaf) -> Result<Register> {
        match leaf {
            Leaf::Int(register) => Ok(register),
            Leaf::Float(_) => self.wrong(),
        }
    }

    /// The only number of a scalar.
    pub(super) fn single(&mut self, handle: Handle<Expression>) -> Result<Leaf> {
        match self.leaves(handle)?[..] {
            [leaf] => Ok(leaf),
            _ => self.wrong(),
        }
    }

    pub(super) fn single_int(&mut self, handle: Handle<Expression>) -> Result<Register> {
        let leaf = self.single(handle)?;
        self.as_int(leaf)
    }

    pub(super) fn single_float(&mut self, handle: Handle<Expression>) -> Result<Register> {
        let leaf = self.single(handle)?;
        self.as_float(leaf)
    }

    fn part(&self, inner: &TypeInner) -> Result<(Option<u32>, TypeInner)> {
        let overridden = |handle| self.context.array_length(handle);
        match types::part(self.module, inner, &overridden) {
            Some(part) => Ok(part),
            None => self.wrong(),
        }
    }

    /// `base[index]` or `base.member`, the index being known.
    pub(super) fn access_index(&mut self, base: Handle<Expression>, index: u32) -> Result<Value> {
        let base_type = self.type_of(base);
        match self.value(base)? {
            Value::Leaves(leaves) => {
                let (first, count) = self.part_range(base_type, index)?;
                match leaves.get(first..first + count) {
                    Some(part) => Ok(Value::Leaves(part.to_vec())),
                    None => self.wrong(),
                }
            }
            Value::Place(place) => {
                let Some(inner) = types::pointee(self.module, base_type) else {
                    return self.wrong();
                };
                self.place_part(place, &inner, index).map(Value::Place)
            }
            Value::Handle(_) => self.unsupported("an array of bindings"),
        }
    }

    fn part_range(&self, inner: &TypeInner, index: u32) -> Result<(usize, usize)> {
        if let TypeInner::Struct { members, .. } = inner {
            let Some(member) = members.get(index as usize) else {
                return self.wrong();
            };
            let ty = &self.module.types[member.ty].inner;
            let first =
                self.with_types(|t| t.member_offset(members, index as usize, Layout::Packed))?;
            return Ok((first as usize, self.with_types(|t| t.leaf_count(ty))?));
        }
        let (_, part) = self.part(inner)?;
        let count = self.with_types(|t| t.leaf_count(&part))?;
        Ok((index as usize * count, count))
    }

    fn place_part(&mut self, place: Place, inner: &TypeInner, index: u32) -> Result<Place> {
        match place {
            Place::Registers {
                choices,
                index: choice,
            } => {
                let (first, count) = self.part_range(inner, index)?;
                let part = |leaves: &Vec<Leaf>| leaves.get(first..first + count).map(<[_]>::to_vec);
                match choices.iter().map(part).collect() {
                    Some(choices) => Ok(Place::Registers {
                        choices,
                        index: choice,
                    }),
                    None => self.wrong(),
                }
            }
            Place::Memory(mut at) => {
                let layout = layout(at.memory);
                let words = match inner {
                    TypeInner::Struct { members, .. } => {
                        self.with_types(|t| t.member_offset(members, index as usize, layout))?
                    }
                    _ => self
                        .with_types(|t| t.stride(inner, layout))?
                        .saturating_mul(index),
                };
                at.offset = at.offset.saturating_add(words);
                Ok(Place::Memory(at))
            }
        }
    }

    /// `base[index]`, the index being computed; beyond the end it names the last element.
    pub(super) fn access(
        &mut self,
        base: Handle<Expression>,
        index: Handle<Expression>,
    ) -> Result<Value> {
        let index = self.single_int(index)?;
        let base_type = self.type_of(base);
        match self.value(base)? {
            Value::Leaves(leaves) => {
                let (_, part) = self.part(base_type)?;
                let count = self.with_types(|t| t.leaf_count(&part))?.max(1);
                let choices: Vec<_> = leaves.chunks(count).map(<[Leaf]>::to_vec).collect();
                let index = self.bounded(index, (leaves.len() / count) as u32);
                let leaves = self.pick(&choices, index)?;
                Ok(Value::Leaves(leaves))
            }
            Value::Place(place) => {
                let Some(inner) = types::pointee(self.module, base_type) else {
                    return self.wrong();
                };
                self.place_element(place, &inner, index).map(Value::Place)
            }
            Value::Handle(_) => self.unsupported("an array of bindings"),
        }
    }

    /// An index that is not beyond the end: `min(index, length − 1)`.
    fn bounded(&mut self, index: Register, length: u32) -> Register {
        let last = self.int_constant(length.saturating_sub(1));
        self.int2(Int2::SmallerUnsigned, index, last)
    }

    fn place_element(&mut self, place: Place, inner: &TypeInner, at: Register) -> Result<Place> {
        let (length, part) = self.part(inner)?;
        match place {
            Place::Registers { choices, index } => {
                let Some(length) = length else {
                    return self.wrong();
                };
                let count = self.with_types(|t| t.leaf_count(&part))?.max(1);
                let element = self.bounded(at, length);
                let index = match index {
                    None => element,
                    Some(outer) => {
                        let length = self.int_constant(length);
                        let first = self.int2(Int2::Times, outer, length);
                        self.int2(Int2::Plus, first, element)
                    }
                };
                let split = |c: &Vec<Leaf>| c.chunks(count).map(<[_]>::to_vec).collect::<Vec<_>>();
                let choices: Vec<_> = choices.iter().flat_map(split).collect();
                Ok(Place::Registers {
                    choices,
                    index: Some(index),
                })
            }
            Place::Memory(address) => {
                let layout = layout(address.memory);
                let stride = self.with_types(|t| t.stride(inner, layout))?;
                let element = match (length, address.memory) {
                    (Some(length), _) => self.bounded(at, length),
                    (None, Memory::Buffer(slot)) => {
                        let length = self.int();
                        self.push(Op::Length {
                            to: length,
                            slot,
                            offset: address.offset,
                            stride,
                        });
                        let one = self.int_constant(1);
                        let last = self.int2(Int2::Minus, length, one);
                        self.int2(Int2::SmallerUnsigned, at, last)
                    }
                    (None, Memory::Workgroup) => return self.wrong(),
                };
                let stride = self.int_constant(stride);
                let mut words = self.int2(Int2::Times, element, stride);
                if address.register != NONE {
                    words = self.int2(Int2::Plus, address.register, words);
                }
                Ok(Place::Memory(Address {
                    register: words,
                    ..address
                }))
            }
        }
    }
}
