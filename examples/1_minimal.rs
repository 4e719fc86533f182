//! The least program: a built-in pipeline and scene, one picture.
//!
//!     cargo run --release --example 1_minimal

use std::error::Error;

use meniscus::gpu::Gpu;
use meniscus::measure::write_png;
use meniscus::{Picture, Project, Sources};

fn main() -> Result<(), Box<dyn Error>> {
    let project = Project::open(&Sources::default())?;
    let pipeline = project.pipeline("refraction/bounded")?;
    let scene = project.scene("pool", &[])?;
    let gpu = Gpu::open(None)?;
    let picture = Picture::render(&project, &gpu, &pipeline, &scene, [640, 360])?;
    let path = std::env::temp_dir().join("meniscus-minimal.png");
    write_png(&path, picture.size, &picture.srgb())?;
    println!("{} on {}", path.display(), gpu.facts());
    Ok(())
}
