//! `meniscus graph`

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use meniscus::Project;
use meniscus::measure::write_atomically;
use meniscus::pipeline::Plan;

use super::arguments::Changes;
use super::moment::Moment;
use super::say::say;
use super::{Failure, outputs};

#[derive(Debug, Args)]
pub(crate) struct Graph {
    /// The pipeline, by name or file.
    pub pipeline: String,
    /// How it is drawn.
    #[arg(long, value_enum, default_value = "svg")]
    pub format: Drawing,
    #[command(flatten)]
    pub moment: Moment,
    #[command(flatten)]
    pub changes: Changes,
    /// The file to write; standard output if none is given.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Drawing {
    /// The language of Graphviz.
    Dot,
    /// A picture: passes from left to right, below them what they read (hollow) and write (full).
    Svg,
}

pub(crate) fn run(project: &Project, graph: &Graph) -> Result<(), Failure> {
    outputs::check(&graph.output, None)?;
    let mut pipelines = [project.pipeline(&graph.pipeline)?];
    graph.changes.apply(&mut pipelines)?;
    let facts = graph.moment.facts()?;
    let plan = Plan::new(&pipelines[0], &project.composer, &facts, false)?;
    let text = match graph.format {
        Drawing::Dot => plan.dot(&pipelines[0]),
        Drawing::Svg => plan.svg(&pipelines[0]),
    };
    match &graph.output {
        Some(file) => Ok(write_atomically(file, text.as_bytes())?),
        None => say(&text),
    }
}
