//! `meniscus ablate`

use std::time::Duration;

use clap::Args;
use meniscus::measure::{Results, Table, write_atomically};
use meniscus::pipeline::{Facts, Pipeline, Plan};
use meniscus::source::{Diagnostic, Report};
use meniscus::{
    Ablation, Project, Rivalry, Rounds, Until, Without, contests_markdown, contests_text,
    gathered_warnings, leave_one_out, moments_text, report, write_directory,
};
use serde_json::{Map, Value, json};

use super::arguments::{Ablate, check_moments};
use super::progress::Bar;
use super::say::{say, tell};
use super::{Failure, attempts, outputs, sweep};

/// What is looked at beside time and error at the scene's own moment.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct Asked {
    /// Run at these moments of the scene, seconds: the water moves and is uploaded for every frame;
    /// errors are the means over the moments, and the worst are told beside them.
    #[arg(
        long,
        value_name = "A,B,…",
        value_delimiter = ',',
        allow_negative_numbers = true,
        conflicts_with = "repeat_scene_times"
    )]
    pub times: Vec<f64>,
    /// The same at so many moments, a quarter of a second apart from the scene's own on.
    #[arg(long, value_name = "NUMBER", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub repeat_scene_times: Option<u32>,
    /// Hold pipelines against these rivals (names, or refraction/* for many): who dominates whom, and
    /// whether each rival is beaten by far, in time or in error.
    #[arg(long, value_name = "A,B,…", value_delimiter = ',')]
    pub against: Vec<String>,
    /// The pipelines that are held against the rivals; all the others but the baseline if none is
    /// given.
    #[arg(
        long,
        value_name = "A,B,…",
        value_delimiter = ',',
        requires = "against"
    )]
    pub ours: Vec<String>,
    /// Also print what frames take beside time: passes, invocations, memory, uploads, preparation.
    #[arg(long)]
    pub wide: bool,
}

/// Seconds between moments that are only counted.
const BETWEEN_MOMENTS: f64 = 0.25;

impl Asked {
    /// The moments, seconds; none where only the scene's own is asked for.
    fn moments(&self, own: f64) -> Result<Vec<f64>, Diagnostic> {
        check_moments(&self.times)?;
        let count = self.repeat_scene_times.unwrap_or(0);
        let counted = (0..count).map(|index| own + BETWEEN_MOMENTS * f64::from(index));
        Ok(self.times.iter().copied().chain(counted).collect())
    }

    /// What is printed under the table, and written under it as Markdown.
    pub fn below(&self, results: &Results) -> String {
        let mut text = moments_text(results);
        text.push_str(&contests_text(results));
        if self.wide {
            text.push('\n');
            text.push_str(&Table::of_costs(results).terminal());
        }
        text
    }

    /// The same as Markdown.
    pub fn markdown(&self, results: &Results) -> String {
        let costs = || format!("\n{}", Table::of_costs(results).markdown());
        let costs = self.wide.then(costs).unwrap_or_default();
        let contests = contests_markdown(results);
        format!("{costs}{contests}")
    }
}

/// What is run where nothing is named.
const ALL: &str = "refraction/*";

pub(crate) fn run(project: &Project, ablate: &Ablate) -> Result<(), Failure> {
    let preset = match &ablate.sweeping.preset {
        Some(name) => Some(project.preset(name)?),
        None => None,
    };
    let asked = preset
        .as_ref()
        .map(|preset| sweep::with_preset(ablate, preset));
    let ablate = asked.as_ref().unwrap_or(ablate);
    if !ablate.sweeping.axes.is_empty() {
        let published = preset.as_ref().and_then(|preset| preset.published.as_ref());
        return sweep::run(project, ablate, published);
    }
    if ablate.sweeping.partition.is_some() {
        return Err(
            Diagnostic::error("`--partition` without a sweep has nothing to divide")
                .with_help("say what is swept with --sweep KEY=A,B")
                .into(),
        );
    }
    once(project, ablate)
}

