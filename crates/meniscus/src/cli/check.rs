//! `meniscus check`

use clap::Args;
use meniscus::Project;
use meniscus::pipeline::{Facts, Plan, Pruning, check_facts};
use meniscus::source::Diagnostic;

use super::Failure;
use super::say::{say, tell};

#[derive(Debug, Args)]
pub(crate) struct Check {
    /// Pipelines by name or file, `refraction/*` for many; all that are known if none is given.
    pub pipelines: Vec<String>,
}

pub(crate) fn check(project: &Project, check: &Check) -> Result<(), Failure> {
    let names = match check.pipelines.is_empty() {
        true => project.pipelines.names().map(str::to_owned).collect(),
        false => project.pipeline_names(&check.pipelines)?,
    };
    let mut report = project.warnings.clone();
    report.extend(check_facts(project.composer.library()));
    let mut passes = 0;
    for name in &names {
        match project.pipeline(name) {
            Err(wrong) => report.extend(wrong),
            Ok(pipeline) => {
                // With shortcuts and without.
                let prunings = match pipeline.shortcuts.is_empty() {
                    true => &[Pruning::Exact][..],
                    false => &[Pruning::Exact, Pruning::Approximate],
                };
                for (facts, pruning) in Facts::all()
                    .into_iter()
                    .flat_map(|facts| prunings.iter().map(move |pruning| (facts, *pruning)))
                {
                    for shown in [false, true] {
                        let composer = &project.composer;
                        match Plan::pruned(&pipeline, composer, &facts, pruning, shown) {
                            Ok(plan) => passes += plan.passes.len(),
                            Err(wrong) => {
                                report.extend(wrong);
                                // What is shown cannot be told of a pipeline that is wrong itself.
                                break;
                            }
                        }
                    }
                }
            }
        }
    }
    if check.pipelines.is_empty() {
        // Modules that no pipeline uses have to be sound as well. What a pipeline has already
        // shown of a module is not said twice.
        for found in project.composer.check_library().0 {
            if !report.0.iter().any(|known| same(known, &found)) {
                report.add(found);
            }
        }
    }
    if !report.0.is_empty() {
        tell(report.to_string().trim_end());
    }
    let errors = report
        .0
        .iter()
        .filter(|d| d.severity == meniscus::source::Severity::Error)
        .count();
    if errors > 0 {
        return Err(Failure::Written(format!(
            "{} in {}",
            counted(errors, "error"),
            counted(names.len(), "pipeline")
        )));
    }
    let shaders = project.composer.composed();
    say(&format!(
        "{}, {} under all facts, {}: all valid\n",
        counted(names.len(), "pipeline"),
        counted_as(passes, "pass", "passes"),
        counted(shaders as usize, "shader")
    ))
}

/// Whether two messages say the same of the same place.
fn same(one: &Diagnostic, other: &Diagnostic) -> bool {
    let place = |diagnostic: &Diagnostic| diagnostic.labels.first().map(|l| l.place.clone());
    one.message == other.message && place(one) == place(other)
}

/// A number of things, in words.
fn counted(count: usize, thing: &str) -> String {
    counted_as(count, thing, &format!("{thing}s"))
}

fn counted_as(count: usize, one: &str, many: &str) -> String {
    match count {
        1 => format!("1 {one}"),
        _ => format!("{count} {many}"),
    }
}
