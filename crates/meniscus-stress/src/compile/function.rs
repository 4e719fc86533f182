//! Functions: calls are written out where they stand.

use std::collections::HashMap;

use naga::{Block, Expression, Handle, Statement, TypeInner};

use super::Root;
use super::builder::{Builder, Context, Frame, Result, Value};
use crate::code::{Argument, Code};
use crate::op::{Leaf, Op};
use crate::registers::LeafMut;
use crate::registers::show;

/// Calls nested deeper than this are refused, so that compiling needs a bounded stack.
const MOST_CALLS: usize = 48;

/// Compiles a function with everything that it calls.
pub(super) fn compile(context: Context<'_>, root: Root) -> Result<Code> {
    let mut builder = Builder::new(context);
    let module = context.module;
    let (function, info, name) = match root {
        Root::Function(handle) => {
            let function = &module.functions[handle];
            (
                function,
                &context.info[handle],
                function.name.clone().unwrap_or_default(),
            )
        }
        Root::Entry(index) => {
            let point = &module.entry_points[index];
            (
                &point.function,
                context.info.get_entry_point(index),
                point.name.clone(),
            )
        }
    };
    builder.code.name.clone_from(&name);
    builder.frames.push(frame(function, info, name));
    builder.start(function)?;
    builder.private_variables(info)?;
    let leaves = builder.body(function)?;
    builder.code.result = leaves;
    builder.check_size()?;
    Ok(builder.finished())
}

fn frame<'a>(
    function: &'a naga::Function,
    info: &'a naga::valid::FunctionInfo,
    name: String,
) -> Frame<'a> {
    Frame {
        function,
        info,
        name,
        values: vec![None; function.expressions.len()],
        arguments: Vec::new(),
        locals: HashMap::new(),
        result: None,
        returned: None,
        breaks: Vec::new(),
        continues: Vec::new(),
        depth: 0,
    }
}

impl<'a> Builder<'a> {
    /// Arguments and result of the outermost function.
    fn start(&mut self, function: &'a naga::Function) -> Result<()> {
        for (i, argument) in function.arguments.iter().enumerate() {
            let name = argument
                .name
                .clone()
                .unwrap_or_else(|| format!("argument {i}"));
            let inner = &self.module.types[argument.ty].inner;
            if matches!(
                inner,
                TypeInner::Pointer { .. } | TypeInner::ValuePointer { .. }
            ) {
                return self.unsupported(format!(
                    "calling from outside with the pointer `{name}` as an argument"
                ));
            }
            let kinds = self.kinds(inner)?;
            let shape = self.with_types(|t| t.named_shape(argument.ty))?;
            let leaves = self.fresh(&kinds);
            let bindings = self.bindings(argument.binding.as_ref(), inner)?;
            self.frame()?.arguments.push(Value::Leaves(leaves.clone()));
            self.code.arguments.push(Argument {
                name,
                shape,
                leaves,
                bindings,
            });
        }
        if let Some(result) = &function.result {
            let inner = &self.module.types[result.ty].inner;
            let shape = self.with_types(|t| t.named_shape(result.ty))?;
            let bindings = self.bindings(result.binding.as_ref(), inner)?;
            let mut by_leaf = vec![None; shape.leaf_count()];
            for (binding, range) in bindings {
                for slot in by_leaf.get_mut(range).into_iter().flatten() {
                    *slot = Some(binding.clone());
                }
            }
            self.code.result_shape = Some(shape);
            self.code.result_bindings = by_leaf;
        }
        Ok(())
    }

    /// Which numbers of an entry point's argument or result are bound to what.
    fn bindings(
        &self,
        whole: Option<&naga::Binding>,
        inner: &TypeInner,
    ) -> Result<Vec<(naga::Binding, std::ops::Range<usize>)>> {
        let count = self.with_types(|t| t.leaf_count(inner))?;
        if let Some(binding) = whole {
            return Ok(vec![(binding.clone(), 0..count)]);
        }
        let mut found = Vec::new();
        if let TypeInner::Struct { members, .. } = inner {
            let mut first = 0;
            for member in members {
                let ty = &self.module.types[member.ty].inner;
                let next = first + self.with_types(|t| t.leaf_count(ty))?;
                if let Some(binding) = &member.binding {
                    found.push((binding.clone(), first..next));
                }
                first = next;
            }
        }
        Ok(found)
    }

    /// Private variables have registers for the whole run, and start anew with each.
    fn private_variables(&mut self, info: &naga::valid::FunctionInfo) -> Result<()> {
        let module = self.module;
        for (handle, variable) in module.global_variables.iter() {
            if variable.space != naga::AddressSpace::Private || info[handle].is_empty() {
                continue;
            }
            let kinds = self.kinds(&module.types[variable.ty].inner)?;
            let leaves = self.fresh(&kinds);
            let from = match variable.init {
                Some(init) => {
                    let value = self.global_constant(init)?;
                    self.leaves_of(value)?
                }
                None => kinds.iter().map(|&kind| self.zero(kind)).collect(),
            };
            self.move_to(&leaves, &from)?;
            self.privates.insert(handle, leaves);
        }
        Ok(())
    }

