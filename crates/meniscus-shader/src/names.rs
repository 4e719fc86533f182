//! Names that are unique in a shader.
//!
//! An item keeps its written name where it can. It gets another one when it fills a slot (the
//! caller's name for the slot), when it is a number of a filling (the filling's role before it),
//! when it is connected to another resource than the whole shader's variable of its name, when
//! WGSL itself declares its name, and when another instance of its module has an item of that name
//! that is not the same.

use std::collections::BTreeMap;
use std::rc::Rc;

use rustc_hash::{FxHashMap as HashMap, FxHashSet as HashSet};

use crate::instance::{Instance, Instances};
use crate::library::Module;
use crate::numbers::LIVE_NUMBERS;
use crate::outline::{Item, ItemKind, Outline};
use crate::predeclared::{is_entry, is_predeclared};

/// The names of one instance: what it writes → what stands in the shader.
pub(crate) type Names = HashMap<Rc<str>, Rc<str>>;

/// The name of a slot's function for who calls the slot by `own`: the slot's main function has the
/// caller's name for the slot, the others have it in front.
pub(crate) fn slot_function(slot: &Module, function: &str, own: &str) -> String {
    if function == slot.leaf() {
        own.to_owned()
    } else if own == slot.leaf() {
        function.to_owned()
    } else {
        format!("{own}_{function}")
    }
}

/// Names for everything that every instance writes; and, for each that was changed, what was
/// written.
pub(crate) fn name_all(instances: &Instances) -> (Vec<Names>, BTreeMap<String, String>) {
    let mut seen = HashSet::default();
    let mut namer = Namer {
        firsts: instances
            .all
            .iter()
            .filter(|instance| seen.insert(instance.module.path.as_str()))
            .collect(),
        made: HashSet::default(),
        connected: HashMap::default(),
        originals: BTreeMap::new(),
    };
    let mut copies: HashMap<&str, Vec<usize>> = HashMap::default();
    let mut all: Vec<Names> = Vec::new();
    for (index, instance) in instances.all.iter().enumerate() {
        let others = copies.entry(&instance.module.path).or_default();
        let names = namer.instance(instances, instance, &all, others);
        others.push(index);
        all.push(names);
    }
    (all, namer.originals)
}

/// What an instance calls of its slots: its name for it, the filling, and the filling's own name.
fn slot_functions<'i>(
    instances: &'i Instances,
    instance: &'i Instance,
) -> impl Iterator<Item = (String, usize, &'i str)> {
    instance.slots.iter().flat_map(|(used, filling)| {
        let slot = instances.all[*filling].slot;
        slot.into_iter().flat_map(|slot| {
            slot.functions().map(|f| {
                (
                    slot_function(slot, &f.name, &used.name.text),
                    *filling,
                    f.name.as_str(),
                )
            })
        })
    })
}

struct Namer<'i> {
    /// An instance of each module.
    firsts: Vec<&'i Instance<'i>>,
    /// Names that were made up.
    made: HashSet<Rc<str>>,
    /// Names of variables by what was written and what they are connected to.
    connected: HashMap<(String, String), Rc<str>>,
    /// For each name that was changed, what was written.
    originals: BTreeMap<String, String>,
}

