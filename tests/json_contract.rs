//! The results of `ablate` are a contract: these keys, of these types, whatever else is added.

mod common;

use std::path::Path;

use common::{folder, json, meniscus, npy_f32, number, row, text, words};
use serde_json::{Map, Value};

/// Runs `ablate` on small pictures and reads its JSON.
#[track_caller]
fn results(arguments: &str) -> Value {
    let there = folder();
    let path = there.path().join("results.json");
    let line = format!("ablate --size 64x36 --set pool.triangles=4k {arguments}");
    let mut line = words(&line);
    line.extend(["--json", text(&path)]);
    meniscus(&line).done();
    json(&path)
}

/// That an object has these keys and, unless `more` is allowed, no others.
#[track_caller]
fn keys<'a>(value: &'a Value, wanted: &[&str], more: &[&str]) -> &'a Map<String, Value> {
    let object = value.as_object().unwrap_or_else(|| panic!("{value}"));
    for key in wanted {
        assert!(object.contains_key(*key), "`{key}` is missing in {value}");
    }
    for key in object.keys() {
        let known = wanted.contains(&key.as_str()) || more.contains(&key.as_str());
        assert!(known, "`{key}` is not documented: {value}");
    }
    object
}

fn numbers(value: &Value, wanted: &[&str]) {
    for key in wanted {
        let number = value[*key].as_f64();
        assert!(number.is_some_and(f64::is_finite), "`{key}` in {value}");
    }
}

const ERRORS: [&str; 7] = [
    "position_px",
    "position_m",
    "within_half_px",
    "wrong_object",
    "rmse",
    "psnr",
    "flip",
];

fn errors(value: &Value) {
    for key in &ERRORS[..2] {
        let figures = ["mean", "median", "p95", "p99"];
        keys(&value[*key], &figures, &[]);
        numbers(&value[*key], &figures);
        let quantiles = ["median", "p95", "p99"].map(|q| number(&value[*key], &format!("/{q}")));
        assert!(quantiles.is_sorted(), "{value}");
    }
    numbers(value, &ERRORS[2..]);
    for share in ["within_half_px", "wrong_object", "flip"] {
        let share = number(value, &format!("/{share}"));
        assert!((0.0..=1.0).contains(&share), "{value}");
    }
}

