//! `meniscus stress`

use std::time::{Duration, Instant};

use clap::{Args, ValueEnum};
use meniscus::gpu::{Gpu, GpuError};
use meniscus::measure::write_atomically;
use meniscus::source::{Diagnostic, Report};
use meniscus::stress::Effort;
use meniscus::stress::modules::{Assay, Declared, Device, Exhaustive, Host, declared};
use meniscus::{FunctionsOnGpu, Project};

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
    /// Try a function of one number on all floats there are, on the CPU; it takes minutes.
    #[arg(long)]
    exhaustive: bool,
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
        return exhaust(project, &all, &chosen, &host);
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
        let text = serde_json::to_string_pretty(&assays)
            .map_err(|error| Failure::Machine(format!("error: {error}")))?;
        write_atomically(path, text.as_bytes())?;
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
        .filter(|declared| {
            let module = project.composer.library().get(&declared.module);
            module.is_some_and(|m| m.file.text.contains(&format!("fn {}(", declared.name)))
        })
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

/// What stands behind a function's name that did not run on the CPU.
fn on(assay: &Assay) -> String {
    let device = assay.device.as_ref();
    device.map_or_else(String::new, |device| format!(" on {device}"))
}

/// Every float for functions of one number.
fn exhaust(
    project: &Project,
    all: &[Declared],
    chosen: &[&Declared],
    host: &Host,
) -> Result<(), Failure> {
    for function in chosen {
        let name = format!("{}:{}", function.module, function.name);
        let bar = Bar::new();
        let start = Instant::now();
        let progress = |part: f64| bar.tell(&name, part);
        let found = Exhaustive::run(&project.composer, all, function, host, &progress)?;
        bar.finish();
        println!(
            "{name}: every finite float, in {:.0} s",
            start.elapsed().as_secs_f64()
        );
        let (low, high) = found.domain;
        for (what, part) in [
            (
                format!("from {low:e} to {high:e}, its domain"),
                found.inside,
            ),
            ("all others".to_owned(), found.outside),
        ] {
            println!("  {what}: {} floats", part.inputs);
            println!(
                "    largest error           {:.4e} ulp at {:e}",
                part.max, part.at
            );
            println!(
                "    error / (1 + condition) {:.4e} ulp at {:e}",
                part.scaled, part.scaled_at
            );
            println!("    not finite              {}", part.non_finite);
        }
    }
    Ok(())
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
            assay.inputs.to_string(),
            short(assay.rounding.median),
            short(assay.rounding.p99),
            short(assay.rounding.max),
            assay
                .method
                .map_or("—".to_owned(), |method| short(method.max)),
            short(assay.condition.max),
            short(assay.scaled.p99),
            short(assay.scaled.max),
            assay.non_finite.to_string(),
            assay.branches.to_string(),
            format!("{:.0} %", 100.0 * assay.enclosed),
            assay.parts_at.clone().unwrap_or_else(|| "—".to_owned()),
        ]);
    }
    let widths: Vec<usize> = (0..title.len())
        .map(|i| {
            rows.iter()
                .map(|row| row[i].chars().count())
                .max()
                .unwrap_or(0)
        })
        .collect();
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

/// A number in as few letters as tell its size.
fn short(x: f64) -> String {
    match x {
        x if x.is_infinite() => "∞".to_owned(),
        x if x >= 1e4 => format!("{x:.1e}"),
        x if x >= 100.0 => format!("{x:.0}"),
        x if x >= 10.0 => format!("{x:.1}"),
        x => format!("{x:.2}"),
    }
}
