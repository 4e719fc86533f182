//! Concatenation: every instance's reachable items, under names that are unique in the shader.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::ops::Range;
use std::sync::Arc;

use meniscus_source::{Diagnostic, Place, Report, SourceFile};

use rustc_hash::{FxHashMap as HashMap, FxHashSet as HashSet};

use crate::entry;
use crate::instance::{Instance, Instances, variables};
use crate::lexer::tokens;
use crate::library::{Module, Role};
use crate::names::{Names, name_all};
use crate::outline::{Item, ItemKind, Outline};
use crate::predeclared::is_predeclared;

/// A composed text, and where each part of it came from.
#[derive(Debug, Default)]
pub(crate) struct Source {
    pub text: String,
    segments: Vec<Segment>,
}

#[derive(Debug)]
struct Segment {
    /// Bytes of the composed text.
    range: Range<usize>,
    /// Where they stand in what the user wrote.
    place: Place,
    /// Whether each byte maps onto one; otherwise (a renamed word) the whole onto the whole.
    exact: bool,
}

impl Source {
    fn copy(&mut self, file: &Arc<SourceFile>, range: Range<usize>) {
        let start = self.text.len();
        self.text.push_str(&file.text[range.clone()]);
        self.segments.push(Segment {
            range: start..self.text.len(),
            place: Place::new(file, range),
            exact: true,
        });
    }

    fn rename(&mut self, file: &Arc<SourceFile>, range: Range<usize>, name: &str) {
        let start = self.text.len();
        self.text.push_str(name);
        self.segments.push(Segment {
            range: start..self.text.len(),
            place: Place::new(file, range),
            exact: false,
        });
    }

    /// Where a range of the composed text was written.
    pub fn origin(&self, range: Range<usize>) -> Option<Place> {
        let index = self
            .segments
            .partition_point(|s| s.range.end <= range.start);
        let Some(first) = self
            .segments
            .get(index)
            .filter(|s| s.range.start <= range.start)
        else {
            // Right behind a part, where something is missing, the part's end is meant.
            let before = self.segments.get(index.checked_sub(1)?)?;
            let gap = self.text.get(before.range.end..range.start)?;
            let end = before.place.range.end;
            return gap
                .trim()
                .is_empty()
                .then(|| Place::new(&before.place.file, end..end));
        };
        let start = match first.exact {
            true => first.place.range.start + (range.start - first.range.start),
            false => first.place.range.start,
        };
        // The end may lie in a later segment of the same file.
        let end = self.segments[index..]
            .iter()
            .take_while(|s| s.range.start < range.end && s.place.file == first.place.file)
            .last()
            .map_or(first.place.range.end, |last| match last.exact {
                true => last.place.range.start + (range.end.min(last.range.end) - last.range.start),
                false => last.place.range.end,
            });
        Some(Place::new(&first.place.file, start..end.max(start)))
    }
}

/// A shader's text, before naga has seen it.
#[derive(Debug)]
pub(crate) struct Written {
    pub source: Source,
    /// The resource that each variable is connected to.
    pub resources: BTreeMap<String, String>,
    /// The longest chain on which naga will recurse.
    pub chain: usize,
    /// Where each variable's declaration begins in the text, in order, and its name there.
    pub variables: Vec<(usize, String)>,
    /// Where each variable is declared.
    pub declarations: BTreeMap<String, Place>,
    /// The `override` of each number, by the number's path.
    pub overrides: BTreeMap<String, String>,
    /// For each name that was changed, what was written.
    pub originals: BTreeMap<String, String>,
    pub entry: crate::shader::Entry,
    pub attributes: Vec<crate::shader::Attribute>,
    pub outputs: Vec<String>,
    /// Where the entry points begin in the text, and what writes them again.
    pub entry_start: usize,
    pub drawing: Option<entry::Drawing>,
    /// The modules in the shader, and where a pipeline asked for them.
    pub modules: Vec<(String, Option<Place>)>,
    /// Where the skeleton says what it is: for what only shows in the entry points.
    pub skeleton: Option<Place>,
}

/// Writes what the entry points reach.
///
/// # Errors
/// When two modules declare one name, or one uses a name without needing who declares it.
pub(crate) fn write(instances: &Instances, entry: entry::Written) -> Result<Written, Report> {
    let reached_first = tokens(&entry.text)
        .into_iter()
        .map(|t| &entry.text[t.range])
        .collect();
    let mut written = concatenate(instances, Some(reached_first))?;
    written.source.text.push_str("// ---- entry points\n");
    let start = written.source.text.len();
    written.source.text.push_str(&entry.text);
    for item in Outline::of(&entry.text).items {
        if matches!(item.kind, ItemKind::Variable { .. }) {
            written
                .variables
                .push((start + item.range.start, item.name));
        }
    }
    written.entry = entry.entry;
    written.attributes = entry.attributes;
    written.outputs = entry.outputs;
    written.entry_start = start;
    written.drawing = entry.drawing;
    Ok(written)
}

/// Writes the last instance with all that it declares, reached or not, and no entry points.
///
/// # Errors
/// As [`write`].
pub(crate) fn write_module(instances: &Instances) -> Result<Written, Report> {
    concatenate(instances, None)
}

