//! Which modules a shader is made of: slots resolved to fillings, needs to modules, each once.
//!
//! The same module may stand in a shader more than once, with other numbers, other resources or
//! other fillings; each such *instance* gets names of its own when the text is written.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use meniscus_source::{Diagnostic, Place, Report};

use crate::filling::Filling;
use crate::header::SlotUse;
use crate::library::{Library, Module, Role};
use crate::outline::ItemKind;

/// One use of a module.
#[derive(Debug)]
pub(crate) struct Instance<'l> {
    pub module: &'l Module,
    /// Path of slot names that leads to it; empty for skeletons and needed modules.
    pub role: Vec<String>,
    /// The slot that it fills.
    pub slot: Option<&'l Module>,
    /// For each of its variables that differs from its name, the resource it is connected to.
    pub reads: BTreeMap<String, String>,
    /// The fillings of the slots it calls.
    pub slots: Vec<(&'l SlotUse, usize)>,
    /// The modules it needs.
    pub needs: Vec<usize>,
    /// Where a pipeline asked for it.
    pub place: Option<Place>,
}

/// Where an unfilled slot looks for its filling.
struct Scope<'r> {
    parent: Option<usize>,
    fillings: &'r BTreeMap<String, Filling>,
    role: Vec<String>,
    reads: BTreeMap<String, String>,
}

/// Instances in the order they were needed; the skeleton is the last.
pub(crate) struct Instances<'l> {
    pub all: Vec<Instance<'l>>,
    /// The resources that variables of the whole shader are connected to, by variable.
    pub reads: BTreeMap<String, String>,
}

struct Resolver<'l, 'r> {
    library: &'l Library,
    facts: &'r BTreeSet<String>,
    scopes: Vec<Scope<'r>>,
    instances: Vec<Instance<'l>>,
    /// Needed modules by path, reads and slots.
    needed: HashMap<(String, BTreeMap<String, String>, Vec<usize>), usize>,
    /// Filled slots by scope and name; none while they are being resolved.
    filled: HashMap<(usize, String), Option<usize>>,
    /// Fillings with nothing of their own, which stand once however often they are asked for.
    plain: HashMap<(String, String), usize>,
    /// Slots filled by default; none while they are being resolved.
    defaults: HashMap<String, Option<usize>>,
    needing: Vec<String>,
    report: Report,
}

/// Resolves everything that a skeleton calls and needs.
pub(crate) fn resolve<'l>(
    library: &'l Library,
    skeleton: &'l Module,
    place: Option<&Place>,
    fillings: &BTreeMap<String, Filling>,
    reads: BTreeMap<String, String>,
    facts: &BTreeSet<String>,
) -> Result<Instances<'l>, Report> {
    let mut resolver = Resolver {
        library,
        facts,
        scopes: vec![Scope {
            parent: None,
            fillings,
            role: Vec::new(),
            reads: reads.clone(),
        }],
        instances: Vec::new(),
        needed: HashMap::new(),
        filled: HashMap::new(),
        plain: HashMap::new(),
        defaults: HashMap::new(),
        needing: Vec::new(),
        report: Report::default(),
    };
    resolver.check_fillings(fillings, None);
    let slots = resolver.slots_of(skeleton, 0);
    let needs = resolver.needs_of(skeleton, 0);
    let instance = Instance {
        module: skeleton,
        role: Vec::new(),
        slot: None,
        reads: resolver.reads_of(skeleton, 0),
        slots,
        needs,
        place: place.cloned(),
    };
    resolver.instances.push(instance);
    let Resolver {
        instances, report, ..
    } = resolver;
    report.into_result(Instances {
        all: instances,
        reads,
    })
}

impl<'l, 'r> Resolver<'l, 'r> {
    /// The instances that fill the slots which a module calls.
    fn slots_of(&mut self, module: &'l Module, scope: usize) -> Vec<(&'l SlotUse, usize)> {
        let mut found = Vec::new();
        for used in &module.header.slots {
            if let Some(instance) = self.slot(used, scope) {
                found.push((used, instance));
            }
        }
        found
    }

