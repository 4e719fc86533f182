//! Buffers and the workgroup's memory.

use std::sync::atomic::Ordering;

use super::Machine;
use crate::number::Scalar;
use crate::op::{Address, AtomicKind, LANES, Memory, NONE, Op};
use crate::resources::{Buffer, Sampler, Texture};

/// What a slot is connected to.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Connected<'r> {
    Buffer(&'r Buffer),
    Texture(&'r Texture),
    Sampler(Sampler),
}

/// The resources of a run, slot by slot.
#[derive(Debug, Default)]
pub(crate) struct Bound<'r> {
    pub slots: Vec<Connected<'r>>,
}

impl<'r> Bound<'r> {
    fn buffer(&self, slot: u32) -> Option<&'r Buffer> {
        match self.slots.get(slot as usize) {
            Some(Connected::Buffer(buffer)) => Some(buffer),
            _ => None,
        }
    }

    pub(super) fn texture(&self, slot: u32) -> Option<&'r Texture> {
        match self.slots.get(slot as usize) {
            Some(Connected::Texture(texture)) => Some(texture),
            _ => None,
        }
    }

    pub(super) fn sampler(&self, slot: u32) -> Sampler {
        match self.slots.get(slot as usize) {
            Some(Connected::Sampler(sampler)) => *sampler,
            _ => Sampler::default(),
        }
    }
}

/// A workgroup's memory. Each place is a floating-point number or an integer for good.
#[derive(Debug, Default)]
pub(crate) struct Shared<S> {
    floats: Vec<S>,
    ints: Vec<u32>,
}

impl<S: Scalar> Shared<S> {
    pub(crate) fn new(words: u32) -> Self {
        let words = words as usize;
        Self {
            floats: vec![S::from_f32(0.0); words],
            ints: vec![0; words],
        }
    }

    pub(crate) fn clear(&mut self) {
        self.floats.fill(S::from_f32(0.0));
        self.ints.fill(0);
    }
}

impl<S: Scalar> Machine<'_, S> {
    fn word(&self, at: Address, lane: usize) -> usize {
        let moved = if at.register == NONE {
            0
        } else {
            self.ints[at.register as usize][lane]
        };
        at.offset as usize + moved as usize
    }

    pub(super) fn memory(&mut self, op: &Op, bound: &Bound<'_>, shared: &mut Shared<S>) {
        match *op {
            Op::LoadFloat { to, at } => {
                let same = at.register == NONE;
                let load = |word: usize| match at.memory {
                    Memory::Buffer(slot) => {
                        let bits = bound.buffer(slot).map_or(0, |b| b.load(word));
                        S::from_f32(f32::from_bits(bits))
                    }
                    Memory::Workgroup => shared.floats.get(word).copied().unwrap_or_default(),
                };
                self.floats[to as usize] = if same {
                    [load(at.offset as usize); LANES]
                } else {
                    std::array::from_fn(|i| load(self.word(at, i)))
                };
            }
            Op::LoadInt { to, at } => {
                let load = |word: usize| match at.memory {
                    Memory::Buffer(slot) => bound.buffer(slot).map_or(0, |b| b.load(word)),
                    Memory::Workgroup => shared.ints.get(word).copied().unwrap_or_default(),
                };
                self.ints[to as usize] = std::array::from_fn(|i| load(self.word(at, i)));
            }
            Op::SaveFloat { at, from } => {
                for lane in self.writing_lanes() {
                    let (word, value) = (self.word(at, lane), self.floats[from as usize][lane]);
                    match at.memory {
                        Memory::Buffer(slot) => {
                            if let Some(buffer) = bound.buffer(slot) {
                                buffer.store(word, value.to_f32().to_bits());
                            }
                        }
                        Memory::Workgroup => {
                            if let Some(place) = shared.floats.get_mut(word) {
                                *place = value;
                            }
                        }
                    }
                }
            }
            Op::SaveInt { at, from } => {
                for lane in self.writing_lanes() {
                    let (word, value) = (self.word(at, lane), self.ints[from as usize][lane]);
                    match at.memory {
                        Memory::Buffer(slot) => {
                            if let Some(buffer) = bound.buffer(slot) {
                                buffer.store(word, value);
                            }
                        }
                        Memory::Workgroup => {
                            if let Some(place) = shared.ints.get_mut(word) {
                                *place = value;
                            }
                        }
                    }
                }
            }
            Op::Length {
                to,
                slot,
                offset,
                stride,
            } => {
                let words = bound.buffer(slot).map_or(0, |b| b.bytes() / 4) as u32;
                let length = words.saturating_sub(offset) / stride.max(1);
                self.ints[to as usize] = [length; LANES];
            }
            Op::Atomic {
                f,
                at,
                value,
                compare,
                to,
                swapped,
            } => {
                for lane in self.writing_lanes() {
                    let word = self.word(at, lane);
                    let value = self.ints[value as usize][lane];
                    let expected = if compare == NONE {
                        0
                    } else {
                        self.ints[compare as usize][lane]
                    };
                    let next = |old: u32| combine(f, old, value, expected);
                    let old = match at.memory {
                        Memory::Workgroup => shared.ints.get_mut(word).map(|place| {
                            let old = *place;
                            *place = next(old).unwrap_or(old);
                            old
                        }),
                        Memory::Buffer(slot) => bound
                            .buffer(slot)
                            .and_then(|b| b.atomic(word))
                            .map(|place| {
                                let order = Ordering::Relaxed;
                                let (Ok(old) | Err(old)) = place.fetch_update(order, order, next);
                                old
                            }),
                    };
                    let old = old.unwrap_or(0);
                    self.ints[to as usize][lane] = old;
                    self.ints[swapped as usize][lane] = u32::from(old == expected);
                }
            }
            // The others do not touch memory.
            _ => {}
        }
    }
}

/// The new value of an atomic place; none where it stays.
fn combine(f: AtomicKind, old: u32, value: u32, expected: u32) -> Option<u32> {
    Some(match f {
        AtomicKind::Add => old.wrapping_add(value),
        AtomicKind::Subtract => old.wrapping_sub(value),
        AtomicKind::And => old & value,
        AtomicKind::Or => old | value,
        AtomicKind::Xor => old ^ value,
        AtomicKind::MinSigned => (old as i32).min(value as i32) as u32,
        AtomicKind::MinUnsigned => old.min(value),
        AtomicKind::MaxSigned => (old as i32).max(value as i32) as u32,
        AtomicKind::MaxUnsigned => old.max(value),
        AtomicKind::Exchange => value,
        AtomicKind::CompareExchange => return (old == expected).then_some(value),
    })
}
