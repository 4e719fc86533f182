//! `meniscus ablate --sweep` and `--preset`, and `meniscus merge`.

use std::path::{Path, PathBuf};

use clap::Args;
use meniscus::measure::{Results, Sweep, SweepPoint, Table, write_atomically};
use meniscus::scene::keys;
use meniscus::source::Diagnostic;
use meniscus::{
    Axis, Beside, Partition, Preset, Project, Published, fingerprint, gathered_warnings, points,
    sweep_report, write_directory,
};
use serde_json::{Map, json};

use super::ablate::prepare;
use super::arguments::Ablate;
use super::progress::Bar;
use super::say::{say, tell};
use super::{Failure, outputs};

/// The key that sweeps scenes.
const SCENE: &str = "scene";

/// Many ablations in one.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct Sweeping {
    /// Run at each of these values: of a setting of the scene (water.rms_slope=0,0.05,0.1), of the
    /// pipelines (PASS.SLOT.NUMBER=1,2), or scene=pool,clutter; given more than once, at every
    /// combination. `--json` then holds a point for each, is written after each, and is gone on
    /// with: a point that it knows is not run again.
    #[arg(long = "sweep", value_name = "KEY=A,B,…")]
    pub axes: Vec<String>,
    /// Run only the K-th of N parts of the sweep, for example on K machines; `meniscus merge` joins
    /// them.
    #[arg(long, value_name = "K/N")]
    pub partition: Option<Partition>,
    /// Run an experiment: pipelines, a scene and what is swept, all of which the command line may
    /// change; its name, or a `.ron` file.
    #[arg(long, value_name = "NAME")]
    pub preset: Option<String>,
    #[command(flatten)]
    pub asked: super::ablate::Asked,
}

/// Join the results of parts of a sweep.
#[derive(Debug, Args)]
pub(crate) struct Merge {
    /// What `meniscus ablate --sweep … --json FILE` has written.
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// The results to write, as JSON.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Write every figure as CSV, with the swept settings as columns.
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
}

/// What the command line asks for, the rest being as the preset says.
pub(crate) fn with_preset(ablate: &Ablate, preset: &Preset) -> Ablate {
    let mut asked = ablate.clone();
    if asked.pipelines.is_empty() {
        asked.pipelines = preset
            .pipelines
            .iter()
            .map(|name| name.value.clone())
            .collect();
    }
    asked.look.scene.get_or_insert_with(|| preset.scene.clone());
    let set = preset
        .set
        .iter()
        .map(|(key, value)| format!("{}={value}", key.value));
    asked.look.set = set.chain(asked.look.set).collect();
    let is_set = |key: &str| {
        let mut given = ablate.look.set.iter().chain(&ablate.sweeping.axes);
        given.any(|text| text.split_once('=').is_some_and(|(k, _)| k.trim() == key))
    };
    for axis in &preset.sweep {
        if !is_set(&axis.key.value) {
            let text = format!("{}={}", axis.key.value, axis.values.join(","));
            asked.sweeping.axes.push(text);
        }
    }
    asked
}

/// What runs at one point: as if the swept settings had been written with `--set` and `--with`.
fn at_point(ablate: &Ablate, swept: &[(String, String)]) -> Ablate {
    let mut point = ablate.clone();
    for (key, value) in swept {
        if key == SCENE {
            point.look.scene = Some(value.clone());
        } else if keys().any(|known| known.name == key) {
            point.look.set.push(format!("{key}={value}"));
        } else {
            point.changes.with.push(format!("{key}={value}"));
        }
    }
    point
}

/// A point before it is run.
fn planned(index: usize, of: usize, swept: &[(String, String)]) -> SweepPoint {
    let swept = swept.iter().map(|(key, value)| (key.clone(), json!(value)));
    SweepPoint {
        index,
        of,
        swept: swept.collect::<Map<_, _>>(),
        hash: String::new(),
    }
}