    /// Local variables and the body of the innermost frame; what it returns.
    fn body(&mut self, function: &'a naga::Function) -> Result<Vec<Leaf>> {
        for (handle, variable) in function.local_variables.iter() {
            self.go_to(function.local_variables.get_span(handle));
            let kinds = self.kinds(&self.module.types[variable.ty].inner)?;
            let leaves = self.fresh(&kinds);
            let from = match variable.init {
                Some(init) => self.leaves(init)?,
                None => kinds.iter().map(|&kind| self.zero(kind)).collect(),
            };
            self.move_to(&leaves, &from)?;
            self.frame()?.locals.insert(handle, leaves);
        }
        let ends_with_its_only_return =
            count_returns(&function.body) == 1 && ends_with_return(&function.body);
        let mut exits = Vec::new();
        if ends_with_its_only_return || count_returns(&function.body) == 0 {
            self.statements(&function.body, &mut exits)?;
            self.land(&exits);
            return Ok(self.frame()?.result.take().unwrap_or_default());
        }
        let returned = self.mask();
        self.push(Op::Clear { mask: returned });
        self.frame()?.returned = Some(returned);
        let result = match &function.result {
            Some(result) => {
                let kinds = self.kinds(&self.module.types[result.ty].inner)?;
                self.fresh(&kinds)
            }
            None => Vec::new(),
        };
        self.frame()?.result = Some(result.clone());
        self.statements(&function.body, &mut exits)?;
        self.land(&exits);
        self.push(Op::Join { mask: returned });
        Ok(result)
    }

    pub(super) fn give_back(
        &mut self,
        value: Option<Handle<Expression>>,
        exits: &mut Vec<usize>,
    ) -> Result<()> {
        let leaves = match value {
            Some(value) => self.leaves(value)?,
            None => Vec::new(),
        };
        match self.frame()?.returned {
            None => {
                self.frame()?.result = Some(leaves);
                Ok(())
            }
            Some(mask) => {
                let to = self.frame()?.result.clone().unwrap_or_default();
                self.store_to(&to, &leaves)?;
                self.leave(Some(mask), exits)
            }
        }
    }

    pub(super) fn call(
        &mut self,
        handle: Handle<naga::Function>,
        arguments: &[Handle<Expression>],
    ) -> Result<Vec<Leaf>> {
        if self.frames.len() >= MOST_CALLS {
            return self.unsupported(format!("calls nested deeper than {MOST_CALLS}"));
        }
        let arguments = arguments
            .iter()
            .map(|&a| self.value(a))
            .collect::<Result<Vec<_>>>()?;
        let function = &self.context.module.functions[handle];
        let name = function.name.clone().unwrap_or_default();
        let mut inner = frame(function, &self.context.info[handle], name);
        inner.arguments = arguments;
        self.frames.push(inner);
        let result = self.body(function);
        if result.is_ok() {
            self.frames.pop();
        }
        result
    }
}

fn count_returns(block: &Block) -> usize {
    let count = |statement: &Statement| match statement {
        Statement::Return { .. } => 1,
        Statement::Block(block) => count_returns(block),
        Statement::If { accept, reject, .. } => count_returns(accept) + count_returns(reject),
        Statement::Switch { cases, .. } => cases.iter().map(|c| count_returns(&c.body)).sum(),
        Statement::Loop {
            body, continuing, ..
        } => count_returns(body) + count_returns(continuing),
        _ => 0,
    };
    block.iter().map(count).sum()
}

fn ends_with_return(block: &Block) -> bool {
    match block.last() {
        Some(Statement::Return { .. }) => true,
        Some(Statement::Block(block)) => ends_with_return(block),
        _ => false,
    }
}

/// Shows every register that the code names to `f`.
pub(super) fn each_register(code: &mut Code, f: &mut dyn FnMut(LeafMut<'_>)) {
    let (mut float_lists, mut int_lists) = (Vec::new(), Vec::new());
    for op in &mut code.ops {
        match op {
            Op::PickFloat { list, .. } | Op::PutFloat { list, .. } => float_lists.push(*list),
            Op::PickInt { list, .. } | Op::PutInt { list, .. } => int_lists.push(*list),
            _ => {}
        }
        op.each_register(f);
    }
    for list in float_lists {
        code.lists[list as usize]
            .iter_mut()
            .for_each(|r| f(LeafMut::Float(r)));
    }
    for list in int_lists {
        code.lists[list as usize]
            .iter_mut()
            .for_each(|r| f(LeafMut::Int(r)));
    }
    code.images
        .iter_mut()
        .for_each(|image| image.each_register(f));
    let arguments = code.arguments.iter_mut().flat_map(|a| &mut a.leaves);
    arguments
        .chain(&mut code.result)
        .for_each(|leaf| show(leaf, f));
}
