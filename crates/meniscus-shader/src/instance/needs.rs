//! Modules that are needed, what their variables are connected to, and what is too much or for nothing.

use std::collections::BTreeMap;

use meniscus_source::{Diagnostic, Report};

use super::{Asked, MAX_DEPTH, MAX_INSTANCES, Resolver, variables};
use crate::header::Name;
use crate::library::{Library, Module, Role};

impl<'l> Resolver<'l, '_> {
    pub(super) fn needs_of(&mut self, module: &'l Module, scope: usize) -> Vec<usize> {
        self.needing.push(&module.path);
        let mut found = Vec::with_capacity(module.header.needs.len());
        for need in &module.header.needs {
            if let Some(start) = self.needing.iter().position(|path| *path == need.text) {
                self.report.add(
                    Diagnostic::error(format!(
                        "modules need each other: {} → {}",
                        self.needing[start..].join(" → "),
                        need.text
                    ))
                    .at(&need.place, "closes the circle")
                    .with_help("move what both use into a module of its own"),
                );
                continue;
            }
            let key = (need.text.as_str(), scope);
            if let Some(&instance) = self.needed.get(&key) {
                found.push(instance);
                continue;
            }
            match self.library.find(&need.text, Some(&need.place)) {
                Ok(needed) if needed.role() == Role::Shared => {
                    if self.enter(need) {
                        let instance =
                            self.instance(needed, None, Vec::new(), scope, Asked::ByDefault);
                        self.depth -= 1;
                        self.needed.insert(key, instance);
                        found.push(instance);
                    }
                }
                Ok(_) => self.report.add(Library::cannot_be_needed(need)),
                Err(unknown) => self.report.add(unknown),
            }
        }
        self.needing.pop();
        found
    }

    /// Goes one step deeper, unless that is too deep or the shader is too large already.
    pub(super) fn enter(&mut self, name: &Name) -> bool {
        let what = if self.depth >= MAX_DEPTH {
            format!("modules lead to modules more than {MAX_DEPTH} deep")
        } else if self.instances.len() >= MAX_INSTANCES {
            format!("a shader of more than {MAX_INSTANCES} modules")
        } else {
            self.depth += 1;
            return true;
        };
        // Said once: everything that follows from it would only repeat it.
        if !self.report.0.iter().any(|d| d.message == what) {
            self.report
                .add(Diagnostic::error(what).at(&name.place, "here it becomes too much"));
        }
        false
    }

    /// The resources of a module's own variables, where they differ from the whole shader's.
    pub(super) fn reads_of(&self, module: &Module, scope: usize) -> BTreeMap<String, String> {
        let shared = &self.scopes[0].reads;
        let reads = &self.scopes[scope].reads;
        variables(module)
            .filter_map(|name| Some((name, reads.get(name)?)))
            .filter(|(name, resource)| {
                shared.get(*name).map_or(*name, String::as_str) != resource.as_str()
            })
            .map(|(name, resource)| (name.to_owned(), resource.clone()))
            .collect()
    }

    /// Warnings about fillings that nothing in the shader asks for.
    pub(super) fn unused(&self) -> Report {
        let mut report = Report::default();
        for (index, scope) in self.scopes.iter().enumerate() {
            for (name, filling) in scope.fillings {
                if self.filled.contains_key(&(index, name.as_str())) {
                    continue;
                }
                let mut unused =
                    Diagnostic::warning(format!("nothing here asks for the slot `{name}`"));
                if let Some(place) = filling
                    .slot_place
                    .as_ref()
                    .or(filling.module.place.as_ref())
                {
                    unused = unused.at(place, "a filling without effect");
                }
                report.add(unused.with_help("leave it out, or fill a slot that is called"));
            }
        }
        report
    }
}
