//! A tracer in Python that shares nothing with this project recomputes what an ablation says.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Output};

const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/recompute.py");

/// Whether there is a Python that can run the script; says so past the capture of output if not.
fn python_is_there() -> bool {
    let there = Command::new("python3")
        .args(["-c", "import numpy"])
        .output()
        .is_ok_and(|output| output.status.success());
    if !there {
        let skip = "skipped: the check of an ablation by recompute.py: no python3 with numpy";
        let _ = writeln!(std::io::stderr(), "{skip}");
    }
    there
}

/// Compares pipelines on a small picture of a coarse scene.
fn ablate(scene: &str, truth: &str, pipelines: &[&str], out: &Path) {
    let output = Command::new(env!("CARGO_BIN_EXE_meniscus"))
        .arg("ablate")
        .args(pipelines)
        .args(["--scene", scene, "--set", "pool.triangles=4k"])
        .args(["--truth", truth, "--size", "160x90", "--rounds", "1"])
        .arg("--out")
        .arg(out)
        .output()
        .expect("the program starts");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{scene}, {truth}: {said}");
}

fn recompute(directory: &Path) -> Output {
    Command::new("python3")
        .arg(SCRIPT)
        .arg(directory)
        .args(["--step", "3"])
        .output()
        .expect("python3 starts")
}

fn agrees(scene: &str, truth: &str, pipelines: &[&str]) {
    if !python_is_there() {
        return;
    }
    let directory = tempfile::tempdir().expect("a temporary directory");
    ablate(scene, truth, pipelines, directory.path());
    let output = recompute(directory.path());
    let said = String::from_utf8_lossy(&output.stdout);
    let complained = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}{complained}");
    for pipeline in pipelines {
        assert!(
            said.contains(pipeline),
            "{pipeline} was not checked: {said}"
        );
    }
}

#[test]
fn figures_on_flat_water_are_recomputed() {
    let pipelines = ["refraction/none", "refraction/broad", "refraction/combined"];
    agrees("pool", "flat", &pipelines);
}

#[test]
fn figures_on_waves_are_recomputed() {
    let pipelines = [
        "refraction/broad",
        "refraction/combined",
        "refraction/paper",
    ];
    agrees("pool", "displaced", &pipelines);
}

#[test]
fn figures_under_water_are_recomputed() {
    // There light is totally reflected, and waves bring some of it back to the surface.
    for truth in ["flat", "displaced"] {
        agrees("underwater", truth, &["refraction/none"]);
    }
}

#[test]
fn what_is_wrong_is_told_from_what_is_missing() {
    if !python_is_there() {
        return;
    }
    let directory = tempfile::tempdir().expect("a temporary directory");
    let inside = |name: &str| directory.path().join(name);
    let pipelines = ["refraction/none", "refraction/combined"];
    ablate("pool", "flat", &pipelines, directory.path());

    let [none, combined] =
        ["none", "combined"].map(|name| inside(&format!("refraction-{name}.shown.npy")));
    std::fs::copy(&none, &combined).expect("the exported arrays are there");
    let output = recompute(directory.path());
    let said = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("OFF refraction/combined"), "{said}");
    assert!(!said.contains("OFF refraction/none"), "{said}");

    std::fs::remove_file(&combined).expect("it was there");
    let output = recompute(directory.path());
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("refraction-combined.shown.npy"), "{said}");
}
