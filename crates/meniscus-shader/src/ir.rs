//! From text to IR: parsing, bindings, pruning, validation; and naga's messages in the users' words.

use std::collections::BTreeMap;
use std::ops::Range;

use meniscus_source::{Diagnostic, Report};
use naga::valid::{Capabilities, GlobalUse, ModuleInfo, ValidationFlags, Validator};

use crate::library::Library;
use crate::lexer::Kind;
use crate::shader::{Binding, BindingKind, Sample, Shader};
use crate::text::Written;

/// naga's parser recurses; hostile texts are given a stack that they cannot exhaust within the
/// size that source files are limited to.
const PARSER_STACK: usize = 64 << 20;
/// The longest chain of operators or `else if`s that is handed to naga, which recurses on them.
const MAX_CHAIN: usize = 1000;

pub(crate) fn shader(written: Written, library: &Library) -> Result<Shader, Report> {
    check_chains(&written)?;
    let text = written.source.text.as_str();
    let parsed = std::thread::scope(|scope| {
        std::thread::Builder::new()
            .stack_size(PARSER_STACK)
            .spawn_scoped(scope, || parse(&written, library))
            .map_err(|error| Report::from(Diagnostic::error(format!("cannot start a parser: {error}"))))?
            .join()
            .unwrap_or_else(|_| {
                Err(Diagnostic::error("naga gave up on a shader without saying why").into())
            })
    });
    let (module, info, stages) = parsed?;
    let bindings = bindings(&module, &info, &written.resources, &stages);
    let overrides = written
        .overrides
        .iter()
        .filter(|(_, name)| module.overrides.iter().any(|(_, o)| o.name.as_ref() == Some(name)))
        .map(|(path, name)| (path.clone(), name.clone()))
        .collect();
    let hash = blake3::hash(text.as_bytes()).to_hex().to_string();
    let text = with_bindings(text, &bindings);
    Ok(Shader {
        module,
        info,
        entry: written.entry,
        bindings,
        attributes: written.attributes,
        outputs: written.outputs,
        text,
        hash,
        overrides,
    })
}

/// Which stages use a variable, by its name: vertex, fragment, compute.
type Stages = BTreeMap<String, [bool; 3]>;

fn parse(written: &Written, library: &Library) -> Result<(naga::Module, ModuleInfo, Stages), Report> {
    let text = written.source.text.as_str();
    let mut module = naga::front::wgsl::parse_str(text).map_err(|error| {
        let labels: Vec<_> = error
            .labels()
            .map(|(span, words)| (span.to_range(), words.to_owned()))
            .collect();
        let notes: Vec<_> = error.notes().map(str::to_owned).collect();
        explain(written, library, error.message(), labels, &notes)
    })?;
    let capabilities = Capabilities::empty();
    let unbound = ValidationFlags::all() - ValidationFlags::BINDINGS;
    let invalid = |error: naga::WithSpan<naga::valid::ValidationError>| {
        let labels = error
            .spans()
            .map(|(span, words)| (span.to_range(), words.clone()))
            .collect();
        explain(written, library, &chain_of(error.as_inner()), labels, &[])
    };
    let info = Validator::new(unbound, capabilities).validate(&module).map_err(invalid)?;
    let stages = stages(&module, &info);
    for (number, name) in stages.keys().enumerate() {
        let found = module.global_variables.iter_mut().find(|(_, v)| v.name.as_ref() == Some(name));
        if let Some((_, variable)) = found {
            variable.binding = Some(naga::ResourceBinding {
                group: 0,
                binding: number as u32,
            });
        }
    }
    naga::compact::compact(&mut module, naga::compact::KeepUnused::No);
    let info = Validator::new(ValidationFlags::all(), capabilities).validate(&module).map_err(invalid)?;
    Ok((module, info, stages))
}

