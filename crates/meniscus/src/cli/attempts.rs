//! Changes to several pipelines, of which some may lack what is changed.

use meniscus::Project;
use meniscus::pipeline::{Facts, Pipeline, Plan};
use meniscus::source::{Diagnostic, Report};

use super::arguments::{Changes, key_value};
use super::say::tell;

/// The most combinations that `--try` may make.
const MAX_COMBINATIONS: usize = 1000;

/// Applies `--with` to those pipelines that have what it names, down to the numbers of their modules.
/// Which have not is told.
///
/// # Errors
/// When none has it.
pub(crate) fn apply(
    project: &Project,
    changes: &Changes,
    pipelines: &mut [Pipeline],
) -> Result<(), Report> {
    for text in &changes.with {
        let before = pipelines.to_vec();
        let one = Changes {
            with: vec![text.clone()],
        };
        one.apply(pipelines)?;
        let (mut taken, mut without) = (false, Vec::new());
        let mut failed = Report::default();
        for (pipeline, old) in pipelines.iter_mut().zip(before) {
            // A pipeline is named with its changes.
            if pipeline.name == old.name {
                continue;
            }
            match composes(project, pipeline) {
                Ok(()) => taken = true,
                Err(wrong) => {
                    failed.extend(wrong);
                    without.push(old.name.clone());
                    *pipeline = old;
                }
            }
        }
        if !without.is_empty() && !taken {
            return Err(failed);
        }
        left_out("--with", text, &without);
    }
    Ok(())
}

/// Every combination of the fillings and numbers that are tried, for every pipeline that has them.
/// Which have not is told; they run once, as they are.
///
/// # Errors
/// When none has them, or one takes some of the values and refuses others.
pub(crate) fn combine(
    project: &Project,
    pipelines: Vec<Pipeline>,
    attempts: &[String],
) -> Result<Vec<Pipeline>, Report> {
    let mut all = pipelines;
    for text in attempts {
        let (key, values) = key_value("--try", text)?;
        let (mut tried, mut without) = (Vec::new(), Vec::new());
        let mut failed = Report::default();
        let mut changed = false;
        for pipeline in &all {
            let mut taken = false;
            for value in values.split(',') {
                let mut attempt = pipeline.clone();
                let has_pass = attempt.set_from("--try", key, value);
                let told = has_pass.is_ok();
                match has_pass.and_then(|()| composes(project, &attempt)) {
                    Ok(()) => {
                        attempt.baseline = false;
                        tried.push(attempt);
                        (taken, changed) = (true, true);
                    }
                    Err(wrong) if taken => return Err(wrong),
                    Err(wrong) => {
                        failed.extend(wrong);
                        tried.push(pipeline.clone());
                        if told {
                            without.push(pipeline.name.clone());
                        }
                        break;
                    }
                }
            }
        }
        if !changed {
            return Err(failed);
        }
        if tried.len() > MAX_COMBINATIONS {
            return Err(Diagnostic::error(format!(
                "`--try` makes {} combinations; at most {MAX_COMBINATIONS} are run",
                tried.len()
            ))
            .into());
        }
        left_out("--try", text, &without);
        all = tried;
    }
    Ok(all)
}

/// Whether a pipeline composes where all of it is needed.
fn composes(project: &Project, pipeline: &Pipeline) -> Result<(), Report> {
    let facts = Facts::new(["waves", "displaced"]);
    Plan::new(pipeline, &project.composer, &facts, false).map(drop)
}

fn left_out(option: &str, text: &str, without: &[String]) {
    if !without.is_empty() {
        tell(&format!(
            "`{option} {text}` changes nothing of {}, which cannot take it",
            without.join(", ")
        ));
    }
}
