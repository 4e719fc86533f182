//! Which modules a shader is made of: slots resolved to fillings, needs to modules, each once.
//!
//! The same module may stand in a shader more than once, with other numbers, other resources or
//! other fillings; each such *instance* gets names of its own when the text is written.

mod needs;
mod slots;

use std::collections::{BTreeMap, BTreeSet};

use meniscus_source::{Place, Report};
use rustc_hash::FxHashMap as HashMap;

use crate::filling::Filling;
use crate::header::SlotUse;
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
    key: Option<(usize, &'r str)>,
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
type Shape<'l> = (
    &'l str,
    Option<&'l str>,
    BTreeMap<String, String>,
    Vec<usize>,
);

pub(crate) struct Resolver<'l, 'r> {
    pub library: &'l Library,
    pub facts: &'r BTreeSet<String>,
    pub scopes: Vec<Scope<'r>>,
    pub instances: Vec<Instance<'l>>,
    /// Instances without numbers of their own, which stand once however often they are wanted.
    shapes: HashMap<Shape<'l>, usize>,
    /// Needed modules by path and scope.
    needed: HashMap<(&'l str, usize), usize>,
    /// Filled slots by scope and name; none while they are being resolved, or when they failed.
    filled: HashMap<(usize, &'r str), Filled>,
    /// Slots filled by default, by path and scope.
    defaults: HashMap<(&'l str, usize), usize>,
    /// Slots whose default is being resolved.
    defaulting: Vec<&'l str>,
    needing: Vec<&'l str>,
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
            shapes: HashMap::default(),
            needed: HashMap::default(),
            filled: HashMap::default(),
            defaults: HashMap::default(),
            defaulting: Vec::new(),
            needing: Vec::new(),
            depth: 0,
            report: Report::default(),
        }
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
        // Every filling has numbers of its own; a default has the defaults everywhere.
        let numbers = slot.is_some() && module.numbers().next().is_some();
        let (shareable, place) = match asked {
            Asked::ByDefault => (true, None),
            Asked::At(place) => (!numbers, place),
        };
        let shape: Shape = (
            module.path.as_str(),
            slot.map(|s| s.path.as_str()),
            reads.clone(),
            parts,
        );
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
