//! Which modules a shader is made of: slots resolved to fillings, needs to modules, each once.
//!
//! The same module may stand in a shader more than once, with other numbers, other resources or
//! other fillings; each such *instance* gets names of its own when the text is written.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use meniscus_source::{Diagnostic, Place, Report};

use crate::filling::Filling;
use crate::header::{Name, SlotUse};
use crate::library::{Library, Module, Role};
use crate::outline::ItemKind;

/// How deep slots and needs may lead; far beyond honest use, and little enough for any stack.
const MAX_DEPTH: usize = 100;
/// The most instances in one shader.
const MAX_INSTANCES: usize = 2000;

/// One use of a module.
#[derive(Debug)]
pub(crate) struct Instance<'l> {
    pub module: &'l Module,
    /// Path of slot names that leads to it; empty for skeletons and needed modules.
    pub role: Vec<String>,
    /// The slot that it fills.
    pub slot: Option<&'l Module>,
    /// The resources of those of its variables that are connected otherwise than the whole
    /// shader's variables of these names.
    pub reads: BTreeMap<String, String>,
    /// The fillings of the slots it calls.
    pub slots: Vec<(&'l SlotUse, usize)>,
    /// The modules it needs.
    pub needs: Vec<usize>,
    /// Values of its constants, where the pipeline sets them.
    pub constants: BTreeMap<String, f64>,
    /// Where a pipeline asked for it, or for what brought it in.
    pub place: Option<Place>,
}

/// Where an unfilled slot looks for its filling.
pub(crate) struct Scope<'r> {
    pub parent: Option<usize>,
    pub fillings: &'r BTreeMap<String, Filling>,
    role: Vec<String>,
    reads: BTreeMap<String, String>,
    /// The filling that this is the inside of.
    key: Option<(usize, String)>,
}

/// Instances in the order they were needed; the skeleton is the last.
pub(crate) struct Instances<'l> {
    pub all: Vec<Instance<'l>>,
    /// The resources that variables of the whole shader are connected to, by variable.
    pub reads: BTreeMap<String, String>,
    /// Whether live numbers are members of a buffer, rather than `override`s like the others.
    pub live: bool,
    /// Warnings about fillings that nothing asks for.
    pub unused: Report,
}

/// What decides an instance that has no numbers of its own: module, slot, reads, slots and needs.
type Shape = (String, Option<String>, BTreeMap<String, String>, Vec<usize>);

pub(crate) struct Resolver<'l, 'r> {
    pub library: &'l Library,
    pub facts: &'r BTreeSet<String>,
    pub scopes: Vec<Scope<'r>>,
    pub instances: Vec<Instance<'l>>,
    /// Instances without numbers of their own, which stand once however often they are wanted.
    shapes: HashMap<Shape, usize>,
    /// Needed modules by path and scope.
    needed: HashMap<(String, usize), usize>,
    /// Filled slots by scope and name; none while they are being resolved, or when they failed.
    filled: HashMap<(usize, String), Filled>,
    /// Slots filled by default, by path and scope.
    defaults: HashMap<(String, usize), usize>,
    /// Slots whose default is being resolved.
    defaulting: Vec<String>,
    needing: Vec<String>,
    depth: usize,
    pub report: Report,
}

/// Why an instance is there.
#[derive(Clone, Copy)]
enum Asked<'p> {
    /// A pipeline filled a slot with it.
    At(Option<&'p Place>),
    /// Nothing else was said, or another module needs it.
    ByDefault,
}

#[derive(Clone, Copy)]
enum Filled {
    InProgress,
    Failed,
    Done(usize),
}

/// Resolves everything that a skeleton, or a module by itself, calls and needs.
pub(crate) fn resolve<'l>(
    library: &'l Library,
    skeleton: &'l Module,
    place: Option<&Place>,
    fillings: &BTreeMap<String, Filling>,
    reads: BTreeMap<String, String>,
    facts: &BTreeSet<String>,
) -> Result<Instances<'l>, Report> {
    let mut resolver = Resolver::new(library, fillings, reads.clone(), facts);
    resolver.check_fillings(fillings, Some(skeleton));
    let slots = resolver.slots_of(skeleton, 0);
    let needs = resolver.needs_of(skeleton, 0);
    // A filling by itself may call the slot that it fills, so it gets a name of its own.
    let provides = skeleton
        .header
        .provides
        .as_ref()
        .filter(|_| skeleton.role() == Role::Filling);
    let slot = provides.and_then(|name| library.slot(&name.text));
    resolver.instances.push(Instance {
        module: skeleton,
        role: slot.iter().map(|_| "filling".to_owned()).collect(),
        slot,
        reads: BTreeMap::new(),
        slots,
        needs,
        constants: BTreeMap::new(),
        place: place.cloned(),
    });
    let unused = resolver.unused();
    let Resolver {
        mut instances,
        report,
        ..
    } = resolver;
    // What a module brings in is asked for where the module is.
    for index in (0..instances.len()).rev() {
        let parent = &instances[index];
        let place = parent.place.clone();
        let parts: Vec<usize> = parent
            .slots
            .iter()
            .map(|(_, i)| *i)
            .chain(parent.needs.iter().copied())
            .collect();
        for part in parts {
            if instances[part].place.is_none() {
                instances[part].place.clone_from(&place);
            }
        }
    }
    report.into_result(Instances {
        all: instances,
        reads,
        live: false,
        unused,
    })
}