    /// The filling of a slot: by the module's own name for it in its own scope, by the slot's name
    /// in the enclosing ones, else the slot's default.
    fn slot(&mut self, used: &'l SlotUse, scope: usize) -> Option<usize> {
        let slot = self.library.slot(&used.slot.text)?;
        let mut name = used.name.text.as_str();
        let mut next = Some(scope);
        while let Some(current) = next {
            let fillings: &'r BTreeMap<String, Filling> = self.scopes[current].fillings;
            if let Some(filling) = fillings.get(name) {
                let key = (current, name.to_owned());
                match self.filled.get(&key) {
                    Some(Some(instance)) => return Some(*instance),
                    // It is this very filling that asks: the next one out is meant.
                    Some(None) => {}
                    None => {
                        self.filled.insert(key.clone(), None);
                        let instance = self.fill(filling, slot, name, current);
                        match instance {
                            Some(instance) => self.filled.insert(key, Some(instance)),
                            None => self.filled.remove(&key),
                        };
                        return instance;
                    }
                }
            }
            next = self.scopes[current].parent;
            name = &used.slot.text;
        }
        self.default_of(slot, used)
    }

    /// The filling that facts choose, or the slot's own body.
    fn default_of(&mut self, slot: &'l Module, used: &SlotUse) -> Option<usize> {
        match self.defaults.get(&slot.path) {
            Some(Some(instance)) => return Some(*instance),
            Some(None) => {
                self.report.add(
                    Diagnostic::error(format!("the slot `{}` is filled by itself", slot.leaf()))
                        .at(&used.name.place, "nothing but this filling is there to call")
                        .with_help(format!("fill `{}` in the pipeline", used.name.text)),
                );
                return None;
            }
            None => {}
        }
        self.defaults.insert(slot.path.clone(), None);
        let chosen = slot
            .header
            .when
            .iter()
            .find(|when| when.facts.iter().all(|fact| self.facts.contains(&fact.text)));
        let module = match chosen {
            Some(when) => self.library.get(&when.module.text)?,
            None => slot,
        };
        if module.path != slot.path {
            let place = chosen.map(|when| when.module.place.clone());
            self.check_contract(module, slot, place.as_ref())?;
        }
        let instance = self.instance(module, Some(slot), vec![slot.leaf().to_owned()], 0, None);
        self.defaults.insert(slot.path.clone(), Some(instance));
        Some(instance)
    }

    fn fill(
        &mut self,
        filling: &'r Filling,
        slot: &'l Module,
        name: &str,
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
        let shareable = filling.slots.is_empty()
            && filling.reads.is_empty()
            && scope == 0
            && module.header.slots.is_empty()
            && module.overrides().next().is_none();
        let key = (module.path.clone(), slot.path.clone());
        if let Some(&instance) = self.plain.get(&key).filter(|_| shareable) {
            return Some(instance);
        }
        let mut role = self.scopes[scope].role.clone();
        role.push(name.to_owned());
        let mut reads = self.scopes[scope].reads.clone();
        reads.extend(filling.reads.iter().map(|(k, v)| (k.clone(), v.value.clone())));
        let inner = self.scopes.len();
        self.scopes.push(Scope {
            parent: Some(scope),
            fillings: &filling.slots,
            role: role.clone(),
            reads,
        });
        self.check_reads(module, filling);
        let instance = self.instance(module, Some(slot), role, inner, place);
        self.check_requirements(instance, inner);
        if shareable {
            self.plain.insert(key, instance);
        }
        Some(instance)
    }

    fn instance(
        &mut self,
        module: &'l Module,
        slot: Option<&'l Module>,
        role: Vec<String>,
        scope: usize,
        place: Option<&Place>,
    ) -> usize {
        let slots = self.slots_of(module, scope);
        let needs = self.needs_of(module, scope);
        let reads = self.reads_of(module, scope);
        self.instances.push(Instance {
            module,
            role,
            slot,
            reads,
            slots,
            needs,
            place: place.cloned(),
        });
        self.instances.len() - 1
    }

