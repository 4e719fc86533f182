//! Hands out registers and writes the code down.

use std::collections::HashMap;

use naga::valid::{FunctionInfo, ModuleInfo};
use naga::{Handle, Module, Span, TypeInner};

use super::Settings;
use super::constant::Folded;
use super::types::Types;
use crate::code::{Code, Site, Slot, SlotKind};
use crate::error::Unsupported;
use crate::op::{CONSTANT, Compare, Float1, Float2, Int1, Int2, Leaf, NONE, Op, Register};
use crate::registers::LeafMut;
use crate::shape::Kind;

/// More code than this is refused: calls are written out, so little text can become much code.
const MOST_OPS: usize = 1 << 20;
/// More registers than this are refused.
const MOST_REGISTERS: u32 = 1 << 17;

pub(super) type Result<T> = std::result::Result<T, Unsupported>;

/// What an expression is while compiling.
#[derive(Debug, Clone)]
pub(super) enum Value {
    /// Numbers in registers.
    Leaves(Vec<Leaf>),
    /// A place that can be read and written.
    Place(Place),
    /// A texture or sampler, by its slot.
    Handle(u32),
}

/// A place that can be read and written.
#[derive(Debug, Clone)]
pub(super) enum Place {
    /// Registers: the choice that `index` names, or the only one.
    Registers {
        choices: Vec<Vec<Leaf>>,
        index: Option<Register>,
    },
    /// Shared memory.
    Memory(crate::op::Address),
}

/// The function that is being written out.
pub(super) struct Frame<'a> {
    pub function: &'a naga::Function,
    pub info: &'a FunctionInfo,
    pub name: String,
    pub values: Vec<Option<Value>>,
    pub arguments: Vec<Value>,
    pub locals: HashMap<Handle<naga::LocalVariable>, Vec<Leaf>>,
    pub result: Option<Vec<Leaf>>,
    /// Lanes that have returned; none where the only return ends the function.
    pub returned: Option<u32>,
    /// Masks that `break` and `continue` send lanes to, innermost last.
    pub breaks: Vec<u32>,
    pub continues: Vec<u32>,
    pub depth: usize,
}

#[derive(Default)]
struct File {
    next: u32,
    peak: u32,
}

impl File {
    fn take(&mut self) -> u32 {
        self.next += 1;
        self.peak = self.peak.max(self.next);
        self.next - 1
    }
}

/// How many registers are in use, to come back to at the end of a block.
#[derive(Clone, Copy)]
pub(super) struct Level(u32, u32);

/// What is known before compiling a function.
#[derive(Clone, Copy)]
pub(super) struct Context<'a> {
    pub module: &'a Module,
    pub info: &'a ModuleInfo,
    pub settings: &'a Settings,
    /// Values of the module's constant expressions; none of those that cannot be had.
    pub constants: &'a [Option<Vec<Folded>>],
}

pub(super) struct Builder<'a> {
    pub context: Context<'a>,
    pub module: &'a Module,
    pub code: Code,
    floats: File,
    ints: File,
    float_pool: HashMap<u64, u32>,
    int_pool: HashMap<u32, u32>,
    site: u32,
    site_pool: HashMap<Site, u32>,
    pub slots: HashMap<Handle<naga::GlobalVariable>, u32>,
    pub privates: HashMap<Handle<naga::GlobalVariable>, Vec<Leaf>>,
    pub workgroup: HashMap<Handle<naga::GlobalVariable>, u32>,
    pub frames: Vec<Frame<'a>>,
    overflow: bool,
}

impl<'a> Builder<'a> {
    pub(super) fn new(context: Context<'a>) -> Self {
        let code = Code {
            masks: 1,
            loop_cap: context.settings.loop_cap,
            ..Code::default()
        };
        Self {
            context,
            module: context.module,
            code,
            floats: File::default(),
            ints: File::default(),
            float_pool: HashMap::new(),
            int_pool: HashMap::new(),
            site: 0,
            site_pool: HashMap::new(),
            slots: HashMap::new(),
            privates: HashMap::new(),
            workgroup: HashMap::new(),
            frames: Vec::new(),
            overflow: false,
        }
    }

    // --- places in the source -------------------------------------------------------------------

