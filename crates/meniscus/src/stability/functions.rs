//! Figures of functions: their errors, those of one number on every float, and what an adapter
//! computes otherwise than the evaluator.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use meniscus_measure::MeasureError;
use serde_json::Value;

use super::{list, name, number, short, table, text, words};
use crate::project::Project;

/// The most that error/(1 + condition) may be without a reason, ulp.
const PROMISED: f64 = 4.0;

pub(super) fn told(page: &mut String, project: &Project, data: &Value) -> Result<(), MeasureError> {
    let all = list(data, "functions")?;
    *page += "## Modules\n\n\
        Errors are in units in the last place (ulp) of 32-bit floats, the worst over all numbers of \
        a result and over water of index 1.333 from above and from below, 2.5 and 0.4. *Rounding* is \
        `f32` against the same formulas with 31 digits; *method* these against an independent truth; \
        *condition* the relative change of the result for a relative change of the arguments. What is \
        promised is error/(1 + condition), and that no result in the domain is infinite or undefined. \
        Inputs are random, special (0, denormals, critical points) and those of an adversary that \
        climbs from bad inputs to worse.\n\n";
    let on: Vec<&str> = list(data, "on")?.iter().filter_map(Value::as_str).collect();
    let commit = text(data, "commit")?;
    let _ = writeln!(page, "Run on: {}; commit {commit}.\n", on.join("; "));
    let mut rows = vec![words([
        "function",
        "on",
        "inputs",
        "rounding: p99",
        "max",
        "truth",
        "method: max",
        "/(1 + condition)",
        "error/(1 + condition): p99",
        "max",
        "not finite",
    ])];
    let (mut held, mut not_finite) = (0, 0.0);
    for function in all {
        let worst = number(function, "/scaled/max")?;
        held += usize::from(worst <= PROMISED);
        not_finite += number(function, "/non_finite")?;
        let method = |key: &str| match function.get(key) {
            None | Some(Value::Null) => Ok("—".to_owned()),
            Some(method) => Ok(short(number(method, "/max")?)),
        };
        let device = function.get("device").and_then(Value::as_str);
        rows.push(vec![
            name(function)?,
            device.map_or("CPU", |_| "GPU").to_owned(),
            format!("{}", number(function, "/inputs")?),
            short(number(function, "/rounding/p99")?),
            short(number(function, "/rounding/max")?),
            text(function, "against").unwrap_or("—").to_owned(),
            method("method")?,
            method("method_scaled")?,
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
    domains(page, project, all)
}

fn domains(page: &mut String, project: &Project, all: &[Value]) -> Result<(), MeasureError> {
    *page += "\n### Domains\n\nWhere inputs may lie for these figures to hold; metres, unit vectors \
              without unit.\n\n";
    let mut modules: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for function in all {
        let said = modules.entry(text(function, "module")?).or_default();
        said.insert(text(function, "domain")?);
    }
    for (module, domains) in modules {
        let purpose = project.composer.library().get(module);
        let purpose = purpose.map_or("", |found| found.header.purpose.as_str());
        let _ = writeln!(page, "- **{module}** — {purpose}");
        for domain in domains {
            let _ = writeln!(page, "  - `{domain}`");
        }
    }
    Ok(())
}

pub(super) fn exhausted(page: &mut String, data: &Value) -> Result<(), MeasureError> {
    let _ = writeln!(
        page,
        "\n### Every float\n\nFunctions of one number were tried on every finite float (both \
         zeros count as one), with the evaluator; errors against the independent truth. Commit {}.\n",
        text(data, "commit")?
    );
    let mut rows = vec![words([
        "function",
        "floats",
        "",
        "largest error, ulp",
        "at",
        "error/(1 + condition)",
        "at",
        "not finite",
        "seconds",
    ])];
    for function in list(data, "functions")? {
        let ends = [
            number(function, "/domain/0")?,
            number(function, "/domain/1")?,
        ];
        let inside = format!("{:e} to {:e}, its domain", ends[0], ends[1]);
        for (where_from, part) in [(inside.as_str(), "inside"), ("all others", "outside")] {
            let of = |key: &str| number(function, &format!("/{part}/{key}"));
            rows.push(vec![
                name(function)?,
                format!("{}", of("inputs")?),
                where_from.to_owned(),
                short(of("max")?),
                format!("{:e}", of("at")?),
                short(of("scaled")?),
                format!("{:e}", of("scaled_at")?),
                format!("{}", of("non_finite")?),
                format!("{}", number(function, "/seconds")?),
            ]);
        }
    }
    *page += &table(&rows);
    Ok(())
}

pub(super) fn agreement(page: &mut String, data: &Value) -> Result<(), MeasureError> {
    let all = list(data, "functions")?;
    let mut rows = vec![words([
        "function",
        "inputs",
        "numbers",
        "differ",
        "decisions among them",
        "largest, ulp",
        "built-ins that drivers round in their own way",
    ])];
    let (mut plain, mut equal, mut equal_plain) = (0, 0, 0);
    for function in all {
        let differ = number(function, "/differ")?;
        let built_ins = list(function, "built_ins")?;
        let built_ins: Vec<&str> = built_ins.iter().filter_map(Value::as_str).collect();
        equal += usize::from(differ == 0.0);
        plain += usize::from(built_ins.is_empty());
        equal_plain += usize::from(built_ins.is_empty() && differ == 0.0);
        rows.push(vec![
            name(function)?,
            format!("{}", number(function, "/inputs")?),
            format!("{}", number(function, "/numbers")?),
            format!("{differ}"),
            format!("{}", number(function, "/decisions")?),
            short(number(function, "/largest_ulp")?),
            built_ins.join(", "),
        ]);
    }
    let _ = writeln!(
        page,
        "\n### The evaluator beside an adapter\n\n\
         {} inputs of each function, in two waters if it reads them, with the evaluator and on {}; commit {}. \
         {equal} of {} functions agree bit for bit, {equal_plain} of the {plain} that use no built-in which \
         WGSL lets drivers round in their own way. A large distance is one of numbers next to 0, or \
         behind a decision that came out otherwise; the test `functions_on_gpu` holds what the adapter \
         computes to what inputs a few ulps away give.\n",
        number(data, "/samples")?,
        text(data, "on")?,
        text(data, "commit")?,
        all.len()
    );
    *page += &table(&rows);
    Ok(())
}