/// Writes what is reached from the open names, or from all of the last instance's.
fn concatenate(instances: &Instances, open: Option<Vec<&str>>) -> Result<Written, Report> {
    let names = name_all(instances);
    let mut report = Report::default();
    let all = collect(instances, &names, &mut report);
    report.into_result(())?;
    let last = || {
        all.last()
            .into_iter()
            .flat_map(|part| part.items.iter().map(|(name, _)| *name))
            .collect()
    };
    let reached = reach(&all, open.unwrap_or_else(last));

    let mut source = Source::default();
    let mut directives = BTreeSet::new();
    for part in all
        .iter()
        .filter(|part| part.items.iter().any(|(name, _)| reached.contains(name)))
    {
        for place in &part.directives {
            if directives.insert(place.text().split_whitespace().collect::<String>()) {
                source.copy(&place.file, place.range.clone());
                source.text.push('\n');
            }
        }
    }
    let mut written = HashSet::default();
    let mut variable_starts = Vec::new();
    let mut chain = 0;
    let mut report = Report::default();
    for (index, part) in all.iter().enumerate() {
        let instance = &instances.all[index];
        // Several instances may share an item, and several modules a resource.
        let wanted: Vec<_> = part
            .items
            .iter()
            .filter(|(name, _)| reached.contains(name) && written.insert(*name))
            .collect();
        if wanted.is_empty() {
            continue;
        }
        let role = match instance.role.is_empty() {
            true => String::new(),
            false => format!(" ({})", instance.role.join(".")),
        };
        let _ = writeln!(source.text, "// ---- {}{role}", instance.module.path);
        for (_, item) in wanted {
            chain = chain.max(item.chain.0);
            if item.chain.0 > MAX_CHAIN {
                report.add(too_long(instance.module, item));
            }
            let start = copy_item(&mut source, instance.module, item, &names[index]);
            if matches!(item.kind, ItemKind::Variable { .. }) {
                variable_starts.push((start, names[index][item.name.as_str()].to_string()));
            }
            source.text.push_str("\n\n");
        }
    }

    report.into_result(())?;

    // The entry points' own variables are connected like everything that is shared.
    let mut resources = instances.reads.clone();
    let mut declarations = BTreeMap::new();
    let mut overrides = BTreeMap::new();
    let mut originals = BTreeMap::new();
    for (instance, names) in instances.all.iter().zip(&names) {
        for name in variables(instance.module) {
            let shared = instances.reads.get(name).map_or(name, String::as_str);
            let resource = instance.reads.get(name).map_or(shared, String::as_str);
            resources.insert(names[name].to_string(), resource.to_owned());
            if let Some(item) = instance.module.item(name) {
                let place = instance.module.place(item.name_range.clone());
                declarations.entry(names[name].to_string()).or_insert(place);
            }
        }
        for number in instance.module.overrides() {
            let path = match instance.role.is_empty() {
                true => number.name.clone(),
                false => format!("{}.{}", instance.role.join("."), number.name),
            };
            overrides.insert(path, names[number.name.as_str()].to_string());
        }
        for (original, name) in names.iter().filter(|(a, b)| a != b) {
            let known = originals
                .entry(name.to_string())
                .or_insert_with(|| original.to_string());
            // Several callers may have names of their own for it: take the same one every time.
            if **original < **known {
                *known = original.to_string();
            }
        }
    }
    let skeleton = instances.all.last().map(|instance| {
        let header = &instance.module.header;
        match &header.skeleton {
            Some(kind) => kind.place.clone(),
            None => instance.module.place(0..0),
        }
    });
    Ok(Written {
        source,
        chain,
        variables: variable_starts,
        resources,
        declarations,
        overrides,
        originals,
        entry: crate::shader::Entry::Compute {
            name: String::new(),
            workgroup: [1; 3],
        },
        attributes: Vec::new(),
        outputs: Vec::new(),
        entry_start: 0,
        drawing: None,
        modules: instances
            .all
            .iter()
            .map(|i| (i.module.path.clone(), i.place.clone()))
            .collect(),
        skeleton,
    })
}

/// An instance's items under their names in the shader.
struct Part<'p> {
    items: Vec<(&'p str, &'p Item)>,
    directives: Vec<Place>,
    /// For each item, the shader's names it mentions.
    mentions: Vec<Vec<&'p str>>,
}

fn collect<'p>(instances: &'p Instances, names: &'p [Names], report: &mut Report) -> Vec<Part<'p>> {
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

fn too_long(module: &Module, item: &Item) -> Diagnostic {
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
fn reach<'p>(all: &[Part<'p>], mut open: Vec<&'p str>) -> HashSet<&'p str> {
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

/// Copies an item and the comment above it, with its words renamed. Returns where the item itself
/// begins in the composed text.
fn copy_item(source: &mut Source, module: &Module, item: &Item, names: &Names) -> usize {
    let file = &module.file;
    let mut at = comment_start(module, item.range.start);
    let start = source.text.len() + (item.range.start - at);
    for &index in &item.words {
        let range = module.outline.tokens[index].range.clone();
        let word = &file.text[range.clone()];
        if let Some(name) = names.get(word).filter(|name| ***name != *word) {
            source.copy(file, at..range.start);
            source.rename(file, range.clone(), name);
            at = range.end;
        }
    }
    source.copy(file, at..item.range.end);
    start
}

/// Where the comment lines right above an item begin; the module's header is not among them.
fn comment_start(module: &Module, item: usize) -> usize {
    let text = &module.file.text;
    let mut start = item;
    while let Some(line_end) = text[..start].strip_suffix('\n').map(str::len) {
        let line_start = text[..line_end].rfind('\n').map_or(0, |at| at + 1);
        let is_comment = text[line_start..line_end].trim_start().starts_with("//");
        if !is_comment || line_start < module.header_range.end {
            break;
        }
        start = line_start;
    }
    start
}
