//! `meniscus run`

use std::path::PathBuf;
use std::time::Instant;

use clap::{Args, ValueEnum};
use meniscus::gpu::GpuError;
use meniscus::measure::{to_srgb8, write_png};
use meniscus::{Device, PassDifference, PassError, Passes, Project, colours};

use super::arguments::{Changes, Look};
use super::say::{say, tell};
use super::{Failure, outputs};

/// What passes run on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum On {
    /// Compute and screen passes on the CPU, on all cores; draws on the GPU, if there is one.
    Cpu,
    /// Everything on the GPU.
    Gpu,
}

#[derive(Debug, Args)]
pub(crate) struct Run {
    /// The pipeline, by name or file.
    pub pipeline: String,
    /// End with this pass; on the CPU none but this one runs there.
    #[arg(long, value_name = "PASS")]
    pub pass: Option<String>,
    /// What passes run on.
    #[arg(long, value_enum, default_value = "cpu")]
    pub device: On,
    /// Run what can run on the CPU on both, from the same inputs, and tell how far the results are
    /// apart.
    #[arg(long)]
    pub compare: bool,
    #[command(flatten)]
    pub look: Look,
    #[command(flatten)]
    pub changes: Changes,
    /// Write what comes out as a picture; with --pass the first texture that the pass writes.
    #[arg(short, long, value_name = "FILE.png")]
    pub output: Option<PathBuf>,
}

impl From<PassError> for Failure {
    fn from(error: PassError) -> Self {
        match error {
            PassError::Gpu(error) => error.into(),
            PassError::Unknown { .. } => Self::Written(format!("error: {error}")),
            _ => Self::Machine(format!("error: {error}")),
        }
    }
}

pub(crate) fn run(project: &Project, run: &Run) -> Result<(), Failure> {
    let mut pipelines = [project.pipeline(&run.pipeline)?];
    run.changes.apply(&mut pipelines)?;
    let scene = run.look.scene(project)?;
    outputs::check(run.output.iter(), None)?;
    let gpu = match run.look.gpu() {
        Err(GpuError::NoAdapter { wanted: None, .. }) if run.device == On::Cpu && !run.compare => {
            tell("there is no graphics adapter: draws are left out, and what reads what they make");
            None
        }
        opened => Some(opened?),
    };
    let [pipeline] = &pipelines;
    let mut passes = Passes::new(project, gpu.as_ref(), pipeline, &scene, run.look.size)?;
    let last = match &run.pass {
        Some(name) => passes.find(name)?,
        None => passes.plan().passes.len().saturating_sub(1),
    };
    for index in 0..passes.plan().passes.len().min(last + 1) {
        let name = passes.plan().passes[index].name.clone();
        let meant = run.pass.as_ref().is_none_or(|only| *only == name);
        let start = Instant::now();
        if meant && run.pass.is_some() && run.device == On::Cpu && passes.is_drawn(index) {
            return Err(Failure::Written(format!(
                "error: pass `{name}` draws triangles, which takes a GPU\n  \
                 help: compute and screen passes run on the CPU; run this one with --device gpu"
            )));
        }
        if run.compare && meant && !passes.is_drawn(index) {
            for difference in passes.compare(index)? {
                say(&format!("{name}: {}\n", told(&difference)))?;
            }
            continue;
        }
        let on_cpu = meant && run.device == On::Cpu && !run.compare && !passes.is_drawn(index);
        let device = match on_cpu || gpu.is_none() {
            true => Device::Cpu,
            false => Device::Gpu,
        };
        match passes.run(index, device) {
            // Without a GPU, others may still run.
            Err(error @ PassError::NotDrawn { .. }) if run.pass.as_ref() != Some(&name) => {
                say(&format!("{name}: left out: {error}\n"))?;
                continue;
            }
            ran => ran?,
        }
        let ms = start.elapsed().as_secs_f64() * 1e3;
        let place = match (device, passes.is_drawn(index), &gpu) {
            (_, true, None) => "left out: it draws, which takes a GPU".to_owned(),
            (Device::Cpu, ..) => format!("on the CPU, {ms:.1} ms with its copies"),
            (Device::Gpu, ..) => format!("on the GPU, {ms:.1} ms with its copies"),
        };
        say(&format!("{name}: {place}\n"))?;
    }
    let Some(path) = &run.output else {
        return Ok(());
    };
    let texture = match &run.pass {
        Some(_) => passes.plan().passes[last].targets.first().cloned(),
        None => Some(passes.plan().output.clone()),
    };
    let Some(texture) = texture else {
        return Err(Failure::Written(
            "error: this pass writes no texture that could be a picture".to_owned(),
        ));
    };
    let store = passes.store()?;
    if let Some(texels) = store.textures.get(&texture) {
        write_png(path, texels.size, &to_srgb8(&colours(texels)))?;
        say(&format!("{}: `{texture}`\n", path.display()))?;
    }
    Ok(())
}

fn told(difference: &PassDifference) -> String {
    let PassDifference {
        resource,
        texels,
        differing,
        beyond,
        largest,
    } = difference;
    format!(
        "`{resource}`: {differing} of {texels} differ, {beyond} beyond the bound, by {largest:.2e} of their size at most"
    )
}
