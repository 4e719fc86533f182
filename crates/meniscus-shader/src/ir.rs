//! From text to IR: parsing, bindings, pruning, validation.

use std::collections::{BTreeMap, BTreeSet};

use meniscus_source::{Diagnostic, Report};
use naga::valid::{Capabilities, GlobalUse, ModuleInfo, ValidationFlags, Validator};

use crate::explain::{chain_of, explain};
use crate::library::Library;
use crate::numbers::LIVE_NUMBERS;
use crate::shader::{Binding, BindingKind, LiveNumber, Sample, Shader};
use crate::text::Written;
use crate::used::all_used;

/// naga's parser recurses; texts that nest deeply are given a stack that they cannot exhaust within
/// the length of chain that is let through.
const PARSER_STACK: usize = 64 << 20;
/// The longest that every thread's stack is good for: ten times less than what was seen to exhaust
/// 2 MiB.
const HARMLESS_CHAIN: usize = 150;

/// Runs naga, on a stack of its own if the text may need it. A panic of naga's is an error.
fn run_naga<T: Send>(
    chain: usize,
    run: impl FnOnce() -> Result<T, Report> + Send,
) -> Result<T, Report> {
    let gave_up = |_| Err(Diagnostic::error("naga gave up on a shader without saying why").into());
    if chain <= HARMLESS_CHAIN {
        return std::panic::catch_unwind(std::panic::AssertUnwindSafe(run)).unwrap_or_else(gave_up);
    }
    std::thread::scope(|scope| {
        std::thread::Builder::new()
            .stack_size(PARSER_STACK)
            .spawn_scoped(scope, run)
            .map_err(|error| {
                Report::from(Diagnostic::error(format!("cannot start a parser: {error}")))
            })?
            .join()
            .unwrap_or_else(gave_up)
    })
}

/// Runs naga on a stack of its own.
pub(crate) fn run_apart<T: Send>(
    run: impl FnOnce() -> Result<T, Report> + Send,
) -> Result<T, Report> {
    run_naga(usize::MAX, run)
}

/// Parses a small text of the composer's own, made of what a user wrote; none where naga cannot.
pub(crate) fn parse_apart(text: &str, chain: usize) -> Option<naga::Module> {
    let parse = || {
        naga::front::wgsl::parse_str(text)
            .map_err(|error| Diagnostic::error(error.message().to_owned()).into())
    };
    run_naga(chain, parse).ok()
}

/// Parses and validates a text without entry points.
///
/// # Errors
/// naga's message, at the place where the cause was written.
pub(crate) fn check(
    written: &Written,
    library: &Library,
) -> Result<(naga::Module, ModuleInfo), Report> {
    let unbound = ValidationFlags::all() - ValidationFlags::BINDINGS;
    run_naga(written.chain, || {
        let module = parse(written, library)?;
        let info = validate(&module, unbound, written, library)?;
        Ok((module, info))
    })
}

pub(crate) fn shader(mut written: Written, library: &Library) -> Result<Shader, Report> {
    let chain = written.chain;
    let (finished, unread) = run_naga(chain, || finish(&mut written, library))?;
    let (module, info, stages) = finished;
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
    let live = live(&module, std::mem::take(&mut written.live));
    let text = written.source.text.as_str();
    let hash = blake3::hash(text.as_bytes()).to_hex().to_string();
    let text = as_it_runs(&written, &module, &bindings);
    Ok(Shader {
        module,
        info,
        entry: written.entry,
        bindings,
        attributes: written.attributes,
        unread,
        outputs: written.outputs,
        text,
        hash,
        overrides,
        live,
    })
}

/// The live numbers of a module that uses them, and where they stand.
fn live(module: &naga::Module, numbers: Vec<LiveNumber>) -> Vec<LiveNumber> {
    let mut variables = module.global_variables.iter();
    let buffer = variables.find(|(_, v)| v.name.as_deref() == Some(LIVE_NUMBERS));
    let members = match buffer.map(|(_, variable)| &module.types[variable.ty].inner) {
        Some(naga::TypeInner::Struct { members, .. }) => members.as_slice(),
        _ => &[],
    };
    let placed = |mut number: LiveNumber| {
        let mut members = members.iter();
        let member = members.find(|m| m.name.as_deref() == Some(number.member()))?;
        number.offset = member.offset;
        Some(number)
    };
    numbers.into_iter().filter_map(placed).collect()
}

/// Parses; where the entry points hand on what nothing reads, writes them again without it.
fn parse_needed(
    written: &mut Written,
    library: &Library,
) -> Result<(naga::Module, Vec<String>), Report> {
    let module = parse(written, library)?;
    let Some(drawing) = &written.drawing else {
        return Ok((module, Vec::new()));
    };
    let unread = drawing.unread(&module);
    if unread == drawing.unmentioned() {
        return Ok((module, unread.names()));
    }
    let (text, attributes) = drawing.write(&unread);
    written.source.text.truncate(written.entry_start);
    written.source.text.push_str(&text);
    written.attributes = attributes;
    Ok((parse(written, library)?, unread.names()))
}

