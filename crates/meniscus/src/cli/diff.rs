//! `meniscus diff`

use clap::Args;
use meniscus::Project;
use meniscus::pipeline;

use super::Failure;
use super::say::say;

#[derive(Debug, Args)]
pub(crate) struct Diff {
    /// The pipeline to start from, by name or file.
    pub from: String,
    /// The pipeline that is told, by name or file.
    pub to: String,
}

pub(crate) fn run(project: &Project, diff: &Diff) -> Result<(), Failure> {
    let from = project.pipeline(&diff.from)?;
    let to = project.pipeline(&diff.to)?;
    let differences = pipeline::diff(&from, &to);
    if differences.is_empty() {
        return say(&format!("{} does the same as {}\n", to.name, from.name));
    }
    let mut text = format!("{}, seen from {}:\n", to.name, from.name);
    for difference in &differences {
        text.push_str(&format!("  {difference}\n"));
    }
    say(&text)
}