/// Checks that a module has the functions of the slot that it says it fills.
pub(crate) fn check_filling(library: &Library, module: &Module) -> Report {
    let (fillings, facts) = (BTreeMap::new(), BTreeSet::new());
    let mut resolver = Resolver::new(library, &fillings, BTreeMap::new(), &facts);
    let slot = module
        .header
        .provides
        .as_ref()
        .and_then(|name| library.slot(&name.text));
    if let Some(slot) = slot {
        resolver.check_contract(module, slot, None);
    }
    resolver.report
}

impl<'l, 'r> Resolver<'l, 'r> {
    fn new(
        library: &'l Library,
        fillings: &'r BTreeMap<String, Filling>,
        reads: BTreeMap<String, String>,
        facts: &'r BTreeSet<String>,
    ) -> Self {
        Self {
            library,
            facts,
            scopes: vec![Scope {
                parent: None,
                fillings,
                role: Vec::new(),
                reads,
                key: None,
            }],
            instances: Vec::new(),
            shapes: HashMap::new(),
            needed: HashMap::new(),
            filled: HashMap::new(),
            defaults: HashMap::new(),
            defaulting: Vec::new(),
            needing: Vec::new(),
            depth: 0,
            report: Report::default(),
        }
    }

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
        let mut enclosing = BTreeSet::new();
        let mut next = Some(scope);
        while let Some(current) = next {
            let fillings: &'r BTreeMap<String, Filling> = self.scopes[current].fillings;
            let own = (current == scope).then_some(used.name.text.as_str());
            let named = own
                .into_iter()
                .chain([used.slot.text.as_str()])
                .find_map(|name| fillings.get_key_value(name));
            if let Some((name, filling)) = named {
                let key = (current, name.clone());
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
                        self.filled.insert(key.clone(), Filled::InProgress);
                        let instance = self.fill(filling, slot, name, current);
                        self.filled
                            .insert(key, instance.map_or(Filled::Failed, Filled::Done));
                        return instance;
                    }
                }
            }
            enclosing.extend(self.scopes[current].key.clone());
            next = self.scopes[current].parent;
        }
        self.default_of(slot, used, scope)
    }

    /// The filling that facts choose, or the slot's own body.
    fn default_of(&mut self, slot: &'l Module, used: &SlotUse, scope: usize) -> Option<usize> {
        let key = (slot.path.clone(), scope);
        if let Some(instance) = self.defaults.get(&key) {
            return Some(*instance);
        }
        if self.defaulting.contains(&slot.path) {
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
        self.defaulting.push(slot.path.clone());
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
            key: Some((scope, name.to_owned())),
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

    /// An instance of a module within a scope, or the one there is already that is just like it.
    fn instance(
        &mut self,
        module: &'l Module,
        slot: Option<&'l Module>,
        role: Vec<String>,
        scope: usize,
        asked: Asked,
    ) -> usize {
        let slots = self.slots_of(module, scope);
        let needs = self.needs_of(module, scope);
        let reads = self.reads_of(module, scope);
        let parts = slots
            .iter()
            .map(|(_, i)| *i)
            .chain(needs.iter().copied())
            .collect();
        let shape = (
            module.path.clone(),
            slot.map(|s| s.path.clone()),
            reads.clone(),
            parts,
        );
        // Every filling has numbers of its own; a default has the defaults everywhere.
        let numbers = slot.is_some() && module.numbers().next().is_some();
        let (shareable, place) = match asked {
            Asked::ByDefault => (true, None),
            Asked::At(place) => (!numbers, place),
        };
        if let Some(&there) = self.shapes.get(&shape).filter(|_| shareable) {
            return there;
        }
        self.instances.push(Instance {
            module,
            role,
            slot,
            reads,
            slots,
            needs,
            constants: BTreeMap::new(),
            place: place.cloned(),
        });
        if shareable {
            self.shapes.insert(shape, self.instances.len() - 1);
        }
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
                    .at(&need.place, "closes the circle")
                    .with_help("move what both use into a module of its own"),
                );
                continue;
            }
            let key = (need.text.clone(), scope);
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
    fn enter(&mut self, name: &Name) -> bool {
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
    fn reads_of(&self, module: &Module, scope: usize) -> BTreeMap<String, String> {
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
    fn unused(&self) -> Report {
        let mut report = Report::default();
        for (index, scope) in self.scopes.iter().enumerate() {
            for (name, filling) in scope.fillings {
                if self.filled.contains_key(&(index, name.clone())) {
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
                report.add(unused);
            }
        }
        report
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
