//! Concatenation: every instance's reachable items, under names that are unique in the shader.

mod parts;
mod source;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::ops::Range;

use meniscus_source::{Place, Report};
use rustc_hash::FxHashSet as HashSet;

use crate::entry;
use crate::instance::{Instance, Instances, variables};
use crate::library::Module;
use crate::names::{Names, name_all};
use crate::numbers::{Bounds, LIVE_NUMBERS, LIVE_TYPE, literal};
use crate::outline::{Item, ItemKind, Outline};
use crate::shader::LiveNumber;
pub(crate) use parts::MAX_CHAIN;
use parts::{Mention, Named, collect, reach, too_long};
pub(crate) use source::Source;

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
    /// Where the functions and variables stand in the text, with the comments above them.
    pub items: Vec<(Range<usize>, String)>,
    /// Where each variable is declared.
    pub declarations: BTreeMap<String, Place>,
    /// The `override` of each number, by the number's path.
    pub overrides: BTreeMap<String, String>,
    /// The numbers that stand in a buffer, in the order of their members; where, is not yet known.
    pub live: Vec<LiveNumber>,
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
    let outline = Outline::of(&entry.text);
    let items = outline.items.iter();
    let mentions = items.flat_map(|item| Outline::spelt(&entry.text, item));
    let reached_first = mentions.map(|(word, s)| (word, s.called)).collect();
    let mut written = concatenate(instances, Some(reached_first))?;
    written.source.text.push_str("// ---- entry points\n");
    let start = written.source.text.len();
    written.source.text.push_str(&entry.text);
    for item in outline.items {
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
fn concatenate(instances: &Instances, open: Option<Vec<Mention>>) -> Result<Written, Report> {
    let (names, originals) = name_all(instances);
    let mut report = Report::default();
    let all = collect(instances, &names, &mut report);
    report.into_result(())?;
    let last = || {
        all.last()
            .into_iter()
            .flat_map(|part| part.items.iter().map(|named| (named.name, true)))
            .collect()
    };
    let reached = reach(&all, open.unwrap_or_else(last));

    let mut source = Source::default();
    let mut directives = BTreeSet::new();
    for part in all
        .iter()
        .filter(|part| !part.directives.is_empty())
        .filter(|part| part.items.iter().any(|named| reached.contains(named.name)))
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
    let mut live = Vec::new();
    let mut items = Vec::new();
    let mut chain = 0;
    let mut report = Report::default();
    for (index, part) in all.iter().enumerate() {
        let instance = &instances.all[index];
        // Several instances may share an item, and several modules a resource.
        let mut wanted: Vec<_> = part
            .items
            .iter()
            .filter(|named| reached.contains(named.name) && written.insert(named.name))
            .collect();
        wanted.retain(|Named { name, item, .. }| {
            let number = instances.live.then(|| live_number(instance, item, name));
            let number = number.flatten();
            let stays = number.is_none();
            live.extend(number);
            stays
        });
        if wanted.is_empty() {
            continue;
        }
        let role = match instance.role.is_empty() {
            true => String::new(),
            false => format!(" ({})", instance.role.join(".")),
        };
        let _ = writeln!(source.text, "// ---- {}{role}", instance.module.path);
        for named in wanted {
            let item = named.item;
            chain = chain.max(item.chain.0);
            if item.chain.0 > MAX_CHAIN {
                report.add(too_long(instance.module, item));
            }
            let before = source.text.len();
            let start = copy_item(&mut source, instance, named, &names[index]);
            if matches!(item.kind, ItemKind::Variable { .. }) {
                variable_starts.push((start, named.name.to_owned()));
            }
            source.text.push_str("\n\n");
            if matches!(
                item.kind,
                ItemKind::Function { .. } | ItemKind::Variable { .. }
            ) {
                items.push((before..source.text.len(), named.name.to_owned()));
            }
        }
    }

    report.into_result(())?;
    live.sort_by(|a, b| a.name.cmp(&b.name));
    variable_starts.extend(write_live(&mut source, &live));

    // The entry points' own variables are connected like everything that is shared.
    let mut resources = instances.reads.clone();
    resources.insert(LIVE_NUMBERS.to_owned(), LIVE_NUMBERS.to_owned());
    let mut declarations = BTreeMap::new();
    let mut overrides = BTreeMap::new();
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
        for number in instance.module.numbers() {
            let is_override = matches!(number.kind, ItemKind::Override { .. });
            if is_override && !(instances.live && instance.module.live(number).is_some()) {
                let name = names[number.name.as_str()].to_string();
                overrides.insert(path_of(instance, number), name);
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
        items,
        resources,
        declarations,
        overrides,
        live,
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

/// A number's path: the slots that lead to its instance, and its name.
fn path_of(instance: &Instance, number: &Item) -> String {
    match instance.role.is_empty() {
        true => number.name.clone(),
        false => format!("{}.{}", instance.role.join("."), number.name),
    }
}

/// A number that is a member of the buffer of live ones, under its name in the shader.
fn live_number(instance: &Instance, item: &Item, name: &str) -> Option<LiveNumber> {
    let module = instance.module;
    module.live(item)?;
    let Bounds {
        ty, least, most, ..
    } = Bounds::of(module, item);
    Some(LiveNumber {
        path: path_of(instance, item),
        name: name.to_owned(),
        offset: 0,
        scalar: match ty {
            "i32" => naga::Scalar::I32,
            "u32" => naga::Scalar::U32,
            _ => naga::Scalar::F32,
        },
        default: module.value(item)?.1?,
        least,
        most,
    })
}

/// Writes the buffer of live numbers; where its declaration begins, and its name.
fn write_live(source: &mut Source, live: &[LiveNumber]) -> Option<(usize, String)> {
    if live.is_empty() {
        return None;
    }
    let text = &mut source.text;
    let _ = writeln!(text, "// ---- live numbers\nstruct {LIVE_TYPE} {{");
    for number in live {
        let ty = match number.scalar.kind {
            naga::ScalarKind::Sint => "i32",
            naga::ScalarKind::Uint => "u32",
            _ => "f32",
        };
        let _ = writeln!(text, "    {}: {ty},", number.member());
    }
    text.push_str("}\n");
    let start = text.len();
    let _ = writeln!(text, "var<storage, read> {LIVE_NUMBERS}: {LIVE_TYPE};\n");
    Some((start, LIVE_NUMBERS.to_owned()))
}

/// Copies an item and the comment above it, with its words renamed and, if it is a constant that the
/// pipeline sets, its value. Returns where the item itself begins in the composed text.
fn copy_item(source: &mut Source, instance: &Instance, named: &Named, names: &Names) -> usize {
    let module = instance.module;
    let item = named.item;
    let file = &module.file;
    let mut at = comment_start(module, item.range.start);
    let start = source.text.len() + (item.range.start - at);
    let value = match &item.kind {
        ItemKind::Constant { ty } => {
            let value = instance.constants.get(&item.name);
            value.and_then(|value| Some((module.value(item)?.0, literal(ty, *value))))
        }
        _ => None,
    };
    let end = value
        .as_ref()
        .map_or(item.range.end, |(range, _)| range.start);
    let words = if named.renamed {
        item.words.as_slice()
    } else {
        &[]
    };
    for &index in words {
        let range = module.outline.tokens[index].range.clone();
        if range.start >= end {
            break;
        }
        let word = &file.text[range.clone()];
        if let Some(name) = names.get(word).filter(|name| ***name != *word) {
            source.copy(file, at..range.start);
            source.rename(file, range.clone(), name);
            at = range.end;
        }
    }
    if let Some((range, value)) = value {
        source.copy(file, at..range.start);
        source.rename(file, range.clone(), &value);
        at = range.end;
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
