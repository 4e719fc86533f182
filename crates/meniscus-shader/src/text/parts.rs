//! What instances declare, what that mentions, and what is wrong with either.

use meniscus_source::{Diagnostic, Place, Report};
use rustc_hash::{FxHashMap as HashMap, FxHashSet as HashSet};

use crate::instance::{Instance, Instances};
use crate::library::{Module, Role};
use crate::names::Names;
use crate::outline::{Item, ItemKind, Outline};
use crate::predeclared::is_predeclared;

/// An instance's items under their names in the shader.
pub(super) struct Part<'p> {
    pub items: Vec<Named<'p>>,
    pub directives: Vec<Place>,
}

/// An item under its name in the shader.
pub(super) struct Named<'p> {
    pub name: &'p str,
    pub item: &'p Item,
    module: &'p Module,
    names: &'p Names,
    /// Whether a word of it has another name in the shader.
    pub renamed: bool,
    /// The shader's names it mentions.
    mentions: Vec<Mention<'p>>,
    /// The words that are the names of nothing that its module may use.
    others: Vec<&'p str>,
}

/// A name that something mentions, and whether it is called there.
pub(super) type Mention<'p> = (&'p str, bool);

pub(super) fn collect<'p>(
    instances: &'p Instances,
    names: &'p [Names],
    report: &mut Report,
) -> Vec<Part<'p>> {
    let count = |instance: &Instance| instance.module.outline.items.len();
    let mut declared: Declared = HashMap::with_capacity_and_hasher(
        instances.all.iter().map(count).sum(),
        Default::default(),
    );
    let mut all = Vec::with_capacity(instances.all.len());
    for (instance, names) in instances.all.iter().zip(names) {
        let module = instance.module;
        let directives = module.outline.directives.iter();
        let mut part = Part {
            items: Vec::with_capacity(module.outline.items.len()),
            directives: directives.map(|d| module.place(d.clone())).collect(),
        };
        for item in &module.outline.items {
            let named = named(module, item, names);
            match declared.get(named.name) {
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
                    declared.insert(named.name, (module, item));
                }
            }
            part.items.push(named);
        }
        all.push(part);
    }
    let mut seen = HashSet::default();
    for (instance, part) in instances.all.iter().zip(&all) {
        if seen.insert(instance.module.path.as_str()) {
            check_needs(instance.module, part, &declared, report);
        }
    }
    all
}

/// What a module's item is called and what it mentions.
fn named<'p>(module: &'p Module, item: &'p Item, names: &'p Names) -> Named<'p> {
    let mut named = Named {
        name: &names[item.name.as_str()],
        item,
        module,
        names,
        renamed: false,
        mentions: Vec::with_capacity(item.spellings.len()),
        others: Vec::new(),
    };
    for (word, spelling) in Outline::spelt(&module.file.text, item) {
        let name = names.get(word).map(|name| &**name);
        named.renamed |= name.is_some_and(|name| name != word);
        match name {
            Some(name) => named.mentions.push((name, spelling.called)),
            None => named.others.push(word),
        }
    }
    named
}

/// Who declares what, by the names in the shader.
type Declared<'p> = HashMap<&'p str, (&'p Module, &'p Item)>;

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
fn check_needs(module: &Module, part: &Part, declared: &Declared, report: &mut Report) {
    let text = &module.file.text;
    let stranger = |item: &Item, word: &str| {
        let (owner, _) = declared.get(word)?;
        let own = owner.path == module.path || is_predeclared(word);
        let mut locals = module.outline.locals(text, item);
        (!own && !locals.any(|local| local == word)).then_some(*owner)
    };
    for Named { item, others, .. } in &part.items {
        let owned = others.iter().map(|word| (*word, stranger(item, word)));
        let strangers: Vec<_> = owned.filter_map(|(w, owner)| Some((w, owner?))).collect();
        if strangers.is_empty() {
            continue;
        }
        for &index in &item.words {
            let range = module.outline.tokens[index].range.clone();
            let Some((word, owner)) = strangers.iter().find(|(w, _)| **w == text[range.clone()])
            else {
                continue;
            };
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
pub(super) fn reach<'p>(all: &[Part<'p>], open: Vec<Mention<'p>>) -> HashSet<&'p str> {
    let items = || all.iter().flat_map(|part| &part.items);
    let mut known: HashMap<&str, &Named> =
        HashMap::with_capacity_and_hasher(items().count(), Default::default());
    for named in items() {
        known.entry(named.name).or_insert(named);
    }
    let is_function = |name: &str| {
        let named = known.get(name);
        named.is_some_and(|named| matches!(named.item.kind, ItemKind::Function { .. }))
    };
    // A name that is not called is no function's in the entry points, and elsewhere none where a
    // local variable has it.
    let meant = |(name, called): &Mention<'p>| (*called || !is_function(name)).then_some(*name);
    let mut waiting: Vec<&str> = open.iter().filter_map(meant).collect();
    let assertions = items().filter(|named| named.item.kind == ItemKind::Assertion);
    waiting.extend(assertions.map(|named| named.name));
    let mut reached = HashSet::default();
    while let Some(name) = waiting.pop() {
        if let Some(named) = known.get(name)
            && reached.insert(name)
        {
            for mention in &named.mentions {
                if meant(mention).is_some() || !named.has_local(mention.0) {
                    waiting.push(mention.0);
                }
            }
        }
    }
    reached
}

impl Named<'_> {
    /// Whether a word that has a name in the shader is a local variable's or a parameter's.
    fn has_local(&self, name: &str) -> bool {
        let Self { module, names, .. } = self;
        let mut locals = module.outline.locals(&module.file.text, self.item);
        locals.any(|local| names.get(local).is_some_and(|named| **named == *name))
    }
}