/// One ablation.
fn once(project: &Project, ablate: &Ablate) -> Result<(), Failure> {
    let ablation = prepare(project, ablate)?;
    let files = [&ablate.json, &ablate.markdown, &ablate.csv, &ablate.report];
    outputs::check(files.into_iter().flatten(), ablate.out.as_ref())?;
    let gpu = ablate.look.gpu()?;
    let bar = Bar::new();
    let outcome = ablation.run(project, &gpu, &|what, part| bar.tell(what, part));
    bar.finish();
    let outcome = outcome?;
    let results = &outcome.results;
    let table = Table::of(results);
    say(&table.terminal())?;
    let asked = &ablate.sweeping.asked;
    say(&asked.below(results))?;
    say(&marginal(results))?;
    for warning in gathered_warnings(results) {
        say(&format!("warning: {warning}\n"))?;
    }
    if let Some(path) = &ablate.report {
        write_atomically(path, report(&outcome)?.as_bytes())?;
    }
    if let Some(path) = &ablate.json {
        write_atomically(path, results.to_json()?.as_bytes())?;
    }
    if let Some(path) = &ablate.markdown {
        let text = table.markdown() + &asked.markdown(results);
        write_atomically(path, text.as_bytes())?;
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

/// What is to be compared, from what was written.
pub(crate) fn prepare(project: &Project, ablate: &Ablate) -> Result<Ablation, Failure> {
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
    attempts::apply(project, &ablate.changes, &mut pipelines)?;
    let mut pipelines = attempts::combine(project, pipelines, &ablate.attempts)?;
    let without = without(project, ablate, &mut pipelines)?;
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
    let asked = &ablate.sweeping.asked;
    let rivalry = match asked.against.is_empty() {
        true => None,
        false => {
            let names: Vec<&str> = pipelines.iter().map(|p| p.name.as_str()).collect();
            let baseline = baseline.map(|index| names[index]);
            Some(Rivalry::of(&asked.ours, &asked.against, &names, baseline)?)
        }
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
    let moments = asked.moments(scene.water.time)?;
    Ok(Ablation {
        moments,
        rivalry,
        pipelines,
        baseline,
        scene,
        truth,
        size: ablate.look.size,
        pruning: ablate.skipping.pruning(),
        rounds: Rounds {
            counted: ablate.rounds,
            until: ablate.until.map(|width| Until {
                width,
                limit: Duration::from_secs(ablate.limit_seconds),
            }),
            ..Rounds::default()
        },
        without,
        settings: settings(ablate),
    })
}

/// The pipeline of `--leave-one-out` without each of its fillings; it and they join the others.
/// What does not compose without a filling is told and left out.
fn without(
    project: &Project,
    ablate: &Ablate,
    pipelines: &mut Vec<Pipeline>,
) -> Result<Vec<Without>, Report> {
    let Some(name) = &ablate.leave_one_out else {
        return Ok(Vec::new());
    };
    let whole = match pipelines.iter().find(|pipeline| pipeline.name == *name) {
        Some(pipeline) => pipeline.clone(),
        None => {
            let mut whole = [project.pipeline(name)?];
            ablate.changes.apply(&mut whole)?;
            let [whole] = whole;
            pipelines.push(whole.clone());
            whole
        }
    };
    let mut left = leave_one_out(&whole);
    left.retain(|without| {
        let facts = Facts::all();
        let composes = |facts| Plan::new(&without.pipeline, &project.composer, facts, true);
        match facts.iter().try_for_each(|facts| composes(facts).map(drop)) {
            Ok(()) => true,
            Err(wrong) => {
                let slot = &without.slot;
                tell(&format!(
                    "{name}: `{slot}` cannot be put back to its default:\n{wrong}"
                ));
                false
            }
        }
    });
    pipelines.extend(left.iter().map(|without| without.pipeline.clone()));
    Ok(left)
}

/// What each filling brings, a line for each; nothing where none was left out.
fn marginal(results: &Results) -> String {
    let rows = meniscus::marginal_table(results);
    let line = |cells: &[String]| {
        let [slot, filling, _, ms, times, px, rmse] = cells else {
            return String::new();
        };
        format!("{slot} = {filling}: {ms} ms (× {times}), {px} px, {rmse} RMSE\n")
    };
    let mut text = String::new();
    if let Some(row) = rows.first() {
        text = format!("\nWhat each filling of {} brings:\n", row[2]);
    }
    text.extend(rows.iter().map(|cells| line(cells)));
    text
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
