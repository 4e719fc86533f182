//! Reading and writing places: variables, buffers, the workgroup's memory.

use naga::{AddressSpace, Handle, TypeInner};

use super::builder::{Builder, Place, Result, Value};
use super::types::Layout;
use crate::code::SlotKind;
use crate::op::{Address, Leaf, Memory, NONE, Op, Register};
use crate::shape::Kind;

impl Builder<'_> {
    pub(super) fn pick(&mut self, choices: &[Vec<Leaf>], index: Register) -> Result<Vec<Leaf>> {
        let Some(first) = choices.first() else {
            return self.wrong();
        };
        let mut picked = Vec::with_capacity(first.len());
        for (i, leaf) in first.iter().enumerate() {
            let list = self.choice_list(choices, i)?;
            picked.push(match leaf {
                Leaf::Float(_) => {
                    let to = self.float();
                    self.push(Op::PickFloat { to, index, list });
                    Leaf::Float(to)
                }
                Leaf::Int(_) => {
                    let to = self.int();
                    self.push(Op::PickInt { to, index, list });
                    Leaf::Int(to)
                }
            });
        }
        Ok(picked)
    }

    fn choice_list(&mut self, choices: &[Vec<Leaf>], leaf: usize) -> Result<u32> {
        let register = |c: &Vec<Leaf>| match c.get(leaf) {
            Some(Leaf::Float(register) | Leaf::Int(register)) => Some(*register),
            None => None,
        };
        match choices.iter().map(register).collect() {
            Some(registers) => Ok(self.list(registers)),
            None => self.wrong(),
        }
    }

    /// Reads a place.
    pub(super) fn load(&mut self, place: &Place, inner: &TypeInner) -> Result<Vec<Leaf>> {
        match place {
            Place::Registers {
                choices,
                index: Some(index),
            } => self.pick(choices, *index),
            Place::Registers {
                choices,
                index: None,
            } => {
                let Some(from) = choices.first() else {
                    return self.wrong();
                };
                let kinds: Vec<_> = from.iter().map(|leaf| rough_kind(*leaf)).collect();
                let to = self.fresh(&kinds);
                self.move_to(&to, from)?;
                Ok(to)
            }
            Place::Memory(at) => {
                let words = self.with_types(|t| t.words(inner, layout(at.memory)))?;
                let mut leaves = Vec::with_capacity(words.len());
                for (word, kind) in words {
                    let at = Address {
                        offset: at.offset.saturating_add(word),
                        ..*at
                    };
                    leaves.push(if kind == Kind::Float {
                        let to = self.float();
                        self.push(Op::LoadFloat { to, at });
                        Leaf::Float(to)
                    } else {
                        let to = self.int();
                        self.push(Op::LoadInt { to, at });
                        Leaf::Int(to)
                    });
                }
                Ok(leaves)
            }
        }
    }

    /// Writes a place, in the active lanes.
    pub(super) fn store(&mut self, place: &Place, inner: &TypeInner, from: &[Leaf]) -> Result<()> {
        match place {
            Place::Registers {
                choices,
                index: None,
            } => match choices.first() {
                Some(to) => self.store_to(to, from),
                None => self.wrong(),
            },
            Place::Registers {
                choices,
                index: Some(index),
            } => {
                for (i, leaf) in from.iter().enumerate() {
                    let list = self.choice_list(choices, i)?;
                    let index = *index;
                    match *leaf {
                        Leaf::Float(from) => self.push(Op::PutFloat { list, index, from }),
                        Leaf::Int(from) => self.push(Op::PutInt { list, index, from }),
                    };
                }
                Ok(())
            }
            Place::Memory(at) => {
                let words = self.with_types(|t| t.words(inner, layout(at.memory)))?;
                for ((word, _), leaf) in words.into_iter().zip(from) {
                    let at = Address {
                        offset: at.offset.saturating_add(word),
                        ..*at
                    };
                    match *leaf {
                        Leaf::Float(from) => self.push(Op::SaveFloat { at, from }),
                        Leaf::Int(from) => self.push(Op::SaveInt { at, from }),
                    };
                }
                Ok(())
            }
        }
    }

    /// A global variable: a place, or a texture or sampler.
    pub(super) fn global(&mut self, handle: Handle<naga::GlobalVariable>) -> Result<Value> {
        let module = self.module;
        let variable = &module.global_variables[handle];
        let inner = &module.types[variable.ty].inner;
        match variable.space {
            AddressSpace::Private => match self.privates.get(&handle) {
                Some(leaves) => Ok(Value::Place(Place::Registers {
                    choices: vec![leaves.clone()],
                    index: None,
                })),
                None => self.unsupported("a private variable of this type"),
            },
            AddressSpace::WorkGroup => {
                let offset = match self.workgroup.get(&handle) {
                    Some(&offset) => offset,
                    None => {
                        let count = self.with_types(|t| t.leaf_count(inner))? as u32;
                        let offset = self.code.workgroup_words;
                        self.code.workgroup_words += count;
                        self.workgroup.insert(handle, offset);
                        offset
                    }
                };
                let at = Address {
                    memory: Memory::Workgroup,
                    offset,
                    register: NONE,
                };
                Ok(Value::Place(Place::Memory(at)))
            }
            AddressSpace::Uniform | AddressSpace::Storage { .. } | AddressSpace::Immediate => {
                let least_bytes = inner.try_size(module.to_ctx()).unwrap_or(0);
                let slot = self.slot(handle, SlotKind::Buffer { least_bytes });
                let at = Address {
                    memory: Memory::Buffer(slot),
                    offset: 0,
                    register: NONE,
                };
                Ok(Value::Place(Place::Memory(at)))
            }
            AddressSpace::Handle => {
                let kind = match inner {
                    TypeInner::Image {
                        class: naga::ImageClass::External,
                        ..
                    } => {
                        return self.unsupported("an external texture");
                    }
                    TypeInner::Image {
                        class: naga::ImageClass::Sampled { multi: true, .. },
                        ..
                    }
                    | TypeInner::Image {
                        class: naga::ImageClass::Depth { multi: true },
                        ..
                    } => {
                        return self.unsupported("a multisampled texture");
                    }
                    TypeInner::Image { .. } => SlotKind::Texture,
                    TypeInner::Sampler { .. } => SlotKind::Sampler,
                    TypeInner::AccelerationStructure { .. } => {
                        return self.unsupported("an acceleration structure");
                    }
                    _ => return self.unsupported("an array of bindings"),
                };
                Ok(Value::Handle(self.slot(handle, kind)))
            }
            _ => self.unsupported("a variable in this address space"),
        }
    }
}

pub(super) fn layout(memory: Memory) -> Layout {
    match memory {
        Memory::Buffer(_) => Layout::Host,
        Memory::Workgroup => Layout::Packed,
    }
}

/// Which file a leaf lies in; all integers share one.
fn rough_kind(leaf: Leaf) -> Kind {
    match leaf {
        Leaf::Float(_) => Kind::Float,
        Leaf::Int(_) => Kind::Uint,
    }
}
