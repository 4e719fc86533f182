//! Concatenation: every instance's reachable items, under names that are unique in the shader.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::fmt::Write as _;
use std::ops::Range;
use std::sync::Arc;

use meniscus_source::{Diagnostic, Place, Report, SourceFile};

use crate::entry;
use crate::instance::{Instance, Instances, variables};
use crate::lexer::{Kind, tokens};
use crate::library::Module;
use crate::outline::{Item, ItemKind};

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
        let index = self.segments.partition_point(|s| s.range.end <= range.start);
        let first = self.segments.get(index).filter(|s| s.range.start <= range.start)?;
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
    /// The `override` of each number, by the number's path.
    pub overrides: BTreeMap<String, String>,
    /// For each name that was changed, what was written.
    pub originals: BTreeMap<String, String>,
    pub entry: crate::shader::Entry,
    pub attributes: Vec<crate::shader::Attribute>,
    pub outputs: Vec<String>,
    /// The modules in the shader, and where a pipeline asked for them.
    pub modules: Vec<(String, Option<Place>)>,
}

/// The names of one instance: what it writes → what stands in the shader.
type Names = HashMap<String, String>;

pub(crate) fn write(instances: &Instances, entry: entry::Written) -> Result<Written, Report> {
    let names = name_all(instances);
    let mut report = Report::default();
    let all = collect(instances, &names, &mut report);
    let reached = reach(&all, &entry.text);
    report.into_result(())?;

    let mut source = Source::default();
    for item in all.iter().flat_map(|part| &part.directives) {
        if !source.text.contains(&item.file.text[item.range.clone()]) {
            source.copy(&item.file, item.range.clone());
            source.text.push('\n');
        }
    }
    let mut written = BTreeSet::new();
    for (index, part) in all.iter().enumerate() {
        let instance = &instances.all[index];
        let wanted: Vec<_> = part
            .items
            .iter()
            .filter(|(name, _)| reached.contains(name.as_str()))
            .filter(|(name, item)| {
                // The same resource may be declared by several modules.
                !matches!(item.kind, ItemKind::Variable { .. }) || written.insert(name.clone())
            })
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
            copy_item(&mut source, instance.module, item, &names[index]);
            source.text.push_str("\n\n");
        }
    }
    let _ = write!(source.text, "// ---- entry points\n{}", entry.text);

    // The entry points' own variables are connected like everything that is shared.
    let mut resources = instances.reads.clone();
    let mut overrides = BTreeMap::new();
    let mut originals = BTreeMap::new();
    for (instance, names) in instances.all.iter().zip(&names) {
        for name in variables(instance.module) {
            let resource = instance.reads.get(name).map_or(name, String::as_str);
            resources.insert(names[name].clone(), resource.to_owned());
        }
        for number in instance.module.overrides() {
            let path = match instance.role.is_empty() {
                true => number.name.clone(),
                false => format!("{}.{}", instance.role.join("."), number.name),
            };
            overrides.insert(path, names[&number.name].clone());
        }
        for (original, name) in names.iter().filter(|(a, b)| a != b) {
            originals.entry(name.clone()).or_insert_with(|| original.clone());
        }
    }
    Ok(Written {
        source,
        resources,
        overrides,
        originals,
        entry: entry.entry,
        attributes: entry.attributes,
        outputs: entry.outputs,
        modules: instances
            .all
            .iter()
            .map(|i| (i.module.path.clone(), i.place.clone()))
            .collect(),
    })
}

/// The name of a slot's function for who calls the slot by `own`: the slot's main function has the
/// caller's name for the slot, the others have it in front.
fn slot_function(slot: &Module, function: &str, own: &str) -> String {
    if function == slot.leaf() {
        own.to_owned()
    } else if own == slot.leaf() {
        function.to_owned()
    } else {
        format!("{own}_{function}")
    }
}

/// Names for everything that every instance writes.
fn name_all(instances: &Instances) -> Vec<Names> {
    let mut copies: HashMap<&str, usize> = HashMap::new();
    let mut all: Vec<Names> = Vec::new();
    for instance in &instances.all {
        let copy = copies.entry(&instance.module.path).or_default();
        *copy += 1;
        let mut names = Names::new();
        // What is needed comes first: an instance's own names hide it.
        for &needed in &instance.needs {
            names.extend(all[needed].iter().map(|(k, v)| (k.clone(), v.clone())));
        }
        for item in &instance.module.outline.items {
            let name = own_name(instance, item, *copy, &instances.reads);
            names.insert(item.name.clone(), name);
        }
        for (used, filling) in &instance.slots {
            let filled = &instances.all[*filling];
            let Some(slot) = filled.slot else { continue };
            for function in slot.functions() {
                names.insert(
                    slot_function(slot, &function.name, &used.name.text),
                    all[*filling][&function.name].clone(),
                );
            }
        }
        all.push(names);
    }
    all
}

