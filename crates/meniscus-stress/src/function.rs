//! Calling a function with many inputs at once.

use std::sync::Arc;

use crate::code::{Argument, Code, SlotKind};
use crate::error::Trap;
use crate::machine::{Blind, Bound, Connected, Machine, Shared};
use crate::number::Scalar;
use crate::op::{LANES, Leaf};
use crate::resources::Resources;
use crate::shape::{Column, Kind, Lanes, Shape};

/// A function, ready to be called in any number system.
#[derive(Debug, Clone)]
pub struct Function {
    code: Arc<Code>,
}

/// What a call gives back.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome<S> {
    /// What the function returns, lane by lane; without columns where it returns nothing.
    pub value: Lanes<S>,
    /// Lanes, in increasing order, where a comparison was too close to call: an interval does not
    /// enclose the result there, and a shadow took `f32`'s branch.
    pub undecided: Vec<usize>,
}

impl Function {
    pub(crate) fn new(code: Arc<Code>) -> Self {
        Self { code }
    }

    pub(crate) fn code(&self) -> &Code {
        &self.code
    }

    /// Its name in WGSL.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.code.name
    }

    /// Names and types of its arguments.
    pub fn arguments(&self) -> impl ExactSizeIterator<Item = (&str, &Shape)> {
        self.code
            .arguments
            .iter()
            .map(|a| (a.name.as_str(), &a.shape))
    }

    /// What it returns; none where it returns nothing.
    #[must_use]
    pub fn result(&self) -> Option<&Shape> {
        self.code.result_shape.as_ref()
    }

    /// Names of the global variables that must be connected.
    pub fn resources(&self) -> impl Iterator<Item = &str> {
        self.code.slots.iter().map(|slot| slot.name.as_str())
    }

    /// Names and kinds of the single numbers that it takes, such as `ray.origin.x`.
    pub fn numbers(&self) -> impl Iterator<Item = (String, Kind)> + '_ {
        self.arguments().flat_map(|(name, shape)| {
            let leaves = shape.leaves().into_iter();
            leaves.map(move |(path, kind)| (format!("{name}{path}"), kind))
        })
    }

    /// Calls it in `lanes` lanes.
    ///
    /// # Errors
    ///
    /// A [`Trap`]: arguments that do not fit, a resource that is missing, an endless loop.
    pub fn call<S: Scalar>(
        &self,
        arguments: &[Lanes<S>],
        lanes: usize,
        resources: &Resources<'_>,
    ) -> Result<Lanes<S>, Trap> {
        Ok(self.run(arguments, lanes, resources)?.value)
    }

    /// Calls it in `lanes` lanes, and tells which of them are undecided.
    ///
    /// # Errors
    ///
    /// As [`call`](Self::call).
    pub fn run<S: Scalar>(
        &self,
        arguments: &[Lanes<S>],
        lanes: usize,
        resources: &Resources<'_>,
    ) -> Result<Outcome<S>, Trap> {
        let code = &*self.code;
        self.check(arguments, lanes)?;
        let bound = bind(code, resources)?;
        let kinds = result_kinds(code);
        let mut value = Lanes {
            columns: kinds
                .iter()
                .map(|&kind| Column::zeros(kind, lanes))
                .collect(),
        };
        let mut undecided = Vec::new();
        let mut machine = Machine::<S>::new(code);
        let mut shared = Shared::new(code.workgroup_words);
        for first in (0..lanes).step_by(LANES) {
            let count = (lanes - first).min(LANES);
            for (argument, given) in code.arguments.iter().zip(arguments) {
                for (&leaf, column) in argument.leaves.iter().zip(&given.columns) {
                    machine.fill(leaf, column, first, count);
                }
            }
            machine.launch(count);
            while machine.run(&bound, &mut shared, &mut Blind)? != crate::machine::Stop::End {}
            for (&leaf, column) in code.result.iter().zip(&mut value.columns) {
                machine.take(leaf, column, first, count);
            }
            undecided.extend(
                (0..count)
                    .filter(|i| machine.undecided >> i & 1 == 1)
                    .map(|i| first + i),
            );
        }
        Ok(Outcome { value, undecided })
    }

    pub(crate) fn check<S: Scalar>(
        &self,
        arguments: &[Lanes<S>],
        lanes: usize,
    ) -> Result<(), Trap> {
        let expected = &self.code.arguments;
        if arguments.len() != expected.len() {
            return Err(Trap::ArgumentCount {
                function: self.code.name.clone(),
                expected: expected.len(),
                given: arguments.len(),
            });
        }
        for (Argument { name, shape, .. }, given) in expected.iter().zip(arguments) {
            let kinds = shape.leaves();
            let fits = |(column, (_, kind)): (&Column<S>, &(String, Kind))| {
                column.kind() == *kind && column.len() == lanes
            };
            if kinds.len() != given.columns.len() || !given.columns.iter().zip(&kinds).all(fits) {
                return Err(Trap::ArgumentShape {
                    function: self.code.name.clone(),
                    argument: name.clone(),
                    expected: shape.to_string(),
                });
            }
        }
        Ok(())
    }
}

