//! `meniscus render`

use meniscus::gpu::Gpu;
use meniscus::measure::write_png;
use meniscus::{Picture, Project};

use super::arguments::Render;
use super::say::say;
use super::{Failure, outputs};

pub(crate) fn run(project: &Project, render: &Render) -> Result<(), Failure> {
    let mut pipelines = [project.pipeline(&render.pipeline)?];
    render.changes.apply(&mut pipelines)?;
    let scene = render.look.scene(project)?;
    outputs::check([&render.output], None)?;
    let gpu = Gpu::open(render.look.adapter.as_deref())?;
    let picture = Picture::render_pruned(
        project,
        &gpu,
        &pipelines[0],
        &scene,
        render.look.size,
        render.skipping.pruning(),
    )?;
    write_png(&render.output, picture.size, &picture.srgb())?;
    say(&format!("{} on {}\n", render.output.display(), gpu.facts()))
}
