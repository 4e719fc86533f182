//! The main job on the built-in pool.

use std::path::PathBuf;

use crate::command::{self, Failure};

/// From no refraction to both phases, the published forms, ours, and tracing everything.
const PIPELINES: [&str; 9] = [
    "refraction/none",
    "refraction/broad",
    "refraction/narrow",
    "refraction/combined",
    "refraction/paper",
    "refraction/paper-literal",
    "refraction/refined",
    "refraction/bounded",
    "refraction/ray-traced",
];

/// Runs it and says where the results are.
pub(crate) fn demo() -> Result<(), Failure> {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or("target".into(), PathBuf::from);
    let out = command::workspace().join(target).join("demo");
    eprintln!("Building and running; the first build takes some minutes.");
    let mut run = command::cargo();
    run.args(["run", "--release", "--locked", "--bin", "meniscus", "--"])
        .arg("ablate")
        .args(PIPELINES)
        .args(["--scene", "pool", "--size", "640x360"])
        .args(["--truth", "displaced"])
        .arg("--out")
        .arg(&out);
    command::run(&mut run)?;
    eprintln!("\nPictures and error maps: {}", out.display());
    eprintln!(
        "Table:                   {}",
        out.join("results.md").display()
    );
    eprintln!(
        "Time against error:      {}",
        out.join("time-error.svg").display()
    );
    Ok(())
}
