//! `meniscus explain`, and `--exact`.

mod common;

use common::{folder, meniscus, text, words};
use serde_json::Value;

#[test]
fn an_explanation_is_text_json_or_a_graph() {
    let line = "explain refraction/combined --set water.rms_slope=0 --size 320x180";
    let said = meniscus(words(line)).done();
    for part in [
        "What is known",
        "Passes",
        "Shortcuts",
        "Objects",
        "Textures and buffers",
    ] {
        assert!(said.contains(part), "`{part}` is missing in\n{said}");
    }
    assert!(
        said.lines().all(|line| line.chars().count() <= 100),
        "{said}"
    );
    let json: Value =
        serde_json::from_str(&meniscus(words(&format!("{line} --json"))).done()).unwrap();
    let passes = json["passes"].as_array().unwrap();
    let kept = passes.iter().filter(|pass| pass["kept"] == true).count();
    assert_eq!(json["total"][0]["passes"], kept);
    let dropped = passes.iter().find(|pass| pass["kept"] == false).unwrap();
    assert_eq!(dropped["dropped"]["promise"], "within");
    let graph = meniscus(words(&format!("{line} --dot"))).done();
    assert!(
        graph.starts_with("digraph") && graph.contains("gray"),
        "{graph}"
    );
}

#[test]
fn what_is_exact_moves_nothing() {
    let line = "explain refraction/combined --set water.rms_slope=0 --exact --json";
    let json: Value = serde_json::from_str(&meniscus(words(line)).done()).unwrap();
    assert_eq!(json["within_px"], 0.0);
    let graph = format!("{} --dot", line.replace(" --json", ""));
    let file = folder();
    let path = file.path().join("a.dot");
    let to_file = format!("{graph} -o {}", text(&path));
    assert_eq!(meniscus(words(&to_file)).done(), "");
    let written = std::fs::read_to_string(&path).unwrap();
    assert_eq!(written, meniscus(words(&graph)).done());
}

#[test]
fn exact_pictures_are_those_of_the_whole_pipeline() {
    let folder = folder();
    let picture = |name: &str, more: &str| {
        let path = folder.path().join(name);
        let line = format!(
            "render refraction/refined --set water.rms_slope=0 --size 160x90 {more} -o {}",
            text(&path)
        );
        meniscus(words(&line)).done();
        std::fs::read(&path).unwrap()
    };
    let exact = picture("exact.png", "--exact");
    assert_eq!(exact, picture("again.png", "--exact"));
    assert_ne!(
        exact,
        picture("short.png", ""),
        "a shortcut rounds otherwise"
    );
}

#[test]
fn what_cannot_be_explained_is_refused() {
    meniscus(words("explain refraction/combind")).refused(&["did you mean `refraction/combined`?"]);
    meniscus(words("explain refraction/combined --scene puddle")).refused(&["puddle"]);
    let both = meniscus(words("explain refraction/combined --dot --json"));
    both.refused(&["cannot be used with"]);
}
