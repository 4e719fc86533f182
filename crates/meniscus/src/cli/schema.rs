//! `meniscus schema`

use clap::{Args, ValueEnum};
use meniscus::{pipeline, scene};

use super::Failure;
use super::say::say;

#[derive(Debug, Args)]
pub(crate) struct Schema {
    /// The kind of file.
    #[arg(value_enum, default_value = "pipeline")]
    pub of: Kind,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Kind {
    /// Pipelines and their variants.
    Pipeline,
    /// Scenes and their variants.
    Scene,
}

pub(crate) fn run(schema: &Schema) -> Result<(), Failure> {
    say(match schema.of {
        Kind::Pipeline => pipeline::SCHEMA,
        Kind::Scene => scene::SCHEMA,
    })
}