    fn needs_of(&mut self, module: &'l Module, scope: usize) -> Vec<usize> {
        self.needing.push(module.path.clone());
        let mut found = Vec::new();
        for need in &module.header.needs {
            if let Some(start) = self.needing.iter().position(|path| *path == need.text) {
                self.report.add(
                    Diagnostic::error(format!(
                        "modules need each other: {} → {}",
                        self.needing[start..].join(" → "),
                        need.text
                    ))
                    .at(&need.place, "closes the circle"),
                );
                continue;
            }
            let Some(needed) = self.library.get(&need.text) else {
                // The library's own report has told of it.
                self.report.extend(Report(
                    self.library.find(&need.text, Some(&need.place)).err().into_iter().collect(),
                ));
                continue;
            };
            if needed.role() != Role::Shared {
                continue;
            }
            let slots = self.slots_of(needed, scope);
            let needs = self.needs_of(needed, scope);
            let reads = self.reads_of(needed, scope);
            let mut parts: Vec<usize> = slots.iter().map(|(_, instance)| *instance).collect();
            parts.extend(&needs);
            let key = (needed.path.clone(), reads.clone(), parts);
            let instance = match self.needed.get(&key) {
                Some(&instance) => instance,
                None => {
                    self.instances.push(Instance {
                        module: needed,
                        role: Vec::new(),
                        slot: None,
                        reads,
                        slots,
                        needs,
                        place: None,
                    });
                    self.needed.insert(key, self.instances.len() - 1);
                    self.instances.len() - 1
                }
            };
            found.push(instance);
        }
        self.needing.pop();
        found
    }

    /// The renamings of resources that concern a module's own variables.
    fn reads_of(&self, module: &Module, scope: usize) -> BTreeMap<String, String> {
        let reads = &self.scopes[scope].reads;
        variables(module)
            .filter_map(|name| Some((name.to_owned(), reads.get(name)?.clone())))
            .filter(|(name, resource)| name != resource)
            .collect()
    }

