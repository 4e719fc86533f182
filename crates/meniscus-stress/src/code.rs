//! A compiled function: its operations, and what surrounds them.

use std::ops::Range;

use crate::op::{ImageOp, Leaf, Op, Register};
use crate::shape::Shape;

/// A place in WGSL: the function and the bytes of the source.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Site {
    /// Name of the function.
    pub function: String,
    /// Byte range in the source that naga parsed, where it is known.
    pub span: Option<Range<usize>>,
}

/// What kind of resource a slot takes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum SlotKind {
    Buffer { least_bytes: u32 },
    Texture,
    Sampler,
}

#[derive(Debug, Clone)]
pub(crate) struct Slot {
    pub name: String,
    pub kind: SlotKind,
}

/// One function, compiled, with everything that it calls written out.
#[derive(Debug, Default)]
pub(crate) struct Code {
    pub name: String,
    pub ops: Vec<Op>,
    /// The site of each op.
    pub at: Vec<u32>,
    pub sites: Vec<Site>,
    pub lists: Vec<Vec<Register>>,
    pub images: Vec<ImageOp>,
    pub slots: Vec<Slot>,
    pub float_constants: Vec<f64>,
    pub int_constants: Vec<u32>,
    pub floats: u32,
    pub ints: u32,
    pub masks: u32,
    pub counters: u32,
    pub workgroup_words: u32,
    pub arguments: Vec<Argument>,
    pub result: Vec<Leaf>,
    pub result_shape: Option<Shape>,
    pub result_bindings: Vec<Option<naga::Binding>>,
    pub loop_cap: u32,
}

/// An argument: its registers, leaf by leaf.
#[derive(Debug, Clone)]
pub(crate) struct Argument {
    pub name: String,
    pub shape: Shape,
    pub leaves: Vec<Leaf>,
    /// For entry points: what is bound, leaf range by leaf range.
    pub bindings: Vec<(naga::Binding, Range<usize>)>,
}

impl Code {
    pub(crate) fn site(&self, op: usize) -> Site {
        let unknown = || Site {
            function: self.name.clone(),
            span: None,
        };
        self.at
            .get(op)
            .and_then(|&s| self.sites.get(s as usize))
            .cloned()
            .unwrap_or_else(unknown)
    }
}
