//! A pipeline changed in place, and an ablation without the command line: does a second tap pay?
//!
//!     cargo run --release --example 2_variants

use std::error::Error;

use meniscus::gpu::Gpu;
use meniscus::measure::Table;
use meniscus::scene::{Setting, WaterGeometry};
use meniscus::{Ablation, Project, Rounds, Sources};
use serde_json::Map;

fn main() -> Result<(), Box<dyn Error>> {
    let project = Project::open(&Sources::default())?;
    let mut pipelines = vec![project.pipeline("refraction/none")?];
    for taps in ["1", "2", "4"] {
        let mut variant = project.pipeline("refraction/refined")?;
        variant.set("narrow.intersect.taps", taps)?;
        pipelines.push(variant);
    }
    let ablation = Ablation {
        pipelines,
        baseline: Some(0),
        scene: project.scene("pool", &[Setting::new("water.rms_slope", "0.1")])?,
        truth: WaterGeometry::Displaced,
        size: [320, 180],
        pruning: Default::default(),
        rounds: Rounds::default(),
        without: Vec::new(),
        settings: Map::new(),
        moments: Vec::new(),
        rivalry: None,
    };
    let outcome = ablation.run(&project, &Gpu::open(None)?, &|_, _| {})?;
    print!("{}", Table::of(&outcome.results).terminal());
    Ok(())
}
