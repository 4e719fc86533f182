//! Laws that the other methods of the literature keep, each within what it promises.

mod common;

use std::path::Path;

use common::{folder, json, npy_f32, number, program, row, run, write};
use serde_json::Value;

const MARCHES: [&str; 2] = ["refraction/screen-space", "refraction/broad-screen-space"];
const OFFSETS: [&str; 2] = ["refraction/offset", "refraction/planar"];

/// The results of some pipelines, in a folder with what they show.
fn ablate(there: &Path, pipelines: &[&str], more: &[&str]) -> Value {
    let results = there.join("results.json");
    run(program()
        .current_dir(there)
        .arg("ablate")
        .args(pipelines)
        .args(["--size", "240x136", "--rounds", "1", "--out", "."])
        .args(more))
    .done();
    json(&results)
}

#[test]
fn nothing_bends_on_flat_water_of_the_air_s_refractive_index() {
    let there = folder();
    let all = [&MARCHES[..], &OFFSETS[..], &["refraction/none"]].concat();
    let set = ["water.refractive_index=1", "water.rms_slope=0"];
    for scene in ["pool", "clutter"] {
        let more = ["--scene", scene, "--set", set[0], "--set", set[1]];
        let results = ablate(there.path(), &all, &more);
        for pipeline in &all {
            let row = row(&results, pipeline);
            let share = number(row, "/error/within_half_px");
            assert!(share > 0.999, "{scene}, {pipeline}: {row}");
        }
    }
}

#[test]
fn waves_of_the_air_s_refractive_index_bend_no_marched_ray() {
    let there = folder();
    let set = ["water.refractive_index=1", "water.rms_slope=0.1"];
    let results = ablate(there.path(), &MARCHES, &["--set", set[0], "--set", set[1]]);
    for pipeline in MARCHES {
        let row = row(&results, pipeline);
        let share = number(row, "/error/within_half_px");
        assert!(share > 0.999, "{pipeline}: {row}");
    }
}

/// A floor and nothing else.
const FLOOR: &str = "Scene(
    about: \"A floor.\",
    camera: (position: (0, -2), height: 1.5, target: (0, 0, -1), field_of_view: 50),
    sun: (azimuth: 0, elevation: 60, colour: (1, 1, 1), ambient: (0.3, 0.3, 0.3)),
    water: (refractive_index: 1.333, rms_slope: 0.05, waves: [
        (direction: 12, wavelength: 1.9, weight: 1.0, phase: 20),
        (direction: 71, wavelength: 1.1, weight: 0.6, phase: 140),
    ]),
    materials: { \"grey\": (colour: (0.5, 0.5, 0.5)) },
    objects: [
        (name: \"floor\", material: \"grey\", edge: 0.12, translate: (0, 0, -1), shape: Plane(size: (20, 20))),
    ],
)";

#[test]
fn a_march_meets_a_floor_where_it_is() {
    let there = folder();
    write(&there.path().join("floor.ron"), FLOOR);
    for stride in ["1", "4"] {
        let more = ["--scene", "floor.ron", "--with"];
        let stride = format!("narrow.intersect.stride={stride}");
        let results = ablate(there.path(), &MARCHES, &[&more[..], &[&stride]].concat());
        for row in results["rows"].as_array().expect("rows") {
            let middle = number(row, "/error/position_px/median");
            assert!(middle < 0.02, "{stride}: {row}");
        }
    }
}

#[test]
fn leaving_out_tiles_changes_nothing_that_is_met() {
    let there = folder();
    for scene in ["pool", "clutter"] {
        let tiled = "refraction/screen-space-hierarchical";
        // The plain march in its finest steps.
        write(
            &there.path().join("pipelines/finest.ron"),
            "Variant(of: \"refraction/screen-space\", about: \"For a test.\", set: { \
             \"narrow.intersect\": \"screen/march\" })",
        );
        let more = ["--scene", scene, "--pipelines", "pipelines"];
        let results = ablate(there.path(), &["finest", tiled], &more);
        let figures = |name| {
            let row = row(&results, name);
            ["within_half_px", "wrong_object"].map(|f| number(row, &format!("/error/{f}")))
        };
        let (plain, tiled) = (figures("finest"), figures(tiled));
        for (plain, tiled) in plain.iter().zip(tiled) {
            assert!((plain - tiled).abs() < 0.005, "{scene}: {plain}, {tiled}");
        }
    }
}

#[test]
fn a_finer_field_takes_more_memory_and_errs_less() {
    let there = folder();
    let name = "refraction/distance-field";
    let figures = ["32768", "2097152"].map(|voxels| {
        let finer = format!("trace.intersect.inside.field_voxels={voxels}");
        let results = ablate(there.path(), &[name], &["--with", &finer]);
        let row = &results["rows"][0];
        let bytes = number(&results["preprocessing"], "/distance_field_bytes");
        (bytes, number(row, "/error/wrong_object"))
    });
    let [coarse, fine] = figures;
    // 64 times the voxels; the grids' shapes decide how many of those allowed there are.
    assert!(fine.0 > 32.0 * coarse.0, "{figures:?}");
    assert!(fine.1 < 0.5 * coarse.1, "{figures:?}");
}

#[test]
fn a_field_of_distances_meets_a_floor_where_it_is() {
    let there = folder();
    write(&there.path().join("floor.ron"), FLOOR);
    let results = ablate(
        there.path(),
        &["refraction/distance-field"],
        &["--scene", "floor.ron"],
    );
    let row = row(&results, "refraction/distance-field");
    // Distances to a plane are linear: exact between voxels, however large they are.
    assert!(number(row, "/error/position_px/p99") < 0.02, "{row}");
    assert!(number(row, "/error/wrong_object") < 1e-6, "{row}");
}

/// The share of the water's pixels that show a point more than a decimetre above the waves.
fn bled(there: &Path, pipeline: &str) -> f64 {
    let (_, shown) = npy_f32(&there.join(format!("{pipeline}.shown.npy")));
    let wet = std::fs::read(there.join("water.npy")).expect("the water's mask");
    // One byte a pixel, behind the header.
    let pixels = shown.len() / 4;
    let wet = &wet[wet.len() - pixels..];
    let seen = shown.chunks_exact(4).zip(wet).filter(|(_, wet)| **wet != 0);
    let dry = seen
        .clone()
        .filter(|(point, _)| point[3] >= 0.0 && point[2] > 0.1);
    dry.count() as f64 / seen.count() as f64
}

#[test]
fn what_stands_before_the_water_does_not_bleed_into_it() {
    let there = folder();
    // Offsets that are strong enough to reach what stands before the water, and without the test.
    let strong = "\"narrow.deflect\": (\"optics/offset_by_normal\", { \"strength\": 2 })";
    let untested = format!("{strong}, \"narrow.intersect\": \"screen/offset\"");
    for (name, of, set) in [
        ("offset", "refraction/offset", strong),
        ("planar", "refraction/planar", strong),
        ("bleeding", "refraction/offset", &untested),
    ] {
        write(
            &there.path().join(format!("pipelines/{name}.ron")),
            format!("Variant(of: \"{of}\", about: \"For a test.\", set: {{ {set} }})"),
        );
    }
    ablate(
        there.path(),
        &["offset", "planar", "bleeding"],
        &["--pipelines", "pipelines", "--set", "water.rms_slope=0.1"],
    );
    let without = bled(there.path(), "bleeding");
    assert!(
        without > 0.005,
        "the scene does not try the test: {without}"
    );
    for pipeline in ["offset", "planar"] {
        let share = bled(there.path(), pipeline);
        assert!(share < 2e-4, "{pipeline}: {share}");
    }
}
