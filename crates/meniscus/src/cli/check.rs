//! `meniscus check` and `meniscus compose`

use meniscus::Project;
use meniscus::pipeline::{Facts, Plan};
use meniscus::source::{Diagnostic, Report};

use super::Failure;
use super::arguments::{Check, Compose};

pub(crate) fn check(project: &Project, check: &Check) -> Result<(), Failure> {
    let names = match check.pipelines.is_empty() {
        true => project.pipelines.names().map(str::to_owned).collect(),
        false => project.pipeline_names(&check.pipelines)?,
    };
    let mut report = project.warnings.clone();
    let mut passes = 0;
    for name in &names {
        match project.pipeline(name) {
            Err(wrong) => report.extend(wrong),
            Ok(pipeline) => {
                for facts in Facts::all() {
                    for shown in [false, true] {
                        match Plan::new(&pipeline, &project.composer, &facts, shown) {
                            Ok(plan) => passes += plan.passes.len(),
                            Err(wrong) => report.extend(wrong),
                        }
                    }
                }
            }
        }
    }
    if !report.0.is_empty() {
        eprintln!("{}", report.to_string().trim_end());
    }
    let errors = report
        .0
        .iter()
        .filter(|d| d.severity == meniscus::source::Severity::Error)
        .count();
    if errors > 0 {
        return Err(Failure::Written(format!(
            "{errors} errors in {} pipelines",
            names.len()
        )));
    }
    let shaders = project.composer.composed();
    println!(
        "{} pipelines, {passes} passes under all facts, {shaders} shaders: all valid",
        names.len()
    );
    Ok(())
}

pub(crate) fn compose(project: &Project, compose: &Compose) -> Result<(), Failure> {
    let mut pipelines = [project.pipeline(&compose.pipeline)?];
    compose.changes.apply(&mut pipelines)?;
    let facts = Facts::new(compose.facts.iter().map(String::as_str));
    let plan = Plan::new(&pipelines[0], &project.composer, &facts, true)?;
    let pass = plan
        .passes
        .iter()
        .find(|pass| pass.name == compose.pass)
        .ok_or_else(|| {
            let names = plan.passes.iter().map(|pass| pass.name.as_str());
            Report::from(
                Diagnostic::error(format!(
                    "`{}` has no pass `{}`",
                    compose.pipeline, compose.pass
                ))
                .with_suggestion(&compose.pass, names),
            )
        })?;
    print!("{}", pass.shader.text);
    Ok(())
}