#[test]
fn the_keys_are_those_of_the_contract() {
    let results = results(
        "refraction/none refraction/combined --rounds 4 --set water.rms_slope=0.1 --truth flat",
    );
    keys(
        &results,
        &[
            "provenance",
            "scene",
            "settings",
            "size",
            "truth",
            "water_pixels",
            "undefined_pixels",
            "rows",
        ],
        &["preprocessing", "scene_bytes"],
    );
    let provenance = keys(
        &results["provenance"],
        &[
            "adapter",
            "driver",
            "backend",
            "device_type",
            "meniscus",
            "commit",
            "left_out",
        ],
        &[],
    );
    for (key, value) in provenance {
        let said = value.as_str().is_some_and(|text| !text.is_empty());
        // Some drivers have no name of their own.
        assert!(said || key == "driver", "{provenance:?}");
    }
    assert_eq!(results["scene"], "pool");
    assert_eq!(results["settings"]["water.rms_slope"], "0.1");
    assert_eq!(results["size"], serde_json::json!([64, 36]));
    assert_eq!(results["truth"], "flat");
    let water = results["water_pixels"].as_u64().expect("a number");
    assert!(water > 0 && water <= 64 * 36);
    assert!(
        results["undefined_pixels"]
            .as_u64()
            .is_some_and(|u| u <= water)
    );

    let rows = results["rows"].as_array().expect("rows");
    let names: Vec<_> = rows.iter().map(|row| &row["pipeline"]).collect();
    assert_eq!(names, ["refraction/none", "refraction/combined"]);
    for row in rows {
        keys(
            row,
            &[
                "pipeline", "timer", "frame_ms", "passes", "counters", "error",
            ],
            &[
                "relative",
                "shaders",
                "not_finite_pixels",
                "within_px",
                "warnings",
                "preprocessing_ms",
                "dominated_by",
            ],
        );
        assert!(number(row, "/preprocessing_ms") >= 0.0);
        assert!(row["dominated_by"].is_array());
        assert!(row["timer"] == "gpu" || row["timer"] == "wall", "{row}");
        let frame = &row["frame_ms"];
        keys(frame, &["median", "low", "high", "min", "samples"], &[]);
        numbers(frame, &["median", "low", "high", "min"]);
        let times = ["min", "low", "median", "high"].map(|t| number(frame, &format!("/{t}")));
        assert!(times.is_sorted() && times[0] > 0.0, "{frame}");
        let samples = frame["samples"].as_array().expect("samples");
        assert_eq!(samples.len(), 4);
        let least = samples
            .iter()
            .filter_map(Value::as_f64)
            .fold(f64::MAX, f64::min);
        assert_eq!(least, times[0]);

        let passes = row["passes"].as_array().expect("passes");
        assert!(!passes.is_empty());
        for pass in passes {
            keys(pass, &["name", "ms"], &[]);
            assert!(pass["name"].is_string());
            assert!(number(pass, "/ms") >= 0.0);
            // The figures can be led back to the shader that made them.
            let name = pass["name"].as_str().expect("a name");
            assert!(
                row["shaders"][name].as_str().is_some_and(|h| h.len() >= 16),
                "{row}"
            );
        }
        let counters = keys(
            &row["counters"],
            &[
                "triangles",
                "vertex_invocations",
                "fragment_invocations",
                "draws",
            ],
            &[
                "dispatches",
                "compute_invocations",
                "texture_bytes",
                "buffer_bytes",
                "scene_bytes",
                "uploaded_bytes",
                "passes",
            ],
        );
        // Waves that move are uploaded where something reads them.
        let waves = row["pipeline"] == "refraction/combined";
        assert_eq!(number(&row["counters"], "/uploaded_bytes") > 0.0, waves);
        let counted = row["counters"]["passes"].as_array().expect("passes");
        for pass in counted {
            keys(
                pass,
                &[
                    "name",
                    "triangles",
                    "vertex_invocations",
                    "fragment_invocations",
                    "compute_invocations",
                ],
                &[],
            );
        }
        let sum: u64 = counted
            .iter()
            .filter_map(|pass| pass["triangles"].as_u64())
            .sum();
        assert_eq!(row["counters"]["triangles"].as_u64(), Some(sum));
        for (key, count) in counters.iter().filter(|(key, _)| *key != "passes") {
            // `null` where the adapter cannot count.
            let known = count.as_u64().is_some();
            assert!(
                known || count.is_null() && key.ends_with("_invocations"),
                "{key}: {count}"
            );
        }
        assert!(number(&row["counters"], "/triangles") >= 1000.0);
        assert!(number(&row["counters"], "/draws") >= 1.0);

        keys(&row["error"], &ERRORS, &["border"]);
        errors(&row["error"]);
        keys(&row["error"]["border"], &ERRORS, &[]);
        errors(&row["error"]["border"]);
    }
    let relative = &row(&results, "refraction/combined")["relative"];
    keys(relative, &["to", "median", "low", "high", "of_minima"], &[]);
    assert_eq!(relative["to"], "refraction/none");
}

#[test]
fn what_was_set_is_recorded() {
    let results = results(
        "refraction/combined --rounds 1 --set camera.height=2 \
         --with narrow.deflect=optics/rotated_refracted_ray",
    );
    assert_eq!(results["settings"]["camera.height"], "2");
    let changed = "optics/rotated_refracted_ray";
    assert_eq!(results["settings"]["narrow.deflect"], changed);
    let name = results["rows"][0]["pipeline"].as_str().expect("a name");
    assert!(name.starts_with("refraction/combined"), "{name}");
    assert!(name.contains(changed), "{name}");
}

