//! `meniscus eval` and `meniscus stress` through the built program.

mod common;

use common::{meniscus, words};
use serde_json::Value;

/// The number that a line of the output names.
fn number(out: &str, name: &str) -> f64 {
    let line = out
        .lines()
        .find(|line| line.split_whitespace().next() == Some(name));
    let word = line.and_then(|line| line.split_whitespace().nth(1));
    word.and_then(|word| word.parse().ok())
        .unwrap_or_else(|| panic!("no {name} in {out}"))
}

const SNELL: &str = "eval optics/snell:refracted 0.6 0 -0.8 0 0 1 1.5";

#[test]
fn eval_obeys_snell_in_every_number_system() {
    for scalar in ["f32", "f64", "dd", "interval", "dual"] {
        let out = meniscus(words(&format!("{SNELL} --scalar {scalar}"))).done();
        let sine = number(&out, "direction.x");
        assert!((1.5 * sine - 0.6).abs() < 1e-6, "{scalar}: {out}");
        assert!(out.contains("false"), "not totally reflected: {out}");
    }
}

#[test]
fn eval_reads_the_water_that_is_set() {
    let bent = |set: &str| {
        let out = meniscus(words(&format!(
            "eval optics/flat_crossing:flat_crossing 1 2 3 {set}"
        )))
        .done();
        number(&out, "tangent")
    };
    let (thin, dense) = (
        bent("--set water.refractive_index=1.1"),
        bent("--set water.refractive_index=2"),
    );
    assert!(1.0 < thin && thin < dense && dense < 3.0, "{thin} {dense}");
}

#[test]
fn eval_reads_columns_by_their_names_in_any_order() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("rays.csv");
    let text = "index,incident.z,incident.y,incident.x,normal.z,normal.y,normal.x\n\
                1.5,-0.8,0,0.6,1,0,0\n1,-0.8,0,0.6,1,0,0\n";
    std::fs::write(&file, text).expect("a file");
    let run = |name: &str| meniscus(["eval", "optics/snell:refracted", "--csv", name]);
    let out = run(&file.to_string_lossy()).done();
    let mut reader = csv::Reader::from_reader(out.as_bytes());
    let sines: Vec<f64> = reader
        .records()
        .map(|r| r.expect("a line")[0].parse().expect("a number"))
        .collect();
    assert!(
        (sines[0] - 0.4).abs() < 1e-6 && (sines[1] - 0.6).abs() < 1e-6,
        "{out}"
    );
    std::fs::write(&file, text.replace("index", "indexes")).expect("a file");
    run(&file.to_string_lossy()).refused(&["no column `index`", "indexes"]);
    std::fs::write(&file, text.replace("1.5", "water")).expect("a file");
    run(&file.to_string_lossy()).refused(&["rays.csv:2", "`water`"]);
    run("nowhere.csv").refused(&["nowhere.csv"]);
}

#[test]
fn eval_refuses_what_does_not_fit() {
    for (line, said) in [
        ("eval optics/snell 1 2 3", "MODULE:FUNCTION"),
        ("eval optics/snel:refracted 1", "optics/snell"),
        ("eval optics/snell:refract 1", "`refracted`"),
        ("eval optics/snell:refracted 1 2 3", "7 numbers, not 3"),
        ("eval optics/snell:refracted 1 0 0 0 0 one 1", "`one`"),
        ("eval screen/neighbours:neighbour 1.5", "i32"),
        (
            "eval optics/flat_crossing:flat_crossing 1 2 3 --set water.refractive_index=0",
            "more than 0",
        ),
        (
            "eval optics/flat_crossing:flat_crossing 1 2 3 --set water.level=inf",
            "finite",
        ),
        (
            "eval optics/flat_crossing:flat_crossing 1 2 3 --set water",
            "NAME=NUMBER",
        ),
        (
            "eval optics/flat_crossing:flat_crossing 1 2 3 --set water.level=1,2",
            "1 numbers, not 2",
        ),
    ] {
        meniscus(words(line)).refused(&[said]);
    }
}

#[test]
fn stress_tells_errors_and_keeps_the_worst_inputs() {
    let folder = tempfile::tempdir().expect("a folder");
    let json = folder.path().join("found.json");
    let worst = folder.path().join("worst");
    let mut arguments = words("stress optics/crossing_split:crossing --samples 2048 --json");
    let (json_name, worst_name) = (json.to_string_lossy(), worst.to_string_lossy());
    arguments.extend([&*json_name, "--worst", &*worst_name]);
    let out = meniscus(&arguments).done();
    assert!(out.contains("optics/crossing_split:crossing"), "{out}");
    let text = std::fs::read_to_string(&json).expect("results");
    let found: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(found["functions"][0]["non_finite"], 0);
    assert!(found["functions"][0]["inputs"].as_u64().expect("a count") >= 2048);
    assert!(
        found["functions"][0]["scaled"]["max"]
            .as_f64()
            .expect("an error")
            < 4.0,
        "{text}"
    );
    let kept = std::fs::read_dir(&worst).expect("a folder").count();
    assert_eq!(kept, 1);
    meniscus(words("stress optics/crossing_spilt")).refused(&["declares no domain"]);
}
