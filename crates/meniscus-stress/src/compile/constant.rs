//! Values that are known before anything runs: constants and `override`s.

use naga::valid::ModuleInfo;
use naga::{Expression, Handle, Module, Override};

use super::Settings;
use super::builder::{Builder, Context, Result, Value};
use super::types;
use crate::machine::Machine;
use crate::op::Leaf;
use crate::shape::Kind;

/// A number known beforehand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Folded {
    Float(f64),
    Int(u32),
}

impl Folded {
    fn of(kind: Kind, number: f64) -> Self {
        match kind {
            Kind::Float => Self::Float(f64::from(number as f32)),
            Kind::Sint => Self::Int(number as i32 as u32),
            Kind::Uint => Self::Int(number as u32),
            Kind::Bool => Self::Int(u32::from(number != 0.0)),
        }
    }
}

/// Whether a setting's name means this `override`.
pub(super) fn is_called(variable: &Override, name: &str) -> bool {
    match variable.id {
        Some(id) => name.parse() == Ok(id) || variable.name.as_deref() == Some(name),
        None => variable.name.as_deref() == Some(name),
    }
}

/// The values of all constant expressions of a module. Like naga, it computes them in `f32`.
pub(super) fn fold_all(
    module: &Module,
    info: &ModuleInfo,
    settings: &Settings,
) -> Vec<Option<Vec<Folded>>> {
    let mut constants = Vec::with_capacity(module.global_expressions.len());
    // Operands come before what uses them.
    for (handle, _) in module.global_expressions.iter() {
        let context = Context {
            module,
            info,
            settings,
            constants: &constants,
        };
        let folded = fold(context, handle).ok();
        constants.push(folded);
    }
    constants
}

fn fold(context: Context<'_>, handle: Handle<Expression>) -> Result<Vec<Folded>> {
    let mut builder = Builder::new(context);
    let leaves = builder.compute(handle).and_then(|v| builder.leaves_of(v))?;
    builder.check_size()?;
    builder.code.result = leaves;
    let code = builder.finished();
    let mut machine = Machine::<f32>::new(&code);
    machine.run_constant();
    let value = |leaf: &Leaf| match *leaf {
        Leaf::Float(at) if (at as usize) < code.float_constants.len() => {
            Folded::Float(code.float_constants[at as usize])
        }
        Leaf::Float(at) => Folded::Float(f64::from(machine.floats[at as usize][0])),
        Leaf::Int(at) => Folded::Int(machine.ints[at as usize][0]),
    };
    Ok(code.result.iter().map(value).collect())
}

impl Context<'_> {
    /// The value of an `override`: as set, or as the module has it.
    fn overridden(&self, handle: Handle<Override>) -> Option<Vec<Folded>> {
        let variable = &self.module.overrides[handle];
        let set = self
            .settings
            .numbers
            .iter()
            .find(|(name, _)| is_called(variable, name));
        if let Some((_, &number)) = set {
            return match self.module.types[variable.ty].inner {
                naga::TypeInner::Scalar(scalar) => {
                    Some(vec![Folded::of(types::kind(scalar).ok()?, number)])
                }
                _ => None,
            };
        }
        self.constants.get(variable.init?.index())?.clone()
    }

    /// The length that an `override` gives to an array.
    pub(super) fn array_length(&self, handle: Handle<Override>) -> Option<u32> {
        match self.overridden(handle)?[..] {
            [Folded::Int(n)] if n > 0 && n < 1 << 31 => Some(n),
            _ => None,
        }
    }

    /// A constant integer.
    pub(super) fn integer(&self, handle: Handle<Expression>) -> Option<u32> {
        match self.constants.get(handle.index())?.as_deref()? {
            [Folded::Int(n)] => Some(*n),
            _ => None,
        }
    }
}

impl Builder<'_> {
    fn pooled(&mut self, folded: &[Folded]) -> Value {
        let leaf = |f: &Folded| match *f {
            Folded::Float(x) => Leaf::Float(self.float_constant(x)),
            Folded::Int(n) => Leaf::Int(self.int_constant(n)),
        };
        Value::Leaves(folded.iter().map(leaf).collect())
    }

    /// The value of one of the module's constant expressions.
    pub(super) fn global_constant(&mut self, handle: Handle<Expression>) -> Result<Value> {
        let constants = self.context.constants;
        match constants.get(handle.index()) {
            Some(Some(folded)) => Ok(self.pooled(folded)),
            _ => self.unsupported("this constant"),
        }
    }

    pub(super) fn override_value(&mut self, handle: Handle<Override>) -> Result<Value> {
        match self.context.overridden(handle) {
            Some(folded) => Ok(self.pooled(&folded)),
            None => {
                let name = self.module.overrides[handle]
                    .name
                    .clone()
                    .unwrap_or_default();
                self.unsupported(format!("`override {name}` without a value"))
            }
        }
    }
}