/// The name of an item of an instance, `copy` counting the instances of its module from 1.
///
/// A variable keeps its name unless this instance is connected otherwise than the whole shader.
fn own_name(
    instance: &Instance,
    item: &Item,
    copy: usize,
    shared: &BTreeMap<String, String>,
) -> String {
    let role = instance.role.join("_");
    let name = &item.name;
    match (&item.kind, instance.slot) {
        (ItemKind::Function { .. }, Some(slot)) if slot.item(name).is_some() => {
            slot_function(slot, name, &role)
        }
        (ItemKind::Variable { .. }, _) => match instance.reads.get(name) {
            Some(resource) if shared.get(name) != Some(resource) => format!("{name}_from_{}", identifier(resource)),
            _ => name.clone(),
        },
        (ItemKind::Override { .. }, _) if !role.is_empty() => format!("{role}_{name}"),
        _ if copy > 1 => format!("{name}_{copy}"),
        _ => name.clone(),
    }
}

/// A resource's name as a part of an identifier.
fn identifier(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect()
}

/// An instance's items under their names in the shader.
struct Part<'l> {
    items: Vec<(String, &'l Item)>,
    directives: Vec<Place>,
    /// For each item, the shader's names it mentions.
    mentions: Vec<Vec<String>>,
}

fn collect<'l>(instances: &Instances<'l>, names: &[Names], report: &mut Report) -> Vec<Part<'l>> {
    let mut declared: HashMap<String, (&Module, &Item)> = HashMap::new();
    let mut all = Vec::new();
    for (instance, names) in instances.all.iter().zip(names) {
        let module = instance.module;
        let mut part = Part {
            items: Vec::new(),
            directives: module.outline.directives.iter().map(|d| module.place(d.clone())).collect(),
            mentions: Vec::new(),
        };
        for item in &module.outline.items {
            let name = names[&item.name].clone();
            match declared.get(&name) {
                Some((other, first)) => {
                    let same = matches!(item.kind, ItemKind::Variable { .. }) && item.kind == first.kind;
                    if !same {
                        report.add(redefinition(module, item, other, first));
                    }
                }
                None => {
                    declared.insert(name.clone(), (module, item));
                }
            }
            let mentions = module.outline.tokens[item.tokens.clone()]
                .iter()
                .filter(|token| token.kind == Kind::Word)
                .map(|token| &module.file.text[token.range.clone()])
                .map(|word| names.get(word).map_or(word, String::as_str).to_owned());
            part.mentions.push(mentions.collect());
            part.items.push((name, item));
        }
        all.push(part);
    }
    all
}

fn redefinition(module: &Module, item: &Item, other: &Module, first: &Item) -> Diagnostic {
    let what = match item.kind {
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
        ItemKind::Variable { .. } => diagnostic.with_help("give one of them another name, or the same type"),
        _ => diagnostic.with_help("rename one, or move it into a module that both need"),
    }
}

/// The names that the entry points reach.
fn reach<'p>(all: &'p [Part], entry: &'p str) -> BTreeSet<&'p str> {
    let mut mentions: HashMap<&str, &[String]> = HashMap::new();
    let mut open: Vec<&str> = Vec::new();
    for part in all {
        for ((name, item), mentioned) in part.items.iter().zip(&part.mentions) {
            mentions.insert(name, mentioned);
            if item.kind == ItemKind::Assertion {
                open.push(name);
            }
        }
    }
    open.extend(tokens(entry).into_iter().map(|t| &entry[t.range]));
    let mut reached = BTreeSet::new();
    while let Some(name) = open.pop() {
        if let Some(mentioned) = mentions.get(name)
            && reached.insert(name)
        {
            open.extend(mentioned.iter().map(String::as_str));
        }
    }
    reached
}

/// Copies an item and the comment above it, with its words renamed.
fn copy_item(source: &mut Source, module: &Module, item: &Item, names: &Names) {
    let file = &module.file;
    let mut at = comment_start(module, item.range.start);
    let tokens = &module.outline.tokens[item.tokens.clone()];
    let is_struct = matches!(item.kind, ItemKind::Struct(_));
    for (index, token) in tokens.iter().enumerate() {
        if token.kind != Kind::Word {
            continue;
        }
        let mark = |at: Option<usize>| at.and_then(|i| tokens.get(i)).map(|t| t.kind);
        let member = mark(index.checked_sub(1)) == Some(Kind::Mark('.'))
            || mark(index.checked_sub(1)) == Some(Kind::Mark('@'))
            // A member's declaration, but not the type after the colon.
            || (is_struct && index > 1 && mark(Some(index + 1)) == Some(Kind::Mark(':')));
        let word = &file.text[token.range.clone()];
        match names.get(word).filter(|name| !member && *name != word) {
            Some(name) => {
                source.copy(file, at..token.range.start);
                source.rename(file, token.range.clone(), name);
                at = token.range.end;
            }
            None => continue,
        }
    }
    source.copy(file, at..item.range.end);
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