#[test]
fn what_was_left_out_is_recorded() {
    let line = "refraction/combined --rounds 1 --set water.rms_slope=0";
    let told = |more: &str| {
        let results = results(&format!("{line} {more}"));
        let row = row(&results, "refraction/combined");
        let left_out = results["provenance"]["left_out"].clone();
        (left_out, number(row, "/within_px"), row["shaders"].clone())
    };
    let (left_out, within_px, short) = told("");
    assert_eq!(left_out, "within_px");
    assert!(within_px > 0.0, "{within_px}");
    let (left_out, within_px, whole) = told("--exact");
    assert_eq!(left_out, "exact");
    assert_eq!(within_px, 0.0);
    assert_ne!(short, whole, "the same shortcuts are taken");
}

#[test]
fn a_scene_without_water_in_sight_has_no_error() {
    let results = results(
        "refraction/none refraction/combined --rounds 1 --set camera.target.z=9 --set camera.height=3",
    );
    assert_eq!(results["water_pixels"], 0);
    for row in results["rows"].as_array().expect("rows") {
        assert!(row["error"].is_null(), "{row}");
    }
}

#[test]
fn the_truth_obeys_the_option_and_the_setting() {
    let errors = |arguments: &str| {
        let results = results(&format!("refraction/combined --rounds 1 {arguments}"));
        let mean = number(&results["rows"][0], "/error/position_px/mean");
        let truth = results["truth"].as_str().expect("a word").to_owned();
        (truth, mean)
    };
    let (truth, flat) = errors("--truth flat");
    assert_eq!(truth, "flat");
    let (truth, displaced) = errors("--truth displaced");
    assert_eq!(truth, "displaced");
    // `--set` holds pipelines and truth alike,
    assert_eq!(errors("--set water.geometry=flat"), ("flat".into(), flat));
    // and only where both are given do they differ.
    for both in [
        "--set water.geometry=flat --truth displaced",
        "--set water.geometry=displaced --truth flat",
    ] {
        let (truth, mixed) = errors(both);
        assert!(both.ends_with(&truth), "{both}: {truth}");
        assert!(
            mixed > 1.2 * flat.max(displaced),
            "{both}: {mixed}, {flat}, {displaced}"
        );
    }
}

#[test]
fn preprocessing_is_told_where_something_reads_what_it_makes() {
    let results = results("refraction/none refraction/ray-traced --rounds 1");
    let made = results["preprocessing"].as_object().expect("an object");
    for (key, value) in made {
        let known = ["bvh", "distance_field", "far_side"].iter().any(|name| {
            let unit = key.strip_prefix(name);
            matches!(unit, Some("_ms" | "_bytes"))
        });
        assert!(
            known && value.as_f64().is_some_and(|v| v >= 0.0),
            "{key}: {value}"
        );
    }
    assert!(number(&results["preprocessing"], "/bvh_ms") > 0.0);
    let [none, traced] =
        ["refraction/none", "refraction/ray-traced"].map(|name| row(&results, name));
    // Only who traces rays pays for the tree.
    assert_eq!(number(none, "/preprocessing_ms"), 0.0);
    assert!(number(traced, "/preprocessing_ms") > 0.0);
    let bytes = |row| number(row, "/counters/scene_bytes");
    let tree = number(&results["preprocessing"], "/bvh_bytes");
    assert_eq!(bytes(traced) - bytes(none), tree);
    assert_eq!(bytes(traced), number(&results, "/scene_bytes"));
}

