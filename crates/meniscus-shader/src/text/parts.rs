//! What instances declare, what that mentions, and what is wrong with either.

use std::collections::BTreeSet;

use meniscus_source::{Diagnostic, Place, Report};
use rustc_hash::{FxHashMap as HashMap, FxHashSet as HashSet};

use crate::instance::{Instance, Instances};
use crate::library::{Module, Role};
use crate::names::Names;
use crate::outline::{Item, ItemKind};
use crate::predeclared::is_predeclared;

/// An instance's items under their names in the shader.
pub(super) struct Part<'p> {
    pub items: Vec<(&'p str, &'p Item)>,
    pub directives: Vec<Place>,
    /// For each item, the shader's names it mentions.
    mentions: Vec<Vec<&'p str>>,
}

pub(super) fn collect<'p>(
    instances: &'p Instances,
    names: &'p [Names],
    report: &mut Report,
) -> Vec<Part<'p>> {
    let mut declared: HashMap<&str, (&Module, &Item)> = HashMap::default();
    let mut all = Vec::new();
    for (instance, names) in instances.all.iter().zip(names) {
        let module = instance.module;
        let mut part = Part {
            items: Vec::new(),
            directives: module
                .outline
                .directives
                .iter()
                .map(|d| module.place(d.clone()))
                .collect(),
            mentions: Vec::new(),
        };
        for item in &module.outline.items {
            let name = &*names[item.name.as_str()];
            match declared.get(name) {
                Some((other, first)) => {
                    let shared =
                        matches!(item.kind, ItemKind::Variable { .. }) && item.kind == first.kind;
                    // Items of one module that have one name are the same, unless it has two.
                    let same = other.path == module.path && item.range == first.range;
                    if !shared && !same {
                        report.add(redefinition(module, item, other, first));
                    }
                }
                None => {
                    declared.insert(name, (module, item));
                }
            }
            let mentions = item
                .spellings
                .iter()
                .map(|&index| &module.file.text[module.outline.tokens[index].range.clone()])
                .map(|word| names.get(word).map_or(word, |name| name));
            part.mentions.push(mentions.collect());
            part.items.push((name, item));
        }
        all.push(part);
    }
    let mut seen = BTreeSet::new();
    for (instance, names) in instances.all.iter().zip(names) {
        if seen.insert(&instance.module.path) {
            check_needs(instance, names, &declared, report);
        }
    }
    all
}

/// The longest chain of operators, accesses, brackets or `else if`s that is handed to naga.
pub(crate) const MAX_CHAIN: usize = 1000;

pub(super) fn too_long(module: &Module, item: &Item) -> Diagnostic {
    let token = &module.outline.tokens[item.chain.1];
    Diagnostic::error(format!(
        "more than {MAX_CHAIN} operators, `else`s and brackets in one go"
    ))
    .at(&module.place(token.range.clone()), "here it is longest")
    .with_help("split the expression into several, or use a loop or a switch")
}

/// A word that only another module's items are called by: naga would accept it as long as that
/// module happens to be in the shader.
fn check_needs(
    instance: &Instance,
    names: &Names,
    declared: &HashMap<&str, (&Module, &Item)>,
    report: &mut Report,
) {
    let module = instance.module;
    for item in &module.outline.items {
        for &index in &item.words {
            let range = module.outline.tokens[index].range.clone();
            let word = &module.file.text[range.clone()];
            let Some((owner, _)) = declared.get(word) else {
                continue;
            };
            if names.contains_key(word) || owner.path == module.path || is_predeclared(word) {
                continue;
            }
            if module
                .outline
                .locals(&module.file.text, item)
                .any(|l| l == word)
            {
                continue;
            }
            let wrong =
                Diagnostic::error(format!("`{}` uses `{word}` without saying so", module.path)).at(
                    &module.place(range),
                    format!("declared by `{}`", owner.path),
                );
            report.add(match owner.role() {
                Role::Shared => wrong.with_help(format!(
                    "add `{}` to `// needs: …` in {}",
                    owner.path, module.file.name
                )),
                _ => wrong.with_help(format!(
                    "call it by a slot (`// slots: …`), or move `{word}` into a module that both need"
                )),
            });
        }
    }
}

fn redefinition(module: &Module, item: &Item, other: &Module, first: &Item) -> Diagnostic {
    let what = match item.kind {
        _ if module.path == other.path => {
            return Diagnostic::error(format!("`{}` declares `{}` twice", module.path, item.name))
                .at(&module.place(item.name_range.clone()), "declared here")
                .see(&other.place(first.name_range.clone()), "and here");
        }
        ItemKind::Variable { .. } => "differently declare the resource",
        _ => "both declare",
    };
    let diagnostic = Diagnostic::error(format!(
        "`{}` and `{}` {what} `{}`",
        other.path, module.path, item.name
    ))
    .at(&module.place(item.name_range.clone()), "declared here")
    .see(&other.place(first.name_range.clone()), "and here");
    match item.kind {
        ItemKind::Variable { .. } => {
            diagnostic.with_help("give one of them another name, or the same type")
        }
        _ => diagnostic.with_help("rename one, or move it into a module that both need"),
    }
}

/// The names that are reached from the open ones.
pub(super) fn reach<'p>(all: &[Part<'p>], mut open: Vec<&'p str>) -> HashSet<&'p str> {
    let mut mentions: HashMap<&str, &[&str]> = HashMap::default();
    for part in all {
        for ((name, item), mentioned) in part.items.iter().zip(&part.mentions) {
            mentions.entry(name).or_insert(mentioned);
            if item.kind == ItemKind::Assertion {
                open.push(name);
            }
        }
    }
    let mut reached = HashSet::default();
    while let Some(name) = open.pop() {
        if let Some(mentioned) = mentions.get(name)
            && reached.insert(name)
        {
            open.extend(*mentioned);
        }
    }
    reached
}
