//! What is asked of a filling: that it provides its slot, and that what it sets is there to be set.

use std::collections::{BTreeMap, BTreeSet};

use meniscus_source::{Diagnostic, Place};

use crate::filling::Filling;
use crate::instance::{Resolver, variables};
use crate::library::Module;
use crate::{numbers, signature};

impl<'l> Resolver<'l, '_> {
    /// A filling provides its slot, with the slot's functions.
    pub fn check_contract(
        &mut self,
        module: &Module,
        slot: &Module,
        place: Option<&Place>,
    ) -> Option<()> {
        let asked = |diagnostic: Diagnostic| match place {
            Some(place) => diagnostic.see(place, "asked for here"),
            None => diagnostic,
        };
        if module.path == slot.path {
            return Some(());
        }
        let Some(provides) = &module.header.provides else {
            let mut wrong = Diagnostic::error(format!("`{}` fills no slot", module.path));
            if let Some(place) = place {
                wrong = wrong.at(place, format!("a filling of `{}` is wanted", slot.leaf()));
            }
            self.report.add(wrong.with_help(format!(
                "add the line `// provides: {}` to {} if it does",
                slot.leaf(),
                module.file.name
            )));
            return None;
        };
        if provides.text != slot.leaf() {
            self.report.add(asked(
                Diagnostic::error(format!(
                    "`{}` fills the slot `{}`, not `{}`",
                    module.path,
                    provides.text,
                    slot.leaf()
                ))
                .at(&provides.place, format!("provides `{}`", provides.text))
                .with_help(format!("take a module with `// provides: {}`", slot.leaf())),
            ));
            return None;
        }
        let mut kept = true;
        for wanted in slot.functions() {
            let wrong = match module.item(&wanted.name) {
                Some(item) => signature::compare(self.library, (module, item), (slot, wanted)),
                None => Some(
                    Diagnostic::error(format!(
                        "`{}` provides `{}` but has no function `{}`",
                        module.path,
                        slot.leaf(),
                        wanted.name
                    ))
                    .at(&provides.place, format!("`{}` is missing", wanted.name))
                    .see(&signature::place_of(slot, wanted), "the slot's signature")
                    .with_help(format!("declare `{}`", signature::written(slot, wanted))),
                ),
            };
            if let Some(wrong) = wrong {
                kept = false;
                self.report.add(asked(wrong));
            }
        }
        kept.then_some(())
    }

    pub fn check_numbers(&mut self, module: &Module, filling: &Filling) {
        self.report
            .extend(numbers::check_numbers(module, &filling.numbers));
    }

    /// What is filled must be a slot: of the module, or one that something within may ask for.
    pub fn check_fillings(
        &mut self,
        fillings: &BTreeMap<String, Filling>,
        module: Option<&Module>,
    ) {
        for (name, filling) in fillings {
            let own = module.is_some_and(|m| m.header.slots.iter().any(|s| s.name.text == *name));
            if !own && self.library.slot(name).is_none() {
                let mut unknown = self.library.unknown_slot(name, filling.slot_place.as_ref());
                if let Some(module) = module {
                    let own: Vec<_> = module
                        .header
                        .slots
                        .iter()
                        .map(|s| format!("`{}`", s.name.text))
                        .collect();
                    if !own.is_empty() {
                        unknown =
                            unknown.with_help(format!("`{}` has {}", module.path, own.join(", ")));
                    }
                }
                self.report.add(unknown);
            }
        }
    }

    /// `reads` must name variables that the module or its needs declare.
    pub fn check_reads(&mut self, module: &Module, filling: &Filling) {
        if filling.reads.is_empty() {
            return;
        }
        let closure = self.library.closure(module);
        let known: BTreeSet<&str> = closure
            .iter()
            .flat_map(|module| variables(module))
            .collect();
        for (name, resource) in &filling.reads {
            // What has no place was not written by anyone; slots may lead to any variable.
            if !known.contains(name.as_str())
                && resource.place.is_some()
                && module.header.slots.is_empty()
            {
                let mut unknown = Diagnostic::error(format!("`{}` reads no `{name}`", module.path));
                if let Some(place) = &resource.place {
                    unknown = unknown.at(place, "connected to nothing");
                }
                let unknown = unknown.with_suggestion(name, known.iter().copied());
                self.report.add(match known.is_empty() {
                    true => unknown.with_help("it reads no texture or buffer: leave `reads` out"),
                    false => unknown,
                });
            }
        }
    }

    pub fn check_requirements(&mut self, instance: usize, scope: usize) {
        let module = self.instances[instance].module;
        for required in &module.header.requires {
            let mut next = Some(scope);
            let mut found = None;
            while let (Some(current), None) = (next, &found) {
                found = self.scopes[current]
                    .fillings
                    .get(&required.slot.text)
                    .map(|filling| filling.module.value.clone());
                next = self.scopes[current].parent;
            }
            let found = found.or_else(|| {
                let slot = self.library.slot(&required.slot.text)?;
                Some(self.default_module(slot)?.0.path.clone())
            });
            if found.as_deref() != Some(required.module.text.as_str()) {
                let mut wrong = Diagnostic::error(format!(
                    "`{}` is valid only with `{}` in the slot `{}`",
                    module.path, required.module.text, required.slot.text
                ))
                .see(&required.slot.place, "required here");
                if let Some(place) = &self.instances[instance].place {
                    let there = found.map_or_else(String::new, |path| {
                        format!("`{path}` fills `{}`", required.slot.text)
                    });
                    wrong = wrong.at(place, there);
                }
                self.report.add(wrong.with_help(format!(
                    "fill `{}` with `{}`, or take another module here",
                    required.slot.text, required.module.text
                )));
            }
        }
    }
}