/// Which stages use a variable, by its name: vertex, fragment, compute.
type Stages = BTreeMap<String, [bool; 3]>;

/// A pruned, bound and validated module, naga's analysis of it, and who uses what.
type Finished = (naga::Module, ModuleInfo, Stages);

fn parse(written: &Written, library: &Library) -> Result<naga::Module, Report> {
    naga::front::wgsl::parse_str(&written.source.text).map_err(|error| {
        let labels: Vec<_> = error
            .labels()
            .map(|(span, words)| (span.to_range(), words.to_owned()))
            .collect();
        let notes: Vec<_> = error.notes().map(str::to_owned).collect();
        explain(written, library, error.message(), labels, &notes)
    })
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

/// Parses, prunes what no entry point uses (and tells what was left out between stages), binds the resources that are left in the order of their
/// names, and validates.
fn finish(written: &mut Written, library: &Library) -> Result<(Finished, Vec<String>), Report> {
    let (mut module, unread) = parse_needed(written, library)?;
    if !all_used(&module) {
        naga::compact::compact(&mut module, naga::compact::KeepUnused::No);
    }
    bind(&mut module);
    let info = validate(&module, ValidationFlags::all(), written, library)?;
    let stages = stages(&module, &info);
    Ok(((module, info, stages), unread))
}

/// Numbers the resources of group 0 that have no binding, in the order of their names, after those
/// that have one.
fn bind(module: &mut naga::Module) {
    let given = module.global_variables.iter();
    let first = given
        .filter_map(|(_, variable)| Some(variable.binding?.binding + 1))
        .max()
        .unwrap_or(0);
    let mut resources: Vec<(&String, naga::Handle<naga::GlobalVariable>)> = module
        .global_variables
        .iter()
        .filter(|(_, variable)| is_resource(variable) && variable.binding.is_none())
        .filter_map(|(handle, variable)| Some((variable.name.as_ref()?, handle)))
        .collect();
    resources.sort_unstable();
    let handles: Vec<_> = resources.into_iter().map(|(_, handle)| handle).collect();
    for (number, handle) in handles.into_iter().enumerate() {
        module.global_variables.get_mut(handle).binding = Some(naga::ResourceBinding {
            group: 0,
            binding: first + number as u32,
        });
    }
}

/// Parses a text that is known to be sound and something that was added to it, prunes what its entry
/// points do not use, numbers its resources and validates.
///
/// # Errors
/// naga's message about what was added.
pub(crate) fn with_entries(text: &str) -> Result<naga::Module, Report> {
    run_apart(|| {
        let wrong = |message: &str| Report::from(Diagnostic::error(message));
        let mut module =
            naga::front::wgsl::parse_str(text).map_err(|error| wrong(error.message()))?;
        naga::compact::compact(&mut module, naga::compact::KeepUnused::No);
        bind(&mut module);
        Validator::new(ValidationFlags::all(), Capabilities::empty())
            .validate(&module)
            .map_err(|error| wrong(&chain_of(error.as_inner())))?;
        Ok(module)
    })
}

fn is_resource(variable: &naga::GlobalVariable) -> bool {
    matches!(
        variable.space,
        naga::AddressSpace::Uniform
            | naga::AddressSpace::Storage { .. }
            | naga::AddressSpace::Handle
    )
}

fn stages(module: &naga::Module, info: &ModuleInfo) -> Stages {
    let mut stages = Stages::new();
    for (handle, variable) in module.global_variables.iter() {
        let Some(name) = &variable.name else { continue };
        let resource = is_resource(variable);
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

/// The text with the bindings that the IR has, and without the functions and variables that it has
/// not: what only looks as if it were used, as where a local variable has a function's name.
fn as_it_runs(written: &Written, module: &naga::Module, bindings: &[Binding]) -> String {
    let functions = module.functions.iter().map(|(_, f)| &f.name);
    let variables = module.global_variables.iter().map(|(_, v)| &v.name);
    let kept: BTreeSet<&str> = functions
        .chain(variables)
        .filter_map(|name| name.as_deref())
        .collect();
    let unused = written.items.iter();
    let unused = unused.filter(|(_, name)| !kept.contains(name.as_str()));
    let number = |name: &str| {
        let binding = bindings.iter().find(|b| b.variable == name)?;
        Some(format!("@group(0) @binding({}) ", binding.index))
    };
    let bound = written.variables.iter();
    let bound = bound.filter_map(|(start, name)| Some((*start..*start, number(name)?)));
    let mut changes: Vec<_> = unused
        .map(|(range, _)| (range.clone(), String::new()))
        .chain(bound)
        .collect();
    changes.sort_by_key(|(range, _)| range.start);
    let text = &written.source.text;
    let mut made = String::with_capacity(text.len() + 32 * changes.len());
    let mut at = 0;
    for (range, new) in changes.iter().filter(|(range, _)| range.start < text.len()) {
        made.push_str(&text[at..range.start]);
        made.push_str(new);
        at = range.end;
    }
    made.push_str(&text[at..]);
    made
}