/// What the numbers of the result are.
pub(crate) fn result_kinds(code: &Code) -> Vec<Kind> {
    let leaves = code
        .result_shape
        .as_ref()
        .map(Shape::leaves)
        .unwrap_or_default();
    leaves.into_iter().map(|(_, kind)| kind).collect()
}

/// Finds the resource of each slot.
pub(crate) fn bind<'r>(code: &Code, resources: &Resources<'r>) -> Result<Bound<'r>, Trap> {
    let mut slots = Vec::with_capacity(code.slots.len());
    for slot in &code.slots {
        let name = &slot.name;
        let (found, kind) = match slot.kind {
            SlotKind::Buffer { least_bytes } => {
                let buffer = resources.buffers.get(name).copied();
                if let Some(buffer) = buffer
                    && buffer.bytes() < least_bytes as usize
                {
                    let (bytes, least) = (buffer.bytes(), least_bytes as usize);
                    return Err(Trap::ShortBuffer {
                        name: name.clone(),
                        bytes,
                        least,
                    });
                }
                (buffer.map(Connected::Buffer), "buffer")
            }
            SlotKind::Texture => (
                resources
                    .textures
                    .get(name)
                    .copied()
                    .map(Connected::Texture),
                "texture",
            ),
            SlotKind::Sampler => (
                resources
                    .samplers
                    .get(name)
                    .copied()
                    .map(Connected::Sampler),
                "sampler",
            ),
        };
        slots.push(found.ok_or_else(|| Trap::NoResource {
            name: name.clone(),
            kind,
        })?);
    }
    Ok(Bound { slots })
}

impl<S: Scalar> Machine<'_, S> {
    /// Copies part of a column into a register; lanes beyond it repeat the first.
    pub(crate) fn fill(&mut self, leaf: Leaf, column: &Column<S>, first: usize, count: usize) {
        match (leaf, column) {
            (Leaf::Float(r), Column::Float(c)) => {
                copy(
                    &mut self.floats[r as usize],
                    &c[first..first + count],
                    |x| x,
                );
            }
            (Leaf::Int(r), Column::Sint(c)) => {
                copy(&mut self.ints[r as usize], &c[first..first + count], |n| {
                    n as u32
                });
            }
            (Leaf::Int(r), Column::Uint(c)) => {
                copy(&mut self.ints[r as usize], &c[first..first + count], |n| n);
            }
            (Leaf::Int(r), Column::Bool(c)) => {
                copy(
                    &mut self.ints[r as usize],
                    &c[first..first + count],
                    u32::from,
                );
            }
            // Shapes were checked before.
            _ => {}
        }
    }

    /// Copies a register into part of a column.
    pub(crate) fn take(&self, leaf: Leaf, column: &mut Column<S>, first: usize, count: usize) {
        match (leaf, column) {
            (Leaf::Float(r), Column::Float(c)) => {
                c[first..first + count].copy_from_slice(&self.floats[r as usize][..count]);
            }
            (Leaf::Int(r), column) => {
                let words = &self.ints[r as usize][..count];
                match column {
                    Column::Sint(c) => {
                        c[first..first + count]
                            .iter_mut()
                            .zip(words)
                            .for_each(|(c, &w)| *c = w as i32);
                    }
                    Column::Uint(c) => c[first..first + count].copy_from_slice(words),
                    Column::Bool(c) => {
                        c[first..first + count]
                            .iter_mut()
                            .zip(words)
                            .for_each(|(c, &w)| *c = w != 0);
                    }
                    Column::Float(_) => {}
                }
            }
            _ => {}
        }
    }
}

fn copy<T: Copy, U: Copy>(to: &mut [U; LANES], from: &[T], f: impl Fn(T) -> U) {
    for (to, &x) in to.iter_mut().zip(from) {
        *to = f(x);
    }
    // Lanes that are not meant hold something harmless: a denormal or NaN there would cost time.
    if let Some(&x) = from.first() {
        to[from.len()..].fill(f(x));
    }
}
