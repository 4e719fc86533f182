//! `meniscus stress --agreement`: the adapter beside the evaluator, bit by bit.

use meniscus::gpu::Gpu;
use meniscus::measure::write_atomically;
use meniscus::stress::modules::{Agreement, Declared, Host};
use meniscus::{FunctionsOnGpu, Project, short};
use serde_json::json;

use super::super::Failure;
use super::super::arguments::Stress;
use super::super::progress::Bar;
use super::super::say::say;
use super::{aligned, write_json};

pub(super) fn run(
    project: &Project,
    stress: &Stress,
    all: &[Declared],
    chosen: &[&Declared],
    host: &Host,
) -> Result<(), Failure> {
    let gpu = FunctionsOnGpu(Gpu::open(stress.computers.adapter.as_deref())?);
    let bar = Bar::new();
    let mut found = Vec::new();
    for (index, function) in chosen.iter().enumerate() {
        let name = format!("{}:{}", function.module, function.name);
        bar.tell(&name, index as f64 / chosen.len() as f64);
        let (composer, inputs) = (&project.composer, stress.samples as usize);
        found.push(Agreement::run(
            &gpu,
            composer,
            all,
            function,
            host,
            inputs,
            stress.seed,
        )?);
    }
    bar.finish();
    let table = table(&found);
    say(&table)?;
    if let Some(path) = &stress.json {
        let on = gpu.0.facts().to_string();
        write_json(path, stress, &json!({ "on": on, "functions": found }))?;
    }
    if let Some(path) = &stress.markdown {
        write_atomically(path, table.as_bytes())?;
    }
    Ok(())
}

fn table(found: &[Agreement]) -> String {
    let head = [
        "function",
        "inputs",
        "numbers",
        "differ",
        "largest, ulp",
        "built-ins",
    ];
    let mut rows = vec![head.map(str::to_owned)];
    for one in found {
        let built_ins: Vec<&str> = one.built_ins.iter().map(String::as_str).collect();
        rows.push([
            format!("{}:{}", one.module, one.function),
            one.inputs.to_string(),
            one.numbers.to_string(),
            one.differ.to_string(),
            short(one.largest_ulp),
            built_ins.join(" "),
        ]);
    }
    aligned(&rows)
}
