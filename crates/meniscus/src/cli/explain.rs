//! `meniscus explain`

use std::path::PathBuf;

use clap::Args;
use meniscus::gpu::Footprint;
use meniscus::measure::write_atomically;
use meniscus::pipeline::{Explanation, Memory, Plan, Pruning};
use meniscus::{Project, outlook_of};

use super::arguments::{Changes, Look};
use super::say::say;
use super::{Failure, outputs};

#[derive(Debug, Args)]
#[command(mut_arg("adapter", |adapter| adapter.hide(true)))]
pub(crate) struct Explain {
    /// The pipeline, by name or file.
    pub pipeline: String,
    #[command(flatten)]
    pub look: Look,
    #[command(flatten)]
    pub changes: Changes,
    #[command(flatten)]
    pub skipping: Skipping,
    /// Draw it in the language of Graphviz, with what is left out in grey.
    #[arg(long, conflicts_with = "json")]
    pub dot: bool,
    /// Write it as JSON.
    #[arg(long)]
    pub json: bool,
    /// The file to write; standard output if none is given.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// What may be left out.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct Skipping {
    /// Leave out only what changes no bit of the picture, and not what moves it by a part of a pixel.
    #[arg(long)]
    pub exact: bool,
}

impl Skipping {
    pub fn pruning(self) -> Pruning {
        match self.exact {
            true => Pruning::Exact,
            false => Pruning::Approximate,
        }
    }
}

pub(crate) fn run(project: &Project, explain: &Explain) -> Result<(), Failure> {
    outputs::check(&explain.output, None)?;
    let mut pipelines = [project.pipeline(&explain.pipeline)?];
    explain.changes.apply(&mut pipelines)?;
    let [pipeline] = &pipelines;
    let scene = explain.look.scene(project)?;
    let outlook = outlook_of(&scene, explain.look.size);
    let pruning = explain.skipping.pruning();
    let plan = |pruning| Plan::pruned(pipeline, &project.composer, &outlook.facts, pruning, false);
    let text = if explain.dot {
        plan(pruning)?.dot_over(pipeline, &plan(Pruning::None)?)
    } else {
        let explanation = Explanation::new(pipeline, &project.composer, &outlook, pruning)?;
        let (size, skipping) = (outlook.size, pruning.into());
        let footprint = Footprint::new(&plan(pruning)?, &scene, size, skipping);
        let memory = Memory {
            guarded: footprint.guarded,
            allocated: footprint.bytes,
        };
        let explanation = explanation.with_clusters(&scene).with_memory(memory);
        match explain.json {
            true => {
                let value = serde_json::to_string_pretty(&explanation);
                let text = value.map_err(|error| Failure::Machine(format!("error: {error}")))?;
                format!("{text}\n")
            }
            false => explanation.to_string(),
        }
    };
    match &explain.output {
        Some(file) => Ok(write_atomically(file, text.as_bytes())?),
        None => say(&text),
    }
}
