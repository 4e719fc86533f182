//! `meniscus stress`

mod agreement;
mod exhaustive;

use std::path::Path;
use std::time::Duration;

use clap::{Args, ValueEnum};
use meniscus::gpu::{Gpu, GpuError};
use meniscus::measure::write_atomically;
use meniscus::source::{Diagnostic, Report};
use meniscus::stress::Effort;
use meniscus::stress::modules::{Assay, Declared, Device, declared};
use meniscus::{FunctionsOnGpu, Project, short};
use serde_json::{Value, json};

use super::arguments::Stress;
use super::progress::Bar;
use super::say::tell;
use super::{Failure, outputs};

/// What computes in `f32`, and on how many inputs.
#[derive(Debug, Args)]
pub(crate) struct Computers {
    /// What runs the functions: the evaluator, a graphics adapter, or one after the other. By
    /// default both, where there is an adapter.
    #[arg(long, value_enum)]
    device: Option<Devices>,
    /// The graphics adapter, by a part of its name (see `meniscus adapters`); the best one if none
    /// is given.
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Try a function of one number on all floats there are, on the CPU; it takes an hour on two
    /// cores. If none is named, all functions of one number.
    #[arg(long)]
    exhaustive: bool,
    /// Hold what the adapter computes to what the evaluator computes, bit by bit, on as many inputs
    /// as --samples says.
    #[arg(long, conflicts_with = "exhaustive")]
    agreement: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Devices {
    /// The evaluator, on the CPU.
    Cpu,
    /// A graphics adapter.
    Gpu,
    /// Both.
    Both,
}

impl Computers {
    /// The evaluator (none) and the adapter, as far as they are wanted and there.
    fn open(&self) -> Result<Vec<Option<FunctionsOnGpu>>, Failure> {
        let gpu = || Gpu::open(self.adapter.as_deref()).map(|gpu| Some(FunctionsOnGpu(gpu)));
        Ok(match self.device {
            Some(Devices::Cpu) => vec![None],
            Some(Devices::Gpu) => vec![gpu()?],
            Some(Devices::Both) => vec![None, gpu()?],
            None => match gpu() {
                Ok(gpu) => vec![None, gpu],
                Err(GpuError::NoAdapter { wanted: None, .. }) => {
                    tell("there is no graphics adapter: functions run on the CPU alone");
                    vec![None]
                }
                Err(error) => return Err(error.into()),
            },
        })
    }
}

pub(crate) fn run(project: &Project, stress: &Stress) -> Result<(), Failure> {
    let host = stress.surroundings.host()?;
    let (all, report) = declared(project.composer.library());
    report.into_result(())?;
    let chosen = choose(project, &all, stress.target.as_deref())?;
    outputs::check(
        [&stress.json, &stress.markdown].into_iter().flatten(),
        stress.worst.as_ref(),
    )?;
    if stress.computers.exhaustive {
        return exhaustive::run(project, stress, &all, &chosen, &host);
    }
    if stress.computers.agreement {
        return agreement::run(project, stress, &all, &chosen, &host);
    }
    let computers = stress.computers.open()?;
    for gpu in computers.iter().flatten() {
        tell(&format!("on the GPU: {}", gpu.0.facts()));
    }
    let water = host
        .number("water.refractive_index")
        .zip(host.number("water.camera_side"));
    let waters: Vec<(f64, bool)> = match water {
        Some((index, side)) if stress.surroundings.sets_water() => vec![(index, side > 0.0)],
        _ => Vec::new(),
    };
    let samples = stress.samples as usize;
    let effort = Effort {
        random: samples,
        special: samples / 16,
        climb: samples / 16,
        time: Duration::from_secs(stress.seconds),
        seed: stress.seed,
    };
    let bar = Bar::new();
    let mut assays = Vec::new();
    for (index, function) in chosen.iter().enumerate() {
        let name = format!("{}:{}", function.module, function.name);
        bar.tell(&name, index as f64 / chosen.len() as f64);
        for computer in &computers {
            let device = computer.as_ref().map(|gpu| gpu as &dyn Device);
            let (composer, waters) = (&project.composer, &waters);
            assays.push(Assay::run_on(
                device, composer, &all, function, &host, waters, &effort,
            )?);
        }
    }
    bar.finish();
    let table = table(&assays);
    print!("{table}");
    for assay in &assays {
        if chosen.len() == 1 {
            println!("\n{}", assay.domain);
            println!("worst input{}:", on(assay));
            for (name, value) in &assay.worst_numbers {
                println!("  {name} = {value:e}");
            }
        }
    }
    if let Some(path) = &stress.json {
        let on: Vec<String> = computers.iter().map(told).collect();
        write_json(path, stress, &json!({ "on": on, "functions": assays }))?;
    }
    if let Some(path) = &stress.markdown {
        write_atomically(path, table.as_bytes())?;
    }
    if let Some(folder) = &stress.worst {
        for assay in assays.iter().filter(|assay| assay.device.is_none()) {
            let name = format!("{}.{}.json", assay.module.replace('/', "."), assay.function);
            let text = serde_json::to_string(&assay.worst)
                .map_err(|error| Failure::Machine(format!("error: {error}")))?;
            write_atomically(&folder.join(name), text.replace("},{", "},\n{").as_bytes())?;
        }
    }
    Ok(())
}

/// Declared functions of a module, or one of them; of structures only functions are told apart when
/// they are run.
fn choose<'d>(
    project: &Project,
    all: &'d [Declared],
    target: Option<&str>,
) -> Result<Vec<&'d Declared>, Report> {
    let functions: Vec<&Declared> = all
        .iter()
        .filter(|declared| declared.is_function(project.composer.library()))
        .collect();
    let Some(target) = target else {
        return Ok(functions);
    };
    let (module, function) = match target.split_once(':') {
        Some((module, function)) => (module, Some(function)),
        None => (target, None),
    };
    let fits = |d: &&&Declared| d.module == module && function.is_none_or(|name| d.name == name);
    let found: Vec<&Declared> = functions.iter().filter(fits).copied().collect();
    if found.is_empty() {
        let known: Vec<String> = functions
            .iter()
            .map(|d| format!("{}:{}", d.module, d.name))
            .collect();
        let wrong = Diagnostic::error(format!("`{target}` declares no domain, or is not there"));
        return Err(wrong
            .with_suggestion(target, known.iter().map(String::as_str))
            .with_help("declare it in the module's header: `// domain: FUNCTION(ARGUMENT 1 to 2)`")
            .into());
    }
    Ok(found)
}

