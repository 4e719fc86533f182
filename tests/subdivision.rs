//! Edges behind the water bow, whatever the size of the triangles that they belong to.

mod common;

use common::untimed;
use meniscus::gpu::Gpu;
use meniscus::measure::Verdict;
use meniscus::scene::Setting;
use meniscus::{Outcome, Project, Sources};

fn run(scene: &str, slope: &str) -> Outcome {
    let project = Project::open(&Sources::default()).unwrap();
    let names = [
        "refraction/broad",
        "refraction/combined",
        "refraction/bounded",
    ];
    let settings = [Setting::new("water.rms_slope", slope)];
    let scene = project.scene(scene, &settings).unwrap();
    let pipelines = names.map(|name| project.pipeline(name).unwrap());
    let ablation = untimed(pipelines.into(), scene, [320, 180]);
    let gpu = Gpu::open(None).unwrap_or_else(|error| panic!("{error}"));
    ablation.run(&project, &gpu, &|_, _| ()).unwrap()
}

/// Of the pixels that show water: the share farther off than half a pixel, and of wrong objects.
fn misses(outcome: &Outcome, row: usize) -> [f64; 2] {
    let [mut all, mut far, mut wrong] = [0.0, 0.0, 0.0];
    for verdict in &outcome.rows[row].judgement.verdicts {
        let Verdict::Error {
            px, wrong_object, ..
        } = verdict
        else {
            continue;
        };
        all += 1.0;
        far += f64::from(u8::from(*px > 0.5));
        wrong += f64::from(u8::from(*wrong_object));
    }
    assert!(all > 10_000.0, "only {all} pixels show water");
    [far / all, wrong / all]
}

#[test]
fn flat_water_shows_coarse_triangles_where_they_are_without_a_tap() {
    for scene in ["coarse", "straddle", "pool"] {
        let outcome = run(scene, "0");
        for row in 0..3 {
            let [far, wrong] = misses(&outcome, row);
            assert!(far <= 1e-3, "{scene}, row {row}: {far} beyond half a pixel");
            assert!(wrong <= 1e-3, "{scene}, row {row}: {wrong} wrong");
        }
    }
}

#[test]
fn outlines_of_coarse_triangles_are_right_under_waves_too() {
    for (scene, most) in [("coarse", 1e-3), ("straddle", 2e-3)] {
        let outcome = run(scene, "0.05");
        let [far, wrong] = misses(&outcome, 2);
        assert!(
            far <= most && wrong <= most,
            "{scene}: {far} far, {wrong} wrong"
        );
    }
}
