//! The page about numerical stability: figures of every module, of what fills a slot side by side,
//! and of extreme scenes; from what `meniscus stress` has written.

mod functions;
mod scenes;

use std::fmt::Write as _;

use meniscus_measure::{FigurePoint, MeasureError, plane_figure};
use serde_json::Value;

use crate::project::Project;
use crate::solvers::Solver;

/// What the page is made from.
#[derive(Debug, Clone, Default)]
pub struct StabilityData {
    /// What `meniscus stress --json` writes.
    pub functions: Value,
    /// What `meniscus stress --agreement --json` writes.
    pub agreement: Value,
    /// What `meniscus stress --exhaustive --json` writes.
    pub exhaustive: Value,
    /// What `meniscus stress --scenes N --json` writes.
    pub scenes: Value,
    /// What fills one slot.
    pub solvers: Vec<Solver>,
    /// What was found and mended, in Markdown.
    pub told: String,
}

/// The page, in Markdown.
///
/// # Errors
/// When figures are missing that the page tells.
pub fn stability_page(project: &Project, data: &StabilityData) -> Result<String, MeasureError> {
    let mut page = String::from(
        "<!-- Made by `meniscus stress --page docs/stability.md` from docs/stability/; edit told.md \
         there, not this. -->\n\n# Numerical stability\n\n\
         Every figure here comes from the modules themselves: the shader code that a GPU runs is \
         evaluated on the CPU in several number systems (see `crates/meniscus-stress`), and \
         pictures are rendered of scenes that are as unkind as can be.\n\n",
    );
    functions::told(&mut page, project, &data.functions)?;
    functions::exhausted(&mut page, &data.exhaustive)?;
    functions::agreement(&mut page, &data.agreement)?;
    solvers(&mut page, data);
    scenes::told(&mut page, &data.scenes)?;
    page += "\n## Found and mended\n\n";
    page += data.told.trim();
    page += MADE;
    Ok(page)
}

const MADE: &str = "\n\n## How to make this page anew\n\n\
    ```sh\n\
    meniscus stress --samples 65536 --device cpu --json docs/stability/functions.json\n\
    meniscus stress --samples 100000 --agreement --json docs/stability/agreement.json\n\
    meniscus stress --exhaustive --json docs/stability/exhaustive.json\n\
    meniscus stress --solvers crossing --json docs/stability/solvers.json\n\
    meniscus stress --scenes 2000 --seed 1 --json docs/stability/scenes.json\n\
    meniscus stress --page docs/stability.md\n\
    ```\n";

/// What is wrong with data that cannot be read.
fn missing(what: &str) -> MeasureError {
    MeasureError::Value {
        what: what.to_owned(),
        problem: "is missing or of another kind; make it anew with `meniscus stress`".to_owned(),
    }
}

fn number(value: &Value, path: &str) -> Result<f64, MeasureError> {
    match value.pointer(path) {
        // JSON has no infinity: what is none was one.
        Some(Value::Null) => Ok(f64::INFINITY),
        Some(found) => found.as_f64().ok_or_else(|| missing(path)),
        None => Err(missing(path)),
    }
}

fn list<'a>(value: &'a Value, key: &str) -> Result<&'a [Value], MeasureError> {
    let found = value.get(key).and_then(Value::as_array);
    found.map(Vec::as_slice).ok_or_else(|| missing(key))
}

/// The name of a function of a module, as on the command line.
fn name(function: &Value) -> Result<String, MeasureError> {
    Ok(format!(
        "{}:{}",
        text(function, "module")?,
        text(function, "function")?
    ))
}

/// A row of a table in words.
fn words<const COLUMNS: usize>(cells: [&str; COLUMNS]) -> Vec<String> {
    cells.map(str::to_owned).to_vec()
}

fn text<'a>(value: &'a Value, key: &str) -> Result<&'a str, MeasureError> {
    value
        .get(key)
        .and_then(Value::as_str)
        .ok_or_else(|| missing(key))
}

/// A number in as few letters as tell its size.
pub fn short(x: f64) -> String {
    match x {
        x if x.is_infinite() => "∞".to_owned(),
        x if x >= 1e4 => format!("{x:.1e}"),
        x if x >= 100.0 => format!("{x:.0}"),
        x if x >= 10.0 => format!("{x:.1}"),
        x => format!("{x:.2}"),
    }
}

fn solvers(page: &mut String, data: &StabilityData) {
    *page += "\n## The solvers of the crossing\n\n\
        Each on every domain that one of them declares, against the independent truth; nanoseconds of \
        one evaluation with the evaluator on one core, and on the adapter with the copies of inputs \
        and results, the fastest of several rounds in turn.\n";
    for (index, domain) in domains(data).into_iter().enumerate() {
        let number = index + 1;
        let _ = writeln!(
            page,
            "\n`{domain}`\n\n![Time against error](stability/solvers-{number}.svg)\n"
        );
        let mut rows = vec![
            [
                "solver",
                "ns, a core",
                "ns, adapter",
                "p99, ulp",
                "max, ulp",
            ]
            .map(str::to_owned)
            .to_vec(),
        ];
        for solver in data.solvers.iter().filter(|s| s.domain == domain) {
            rows.push(vec![
                solver.module.clone(),
                format!("{:.0}", solver.cpu_ns),
                solver
                    .gpu_ns
                    .map_or("—".to_owned(), |ns| format!("{ns:.0}")),
                short(solver.p99_ulp),
                short(solver.max_ulp),
            ]);
        }
        *page += &table(&rows);
    }
}

/// Time against error on each domain that solvers were tried on, in the order in which the page
/// tells of them: the figures `solvers-1.svg` and so on beside its data.
///
/// # Errors
/// When a time or an error cannot be drawn.
pub fn solvers_figures(data: &StabilityData) -> Result<Vec<String>, MeasureError> {
    let figure = |domain: &str| {
        let mut points = Vec::new();
        for solver in data.solvers.iter().filter(|s| s.domain == domain) {
            let leaf = solver.module.rsplit('/').next().unwrap_or(&solver.module);
            let ns = solver.cpu_ns.max(1e-3);
            for (which, error) in [("p99", solver.p99_ulp), ("max", solver.max_ulp)] {
                points.push(FigurePoint {
                    label: format!("{leaf}, {which}"),
                    ms: ns,
                    spread_ms: [ns, ns],
                    // A drawing has no place for what is infinite.
                    error: error.min(1e38),
                });
            }
        }
        let axes = [
            "nanoseconds of an evaluation, on one core",
            "error against the truth, ulp",
        ];
        plane_figure(domain, axes, &points)
    };
    domains(data).into_iter().map(figure).collect()
}

/// The domains that solvers were tried on.
fn domains(data: &StabilityData) -> Vec<&str> {
    let mut domains: Vec<&str> = Vec::new();
    for solver in &data.solvers {
        if !domains.contains(&solver.domain.as_str()) {
            domains.push(&solver.domain);
        }
    }
    domains
}

/// A table in Markdown, the first row being its head.
fn table(rows: &[Vec<String>]) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let mut text = String::new();
    for (index, row) in rows.iter().enumerate() {
        text += &line(row);
        if index == 0 {
            text += &line(&vec!["---".to_owned(); row.len()]);
        }
    }
    text
}
