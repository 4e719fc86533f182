//! Which parts of a function's arguments matter for which parts of its result, in naga's IR.
//!
//! naga's own pruning does not see through structs: a varying that a fragment shader copies into a
//! struct counts as used though nothing reads that member. Here the wish goes backwards, from what
//! is returned, stored or decided upon, member by member, through calls.

use std::collections::BTreeMap;
use std::rc::Rc;

use naga::{Block, Expression, Function, Handle, Module, Statement};
use rustc_hash::FxHashMap;

/// How deep calls are followed; beyond that, everything counts as wanted.
const MAX_CALLS: usize = 64;

/// What is wanted of a value.
#[derive(Debug, Clone, Default, PartialEq, Eq, Hash)]
pub(crate) enum Demand {
    #[default]
    Nothing,
    /// Members by their index.
    Members(BTreeMap<u32, Demand>),
    All,
}

impl Demand {
    /// Only some members, each in whole.
    pub fn members(indices: impl IntoIterator<Item = u32>) -> Self {
        Self::Members(indices.into_iter().map(|i| (i, Self::All)).collect())
    }

    /// What is wanted of a member.
    pub fn member(&self, index: u32) -> Self {
        match self {
            Self::Members(members) => members.get(&index).cloned().unwrap_or_default(),
            whole => whole.clone(),
        }
    }

    fn add(&mut self, more: &Self) {
        match (&mut *self, more) {
            (Self::All, _) | (_, Self::Nothing) => {}
            (Self::Members(known), Self::Members(members)) => {
                for (index, demand) in members {
                    known.entry(*index).or_default().add(demand);
                }
            }
            _ => *self = more.clone(),
        }
    }
}

/// Demands of functions that were found already.
pub(crate) struct Demands<'m> {
    module: &'m Module,
    known: FxHashMap<(Handle<Function>, Demand), Rc<[Demand]>>,
    depth: usize,
}

/// What was wanted of each expression of a function so far.
type Wanted = Vec<Demand>;

/// The arguments of calls, by the expression of their result.
type Calls<'f> = FxHashMap<Handle<Expression>, (Handle<Function>, &'f [Handle<Expression>])>;

impl<'m> Demands<'m> {
    pub fn of(module: &'m Module) -> Self {
        Self {
            module,
            known: FxHashMap::default(),
            depth: 0,
        }
    }

    /// What a function wants of its arguments when so much is wanted of its result.
    pub fn arguments(&mut self, function: &'m Function, result: &Demand) -> Rc<[Demand]> {
        let count = function.arguments.len();
        if self.depth >= MAX_CALLS {
            return vec![Demand::All; count].into();
        }
        self.depth += 1;
        let found = self.within(function, result);
        self.depth -= 1;
        found.unwrap_or_else(|| vec![Demand::All; count]).into()
    }

    fn call(&mut self, function: Handle<Function>, result: &Demand) -> Rc<[Demand]> {
        let key = (function, result.clone());
        if let Some(known) = self.known.get(&key) {
            return known.clone();
        }
        let found = self.arguments(&self.module.functions[function], result);
        self.known.insert(key, found.clone());
        found
    }

    /// None where the function holds what is not known here.
    fn within(&mut self, function: &'m Function, result: &Demand) -> Option<Vec<Demand>> {
        let mut wanted: Wanted = vec![Demand::Nothing; function.expressions.len()];
        let mut calls = Calls::default();
        for (_, local) in function.local_variables.iter() {
            want_all(&mut wanted, local.init);
        }
        self.block(&function.body, result, &mut wanted, &mut calls)?;
        let mut arguments = vec![Demand::Nothing; function.arguments.len()];
        // An expression stands behind those that it is made of.
        let expressions: Vec<_> = function.expressions.iter().collect();
        for (handle, expression) in expressions.into_iter().rev() {
            let demand = std::mem::take(&mut wanted[handle.index()]);
            if let Some((called, operands)) = calls.get(&handle) {
                let demands = self.call(*called, &demand);
                for (operand, demand) in operands.iter().zip(demands.iter()) {
                    wanted[operand.index()].add(demand);
                }
                continue;
            }
            if demand == Demand::Nothing {
                continue;
            }
            match expression {
                Expression::FunctionArgument(index) => {
                    arguments.get_mut(*index as usize)?.add(&demand);
                }
                Expression::AccessIndex { base, index } => {
                    let member = Demand::Members(BTreeMap::from([(*index, demand)]));
                    wanted[base.index()].add(&member);
                }
                Expression::Compose { ty, components } => {
                    let is_struct =
                        matches!(self.module.types[*ty].inner, naga::TypeInner::Struct { .. });
                    for (component, index) in components.iter().zip(0..) {
                        let part = match is_struct {
                            true => demand.member(index),
                            false => Demand::All,
                        };
                        wanted[component.index()].add(&part);
                    }
                }
                other => {
                    want_all(&mut wanted, operands(other)?);
                }
            }
        }
        Some(arguments)
    }