pub(crate) fn run(
    project: &Project,
    ablate: &Ablate,
    published: Option<&Published>,
) -> Result<(), Failure> {
    let mut axes = Vec::new();
    for text in &ablate.sweeping.axes {
        axes.push(text.parse::<Axis>()?);
    }
    let points = points(&axes)?;
    let part = ablate.sweeping.partition;
    let own = |index: usize| part.is_none_or(|part| part.holds(index));
    // What is wrong anywhere is said before hours are spent.
    for (index, swept) in points.iter().enumerate() {
        if own(index) {
            prepare(project, &at_point(ablate, swept))?;
        }
    }
    let files = [&ablate.json, &ablate.markdown, &ablate.csv, &ablate.report];
    outputs::check(files.into_iter().flatten(), ablate.out.as_ref())?;
    let mut sweep = match &ablate.json {
        Some(path) if path.exists() => read(path)?,
        _ => Sweep::default(),
    };
    for (known, _) in sweep.places() {
        let expected = points.get(known.index);
        if expected
            .is_none_or(|swept| planned(known.index, points.len(), swept).swept != known.swept)
            || known.of != points.len()
        {
            let message = format!(
                "the results file holds a point of another sweep: {}",
                known.label()
            );
            let help = "name another file, or remove this one";
            return Err(Diagnostic::error(message).with_help(help).into());
        }
    }
    let gpu = ablate.look.gpu()?;
    for (index, swept) in points.iter().enumerate().filter(|(index, _)| own(*index)) {
        let ablation = prepare(project, &at_point(ablate, swept))?;
        let mut point = planned(index, points.len(), swept);
        point.hash = fingerprint(&ablation, project, &gpu)?;
        let title = format!("point {} of {}: {}", index + 1, points.len(), point.label());
        if sweep.holds(&point.hash) {
            tell(&format!("{title}: known already"));
            continue;
        }
        if sweep.places().any(|(known, _)| known.index == index) {
            tell(&format!(
                "{title}: known of another program, adapter or question; run anew"
            ));
        }
        let bar = Bar::new();
        let outcome = ablation.run(project, &gpu, &|what, done| bar.tell(what, done));
        bar.finish();
        let outcome = outcome?;
        say(&format!(
            "\n{title}\n{}",
            Table::of(&outcome.results).terminal()
        ))?;
        say(&ablate.sweeping.asked.below(&outcome.results))?;
        for warning in gathered_warnings(&outcome.results) {
            say(&format!("warning: {warning}\n"))?;
        }
        if let Some(folder) = &ablate.out {
            write_directory(&folder.join(folder_name(&point)), &outcome)?;
        }
        sweep.put(&point, outcome.results)?;
        if let Some(path) = &ablate.json {
            write_atomically(path, sweep.to_json()?.as_bytes())?;
        }
    }
    let rows = published.map_or(Vec::new(), |published| beside(&sweep, published));
    let source = published.map_or(String::new(), source);
    let beside = match rows.is_empty() {
        true => String::new(),
        false => format!("\n{source}\n\n{}", aligned(&rows)),
    };
    say(&beside)?;
    if let Some(path) = &ablate.report {
        let table = (!rows.is_empty()).then_some(Beside {
            source: &source,
            headings: &HEADINGS,
            rows: &rows,
        });
        write_atomically(path, sweep_report(&sweep, table)?.as_bytes())?;
    }
    if let Some(path) = &ablate.csv {
        write_atomically(path, sweep.csv()?.as_bytes())?;
    }
    if let Some(path) = &ablate.markdown {
        let mut text = String::new();
        for (point, results) in sweep.places() {
            text.push_str(&format!(
                "## {}\n\n{}{}\n",
                point.label(),
                Table::of(results).markdown(),
                ablate.sweeping.asked.markdown(results)
            ));
        }
        write_atomically(path, (text + &beside).as_bytes())?;
    }
    Ok(())
}

/// A folder's name for a point: its number and settings.
fn folder_name(point: &SweepPoint) -> String {
    let allowed = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.' | '=' | ',');
    let settings = point.label().replace(", ", ",");
    let settings: String = settings
        .chars()
        .map(|c| if allowed(c) { c } else { '-' })
        .collect();
    format!("{:03}-{settings}", point.index + 1)
}

fn read(path: &Path) -> Result<Sweep, Failure> {
    let name = path.display().to_string();
    let text = std::fs::read_to_string(path)
        .map_err(|error| Diagnostic::error(format!("cannot read `{name}`: {error}")))?;
    Sweep::from_json(&name, &text).map_err(|wrong| Diagnostic::error(wrong.to_string()).into())
}