    pub(super) fn here(&self) -> Site {
        self.code
            .sites
            .get(self.site as usize)
            .cloned()
            .unwrap_or(Site {
                function: self
                    .frames
                    .last()
                    .map_or_else(String::new, |f| f.name.clone()),
                span: None,
            })
    }

    pub(super) fn go_to(&mut self, span: Span) {
        let function = self
            .frames
            .last()
            .map_or_else(String::new, |f| f.name.clone());
        let site = Site {
            function,
            span: span.to_range(),
        };
        let next = self.code.sites.len() as u32;
        self.site = *self.site_pool.entry(site.clone()).or_insert(next);
        if self.site == next {
            self.code.sites.push(site);
        }
    }

    pub(super) fn unsupported<T>(&self, construct: impl Into<String>) -> Result<T> {
        Err(Unsupported {
            construct: construct.into(),
            site: self.here(),
        })
    }

    /// For constructs that validation lets through only where they make sense.
    pub(super) fn wrong<T>(&self) -> Result<T> {
        self.unsupported("an operation on operands of these types")
    }

    pub(super) fn with_types<T>(
        &self,
        ask: impl FnOnce(&Types<'_>) -> std::result::Result<T, String>,
    ) -> Result<T> {
        let overridden = |handle| self.context.array_length(handle);
        let types = Types {
            module: self.module,
            overridden: &overridden,
        };
        ask(&types).or_else(|construct| self.unsupported(construct))
    }

    pub(super) fn kinds(&self, inner: &TypeInner) -> Result<Vec<Kind>> {
        self.with_types(|t| t.kinds(inner))
    }

    // --- registers ------------------------------------------------------------------------------

    pub(super) fn level(&self) -> Level {
        Level(self.floats.next, self.ints.next)
    }

    pub(super) fn release(&mut self, level: Level) {
        (self.floats.next, self.ints.next) = (level.0, level.1);
    }

    pub(super) fn float(&mut self) -> Register {
        self.floats.take()
    }

    pub(super) fn int(&mut self) -> Register {
        self.ints.take()
    }

    pub(super) fn leaf(&mut self, kind: Kind) -> Leaf {
        if kind == Kind::Float {
            Leaf::Float(self.float())
        } else {
            Leaf::Int(self.int())
        }
    }

    pub(super) fn fresh(&mut self, kinds: &[Kind]) -> Vec<Leaf> {
        kinds.iter().map(|&kind| self.leaf(kind)).collect()
    }

    pub(super) fn mask(&mut self) -> u32 {
        self.code.masks += 1;
        self.code.masks - 1
    }

    pub(super) fn float_constant(&mut self, value: f64) -> Register {
        let next = self.code.float_constants.len() as u32;
        let at = *self.float_pool.entry(value.to_bits()).or_insert(next);
        if at == next {
            self.code.float_constants.push(value);
        }
        CONSTANT | at
    }

    pub(super) fn int_constant(&mut self, value: u32) -> Register {
        let next = self.code.int_constants.len() as u32;
        let at = *self.int_pool.entry(value).or_insert(next);
        if at == next {
            self.code.int_constants.push(value);
        }
        CONSTANT | at
    }

    pub(super) fn zero(&mut self, kind: Kind) -> Leaf {
        if kind == Kind::Float {
            Leaf::Float(self.float_constant(0.0))
        } else {
            Leaf::Int(self.int_constant(0))
        }
    }

    pub(super) fn list(&mut self, registers: Vec<Register>) -> u32 {
        self.code.lists.push(registers);
        self.code.lists.len() as u32 - 1
    }

    /// The slot of a resource.
    pub(super) fn slot(&mut self, handle: Handle<naga::GlobalVariable>, kind: SlotKind) -> u32 {
        if let Some(&slot) = self.slots.get(&handle) {
            return slot;
        }
        let variable = &self.module.global_variables[handle];
        let name = variable
            .name
            .clone()
            .unwrap_or_else(|| format!("{handle:?}"));
        let slot = self.code.slots.len() as u32;
        self.code.slots.push(Slot { name, kind });
        self.slots.insert(handle, slot);
        slot
    }

    // --- code -----------------------------------------------------------------------------------

    pub(super) fn push(&mut self, op: Op) -> usize {
        if self.code.ops.len() >= MOST_OPS {
            self.overflow = true;
            return self.code.ops.len() - 1;
        }
        self.code.ops.push(op);
        self.code.at.push(self.site);
        self.code.ops.len() - 1
    }

    pub(super) fn next_op(&self) -> u32 {
        self.code.ops.len() as u32
    }

    /// Whether the code has grown too large; compiling stops then.
    pub(super) fn check_size(&self) -> Result<()> {
        if self.overflow || self.floats.peak.max(self.ints.peak) > MOST_REGISTERS {
            return self
                .unsupported("a function that becomes so large once its calls are written out");
        }
        Ok(())
    }

    pub(super) fn float1(&mut self, f: Float1, a: Register) -> Register {
        let to = self.float();
        self.push(Op::Float1 { f, to, a });
        to
    }

    pub(super) fn float2(&mut self, f: Float2, a: Register, b: Register) -> Register {
        let to = self.float();
        self.push(Op::Float2 { f, to, a, b });
        to
    }

    pub(super) fn compare(&mut self, f: Compare, a: Register, b: Register) -> Register {
        let to = self.int();
        self.push(Op::Compare { f, to, a, b });
        to
    }

    pub(super) fn int1(&mut self, f: Int1, a: Register) -> Register {
        let to = self.int();
        self.push(Op::Int1 { f, to, a });
        to
    }

    pub(super) fn int2(&mut self, f: Int2, a: Register, b: Register) -> Register {
        let to = self.int();
        self.push(Op::Int2 { f, to, a, b });
        to
    }

    pub(super) fn select(&mut self, condition: Register, yes: Leaf, no: Leaf) -> Result<Leaf> {
        match (yes, no) {
            (Leaf::Float(yes), Leaf::Float(no)) => {
                let to = self.float();
                self.push(Op::SelectFloat {
                    to,
                    condition,
                    yes,
                    no,
                });
                Ok(Leaf::Float(to))
            }
            (Leaf::Int(yes), Leaf::Int(no)) => {
                let to = self.int();
                self.push(Op::SelectInt {
                    to,
                    condition,
                    yes,
                    no,
                });
                Ok(Leaf::Int(to))
            }
            _ => self.wrong(),
        }
    }

    /// Copies in all lanes.
    pub(super) fn move_to(&mut self, to: &[Leaf], from: &[Leaf]) -> Result<()> {
        for (&to, &from) in to.iter().zip(from) {
            match (to, from) {
                (Leaf::Float(to), Leaf::Float(from)) => self.push(Op::MoveFloat { to, from }),
                (Leaf::Int(to), Leaf::Int(from)) => self.push(Op::MoveInt { to, from }),
                _ => return self.wrong(),
            };
        }
        Ok(())
    }

    /// Copies in the active lanes.
    pub(super) fn store_to(&mut self, to: &[Leaf], from: &[Leaf]) -> Result<()> {
        for (&to, &from) in to.iter().zip(from) {
            match (to, from) {
                (Leaf::Float(to), Leaf::Float(from)) => self.push(Op::StoreFloat { to, from }),
                (Leaf::Int(to), Leaf::Int(from)) => self.push(Op::StoreInt { to, from }),
                _ => return self.wrong(),
            };
        }
        Ok(())
    }

    /// Sets where a jump goes.
    pub(super) fn aim(&mut self, op: usize, target: u32) {
        match self.code.ops.get_mut(op) {
            Some(
                Op::If { end, .. }
                | Op::Else { end, .. }
                | Op::Enter { end, .. }
                | Op::SkipIfNone { end },
            ) => *end = target,
            _ => self.overflow = true,
        }
    }

    /// Puts the constants in front of the other registers: the code is complete.
    pub(super) fn finished(mut self) -> Code {
        let floats = self.code.float_constants.len() as u32;
        let ints = self.code.int_constants.len() as u32;
        let place = |register: &mut Register, constants: u32| {
            if *register == NONE {
            } else if *register & CONSTANT != 0 {
                *register &= !CONSTANT;
            } else {
                *register += constants;
            }
        };
        super::function::each_register(&mut self.code, &mut |leaf: LeafMut<'_>| match leaf {
            LeafMut::Float(register) => place(register, floats),
            LeafMut::Int(register) => place(register, ints),
        });
        self.code.floats = floats + self.floats.peak;
        self.code.ints = ints + self.ints.peak;
        self.code
    }
}