/// An error and what caused it, in one line.
fn chain_of(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut source = error.source();
    while let Some(cause) = source {
        text.push_str(": ");
        text.push_str(&cause.to_string());
        source = cause.source();
    }
    text
}

/// A message of naga, at the places and in the words of what was written.
fn explain(
    written: &Written,
    library: &Library,
    message: &str,
    labels: Vec<(Option<Range<usize>>, String)>,
    notes: &[String],
) -> Report {
    let say = |text: &str| restore(text, &written.originals);
    let mut diagnostic = Diagnostic::error(say(message));
    let mut unplaced = Vec::new();
    let mut first = None;
    for (range, words) in labels {
        let Some(range) = range else { continue };
        match written.source.origin(range.clone()) {
            Some(place) if first.is_none() => {
                first = Some(place.clone());
                diagnostic = diagnostic.at(&place, say(&words));
            }
            Some(place) => diagnostic = diagnostic.see(&place, say(&words)),
            None => unplaced.push(written.source.text.get(range).unwrap_or("").to_owned()),
        }
    }
    for text in unplaced.iter().filter(|_| first.is_none()) {
        diagnostic = diagnostic.with_help(format!("it shows in the entry points, at `{}`", say(text)));
    }
    for note in notes {
        diagnostic = diagnostic.with_help(say(note));
    }
    if let Some(place) = &first {
        let word = place.text().to_owned();
        let owners: Vec<_> = library
            .modules()
            .filter(|m| m.role() == crate::Role::Shared && m.item(&word).is_some())
            .filter(|m| m.file != place.file)
            .map(|m| format!("`{}`", m.path))
            .collect();
        if message.contains("no definition in scope") && !owners.is_empty() {
            diagnostic = diagnostic.with_help(format!(
                "{} declares `{word}`: add it to `// needs: …` in {}",
                owners.join(" or "),
                place.file.name
            ));
        }
        let asked = written
            .modules
            .iter()
            .filter(|(path, _)| library.get(path).is_some_and(|m| m.file == place.file))
            .find_map(|(_, asked)| asked.as_ref());
        if let Some(asked) = asked {
            diagnostic = diagnostic.see(asked, "the module is used here");
        }
    }
    diagnostic.into()
}

/// Puts the names that were written in the place of those of the composed text.
fn restore(text: &str, originals: &BTreeMap<String, String>) -> String {
    let mut restored = String::new();
    let mut at = 0;
    for token in crate::lexer::tokens(text) {
        if token.kind != Kind::Word {
            continue;
        }
        if let Some(original) = originals.get(&text[token.range.clone()]) {
            restored.push_str(&text[at..token.range.start]);
            restored.push_str(original);
            at = token.range.end;
        }
    }
    restored.push_str(&text[at..]);
    restored
}

fn stages(module: &naga::Module, info: &ModuleInfo) -> Stages {
    let mut stages = Stages::new();
    for (handle, variable) in module.global_variables.iter() {
        let Some(name) = &variable.name else { continue };
        let resource = matches!(
            variable.space,
            naga::AddressSpace::Uniform | naga::AddressSpace::Storage { .. } | naga::AddressSpace::Handle
        );
        for (index, entry) in module.entry_points.iter().enumerate() {
            if resource && info.get_entry_point(index)[handle] != GlobalUse::empty() {
                let used = stages.entry(name.clone()).or_default();
                used[match entry.stage {
                    naga::ShaderStage::Vertex => 0,
                    naga::ShaderStage::Fragment => 1,
                    _ => 2,
                }] = true;
            }
        }
    }
    stages
}

