//! `meniscus new`

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use meniscus::Project;
use meniscus::measure::write_atomically;
use meniscus::pipeline::Pipeline;
use meniscus::shader::{Composer, Filling, Library};
use meniscus::source::{Diagnostic, SourceFile};
use meniscus::stress::Kind;
use meniscus::stress::modules::{Choice, Specimen};

use super::say::say;
use super::{Failure, outputs};

#[derive(Debug, Args)]
pub(crate) struct New {
    #[command(subcommand)]
    pub what: What,
}

#[derive(Debug, Subcommand)]
pub(crate) enum What {
    /// Write a WGSL module that fills a slot, and say how to try it.
    Module(NewModule),
}

#[derive(Debug, Args)]
pub(crate) struct NewModule {
    /// Its name: FOLDER/NAME.
    pub name: String,
    /// The slot that it fills: see `meniscus list slots`.
    #[arg(long, value_name = "SLOT")]
    pub slot: String,
    /// The folder of modules that it is written to.
    #[arg(long, value_name = "DIR", default_value = "modules")]
    pub dir: PathBuf,
}

pub(crate) fn run(project: &Project, new: &New) -> Result<(), Failure> {
    let What::Module(module) = &new.what;
    let text = project
        .composer
        .library()
        .template(&module.name, &module.slot)?;
    let file = module.dir.join(format!("{}.wgsl", module.name));
    outputs::check([&file], None)?;
    write_new(&file, &text)?;
    let directory = module.dir.display();
    let mut said = format!(
        "{} is written: it fills `{}` with the slot's default. Change it, then\n\n",
        file.display(),
        module.slot
    );
    said.push_str(&format!("  meniscus check --modules {directory}\n"));
    for line in evaluations(project, module, &text)? {
        said.push_str(&format!("  meniscus eval --modules {directory} {line}\n"));
    }
    if let Some(place) = place(project, &module.slot) {
        let Place { pipeline, key, now } = &place;
        let name = &module.name;
        let both = now.iter().chain([name]).cloned().collect::<Vec<_>>();
        said.push_str(&format!(
            "  meniscus ablate {pipeline} --modules {directory} --try {key}={}\n\n",
            both.join(",")
        ));
        said.push_str(&format!(
            "and keep it as a pipeline of its own, a file FOLDER/NAME.ron for `--pipelines FOLDER`:\n\n\
             Variant(\n    of: \"{pipeline}\",\n    about: \"Say here what it is.\",\n    \
             set: {{ \"{key}\": \"{name}\" }},\n)\n",
        ));
    }
    say(&said)
}

/// Writes a file that must not be there yet.
fn write_new(file: &Path, text: &str) -> Result<(), Failure> {
    if file.symlink_metadata().is_ok() {
        let there = Diagnostic::error(format!("`{}` is there already", file.display()));
        return Err(there.with_help("take another name, or remove it").into());
    }
    Ok(write_atomically(file, text.as_bytes())?)
}

/// A call of each of the module's functions: MODULE:FUNCTION and numbers.
fn evaluations(project: &Project, new: &NewModule, text: &str) -> Result<Vec<String>, Failure> {
    let library = project.composer.library();
    let known = library.modules().map(|m| (m.path.as_str(), m.file.clone()));
    let file = SourceFile::new(format!("{}.wgsl", new.name), text);
    let (library, _) = Library::new(known.chain([(new.name.as_str(), file)]));
    let functions: Vec<String> = match library.slot(&new.slot) {
        Some(slot) => slot.function_names().map(str::to_owned).collect(),
        None => Vec::new(),
    };
    let composer = Composer::new(library);
    let specimen = Specimen::new(&composer, &new.name, &Choice::default())?;
    let mut lines = Vec::new();
    for name in functions {
        let function = specimen.function(&name)?;
        let numbers = function.arguments().flat_map(|(_, shape)| shape.leaves());
        let numbers: Vec<&str> = numbers.map(|(path, kind)| number(&path, kind)).collect();
        lines.push(format!("{}:{name} {}", new.name, numbers.join(" ")));
    }
    Ok(lines)
}

/// A number to begin with: vectors are (0, 0, 1), which is a unit vector.
fn number(path: &str, kind: Kind) -> &'static str {
    let first = path.ends_with(".x") || path.ends_with(".y");
    match kind {
        Kind::Bool => "false",
        _ if first => "0",
        _ => "1",
    }
}

/// Where a pipeline fills a slot, or may.
struct Place {
    pipeline: String,
    /// PASS.SLOT, PASS.SLOT.SLOT …
    key: String,
    /// What fills it.
    now: Option<String>,
}

/// The place in the shortest pipeline that fills the slot, or else that calls it.
fn place(project: &Project, slot: &str) -> Option<Place> {
    let names: Vec<String> = project.pipelines.names().map(str::to_owned).collect();
    let mut pipelines: Vec<Pipeline> = names
        .iter()
        .filter_map(|name| project.pipeline(name).ok())
        .collect();
    pipelines.sort_by_key(|pipeline| pipeline.passes.len());
    let filled = pipelines.iter().find_map(|pipeline| {
        pipeline.passes.iter().find_map(|pass| {
            let (key, now) = filling(&pass.slots, slot, &pass.name.value)?;
            let pipeline = pipeline.name.clone();
            let now = Some(now);
            Some(Place { pipeline, key, now })
        })
    });
    filled.or_else(|| {
        let library = project.composer.library();
        pipelines.iter().find_map(|pipeline| {
            // A slot deep inside is filled by its name at the pass, too.
            let pass = pipeline.passes.iter().find(|pass| {
                let mut modules = vec![pass.skeleton.value.as_str()];
                named(&pass.slots, &mut modules);
                let mut known = modules.into_iter().filter_map(|path| library.get(path));
                known.any(|module| library.calls(module, slot))
            })?;
            Some(Place {
                pipeline: pipeline.name.clone(),
                key: format!("{}.{slot}", pass.name.value),
                now: None,
            })
        })
    })
}

/// Where a slot of this name is filled, and with what.
fn filling(
    slots: &BTreeMap<String, Filling>,
    wanted: &str,
    path: &str,
) -> Option<(String, String)> {
    if let Some(found) = slots.get(wanted) {
        return Some((format!("{path}.{wanted}"), found.module.value.clone()));
    }
    slots
        .iter()
        .find_map(|(slot, inner)| filling(&inner.slots, wanted, &format!("{path}.{slot}")))
}

/// The modules of fillings and of those within.
fn named<'p>(slots: &'p BTreeMap<String, Filling>, found: &mut Vec<&'p str>) {
    for filling in slots.values() {
        found.push(&filling.module.value);
        named(&filling.slots, found);
    }
}