    /// What statements want of expressions.
    fn block(
        &mut self,
        block: &'m Block,
        result: &Demand,
        wanted: &mut Wanted,
        calls: &mut Calls<'m>,
    ) -> Option<()> {
        for statement in block {
            match statement {
                Statement::Emit(_)
                | Statement::Break
                | Statement::Continue
                | Statement::Kill
                | Statement::ControlBarrier(_)
                | Statement::MemoryBarrier(_) => {}
                Statement::Block(inner) => self.block(inner, result, wanted, calls)?,
                Statement::If {
                    condition,
                    accept,
                    reject,
                } => {
                    want_all(wanted, [*condition]);
                    self.block(accept, result, wanted, calls)?;
                    self.block(reject, result, wanted, calls)?;
                }
                Statement::Switch { selector, cases } => {
                    want_all(wanted, [*selector]);
                    for case in cases {
                        self.block(&case.body, result, wanted, calls)?;
                    }
                }
                Statement::Loop {
                    body,
                    continuing,
                    break_if,
                } => {
                    want_all(wanted, *break_if);
                    self.block(body, result, wanted, calls)?;
                    self.block(continuing, result, wanted, calls)?;
                }
                Statement::Return { value } => {
                    if let Some(value) = value {
                        wanted[value.index()].add(result);
                    }
                }
                Statement::Store { pointer, value } => want_all(wanted, [*pointer, *value]),
                Statement::ImageStore {
                    image,
                    coordinate,
                    array_index,
                    value,
                } => {
                    want_all(wanted, [*image, *coordinate, *value]);
                    want_all(wanted, *array_index);
                }
                Statement::Atomic {
                    pointer,
                    fun,
                    value,
                    ..
                } => {
                    want_all(wanted, [*pointer, *value]);
                    if let naga::AtomicFunction::Exchange { compare } = fun {
                        want_all(wanted, *compare);
                    }
                }
                Statement::Call {
                    function,
                    arguments,
                    result: Some(result),
                } => {
                    calls.insert(*result, (*function, arguments));
                }
                Statement::Call {
                    function,
                    arguments,
                    result: None,
                } => {
                    let demands = self.call(*function, &Demand::Nothing);
                    for (argument, demand) in arguments.iter().zip(demands.iter()) {
                        wanted[argument.index()].add(demand);
                    }
                }
                _ => return None,
            }
        }
        Some(())
    }
}

fn want_all(wanted: &mut Wanted, expressions: impl IntoIterator<Item = Handle<Expression>>) {
    for expression in expressions {
        wanted[expression.index()] = Demand::All;
    }
}

/// The expressions that one is made of; none for kinds that are not known here.
fn operands(expression: &Expression) -> Option<Vec<Handle<Expression>>> {
    let listed = |first: &[Handle<Expression>], others: &[Option<Handle<Expression>>]| {
        let others = others.iter().flatten().copied();
        Some(first.iter().copied().chain(others).collect())
    };
    match *expression {
        Expression::Literal(_)
        | Expression::Constant(_)
        | Expression::Override(_)
        | Expression::ZeroValue(_)
        | Expression::GlobalVariable(_)
        | Expression::LocalVariable(_)
        | Expression::AtomicResult { .. } => listed(&[], &[]),
        Expression::Access { base, index } => listed(&[base, index], &[]),
        Expression::Splat { value, .. } => listed(&[value], &[]),
        Expression::Swizzle { vector, .. } => listed(&[vector], &[]),
        Expression::Load { pointer } => listed(&[pointer], &[]),
        Expression::ImageSample {
            image,
            sampler,
            coordinate,
            array_index,
            offset,
            level,
            depth_ref,
            ..
        } => {
            let (level, gradient) = match level {
                naga::SampleLevel::Exact(level) | naga::SampleLevel::Bias(level) => {
                    (Some(level), None)
                }
                naga::SampleLevel::Gradient { x, y } => (Some(x), Some(y)),
                naga::SampleLevel::Auto | naga::SampleLevel::Zero => (None, None),
            };
            let others = [array_index, offset, depth_ref, level, gradient];
            listed(&[image, sampler, coordinate], &others)
        }
        Expression::ImageLoad {
            image,
            coordinate,
            array_index,
            sample,
            level,
        } => listed(&[image, coordinate], &[array_index, sample, level]),
        Expression::ImageQuery { image, query } => {
            let level = match query {
                naga::ImageQuery::Size { level } => level,
                _ => None,
            };
            listed(&[image], &[level])
        }
        Expression::Unary { expr, .. }
        | Expression::Derivative { expr, .. }
        | Expression::As { expr, .. } => listed(&[expr], &[]),
        Expression::Binary { left, right, .. } => listed(&[left, right], &[]),
        Expression::Select {
            condition,
            accept,
            reject,
        } => listed(&[condition, accept, reject], &[]),
        Expression::Relational { argument, .. } => listed(&[argument], &[]),
        Expression::Math {
            arg,
            arg1,
            arg2,
            arg3,
            ..
        } => listed(&[arg], &[arg1, arg2, arg3]),
        Expression::ArrayLength(array) => listed(&[array], &[]),
        _ => None,
    }
}
