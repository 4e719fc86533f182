//! What the methods' errors have to be: the figures that the project stands for.
//!
//! Errors do not depend on time, so that one round is enough.

mod common;

use common::{folder, json, meniscus, number, row, text, words};
use serde_json::Value;

/// The results of these pipelines on the pool at 640×360.
#[track_caller]
fn figures(arguments: &str) -> Value {
    let there = folder();
    let path = there.path().join("results.json");
    let line = format!(
        "ablate refraction/none refraction/broad refraction/combined refraction/paper \
         refraction/paper-literal --scene pool --size 640x360 --rounds 1 {arguments}"
    );
    let mut line = words(&line);
    line.extend(["--json", text(&path)]);
    meniscus(&line).done();
    let results = json(&path);
    // The water fills over half of the frame, and the errors are taken over all of it.
    let water = number(&results, "/water_pixels");
    assert!(water > 0.5 * 640.0 * 360.0, "{water} pixels of water");
    results
}

fn error(results: &Value, pipeline: &str, figure: &str) -> f64 {
    number(row(results, pipeline), &format!("/error/{figure}"))
}

fn mean(results: &Value, pipeline: &str) -> f64 {
    error(results, pipeline, "position_px/mean")
}

#[test]
fn flat_water_is_right_with_and_without_a_narrow_phase() {
    for geometry in ["flat", "displaced"] {
        let results = figures(&format!("--set water.rms_slope=0 --truth {geometry}"));
        assert_eq!(results["undefined_pixels"], 0);
        for pipeline in ["refraction/broad", "refraction/combined"] {
            let within = error(&results, pipeline, "within_half_px");
            assert!(within >= 0.995, "{pipeline}: {within} within half a pixel");
            let wrong = error(&results, pipeline, "wrong_object");
            assert!(wrong <= 0.003, "{pipeline}: {wrong} wrong objects");
        }
        // Nothing is rotated where the water is flat.
        for pipeline in ["refraction/paper", "refraction/paper-literal"] {
            let apart = mean(&results, pipeline) - mean(&results, "refraction/broad");
            assert!(apart.abs() <= 0.05, "{pipeline}: {apart} px from broad");
        }
        let none = mean(&results, "refraction/none");
        assert!(none > 5.0, "no refraction is {none} px off");
        assert!(error(&results, "refraction/none", "wrong_object") > 0.1);
    }
}

#[test]
fn waves_are_right_where_rays_are_refracted_and_not_where_they_are_rotated() {
    let results = figures("--set water.rms_slope=0.05 --truth displaced");
    let broad = mean(&results, "refraction/broad");
    // A prototype with another scene had 3.28 px.
    assert!((1.0..10.0).contains(&broad), "broad: {broad} px");
    let combined = mean(&results, "refraction/combined");
    assert!(
        combined <= broad / 20.0,
        "combined: {combined}, broad: {broad} px"
    );
    for pipeline in ["refraction/paper", "refraction/paper-literal"] {
        let ratio = mean(&results, pipeline) / broad;
        assert!(
            (0.8..=1.5).contains(&ratio),
            "{pipeline}: {ratio} times broad's"
        );
    }
    assert!(mean(&results, "refraction/none") > 5.0);
}

#[test]
fn waves_on_the_rest_plane_isolate_the_error_of_the_method() {
    let results = figures("--set water.rms_slope=0.05 --truth flat");
    let broad = mean(&results, "refraction/broad");
    let combined = mean(&results, "refraction/combined");
    assert!(
        combined <= broad / 20.0,
        "combined: {combined}, broad: {broad} px"
    );
}

#[test]
fn a_truth_of_another_geometry_shows_the_error_of_the_model() {
    // Pipelines that put waves on a plane, judged by the waves themselves.
    let model = figures("--set water.geometry=flat --truth displaced");
    let method = figures("--set water.geometry=flat --truth flat");
    let of = |results| mean(results, "refraction/combined");
    assert!(
        of(&model) > 4.0 * of(&method),
        "{} {}",
        of(&model),
        of(&method)
    );
}
