//! `meniscus ablate`

use meniscus::gpu::Gpu;
use meniscus::measure::{Table, write_atomically};
use meniscus::pipeline::Pipeline;
use meniscus::source::{Diagnostic, Report};
use meniscus::{Ablation, Project, Rounds, write_directory};
use serde_json::{Map, Value, json};

use super::arguments::{Ablate, key_value};
use super::progress::Bar;
use super::say::say;
use super::{Failure, outputs};

/// What is run where nothing is named.
const ALL: &str = "refraction/*";
/// The most combinations that `--try` may make.
const MAX_COMBINATIONS: usize = 1000;

pub(crate) fn run(project: &Project, ablate: &Ablate) -> Result<(), Failure> {
    let ablation = prepare(project, ablate)?;
    let files = [&ablate.json, &ablate.markdown, &ablate.csv];
    outputs::check(files.into_iter().flatten(), ablate.out.as_ref())?;
    let gpu = Gpu::open(ablate.look.adapter.as_deref())?;
    let bar = Bar::new();
    let outcome = ablation.run(project, &gpu, &|what, part| bar.tell(what, part));
    bar.finish();
    let outcome = outcome?;
    let results = &outcome.results;
    let table = Table::of(results);
    say(&table.terminal().to_string())?;
    if let Some(path) = &ablate.json {
        write_atomically(path, results.to_json()?.as_bytes())?;
    }
    if let Some(path) = &ablate.markdown {
        write_atomically(path, table.markdown().as_bytes())?;
    }
    if let Some(path) = &ablate.csv {
        write_atomically(path, table.csv()?.as_bytes())?;
    }
    if let Some(folder) = &ablate.out {
        write_directory(folder, &outcome)?;
        say(&format!("pictures, maps and data: {}\n", folder.display()))?;
    }
    Ok(())
}

fn prepare(project: &Project, ablate: &Ablate) -> Result<Ablation, Failure> {
    let patterns = match ablate.pipelines.is_empty() {
        true => vec![ALL.to_owned()],
        false => ablate.pipelines.clone(),
    };
    let mut report = Report::default();
    let mut pipelines = Vec::new();
    for name in project.pipeline_names(&patterns)? {
        match project.pipeline(&name) {
            Ok(pipeline) => pipelines.push(pipeline),
            Err(wrong) => report.extend(wrong),
        }
    }
    report.into_result(())?;
    ablate.changes.apply(&mut pipelines)?;
    let mut pipelines = combine(pipelines, &ablate.attempts)?;
    // The baseline comes first, so that the table begins with it.
    pipelines.sort_by_key(|pipeline| !pipeline.baseline);
    let baseline =
        match &ablate.baseline {
            Some(name) => Some(pipelines.iter().position(|p| p.name == *name).ok_or_else(
                || {
                    Diagnostic::error(format!(
                        "the baseline `{name}` is not among the pipelines that run"
                    ))
                    .with_suggestion(name, pipelines.iter().map(|p| p.name.as_str()))
                },
            )?),
            None => pipelines.iter().position(|pipeline| pipeline.baseline),
        };
    let mut scene = ablate.look.scene(project)?;
    let chosen = ablate
        .look
        .set
        .iter()
        .any(|set| set.trim_start().starts_with("water.geometry"));
    let truth = ablate.truth.map_or(scene.water.geometry, Into::into);
    if !chosen {
        scene.water.geometry = truth;
    }
    Ok(Ablation {
        pipelines,
        baseline,
        scene,
        truth,
        size: ablate.look.size,
        rounds: Rounds {
            counted: ablate.rounds,
            ..Rounds::default()
        },
        settings: settings(ablate),
    })
}

/// Every combination of the fillings that are tried, for every pipeline that has their passes.
fn combine(pipelines: Vec<Pipeline>, attempts: &[String]) -> Result<Vec<Pipeline>, Report> {
    let mut all = pipelines;
    for text in attempts {
        let (key, values) = key_value("--try", text)?;
        let mut tried = Vec::new();
        let mut failed = Report::default();
        let mut changed = false;
        for pipeline in &all {
            for value in values.split(',') {
                let mut attempt = pipeline.clone();
                match attempt.set(key, value) {
                    Ok(()) => {
                        attempt.baseline = false;
                        tried.push(attempt);
                        changed = true;
                    }
                    Err(wrong) => {
                        failed.extend(wrong);
                        // A pipeline without the pass runs once, as it is.
                        tried.push(pipeline.clone());
                        break;
                    }
                }
            }
        }
        if !changed {
            return Err(failed);
        }
        if tried.len() > MAX_COMBINATIONS {
            return Err(Diagnostic::error(format!(
                "`--try` makes {} combinations; at most {MAX_COMBINATIONS} are run",
                tried.len()
            ))
            .into());
        }
        all = tried;
    }
    Ok(all)
}

fn settings(ablate: &Ablate) -> Map<String, Value> {
    let mut settings = Map::new();
    for text in ablate.look.set.iter().chain(&ablate.changes.with) {
        if let Some((key, value)) = text.split_once('=') {
            settings.insert(key.trim().to_owned(), json!(value.trim()));
        }
    }
    settings
}