impl Namer<'_> {
    fn instance(
        &mut self,
        instances: &Instances,
        instance: &Instance,
        all: &[Names],
        others: &[usize],
    ) -> Names {
        let needed = instance.needs.iter().map(|&needed| all[needed].len());
        let count = needed.sum::<usize>() + instance.module.outline.items.len();
        let mut imported = Names::with_capacity_and_hasher(count, Default::default());
        for &needed in &instance.needs {
            imported.extend(all[needed].iter().map(|(k, v)| (k.clone(), v.clone())));
        }
        let called: Vec<(Rc<str>, Rc<str>)> = slot_functions(instances, instance)
            .filter_map(|(own, filling, function)| {
                Some((Rc::from(own), all[filling].get(function)?.clone()))
            })
            .collect();
        let mut names = imported;
        // An instance's own items hide what is needed, and its slots both.
        for item in &instance.module.outline.items {
            names.remove(item.name.as_str());
        }
        for (written, name) in &called {
            self.keep_original(written, name);
        }
        names.extend(called);
        let items = &instance.module.outline.items;
        let mut own: HashMap<&str, Rc<str>> = HashMap::default();
        for item in items {
            if let Some(name) = self.own_name(instance, item, instances) {
                own.insert(&item.name, name);
            }
        }
        for &other in others {
            let same = same_items(instance, &all[other], &names, &own);
            for item in items {
                if same.contains(item.name.as_str()) && !own.contains_key(item.name.as_str()) {
                    own.insert(&item.name, all[other][item.name.as_str()].clone());
                }
            }
        }
        for item in items {
            own.entry(&item.name).or_insert_with(|| match others.len() {
                0 if !is_predeclared(&item.name) && !is_entry(&item.name) => Rc::from(&*item.name),
                0 => self.fresh(&format!("{}_", item.name), instances),
                copies => self.fresh(&format!("{}_{}", item.name, copies + 1), instances),
            });
        }
        for (written, name) in &own {
            self.keep_original(written, name);
        }
        names.extend(
            own.into_iter()
                .map(|(written, name)| (Rc::from(written), name)),
        );
        names
    }

    fn keep_original(&mut self, written: &str, name: &str) {
        if written == name {
            return;
        }
        // naga speaks of the member alone.
        let name = name.rsplit('.').next().unwrap_or(name);
        match self.originals.get_mut(name) {
            // Several callers may have names of their own for it: take the same one every time.
            Some(known) if *written < **known => *known = written.to_owned(),
            Some(_) => {}
            None => {
                self.originals.insert(name.to_owned(), written.to_owned());
            }
        }
    }

    /// The name of an item that does not depend on other instances of its module.
    fn own_name(
        &mut self,
        instance: &Instance,
        item: &Item,
        instances: &Instances,
    ) -> Option<Rc<str>> {
        let role = instance.role.join("_");
        let name = &item.name;
        match (&item.kind, instance.slot) {
            (ItemKind::Function { .. }, Some(slot)) if slot.item(name).is_some() => {
                let wanted = slot_function(slot, name, &role);
                Some(if wanted == *name && !is_predeclared(name) {
                    wanted.into()
                } else {
                    self.fresh(&wanted, instances)
                })
            }
            (ItemKind::Variable { .. }, _) => {
                let resource = instance.reads.get(name);
                if resource.is_none() && !is_predeclared(name) {
                    return Some(Rc::from(&**name));
                }
                let resource = resource
                    .or(instances.reads.get(name))
                    .unwrap_or(name)
                    .clone();
                let key = (name.clone(), resource);
                if let Some(known) = self.connected.get(&key) {
                    return Some(known.clone());
                }
                let made = self.fresh(&format!("{name}_from_{}", identifier(&key.1)), instances);
                self.connected.insert(key, made.clone());
                Some(made)
            }
            (ItemKind::Override { .. }, _)
                if instances.live && instance.module.live(item).is_some() =>
            {
                Some(self.member(&role, name))
            }
            (ItemKind::Override { .. }, _) if !role.is_empty() => {
                Some(self.fresh(&format!("{role}_{name}"), instances))
            }
            (ItemKind::Constant { .. }, Some(_))
                if instance.module.header.number(name).is_some() =>
            {
                Some(self.fresh(&format!("{role}_{name}"), instances))
            }
            (ItemKind::Assertion, _) => Some(format!("{} {name}", instance.module.path).into()),
            _ => None,
        }
    }

    /// A member of the buffer of live numbers.
    fn member(&mut self, role: &str, name: &str) -> Rc<str> {
        let plain = match role {
            "" => name.to_owned(),
            role => format!("{role}_{name}"),
        };
        let mut member: Rc<str> = format!("{LIVE_NUMBERS}.{plain}").into();
        let mut number = 2;
        while !self.made.insert(member.clone()) {
            member = format!("{LIVE_NUMBERS}.{plain}_{number}").into();
            number += 1;
        }
        member
    }

    /// Whether a module writes a word, other than as the name by which it calls a slot: no name that
    /// is made up may be one of those, lest a local variable hide it.
    fn is_written(&self, word: &str, instances: &Instances) -> bool {
        self.firsts.iter().any(|instance| {
            let module = instance.module;
            module.outline.has_word(&module.file.text, word)
                && !slot_functions(instances, instance).any(|(own, ..)| own == word)
        })
    }

    /// A name that nothing else has.
    fn fresh(&mut self, wanted: &str, instances: &Instances) -> Rc<str> {
        let mut name = wanted.to_owned();
        let mut number = 2;
        while is_predeclared(&name)
            || is_entry(&name)
            || self.made.contains(name.as_str())
            || self.is_written(&name, instances)
        {
            name = format!("{wanted}_{number}");
            number += 1;
        }
        let name: Rc<str> = name.into();
        self.made.insert(name.clone());
        name
    }
}

/// The items of an instance that mean the same as in another instance of its module: every word in
/// them stands for the same.
fn same_items<'i>(
    instance: &'i Instance,
    other: &Names,
    imported: &Names,
    own: &HashMap<&str, Rc<str>>,
) -> HashSet<&'i str> {
    let items = &instance.module.outline.items;
    let text = &instance.module.file.text;
    let mut same: HashSet<&str> = items.iter().map(|item| item.name.as_str()).collect();
    // Which items mention an item of the module whose name is still open, and which differ of
    // themselves.
    let mut users: HashMap<&str, Vec<&str>> = HashMap::default();
    let mut differing = Vec::new();
    for item in items {
        for (word, _) in Outline::spelt(text, item) {
            let differs = match own.get(word) {
                Some(name) => other.get(word) != Some(name),
                None if same.contains(word) => {
                    users.entry(word).or_default().push(&item.name);
                    false
                }
                None => other.get(word) != imported.get(word),
            };
            if differs {
                differing.push(item.name.as_str());
            }
        }
    }
    while let Some(name) = differing.pop() {
        if same.remove(name) {
            differing.extend(users.remove(name).into_iter().flatten());
        }
    }
    same
}

/// A resource's name as a part of an identifier.
fn identifier(name: &str) -> String {
    name.chars()
        .map(|c| if c.is_alphanumeric() { c } else { '_' })
        .collect()
}