#[test]
fn several_moments_are_told_with_their_mean_and_worst() {
    let line = "refraction/none refraction/combined --set water.rms_slope=0.1 --rounds 4";
    let moments = results(&format!("{line} --times 0,0.5,2"));
    assert_eq!(moments["moments"], serde_json::json!([0.0, 0.5, 2.0]));
    let combined = row(&moments, "refraction/combined");
    let errors = |row: &Value, figure: &str| -> Vec<f64> {
        let each = row["moments"].as_array().expect("moments").iter();
        each.map(|moment| number(moment, figure)).collect()
    };
    let each = errors(combined, "/error/position_px/mean");
    assert!(each[0] != each[1] && each[1] != each[2], "{each:?}");
    let mean = number(combined, "/error/position_px/mean");
    assert!((mean - each.iter().sum::<f64>() / 3.0).abs() < 1e-12);
    let worst = number(combined, "/worst/position_px/mean");
    assert_eq!(worst, each.iter().copied().fold(0.0, f64::max));
    // The same as if the moment had run alone.
    let alone = results(&format!("{line} --set water.time=0.5"));
    let alone = row(&alone, "refraction/combined");
    assert_eq!(number(alone, "/error/position_px/mean"), each[1]);
    // And the same again.
    let again = results(&format!("{line} --times 0,0.5,2"));
    let again = row(&again, "refraction/combined");
    assert_eq!(again["moments"], combined["moments"]);
}

#[test]
fn counted_moments_begin_with_the_scene_s_own() {
    let results = results("refraction/none --rounds 1 --set water.time=3 --repeat-scene-times 2");
    assert_eq!(results["moments"], serde_json::json!([3.0, 3.25]));
}

#[test]
fn moments_and_rivals_that_mean_nothing_are_refused() {
    let said = |more: &str| {
        let line = format!("ablate refraction/none refraction/broad --size 16x9 {more}");
        meniscus(words(&line))
    };
    said("--times 0,inf").refused(&["inf", "no moment"]);
    said("--times 0,1e9").refused(&["1000000000", "no moment"]);
    said("--times 0,soon").refused(&["soon"]);
    said("--repeat-scene-times 0").refused(&["0"]);
    said("--times 0,1 --repeat-scene-times 2").refused(&["--times", "--repeat-scene-times"]);
    said("--against refraction/brod").refused(&["refraction/brod", "refraction/broad"]);
    said("--ours refraction/broad").refused(&["--against"]);
    said("--ours refraction/broad --against refraction/broad").refused(&["both sides"]);
}

#[test]
fn rivals_are_held_against_ours() {
    let results = results(
        "refraction/none refraction/broad refraction/combined refraction/planar --rounds 4 \
         --against refraction/none,refraction/planar",
    );
    let contests = results["contests"].as_array().expect("contests");
    let rivals: Vec<_> = contests.iter().map(|contest| &contest["rival"]).collect();
    assert_eq!(rivals, ["refraction/none", "refraction/planar"]);
    for contest in contests {
        keys(
            contest,
            &[
                "rival",
                "holds",
                "certain",
                "ours",
                "times",
                "ours_px",
                "rival_px",
                "ours_wrong",
                "rival_wrong",
                "needs",
                "dominates",
            ],
            &[],
        );
        assert_eq!(contest["holds"], number(contest, "/needs") <= 1.0);
        assert_eq!(contest["times"]["to"], contest["rival"]);
        let ours = row(&results, contest["ours"].as_str().expect("a name"));
        assert_eq!(contest["ours_px"], ours["error"]["position_px"]["mean"]);
    }
}