fn bindings(
    module: &naga::Module,
    info: &ModuleInfo,
    resources: &BTreeMap<String, String>,
    stages: &Stages,
) -> Vec<Binding> {
    let mut found = Vec::new();
    for (handle, variable) in module.global_variables.iter() {
        let (Some(binding), Some(name)) = (&variable.binding, &variable.name) else {
            continue;
        };
        let filtered = (0..module.entry_points.len())
            .flat_map(|index| info.get_entry_point(index).sampling_set.iter())
            .any(|key| key.image == handle);
        let kind = match (variable.space, &module.types[variable.ty].inner) {
            (naga::AddressSpace::Uniform, _) => BindingKind::Uniform(variable.ty),
            (naga::AddressSpace::Storage { access }, _) => BindingKind::Storage {
                ty: variable.ty,
                read_only: !access.contains(naga::StorageAccess::STORE),
            },
            (_, naga::TypeInner::Image { dim, class, .. }) => match class {
                naga::ImageClass::Storage { format, access } => BindingKind::StorageTexture {
                    format: *format,
                    dimension: *dim,
                    reads: access.contains(naga::StorageAccess::LOAD),
                },
                naga::ImageClass::Depth { .. } => BindingKind::Texture {
                    dimension: *dim,
                    sample: Sample::Depth,
                    filtered,
                },
                naga::ImageClass::Sampled { kind, .. } => BindingKind::Texture {
                    dimension: *dim,
                    sample: match kind {
                        naga::ScalarKind::Sint => Sample::Sint,
                        naga::ScalarKind::Uint => Sample::Uint,
                        _ => Sample::Float,
                    },
                    filtered,
                },
                naga::ImageClass::External => continue,
            },
            _ => BindingKind::Sampler,
        };
        let [in_vertex, in_fragment, in_compute] = stages.get(name).copied().unwrap_or_default();
        found.push(Binding {
            index: binding.binding,
            variable: name.clone(),
            resource: resources.get(name).unwrap_or(name).clone(),
            kind,
            in_vertex,
            in_fragment,
            in_compute,
        });
    }
    found.sort_by_key(|binding| binding.index);
    found
}

/// The text with the bindings that the IR has.
fn with_bindings(text: &str, bindings: &[Binding]) -> String {
    let numbers: BTreeMap<&str, u32> =
        bindings.iter().map(|b| (b.variable.as_str(), b.index)).collect();
    let mut bound = String::with_capacity(text.len() + 32 * bindings.len());
    let mut at = 0;
    for item in crate::outline::Outline::of(text).items {
        if let (crate::outline::ItemKind::Variable { .. }, Some(number)) =
            (&item.kind, numbers.get(item.name.as_str()))
        {
            bound.push_str(&text[at..item.range.start]);
            bound.push_str(&format!("@group(0) @binding({number}) "));
            at = item.range.start;
        }
    }
    bound.push_str(&text[at..]);
    bound
}

/// Refuses texts on which naga would exhaust its stack: it recurses on chained operators, on
/// `else if`, and on brackets.
fn check_chains(written: &Written) -> Result<(), Report> {
    let text = &written.source.text;
    let mut operators = 0;
    let mut elses = 0;
    let mut depth = 0usize;
    for token in crate::lexer::tokens(text) {
        match token.kind {
            Kind::Mark(';') => operators = 0,
            Kind::Mark('(' | '[' | '{') => depth += 1,
            Kind::Mark(')' | ']' | '}') => depth = depth.saturating_sub(1),
            Kind::Mark('+' | '-' | '*' | '/' | '%' | '&' | '|' | '^' | '!' | '~') => operators += 1,
            Kind::Word => match &text[token.range.clone()] {
                "else" => elses += 1,
                "fn" => (elses, operators) = (0, 0),
                _ => {}
            },
            _ => {}
        }
        if operators > MAX_CHAIN || elses > MAX_CHAIN || depth > MAX_CHAIN {
            let mut wrong = Diagnostic::error(format!(
                "more than {MAX_CHAIN} operators, `else`s or brackets in one go"
            ))
            .with_help("split the expression into several, or use a loop or a switch");
            if let Some(place) = written.source.origin(token.range) {
                wrong = wrong.at(&place, "here it becomes too long");
            }
            return Err(wrong.into());
        }
    }
    Ok(())
}