    /// A filling provides its slot, with the slot's functions.
    fn check_contract(
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
                .at(&provides.place, format!("provides `{}`", provides.text)),
            ));
            return None;
        }
        let mut kept = true;
        for wanted in slot.functions() {
            let there = module.item(&wanted.name);
            let types = |kind: &ItemKind| match kind {
                ItemKind::Function { parameters, result } => Some((
                    parameters.iter().map(|p| p.ty.clone()).collect::<Vec<_>>(),
                    result.clone(),
                )),
                _ => None,
            };
            let wrong = match there {
                Some(item) if types(&item.kind) == types(&wanted.kind) => continue,
                Some(item) => Diagnostic::error(format!(
                    "`{}` has not the signature of the slot `{}`",
                    module.path,
                    slot.leaf()
                ))
                .at(&module.place(signature(module, item)), "this signature"),
                None => Diagnostic::error(format!(
                    "`{}` provides `{}` but has no function `{}`",
                    module.path,
                    slot.leaf(),
                    wanted.name
                ))
                .at(&provides.place, format!("`{}` is missing", wanted.name)),
            };
            kept = false;
            self.report.add(asked(
                wrong.see(&slot.place(signature(slot, wanted)), "the slot's signature"),
            ));
        }
        kept.then_some(())
    }

    fn check_numbers(&mut self, module: &Module, filling: &Filling) {
        for (name, value) in &filling.numbers {
            let report = |report: &mut Report, diagnostic: Diagnostic, words: &str| {
                report.add(match &value.place {
                    Some(place) => diagnostic.at(place, words),
                    None => diagnostic,
                });
            };
            if !module.overrides().any(|item| item.name == *name) {
                let known = module.overrides().map(|item| item.name.as_str());
                let unknown = Diagnostic::error(format!("`{}` has no number `{name}`", module.path))
                    .with_suggestion(name, known);
                report(&mut self.report, unknown, "unknown number");
                continue;
            }
            let number = module.header.number(name);
            let (least, most) = number.map_or((f64::MIN, f64::MAX), |n| (n.least, n.most));
            if !(least..=most).contains(&value.value) {
                let unit = number.map_or("", |n| n.unit.as_str());
                let wrong = Diagnostic::error(format!(
                    "`{name}` of `{}` is {least} to {most} {unit}",
                    module.path
                ));
                report(&mut self.report, wrong, &format!("{} is outside", value.value));
            }
        }
    }

    /// What is filled must be a slot: of the module, or one that something within may ask for.
    fn check_fillings(&mut self, fillings: &BTreeMap<String, Filling>, module: Option<&Module>) {
        for (name, filling) in fillings {
            let own = module.is_some_and(|m| m.header.slots.iter().any(|s| s.name.text == *name));
            if !own && self.library.slot(name).is_none() {
                let mut unknown = self.library.unknown_slot(name, filling.slot_place.as_ref());
                if let Some(module) = module {
                    let own: Vec<_> =
                        module.header.slots.iter().map(|s| format!("`{}`", s.name.text)).collect();
                    if !own.is_empty() {
                        unknown = unknown
                            .with_help(format!("`{}` has {}", module.path, own.join(", ")));
                    }
                }
                self.report.add(unknown);
            }
        }
    }

    /// `reads` must name variables that the module or its needs declare.
    fn check_reads(&mut self, module: &Module, filling: &Filling) {
        if filling.reads.is_empty() {
            return;
        }
        let mut known = BTreeSet::new();
        let mut open = vec![module];
        let mut seen = BTreeSet::new();
        while let Some(module) = open.pop() {
            if seen.insert(module.path.clone()) {
                known.extend(variables(module).map(str::to_owned));
                let needs = module.header.needs.iter();
                open.extend(needs.filter_map(|need| self.library.get(&need.text)));
            }
        }
        for (name, resource) in &filling.reads {
            if !known.contains(name) && filling.slots.is_empty() {
                let mut unknown =
                    Diagnostic::error(format!("`{}` reads no `{name}`", module.path));
                if let Some(place) = &resource.place {
                    unknown = unknown.at(place, "connected to nothing");
                }
                self.report
                    .add(unknown.with_suggestion(name, known.iter().map(String::as_str)));
            }
        }
    }

    fn check_requirements(&mut self, instance: usize, scope: usize) {
        let module = self.instances[instance].module;
        for required in &module.header.requires {
            let used = SlotUse {
                name: required.slot.clone(),
                slot: required.slot.clone(),
            };
            // Resolved already if the module calls the slot; otherwise looked up by name alone.
            let mut next = Some(scope);
            let mut found = None;
            while let (Some(current), None) = (next, &found) {
                found = self.scopes[current]
                    .fillings
                    .get(&used.slot.text)
                    .map(|filling| filling.module.value.clone());
                next = self.scopes[current].parent;
            }
            if found.as_deref() != Some(required.module.text.as_str()) {
                let mut wrong = Diagnostic::error(format!(
                    "`{}` is valid only with `{}` in the slot `{}`",
                    module.path, required.module.text, required.slot.text
                ))
                .see(&required.slot.place, "required here");
                if let Some(place) = &self.instances[instance].place {
                    let there = found.unwrap_or_else(|| "the slot's default".into());
                    wrong = wrong.at(place, format!("`{}` is {there} here", required.slot.text));
                }
                self.report.add(wrong);
            }
        }
    }
}

/// Names of a module's resource variables.
pub(crate) fn variables(module: &Module) -> impl Iterator<Item = &str> {
    module
        .outline
        .items
        .iter()
        .filter(|item| matches!(item.kind, ItemKind::Variable { .. }))
        .map(|item| item.name.as_str())
}

/// From `fn` to the end of the result's type.
fn signature(module: &Module, item: &crate::outline::Item) -> std::ops::Range<usize> {
    let text = &module.file.text[item.range.clone()];
    let end = text.find('{').unwrap_or(text.len());
    item.range.start..item.range.start + text[..end].trim_end().len()
}