/// Headings of [`beside`].
const HEADINGS: [&str; 6] = [
    "at",
    "pipeline",
    "frames/s",
    "times",
    "theirs: frames/s",
    "theirs: times",
];

/// Whose figures stand beside ours.
fn source(published: &Published) -> String {
    format!(
        "Beside {}; times are multiples of {}'s. Theirs are of their machine and scene: compare \
         ratios.",
        published.source, published.relative_to
    )
}

/// Published figures beside ours; none where they are of other points than those that ran.
fn beside(sweep: &Sweep, published: &Published) -> Vec<Vec<String>> {
    let mut rows: Vec<Vec<String>> = Vec::new();
    for (point, results) in sweep.places() {
        let value = |v: &serde_json::Value| v.as_str().unwrap_or_default().to_owned();
        let swept = point.swept.iter();
        let swept: Vec<_> = swept.map(|(k, v)| (k.clone(), value(v))).collect();
        let Some(figures) = published.at(&swept) else {
            continue;
        };
        for row in &results.rows {
            let Some(rate) = figures.frames_per_second.get(&row.pipeline) else {
                continue;
            };
            let times = |times: Option<f64>| times.map_or("–".to_owned(), |t| format!("{t:.2}"));
            rows.push(vec![
                point.label(),
                row.pipeline.clone(),
                format!("{:.2}", 1000.0 / row.frame_ms.median),
                times(ratio(results, &row.pipeline, &published.relative_to)),
                format!("{rate:.2}"),
                times(figures.relative(&row.pipeline, &published.relative_to)),
            ]);
        }
    }
    rows
}

/// Rows under [`HEADINGS`] as Markdown with columns of even width.
fn aligned(rows: &[Vec<String>]) -> String {
    let width = |column: usize| {
        let cells = rows.iter().map(|row| row[column].chars().count());
        let heading = HEADINGS[column].chars().count();
        cells.fold(heading, usize::max)
    };
    let line = |cells: Vec<&str>| {
        let padded = cells.iter().enumerate().map(|(column, cell)| {
            let pad = " ".repeat(width(column).saturating_sub(cell.chars().count()));
            match column < 2 {
                true => format!("{cell}{pad}"),
                false => format!("{pad}{cell}"),
            }
        });
        format!("| {} |\n", padded.collect::<Vec<_>>().join(" | "))
    };
    let rule = |column: usize| match column < 2 {
        true => "-".repeat(width(column)),
        false => "-".repeat(width(column) - 1) + ":",
    };
    let rules: Vec<String> = (0..HEADINGS.len()).map(rule).collect();
    let mut text = line(HEADINGS.to_vec());
    text.push_str(&line(rules.iter().map(String::as_str).collect()));
    for row in rows {
        text.push_str(&line(row.iter().map(String::as_str).collect()));
    }
    text
}

/// Time of a pipeline as a multiple of another's in the same results: the median of the rounds.
fn ratio(results: &Results, pipeline: &str, to: &str) -> Option<f64> {
    let samples = |name: &str| {
        let row = results.rows.iter().find(|row| row.pipeline == name)?;
        Some(&row.frame_ms.samples)
    };
    let (ours, base) = (samples(pipeline)?, samples(to)?);
    let ratios: Vec<f64> = ours.iter().zip(base).map(|(a, b)| a / b).collect();
    meniscus::measure::median(&ratios)
}

pub(crate) fn merge(merge: &Merge) -> Result<(), Failure> {
    outputs::check(
        [Some(&merge.output), merge.csv.as_ref()]
            .into_iter()
            .flatten(),
        None,
    )?;
    let mut sweeps = Vec::new();
    for path in &merge.files {
        sweeps.push((path.display().to_string(), read(path)?));
    }
    let merged = Sweep::merge(sweeps).map_err(|wrong| Diagnostic::error(wrong.to_string()))?;
    let (known, all) = merged.progress();
    write_atomically(&merge.output, merged.to_json()?.as_bytes())?;
    if let Some(path) = &merge.csv {
        write_atomically(path, merged.csv()?.as_bytes())?;
    }
    say(&format!(
        "{known} of {all} points: {}\n",
        merge.output.display()
    ))
}
