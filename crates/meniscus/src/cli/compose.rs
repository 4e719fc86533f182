//! `meniscus compose`

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use meniscus::Project;
use meniscus::measure::write_atomically;
use meniscus::pipeline::Plan;
use meniscus::shader::{Exported, Language};
use meniscus::source::{Diagnostic, Report};

use super::arguments::Changes;
use super::moment::Moment;
use super::say::say;
use super::{Failure, outputs};

#[derive(Debug, Args)]
pub(crate) struct Compose {
    /// The pipeline, by name or file.
    pub pipeline: String,
    /// The pass, by its name in the pipeline.
    #[arg(long, value_name = "NAME")]
    pub pass: String,
    /// The language. All but wgsl hold the pass's numbers instead of `override`s.
    #[arg(long, value_enum, default_value = "wgsl")]
    pub format: Format,
    /// The file to write; standard output if none is given, which spirv is not written to. glsl and
    /// glsl-es are written to a file for each stage: FILE.vert, FILE.frag.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub moment: Moment,
    #[command(flatten)]
    pub changes: Changes,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// The text, with the modules' comments.
    Wgsl,
    /// SPIR-V 1.3, binary.
    Spirv,
    /// HLSL for shader model 6.0.
    Hlsl,
    /// Metal's language, version 2.4.
    Msl,
    /// GLSL 4.50.
    Glsl,
    /// GLSL ES 3.10.
    GlslEs,
}

pub(crate) fn run(project: &Project, compose: &Compose) -> Result<(), Failure> {
    if compose.format == Format::Spirv && compose.output.is_none() {
        return Err(Diagnostic::error("SPIR-V is binary and wants a file")
            .with_help(format!("add `-o {}.spv`", compose.pass))
            .into());
    }
    outputs::check(&compose.output, None)?;
    let mut pipelines = [project.pipeline(&compose.pipeline)?];
    compose.changes.apply(&mut pipelines)?;
    let facts = compose.moment.facts()?;
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
    let language = match compose.format {
        Format::Wgsl => None,
        Format::Spirv => Some(Language::SpirV),
        Format::Hlsl => Some(Language::Hlsl),
        Format::Msl => Some(Language::Msl),
        Format::Glsl => Some(Language::Glsl),
        Format::GlslEs => Some(Language::GlslEs),
    };
    let parts = match language {
        Some(language) => pass.shader.export(language, &pass.numbers)?,
        None => vec![Exported {
            stage: None,
            bytes: pass.shader.text.clone().into_bytes(),
        }],
    };
    for part in &parts {
        match &compose.output {
            Some(file) => write_atomically(&file_of(file, part.stage), &part.bytes)?,
            None => {
                if let Some(stage) = part.stage.filter(|_| parts.len() > 1) {
                    say(&format!("// {}.{stage}\n", pass.name))?;
                }
                say(&String::from_utf8_lossy(&part.bytes))?;
            }
        }
    }
    Ok(())
}

/// The file of a stage: the given one, with the stage's ending behind it.
fn file_of(file: &Path, stage: Option<&str>) -> PathBuf {
    let mut name = file.as_os_str().to_owned();
    if let Some(stage) = stage {
        name.push(".");
        name.push(stage);
    }
    name.into()
}
