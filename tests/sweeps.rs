//! Sweeps: resumed, divided, merged.

mod common;

use std::path::Path;

use common::meniscus;
use serde_json::Value;

/// Two pipelines at four points, small and quick.
fn sweep(json: &Path, more: &[&str]) -> common::Said {
    let json = json.to_str().unwrap();
    let mut arguments = common::words(
        "ablate refraction/none refraction/broad --size 64x36 --rounds 2 \
         --sweep water.rms_slope=0,0.1 --sweep camera.height=1.5,1.9",
    );
    arguments.extend(["--json", json]);
    arguments.extend(more);
    meniscus(arguments)
}

fn read(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// The results without what a clock has said.
fn without_times(mut sweep: Value) -> Value {
    for point in sweep["points"].as_array_mut().unwrap() {
        let point = point.as_object_mut().unwrap();
        point.remove("preprocessing");
        for row in point["rows"].as_array_mut().unwrap() {
            let row = row.as_object_mut().unwrap();
            for key in [
                "timer",
                "frame_ms",
                "relative",
                "passes",
                "warnings",
                "preprocessing_ms",
                "dominated_by",
            ] {
                row.remove(key);
            }
        }
    }
    sweep
}

#[test]
fn a_sweep_that_was_interrupted_goes_on_where_it_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("sweep.json");
    let report = folder.path().join("report.html");
    sweep(&file, &["--report", report.to_str().unwrap()]).done();
    // Time, relative time and error along either setting at each value of the other.
    let page = std::fs::read_to_string(&report).unwrap();
    assert_eq!(page.matches("<svg").count(), 3 * (2 + 2));
    let whole = read(&file);
    assert_eq!(whole["points"].as_array().unwrap().len(), 4);

    // As if the program had been stopped after two points.
    let mut stopped = whole.clone();
    stopped["points"].as_array_mut().unwrap().truncate(2);
    std::fs::write(&file, stopped.to_string()).unwrap();
    let said = sweep(&file, &[]);
    assert_eq!(said.err.matches("known already").count(), 2, "{}", said.err);
    said.done();
    let resumed = read(&file);
    assert_eq!(without_times(resumed.clone()), without_times(whole.clone()));
    for index in [0, 1] {
        // Samples of a clock do not come out the same twice: these were not taken again.
        assert_eq!(resumed["points"][index], whole["points"][index]);
    }
    for index in [2, 3] {
        assert_ne!(resumed["points"][index], whole["points"][index]);
    }
}

#[test]
fn a_point_that_was_asked_otherwise_is_run_anew() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("sweep.json");
    sweep(&file, &[]).done();
    let said = sweep(&file, &["--set", "water.refractive_index=1.2"]);
    assert_eq!(said.err.matches("run anew").count(), 4, "{}", said.err);
    assert_eq!(read(&file)["points"].as_array().unwrap().len(), 4);
}

#[test]
fn parts_merge_to_what_one_run_finds() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    sweep(&path("whole.json"), &[]).done();
    sweep(&path("a.json"), &["--partition", "1/2"]).done();
    sweep(&path("b.json"), &["--partition", "2/2"]).done();
    assert_eq!(read(&path("a.json"))["points"].as_array().unwrap().len(), 2);
    let text = |name: &str| path(name).to_str().unwrap().to_owned();
    meniscus([
        "merge".to_owned(),
        text("b.json"),
        text("a.json"),
        "-o".to_owned(),
        text("merged.json"),
        "--csv".to_owned(),
        text("merged.csv"),
    ])
    .done();
    let [merged, whole] = ["merged.json", "whole.json"].map(|name| read(&path(name)));
    assert_eq!(without_times(merged), without_times(whole));
    let csv = std::fs::read_to_string(path("merged.csv")).unwrap();
    assert!(csv.starts_with("water.rms_slope,camera.height,pipeline,"));
    assert_eq!(csv.lines().count(), 1 + 4 * 2);
}

#[test]
fn what_cannot_be_swept_is_refused_before_anything_runs() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("sweep.json");
    sweep(&file, &["--sweep", "water.rms_slop=1"]).refused(&["water.rms_slop"]);
    sweep(&file, &["--sweep", "camera.target.x"]).refused(&["camera.target.x", "="]);
    sweep(&file, &["--sweep", "camera.height=2"]).refused(&["swept twice"]);
    sweep(&file, &["--partition", "3/2"]).refused(&["3/2", "K/N"]);
    assert!(!file.exists());
    std::fs::write(&file, "{}").unwrap();
    sweep(&file, &[]).refused(&["sweep.json", "not the results of a sweep"]);
    meniscus(["ablate", "--preset", "lui2020"]).refused(&["lui2020", "liu2020"]);
    meniscus(["ablate", "--partition", "1/2"]).refused(&["--sweep"]);
}

#[test]
fn the_report_asks_for_nothing_from_outside() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("report.html");
    let mut arguments = common::words(
        "ablate refraction/none refraction/broad --size 64x36 --rounds 2 \
         --leave-one-out refraction/broad",
    );
    arguments.extend(["--report", file.to_str().unwrap()]);
    meniscus(arguments).done();
    let page = std::fs::read_to_string(&file).unwrap();
    // A namespace is a name, and fetches nothing.
    let page = page.replace("http://www.w3.org/2000/svg", "");
    for outside in ["http:", "https:", "src=\"/", "url(", "@import", "<link"] {
        assert!(!page.contains(outside), "{outside}");
    }
    // The truth, two pipelines with a map each, and those without a filling.
    let pictures = page.matches("<img alt=").count();
    let maps = page.matches("<img class=\"map\"").count();
    assert!(
        pictures > 3 && maps == pictures - 1,
        "{pictures} and {maps}"
    );
    for part in [
        "id=\"table\"",
        "id=\"plane\"",
        "id=\"passes\"",
        "id=\"marginal\"",
        "id=\"provenance\"",
    ] {
        assert!(page.contains(part), "{part}");
    }
}

#[test]
fn what_presets_name_is_there_and_published_figures_belong_to_points() {
    let project = meniscus::Project::open(&meniscus::Sources::default()).unwrap();
    let names = project.preset_names();
    assert!(!names.is_empty());
    for name in names {
        let preset = project.preset(&name).unwrap();
        project.scene(&preset.scene, &[]).unwrap();
        let pipelines: Vec<&str> = preset.pipelines.iter().map(|p| p.value.as_str()).collect();
        for pipeline in &pipelines {
            project.pipeline(pipeline).unwrap();
        }
        let Some(published) = preset.published else {
            continue;
        };
        assert!(pipelines.contains(&published.relative_to.as_str()));
        for figures in &published.figures {
            for (key, value) in figures.at.iter() {
                let axis = preset.sweep.iter().find(|axis| axis.key.value == key.value);
                assert!(
                    axis.is_some_and(|axis| axis.values.contains(value)),
                    "{name}: {key:?}"
                );
            }
            for (pipeline, _) in figures.frames_per_second.iter() {
                assert!(
                    pipelines.contains(&pipeline.value.as_str()),
                    "{name}: {pipeline:?}"
                );
            }
        }
    }
}