#[test]
fn every_combination_of_what_is_tried_is_run() {
    let results = results(
        "refraction/combined --rounds 1 \
         --try narrow.deflect=optics/refracted_ray,optics/rotated_refracted_ray \
         --try broad.place=optics/apparent_position,optics/path_length,optics/in_place",
    );
    let rows = results["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 6);
    for deflect in ["optics/refracted_ray", "optics/rotated_refracted_ray"] {
        for place in [
            "optics/apparent_position",
            "optics/path_length",
            "optics/in_place",
        ] {
            let both = rows.iter().filter(|row| {
                let name = row["pipeline"].as_str().unwrap_or_default();
                name.contains(&format!("narrow.deflect={deflect} "))
                    && name.contains(&format!("broad.place={place}"))
            });
            assert_eq!(both.count(), 1, "{deflect}, {place}");
        }
    }
    // What was tried was used: the shaders of no two rows are the same.
    for (index, row) in rows.iter().enumerate() {
        let other = rows[..index]
            .iter()
            .find(|r| r["shaders"] == row["shaders"]);
        assert!(other.is_none(), "{row}\n{other:?}");
    }
}

#[test]
fn times_are_relative_to_the_baseline_that_is_named() {
    let results = results(
        "refraction/none refraction/broad refraction/combined --rounds 3 --baseline refraction/broad",
    );
    for row in results["rows"].as_array().expect("rows") {
        assert_eq!(row["relative"]["to"], "refraction/broad");
    }
    let itself = &row(&results, "refraction/broad")["relative"];
    for figure in ["median", "low", "high", "of_minima"] {
        assert_eq!(itself[figure], 1.0);
    }
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

#[test]
fn tables_pictures_and_data_are_left_behind() {
    let there = folder();
    let path = |name: &str| there.path().join(name);
    let (markdown, csv, out) = (path("deep/table.md"), path("table.csv"), path("out"));
    let line = "ablate refraction/none refraction/combined --size 64x36 --rounds 1 \
                --set pool.triangles=4k";
    let mut line = words(line);
    line.extend([
        "--markdown",
        text(&markdown),
        "--csv",
        text(&csv),
        "--out",
        text(&out),
    ]);
    let table = meniscus(&line).done();

    let pipelines = ["refraction/none", "refraction/combined"];
    let markdown = read(&markdown);
    let lines: Vec<&str> = markdown.lines().filter(|l| l.starts_with('|')).collect();
    assert_eq!(lines.len(), 2 + pipelines.len(), "{markdown}");
    let columns = |line: &str| line.matches('|').count();
    assert!(
        lines.iter().all(|l| columns(l) == columns(lines[0])),
        "{markdown}"
    );

    let csv = read(&csv);
    let mut records = csv.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let head = records.next().expect("a head");
    let records: Vec<_> = records.collect();
    assert_eq!(records.len(), pipelines.len(), "{csv}");
    assert!(records.iter().all(|r| r.len() == head.len()), "{csv}");
    for pipeline in pipelines {
        assert!(table.contains(pipeline) && markdown.contains(pipeline));
        assert!(records.iter().any(|r| r.contains(&pipeline)), "{csv}");
        let file = pipeline.replace('/', "-");
        for ending in ["png", "error.png"] {
            let picture = image::open(out.join(format!("{file}.{ending}"))).expect("a picture");
            assert_eq!((picture.width(), picture.height()), (64, 36));
        }
        let (shape, _) = npy_f32(&out.join(format!("{file}.shown.npy")));
        assert_eq!(shape, [36, 64, 4]);
    }
    let truth = image::open(out.join("truth.png")).expect("a picture");
    assert_eq!((truth.width(), truth.height()), (64, 36));
    for file in ["truth.npy", "water.npy", "undefined.npy", "total.npy"] {
        let bytes = std::fs::read(out.join(file)).unwrap_or_else(|e| panic!("{file}: {e}"));
        assert_eq!(&bytes[..6], b"\x93NUMPY", "{file}");
    }
    let scene = json(&out.join("scene.json"));
    assert!(scene.is_object());
    assert!(json(&out.join("results.json"))["rows"].is_array());
    let figure = read(&out.join("time-error.svg"));
    assert!(
        figure.starts_with("<svg") || figure.starts_with("<?xml"),
        "{figure}"
    );
    assert!(pipelines.iter().all(|pipeline| figure.contains(pipeline)));
    // Nothing half written stays.
    let left = std::fs::read_dir(&out).expect("the directory").flatten();
    for entry in left {
        let name = entry.file_name();
        assert!(!name.to_string_lossy().starts_with('.'), "{name:?}");
    }
}