/// What computes, in words.
fn told(computer: &Option<FunctionsOnGpu>) -> String {
    match computer {
        Some(gpu) => gpu.0.facts().to_string(),
        None => "the CPU".to_owned(),
    }
}

/// Writes results with where they come from.
fn write_json(path: &Path, stress: &Stress, found: &Value) -> Result<(), Failure> {
    let mut all = json!({
        "meniscus": env!("CARGO_PKG_VERSION"),
        "commit": meniscus::COMMIT,
        "samples": stress.samples,
        "seed": stress.seed,
    });
    if let (Some(all), Some(found)) = (all.as_object_mut(), found.as_object()) {
        all.extend(found.clone());
    }
    let text = serde_json::to_string_pretty(&all)
        .map_err(|error| Failure::Machine(format!("error: {error}")))?;
    Ok(write_atomically(path, (text + "\n").as_bytes())?)
}

/// What stands behind a function's name that did not run on the CPU.
fn on(assay: &Assay) -> String {
    let device = assay.device.as_ref();
    device.map_or_else(String::new, |device| format!(" on {device}"))
}

/// A Markdown table, aligned for the terminal.
fn table(assays: &[Assay]) -> String {
    let title = [
        "function",
        "inputs",
        "rounding: median",
        "p99",
        "max",
        "method: max",
        "condition: max",
        "error/(1 + condition): p99",
        "max",
        "not finite",
        "branches",
        "enclosed",
        "parts at",
    ];
    let mut rows = vec![title.map(str::to_owned)];
    for assay in assays {
        rows.push([
            format!("{}:{}{}", assay.module, assay.function, on(assay)),
            assay.found.inputs.to_string(),
            short(assay.found.rounding.median),
            short(assay.found.rounding.p99),
            short(assay.found.rounding.max),
            assay
                .found
                .method
                .map_or("—".to_owned(), |method| short(method.max)),
            short(assay.found.condition.max),
            short(assay.found.scaled.p99),
            short(assay.found.scaled.max),
            assay.found.non_finite.to_string(),
            assay.found.branches.to_string(),
            format!("{:.0} %", 100.0 * assay.found.enclosed),
            assay.parts_at.clone().unwrap_or_else(|| "—".to_owned()),
        ]);
    }
    aligned(&rows)
}

/// Rows in Markdown, the first being the head, with columns of equal width.
fn aligned<const COLUMNS: usize>(rows: &[[String; COLUMNS]]) -> String {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max();
    let widths: [usize; COLUMNS] = std::array::from_fn(|column| width(column).unwrap_or(0));
    let mut text = String::new();
    for (index, row) in rows.iter().enumerate() {
        let cells: Vec<String> = row
            .iter()
            .zip(&widths)
            .map(|(cell, width)| format!("{cell}{}", " ".repeat(width - cell.chars().count())))
            .collect();
        text += &format!("| {} |\n", cells.join(" | "));
        if index == 0 {
            let lines: Vec<String> = widths.iter().map(|width| "-".repeat(*width)).collect();
            text += &format!("|-{}-|\n", lines.join("-|-"));
        }
    }
    text
}
