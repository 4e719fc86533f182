//! From text to IR: parsing, bindings, pruning, validation.

use std::collections::BTreeMap;

use meniscus_source::{Diagnostic, Report};
use naga::valid::{Capabilities, GlobalUse, ModuleInfo, ValidationFlags, Validator};

use crate::explain::{chain_of, explain};
use crate::lexer::Kind;
use crate::library::Library;
use crate::shader::{Binding, BindingKind, Sample, Shader};
use crate::text::Written;

/// naga's parser recurses; hostile texts are given a stack that they cannot exhaust within the
/// size that source files are limited to.
const PARSER_STACK: usize = 64 << 20;
/// The longest chain of operators or `else if`s that is handed to naga, which recurses on them.
const MAX_CHAIN: usize = 1000;

/// Runs naga on a stack of its own.
fn on_large_stack<T: Send>(run: impl FnOnce() -> Result<T, Report> + Send) -> Result<T, Report> {
    std::thread::scope(|scope| {
        std::thread::Builder::new()
            .stack_size(PARSER_STACK)
            .spawn_scoped(scope, run)
            .map_err(|error| {
                Report::from(Diagnostic::error(format!("cannot start a parser: {error}")))
            })?
            .join()
            .unwrap_or_else(|_| {
                Err(Diagnostic::error("naga gave up on a shader without saying why").into())
            })
    })
}

/// Parses and validates a text without entry points.
///
/// # Errors
/// naga's message, at the place where the cause was written.
pub(crate) fn check(
    written: &Written,
    library: &Library,
) -> Result<(naga::Module, ModuleInfo), Report> {
    check_chains(written)?;
    on_large_stack(|| parse(written, library))
}

pub(crate) fn shader(written: Written, library: &Library) -> Result<Shader, Report> {
    check_chains(&written)?;
    let text = written.source.text.as_str();
    let (module, info, stages) = on_large_stack(|| finish(&written, library))?;
    let bindings = bindings(&module, &info, &written.resources, &stages);
    let overrides = written
        .overrides
        .iter()
        .filter(|(_, name)| {
            module
                .overrides
                .iter()
                .any(|(_, o)| o.name.as_ref() == Some(name))
        })
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

fn parse(written: &Written, library: &Library) -> Result<(naga::Module, ModuleInfo), Report> {
    let module = naga::front::wgsl::parse_str(&written.source.text).map_err(|error| {
        let labels: Vec<_> = error
            .labels()
            .map(|(span, words)| (span.to_range(), words.to_owned()))
            .collect();
        let notes: Vec<_> = error.notes().map(str::to_owned).collect();
        explain(written, library, error.message(), labels, &notes)
    })?;
    let unbound = ValidationFlags::all() - ValidationFlags::BINDINGS;
    let info = validate(&module, unbound, written, library)?;
    Ok((module, info))
}

fn validate(
    module: &naga::Module,
    flags: ValidationFlags,
    written: &Written,
    library: &Library,
) -> Result<ModuleInfo, Report> {
    Validator::new(flags, Capabilities::empty())
        .validate(module)
        .map_err(|error| {
            let labels = error
                .spans()
                .map(|(span, words)| (span.to_range(), words.clone()))
                .collect();
            explain(written, library, &chain_of(error.as_inner()), labels, &[])
        })
}

fn finish(
    written: &Written,
    library: &Library,
) -> Result<(naga::Module, ModuleInfo, Stages), Report> {
    let (mut module, info) = parse(written, library)?;
    let stages = stages(&module, &info);
    for (number, name) in stages.keys().enumerate() {
        let found = module
            .global_variables
            .iter_mut()
            .find(|(_, v)| v.name.as_ref() == Some(name));
        if let Some((_, variable)) = found {
            variable.binding = Some(naga::ResourceBinding {
                group: 0,
                binding: number as u32,
            });
        }
    }
    naga::compact::compact(&mut module, naga::compact::KeepUnused::No);
    let info = validate(&module, ValidationFlags::all(), written, library)?;
    Ok((module, info, stages))
}

fn stages(module: &naga::Module, info: &ModuleInfo) -> Stages {
    let mut stages = Stages::new();
    for (handle, variable) in module.global_variables.iter() {
        let Some(name) = &variable.name else { continue };
        let resource = matches!(
            variable.space,
            naga::AddressSpace::Uniform
                | naga::AddressSpace::Storage { .. }
                | naga::AddressSpace::Handle
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
    let numbers: BTreeMap<&str, u32> = bindings
        .iter()
        .map(|b| (b.variable.as_str(), b.index))
        .collect();
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

/// Refuses texts on which naga would exhaust its stack: it recurses on chained operators and
/// accesses, on `else if`, on template lists, and on brackets.
fn check_chains(written: &Written) -> Result<(), Report> {
    let text = &written.source.text;
    // How long the chain was when each open bracket was met: a comma goes back to that.
    let mut open: Vec<usize> = Vec::new();
    let mut chain = 0;
    let mut elses = 0;
    for token in crate::lexer::tokens(text) {
        match token.kind {
            Kind::Mark(';' | '{' | '}') => {
                chain = 0;
                match &text[token.range.clone()] {
                    "{" => open.push(0),
                    "}" => drop(open.pop()),
                    _ => {}
                }
            }
            Kind::Mark('(' | '[') => {
                chain += 1;
                open.push(chain);
            }
            Kind::Mark(')' | ']') => drop(open.pop()),
            Kind::Mark(',') => chain = open.last().copied().unwrap_or(0),
            Kind::Mark('+' | '-' | '*' | '/' | '%' | '&' | '|' | '^' | '!' | '~' | '<' | '>' | '.') => chain += 1,
            Kind::Word => match &text[token.range.clone()] {
                "else" => elses += 1,
                "fn" => elses = 0,
                _ => {}
            },
            _ => {}
        }
        if chain > MAX_CHAIN || elses > MAX_CHAIN || open.len() > MAX_CHAIN {
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
