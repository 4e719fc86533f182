//! Which bytes of the host's buffers a pass reads: a block that two passes share may change for one
//! of them alone.

use std::ops::Range;

use meniscus_shader::{Binding, Shader};
use naga::{Expression, Function, GlobalVariable, Handle, Statement, TypeInner};

use crate::host_buffers::HostBuffers;

/// A buffer of which a pass reads some bytes.
#[derive(Debug)]
pub(crate) struct HostUse {
    buffer: wgpu::Buffer,
    ranges: Vec<Range<usize>>,
}

impl HostUse {
    /// What a shader reads of the buffer that it is given for a binding.
    pub fn new(shader: &Shader, binding: &Binding, buffer: &wgpu::Buffer) -> Self {
        let all = 0..buffer.size() as usize;
        let ranges = members(shader, binding.index).unwrap_or_else(|| vec![all]);
        Self {
            buffer: buffer.clone(),
            ranges,
        }
    }

    /// Whether the last update changed something of it.
    pub fn changed(&self, host: &HostBuffers) -> bool {
        host.changed(&self.buffer, &self.ranges)
    }
}

/// The bytes of the members that are read of a block; none if all may be.
fn members(shader: &Shader, number: u32) -> Option<Vec<Range<usize>>> {
    let module = &shader.module;
    let bound = |variable: &GlobalVariable| {
        let found = variable.binding.as_ref().map(|b| b.binding);
        found == Some(number)
    };
    let mut globals = module.global_variables.iter();
    let (block, variable) = globals.find(|(_, variable)| bound(variable))?;
    let TypeInner::Struct { members, span } = &module.types[variable.ty].inner else {
        return None;
    };
    let mut used = vec![false; members.len()];
    let functions = module.functions.iter().map(|(_, function)| function);
    let stages = module.entry_points.iter().map(|entry| &entry.function);
    for function in functions.chain(stages) {
        mark(function, block, &mut used)?;
    }
    let end = |index: usize| {
        let next = members.get(index + 1);
        next.map_or(*span, |next| next.offset) as usize
    };
    let range = |index: usize| members[index].offset as usize..end(index);
    let used = used.iter().enumerate().filter(|(_, used)| **used);
    Some(used.map(|(index, _)| range(index)).collect())
}

/// Marks the members that a function reads; none where it takes the block as a whole.
fn mark(function: &Function, block: Handle<GlobalVariable>, used: &mut [bool]) -> Option<()> {
    let is_block = |handle: Handle<Expression>| matches!(function.expressions[handle], Expression::GlobalVariable(g) if g == block);
    for (_, expression) in function.expressions.iter() {
        match *expression {
            Expression::AccessIndex { base, index } if is_block(base) => {
                *used.get_mut(index as usize)? = true;
            }
            Expression::Access { base, .. } if is_block(base) => return None,
            Expression::Load { pointer } if is_block(pointer) => return None,
            _ => {}
        }
    }
    passes_on(&function.body, &is_block)
}

/// None where the block is handed to a function.
fn passes_on(body: &naga::Block, is_block: &dyn Fn(Handle<Expression>) -> bool) -> Option<()> {
    for statement in body {
        match statement {
            Statement::Call { arguments, .. } if arguments.iter().any(|&a| is_block(a)) => {
                return None;
            }
            Statement::Block(block) => passes_on(block, is_block)?,
            Statement::If { accept, reject, .. } => {
                passes_on(accept, is_block)?;
                passes_on(reject, is_block)?;
            }
            Statement::Switch { cases, .. } => {
                for case in cases {
                    passes_on(&case.body, is_block)?;
                }
            }
            Statement::Loop {
                body, continuing, ..
            } => {
                passes_on(body, is_block)?;
                passes_on(continuing, is_block)?;
            }
            _ => {}
        }
    }
    Some(())
}
