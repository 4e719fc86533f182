//! Whether everything that a module declares is used, so that there is nothing to prune.

use naga::{Block, Expression, Function, Handle, Module, Statement, Type, TypeInner};

/// What was found in use, by the handles' indices.
struct Used {
    functions: Vec<bool>,
    variables: Vec<bool>,
    overrides: Vec<bool>,
    types: Vec<bool>,
}

/// Whether all functions, variables, named numbers and named types of a module that naga's front end
/// made are used: naga's compaction would leave such a module as it is, as the front end has left
/// out all else. It may say no where the answer is yes.
pub(crate) fn all_used(module: &Module) -> bool {
    let mut used = Used {
        functions: vec![false; module.functions.len()],
        variables: vec![false; module.global_variables.len()],
        overrides: vec![false; module.overrides.len()],
        types: vec![false; module.types.len()],
    };
    let mut waiting = Vec::new();
    for entry in &module.entry_points {
        used.function(&entry.function, &mut waiting);
    }
    while let Some(handle) = waiting.pop() {
        used.function(&module.functions[handle], &mut waiting);
    }
    for (_, expression) in module.global_expressions.iter() {
        used.expression(expression);
    }
    let constants = module.constants.iter().map(|(_, constant)| constant.ty);
    let overrides = module.overrides.iter().map(|(_, number)| number.ty);
    let variables = module.global_variables.iter().map(|(_, v)| v.ty);
    used.types(constants.chain(overrides).chain(variables));
    // A type stands behind those that it is made of.
    let types: Vec<_> = module.types.iter().collect();
    for (handle, ty) in types.into_iter().rev() {
        if used.types[handle.index()] {
            used.parts(&ty.inner);
        } else if ty.name.is_some() {
            return false;
        }
    }
    let mut overrides = module.overrides.iter();
    used.functions.iter().all(|used| *used)
        && used.variables.iter().all(|used| *used)
        && overrides.all(|(handle, o)| o.name.is_none() || used.overrides[handle.index()])
}

impl Used {
    fn types(&mut self, types: impl IntoIterator<Item = Handle<Type>>) {
        for ty in types {
            self.types[ty.index()] = true;
        }
    }

    fn function(&mut self, function: &Function, waiting: &mut Vec<Handle<Function>>) {
        self.types(function.arguments.iter().map(|a| a.ty));
        self.types(function.result.iter().map(|r| r.ty));
        self.types(function.local_variables.iter().map(|(_, local)| local.ty));
        for (_, expression) in function.expressions.iter() {
            self.expression(expression);
        }
        self.block(&function.body, waiting);
    }

    fn expression(&mut self, expression: &Expression) {
        match *expression {
            Expression::GlobalVariable(variable) => self.variables[variable.index()] = true,
            Expression::Override(number) => self.overrides[number.index()] = true,
            Expression::Compose { ty, .. } | Expression::ZeroValue(ty) => self.types([ty]),
            _ => {}
        }
    }

    fn block(&mut self, block: &Block, waiting: &mut Vec<Handle<Function>>) {
        for statement in block {
            match statement {
                Statement::Call { function, .. } => {
                    let known = std::mem::replace(&mut self.functions[function.index()], true);
                    waiting.extend((!known).then_some(*function));
                }
                Statement::Block(inner) => self.block(inner, waiting),
                Statement::If { accept, reject, .. } => {
                    self.block(accept, waiting);
                    self.block(reject, waiting);
                }
                Statement::Switch { cases, .. } => {
                    for case in cases {
                        self.block(&case.body, waiting);
                    }
                }
                Statement::Loop {
                    body, continuing, ..
                } => {
                    self.block(body, waiting);
                    self.block(continuing, waiting);
                }
                _ => {}
            }
        }
    }

    fn parts(&mut self, ty: &TypeInner) {
        match ty {
            TypeInner::Struct { members, .. } => {
                self.types(members.iter().map(|m| m.ty));
            }
            TypeInner::Array { base, .. }
            | TypeInner::BindingArray { base, .. }
            | TypeInner::Pointer { base, .. } => self.types([*base]),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use naga::compact::{KeepUnused, compact};

    use super::all_used;

    const USED: &str = "struct Ray { at: vec3f }\nstruct Rays { all: array<Ray, 2> }\n\
        const TWO: f32 = 2.0;\noverride taps: i32 = 2;\nvar<private> rays: Rays;\n\
        fn first(i: i32) -> Ray { if i > 0 { return rays.all[0]; } return Ray(); }\n\
        @compute @workgroup_size(1) fn main() { loop { let r = first(taps); if r.at.x > TWO { break; } } }\n";

    fn parsed(text: &str) -> naga::Module {
        naga::front::wgsl::parse_str(text).unwrap()
    }

    #[test]
    fn where_everything_is_used_compaction_changes_nothing() {
        let module = parsed(USED);
        assert!(all_used(&module));
        let mut compacted = module.clone();
        compact(&mut compacted, KeepUnused::No);
        assert_eq!(format!("{module:?}"), format!("{compacted:?}"));
    }

    #[test]
    fn what_nothing_uses_is_noticed() {
        for unused in [
            "fn other() {}",
            "fn other() { other2(); } fn other2() {}",
            "var<private> other: f32;",
            "override other: f32 = 1.0;",
            "struct Other { x: f32 }",
        ] {
            assert!(!all_used(&parsed(&format!("{USED}{unused}"))), "{unused}");
        }
    }
}
