//! Which textures and buffers a pass reads and writes.

use std::collections::BTreeSet;

use meniscus_shader::BindingKind;

use crate::plan::{PassKind, Plan, PlannedPass};

/// What of a plan's textures and buffers a pass reads and writes.
#[derive(Debug)]
pub(crate) struct Uses<'p> {
    pub reads: BTreeSet<&'p str>,
    pub writes: BTreeSet<&'p str>,
}

impl Plan {
    pub(crate) fn uses<'p>(&'p self, pass: &'p PlannedPass) -> Uses<'p> {
        let known =
            |name: &str| self.textures.contains_key(name) || self.buffers.contains_key(name);
        let mut uses = Uses {
            reads: BTreeSet::new(),
            writes: pass
                .targets
                .iter()
                .chain(&pass.depth)
                .map(String::as_str)
                .collect(),
        };
        for binding in &pass.shader.bindings {
            let name = binding.resource.as_str();
            if !known(name) || pass.targets.iter().any(|target| target == name) {
                continue;
            }
            let (reads, writes) = match binding.kind {
                BindingKind::Storage { read_only, .. } => (true, !read_only),
                BindingKind::StorageTexture { reads, .. } => (reads, true),
                _ => (true, false),
            };
            if reads {
                uses.reads.insert(name);
            }
            if writes {
                uses.writes.insert(name);
            }
        }
        if let PassKind::DispatchIndirect(arguments) = &pass.kind {
            uses.reads.insert(arguments);
        }
        uses
    }
}
