//! The page about numerical stability: figures of every module, of what fills a slot side by side,
//! and of extreme scenes; from what `meniscus stress` has written.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use meniscus_measure::{FigurePoint, MeasureError, plane_figure};
use serde_json::Value;

use crate::project::Project;
use crate::solvers::Solver;

/// The most that error/(1 + condition) may be without a reason, ulp.
const PROMISED: f64 = 4.0;

/// What the page is made from.
#[derive(Debug, Clone, Default)]
pub struct StabilityData {
    /// What `meniscus stress --json` writes.
    pub functions: Value,
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
    functions(&mut page, project, data)?;
    solvers(&mut page, data);
    scenes(&mut page, data)?;
    page += "\n## Found and mended\n\n";
    page += data.told.trim();
    page += MADE;
    Ok(page)
}

const MADE: &str = "\n\n## How to make this page anew\n\n\
    ```sh\n\
    meniscus stress --samples 65536 --json docs/stability/functions.json\n\
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

fn text<'a>(value: &'a Value, key: &str) -> Result<&'a str, MeasureError> {
    value
        .get(key)
        .and_then(Value::as_str)
        .ok_or_else(|| missing(key))
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

fn functions(
    page: &mut String,
    project: &Project,
    data: &StabilityData,
) -> Result<(), MeasureError> {
    let all = data
        .functions
        .as_array()
        .ok_or_else(|| missing("functions.json"))?;
    *page += "## Modules\n\n\
        Errors are in units in the last place (ulp) of 32-bit floats, the worst over all numbers of \
        a result and over water of index 1.333 from above and from below, 2.5 and 0.4. *Rounding* is \
        `f32` against the same formulas with 31 digits; *method* these against an independent truth; \
        *condition* the relative change of the result for a relative change of the arguments. What is \
        promised is error/(1 + condition), and that no result in the domain is infinite or undefined. \
        Inputs are random, special (0, denormals, critical points) and those of an adversary that \
        climbs from bad inputs to worse.\n\n";
    let mut modules: BTreeMap<&str, Vec<&Value>> = BTreeMap::new();
    let mut devices = BTreeSet::new();
    for function in all {
        modules
            .entry(text(function, "module")?)
            .or_default()
            .push(function);
        devices.insert(
            function
                .get("device")
                .and_then(Value::as_str)
                .unwrap_or("the CPU"),
        );
    }
    let names: Vec<&str> = devices.into_iter().collect();
    let _ = writeln!(page, "Run on: {}.\n", names.join("; "));
    let mut rows = vec![
        [
            "function",
            "on",
            "inputs",
            "rounding: p99",
            "max",
            "method: max",
            "error/(1 + condition): p99",
            "max",
            "not finite",
        ]
        .map(str::to_owned)
        .to_vec(),
    ];
    let (mut held, mut not_finite) = (0, 0.0);
    for function in all {
        let name = format!(
            "{}:{}",
            text(function, "module")?,
            text(function, "function")?
        );
        let worst = number(function, "/scaled/max")?;
        held += usize::from(worst <= PROMISED);
        not_finite += number(function, "/non_finite")?;
        let method = match function.get("method") {
            None | Some(Value::Null) => "—".to_owned(),
            Some(method) => short(number(method, "/max")?),
        };
        let device = function
            .get("device")
            .and_then(Value::as_str)
            .map_or("CPU", |_| "GPU");
        rows.push(vec![
            name,
            device.to_owned(),
            format!("{}", number(function, "/inputs")?),
            short(number(function, "/rounding/p99")?),
            short(number(function, "/rounding/max")?),
            method,
            short(number(function, "/scaled/p99")?),
            short(worst),
            format!("{}", number(function, "/non_finite")?),
        ]);
    }
    let _ = writeln!(
        page,
        "Of {} rows {held} are within {PROMISED} ulp at their worst input; {not_finite} results are not \
         finite. Why the others are beyond it is told in `crates/meniscus-stress/README.md`.\n",
        all.len()
    );
    *page += &table(&rows);
    *page += "\n### Domains\n\nWhere inputs may lie for these figures to hold; metres, unit vectors \
              without unit.\n\n";
    for (module, functions) in modules {
        let purpose = project.composer.library().get(module);
        let purpose = purpose.map_or("", |found| found.header.purpose.as_str());
        let _ = writeln!(page, "- **{module}** — {purpose}");
        let mut said = BTreeSet::new();
        for function in functions {
            let domain = text(function, "domain")?;
            if said.insert(domain) {
                let _ = writeln!(page, "  - `{domain}`");
            }
        }
    }
    Ok(())
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

fn scenes(page: &mut String, data: &StabilityData) -> Result<(), MeasureError> {
    let scenes = &data.scenes;
    let (tried, pictures) = (number(scenes, "/scenes")?, number(scenes, "/pictures")?);
    let failures = scenes.get("failures").and_then(Value::as_array);
    let failures = failures.ok_or_else(|| missing("failures"))?.len();
    let refused = scenes.get("refused").and_then(Value::as_object);
    let refused = refused.ok_or_else(|| missing("refused"))?;
    let oddities = scenes.get("oddities").and_then(Value::as_object);
    let oddities = oddities.ok_or_else(|| missing("oddities"))?;
    let _ = writeln!(
        page,
        "\n## Extreme scenes\n\n\
         {tried} random scenes of seed {} were rendered by two pipelines each, by turns of {}: {pictures} \
         pictures, of which {failures} fail. A picture holds when no texture has a NaN or an infinity, a \
         second frame and a frame that leaves out what it can are equal to it bit for bit, no driver or \
         graphics library objects, nothing panics, and, where the scene lies in the modules' domains \
         and a pass traces the scene's triangles, it shows the points that a ray tracer in `f64` shows.\n",
        number(scenes, "/seed")?,
        number(scenes, "/pipelines")?,
    );
    let _ = writeln!(
        page,
        "{} pictures with {} pixels of water were held to that truth: {} pixels are more than half a \
         pixel off; the mean error is {:.4} pixels.\n",
        number(scenes, "/judged")?,
        number(scenes, "/distance/pixels")?,
        number(scenes, "/distance/far")?,
        number(scenes, "/distance/mean_px")?,
    );
    if refused.is_empty() {
        *page += "No scene was refused.\n\n";
    } else {
        *page += "Scenes that were refused in words, which is no failure:\n\n";
        for (why, times) in refused {
            let _ = writeln!(page, "- {times} × {why}");
        }
        *page += "\n";
    }
    *page += "A scene is an ordinary pool that is made odd in up to six of these ways; of each, the \
              values lie at those listed in `crates/meniscus/src/scene_stress/oddities.rs` or between \
              them:\n\n";
    let mut kinds: BTreeMap<&str, (f64, BTreeSet<String>)> = BTreeMap::new();
    for (said, times) in oddities {
        let (name, value) = said.rsplit_once(": ").unwrap_or((said, ""));
        let kind = kinds.entry(name).or_default();
        kind.0 += times.as_f64().unwrap_or(0.0);
        kind.1.insert(value.to_owned());
    }
    for (name, (times, values)) in kinds {
        let _ = writeln!(page, "- {name}: {times} scenes, {} values", values.len());
    }
    Ok(())
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
