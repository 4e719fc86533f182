//! `meniscus stress --exhaustive`: every float for functions of one number.

use std::time::Instant;

use meniscus::Project;
use meniscus::stress::modules::{Declared, Exhaustive, Host};
use serde_json::{Value, json};

use super::super::Failure;
use super::super::arguments::Stress;
use super::super::progress::Bar;
use super::super::say::say;
use super::write_json;

pub(super) fn run(
    project: &Project,
    stress: &Stress,
    all: &[Declared],
    chosen: &[&Declared],
    host: &Host,
) -> Result<(), Failure> {
    let mut tried: Vec<Value> = Vec::new();
    for function in chosen {
        // Of all functions those that can be tried; what is named is refused where it cannot.
        if stress.target.is_none() && !Exhaustive::suits(&project.composer, function)? {
            continue;
        }
        let name = format!("{}:{}", function.module, function.name);
        let bar = Bar::new();
        let start = Instant::now();
        let progress = |part: f64| bar.tell(&name, part);
        let found = Exhaustive::run(&project.composer, all, function, host, &progress)?;
        bar.finish();
        let seconds = start.elapsed().as_secs_f64();
        say(&told(&name, &found, seconds))?;
        let mut entry = serde_json::to_value(&found)
            .map_err(|error| Failure::Machine(format!("error: {error}")))?;
        entry["seconds"] = json!(seconds.round());
        tried.push(entry);
    }
    match &stress.json {
        Some(path) => write_json(path, stress, &json!({ "functions": tried })),
        None => Ok(()),
    }
}

fn told(name: &str, found: &Exhaustive, seconds: f64) -> String {
    let (low, high) = found.domain;
    let inside = format!("from {low:e} to {high:e}, its domain");
    let mut text = format!("{name}: every finite float, in {seconds:.0} s\n");
    for (what, part) in [(&*inside, found.inside), ("all others", found.outside)] {
        text += &format!(
            "  {what}: {} floats\n    \
             largest error           {:.4e} ulp at {:e}\n    \
             error / (1 + condition) {:.4e} ulp at {:e}\n    \
             not finite              {}\n",
            part.inputs, part.max, part.at, part.scaled, part.scaled_at, part.non_finite
        );
    }
    text
}
