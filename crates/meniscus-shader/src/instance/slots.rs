//! Which filling a slot has: what a pipeline said nearest, what facts choose, or the slot's own body.

use std::collections::BTreeMap;

use meniscus_source::{Diagnostic, Place};

use super::{Asked, Filled, Resolver, Scope};
use crate::filling::Filling;
use crate::header::{Name, SlotUse};
use crate::library::Module;
use crate::outline::ItemKind;

impl<'l, 'r> Resolver<'l, 'r> {
    /// The instances that fill the slots which a module calls.
    pub(super) fn slots_of(
        &mut self,
        module: &'l Module,
        scope: usize,
    ) -> Vec<(&'l SlotUse, usize)> {
        let mut found = Vec::new();
        for used in &module.header.slots {
            if let Some(instance) = self.slot(used, scope) {
                found.push((used, instance));
            }
        }
        found
    }

    /// The filling of a slot: by the module's own name for it in its own scope, by the slot's name
    /// there and in the enclosing ones, else the slot's default.
    fn slot(&mut self, used: &'l SlotUse, scope: usize) -> Option<usize> {
        let slot = self.library.slot(&used.slot.text)?;
        if !self.enter(&used.name) {
            return None;
        }
        let found = self.slot_within(slot, used, scope);
        self.depth -= 1;
        found
    }

    fn slot_within(&mut self, slot: &'l Module, used: &'l SlotUse, scope: usize) -> Option<usize> {
        let mut enclosing = Vec::new();
        let mut next = Some(scope);
        while let Some(current) = next {
            let fillings: &'r BTreeMap<String, Filling> = self.scopes[current].fillings;
            let own = (current == scope).then_some(used.name.text.as_str());
            let named = own
                .into_iter()
                .chain([used.slot.text.as_str()])
                .find_map(|name| fillings.get_key_value(name));
            if let Some((name, filling)) = named {
                let key = (current, name.as_str());
                match self.filled.get(&key) {
                    Some(Filled::Done(instance)) => return Some(*instance),
                    Some(Filled::Failed) => return None,
                    // It is this very filling, or one within it, that asks: the next one out is meant.
                    Some(Filled::InProgress) if enclosing.contains(&key) => {}
                    Some(Filled::InProgress) => {
                        let mut circle = Diagnostic::error(format!(
                            "the filling of `{name}` calls itself by way of others"
                        ));
                        if let Some(place) = &filling.module.place {
                            circle = circle.at(place, "comes back here");
                        }
                        self.report
                            .add(
                                circle
                                    .see(&used.name.place, "called here")
                                    .with_help(format!(
                                        "give one of them a filling of its own for `{}`",
                                        used.slot.text
                                    )),
                            );
                        return None;
                    }
                    None => {
                        self.filled.insert(key, Filled::InProgress);
                        let instance = self.fill(filling, slot, name, current);
                        self.filled
                            .insert(key, instance.map_or(Filled::Failed, Filled::Done));
                        return instance;
                    }
                }
            }
            enclosing.extend(self.scopes[current].key);
            next = self.scopes[current].parent;
        }
        self.default_of(slot, used, scope)
    }

    /// The filling that facts choose, or the slot's own body.
    fn default_of(&mut self, slot: &'l Module, used: &SlotUse, scope: usize) -> Option<usize> {
        let key = (slot.path.as_str(), scope);
        if let Some(instance) = self.defaults.get(&key) {
            return Some(*instance);
        }
        if self.defaulting.contains(&slot.path.as_str()) {
            self.report.add(
                Diagnostic::error(format!("the slot `{}` is filled by itself", slot.leaf()))
                    .at(
                        &used.name.place,
                        "nothing but this filling is there to call",
                    )
                    .with_help(format!("fill `{}` in the pipeline", used.name.text)),
            );
            return None;
        }
        let (module, place) = self.default_module(slot)?;
        if module.path != slot.path {
            self.check_contract(module, slot, place)?;
        }
        self.defaulting.push(&slot.path);
        // Mostly there is one default of a slot; it has the slot's name.
        let leaf = slot.leaf().to_owned();
        let first = !self.scopes[0].fillings.contains_key(&leaf)
            && !self.defaults.keys().any(|(path, _)| *path == slot.path);
        let mut role = if first {
            Vec::new()
        } else {
            self.scopes[scope].role.clone()
        };
        role.push(leaf);
        let instance = self.instance(module, Some(slot), role, scope, Asked::ByDefault);
        self.check_requirements(instance, scope);
        self.defaulting.pop();
        self.defaults.insert(key, instance);
        Some(instance)
    }

    /// The module that fills a slot which nothing else fills, and where the slot says so.
    pub fn default_module(&self, slot: &'l Module) -> Option<(&'l Module, Option<&'l Place>)> {
        let holds = |fact: &Name| self.facts.contains(&fact.text);
        match slot
            .header
            .when
            .iter()
            .find(|when| when.facts.iter().all(holds))
        {
            Some(when) => Some((
                self.library.get(&when.module.text)?,
                Some(&when.module.place),
            )),
            None => Some((slot, None)),
        }
    }

    fn fill(
        &mut self,
        filling: &'r Filling,
        slot: &'l Module,
        name: &'r str,
        scope: usize,
    ) -> Option<usize> {
        let place = filling.module.place.as_ref();
        let module = match self.library.find(&filling.module, place) {
            Ok(module) => module,
            Err(unknown) => {
                self.report.add(unknown);
                return None;
            }
        };
        self.check_contract(module, slot, place)?;
        self.check_numbers(module, filling);
        self.check_fillings(&filling.slots, Some(module));
        self.check_reads(module, filling);
        let mut role = self.scopes[scope].role.clone();
        role.push(name.to_owned());
        let mut reads = self.scopes[scope].reads.clone();
        reads.extend(
            filling
                .reads
                .iter()
                .map(|(k, v)| (k.clone(), v.value.clone())),
        );
        let inner = self.scopes.len();
        self.scopes.push(Scope {
            parent: Some(scope),
            fillings: &filling.slots,
            role: role.clone(),
            reads,
            key: Some((scope, name)),
        });
        let instance = self.instance(module, Some(slot), role, inner, Asked::At(place));
        self.check_requirements(instance, inner);
        let is_constant = |name: &str| {
            let item = module.item(name);
            item.is_some_and(|item| matches!(item.kind, ItemKind::Constant { .. }))
        };
        let constants = filling.numbers.iter();
        self.instances[instance].constants = constants
            .filter(|(name, _)| is_constant(name))
            .map(|(name, value)| (name.clone(), value.value))
            .collect();
        Some(instance)
    }
}
