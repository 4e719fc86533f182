//! The page about numerical stability is what its data say, and they say that everything holds.

mod common;

use std::path::Path;

use common::{folder, json, meniscus, number, text};
use serde_json::Value;

const DATA: [&str; 6] = [
    "functions.json",
    "agreement.json",
    "exhaustive.json",
    "solvers.json",
    "scenes.json",
    "told.md",
];

fn docs() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/docs"))
}

/// The page without the lines that tell modules' purposes, which are those of today's headers.
fn page(path: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let lines = text.lines().filter(|line| !line.starts_with("- **"));
    lines.map(str::to_owned).collect()
}

#[test]
fn the_page_is_made_of_its_data() {
    let there = folder();
    let data = there.path().join("stability");
    std::fs::create_dir(&data).expect("a directory");
    for file in DATA {
        std::fs::copy(docs().join("stability").join(file), data.join(file)).expect(file);
    }
    let made = there.path().join("stability.md");
    meniscus(["stress", "--page", text(&made)]).done();
    let (made, kept) = (page(&made), page(&docs().join("stability.md")));
    assert!(made.len() > 100, "{made:?}");
    for (made, kept) in made.iter().zip(&kept) {
        assert_eq!(made, kept, "make the page anew: its last lines tell how");
    }
    assert_eq!(made.len(), kept.len());
    let drawn = std::fs::read_to_string(data.join("solvers-1.svg")).expect("a figure");
    assert!(drawn.starts_with("<svg") && drawn.contains("nanoseconds"));
}

#[test]
fn what_the_page_tells_of_holds() {
    let data = docs().join("stability");
    let scenes = json(&data.join("scenes.json"));
    assert!(number(&scenes, "/scenes") >= 2000.0);
    assert!(number(&scenes, "/judged") >= 100.0);
    assert_eq!(scenes["failures"].as_array().map(Vec::len), Some(0));
    let share = number(&scenes, "/distance/far") / number(&scenes, "/distance/pixels");
    assert!(share <= 0.001, "{share}");
    let functions = json(&data.join("functions.json"));
    let functions = functions["functions"].as_array().expect("functions");
    assert!(functions.len() >= 40, "{}", functions.len());
    for function in functions {
        assert_eq!(function["non_finite"], 0, "{function}");
    }
    let agreement = json(&data.join("agreement.json"));
    assert!(number(&agreement, "/samples") >= 1e5);
    let agreement = agreement["functions"].as_array().expect("functions");
    let plain = |f: &&Value| f["built_ins"].as_array().is_some_and(Vec::is_empty);
    let plain: Vec<&Value> = agreement.iter().filter(plain).collect();
    let alike = plain.iter().filter(|f| f["differ"] == 0).count();
    assert!(plain.len() > 20 && alike == plain.len(), "{alike}");
    let exhaustive = json(&data.join("exhaustive.json"));
    let exhaustive = exhaustive["functions"].as_array().expect("functions");
    assert!(!exhaustive.is_empty());
    for function in exhaustive {
        // All floats that are finite; 0 has two, which count as one.
        let all = number(function, "/inside/inputs") + number(function, "/outside/inputs");
        assert_eq!(all, 2.0 * f64::from(0x7F7F_FFFF_u32) + 1.0);
        assert_eq!(function["inside"]["non_finite"], 0);
        assert!(number(function, "/inside/scaled") <= 4.0, "{function}");
    }
    let solvers = json(&data.join("solvers.json"));
    let solvers = solvers.as_array().expect("solvers");
    // The most exact one is right to a few units in the last place wherever one was tried.
    let domains: std::collections::BTreeSet<&str> = solvers
        .iter()
        .filter_map(|s| s["domain"].as_str())
        .collect();
    assert!(!domains.is_empty());
    for domain in domains {
        let here = solvers.iter().filter(|s| s["domain"] == domain);
        let best = here
            .map(|s| number(s, "/max_ulp"))
            .fold(f64::INFINITY, f64::min);
        assert!(best <= 8.0, "{domain}: {best}");
    }
}

#[test]
fn missing_data_are_told() {
    let there = folder();
    let page = there.path().join("page.md");
    let said = meniscus(["stress", "--page", text(&page)]);
    said.refused(&["functions.json"]);
    meniscus(["stress", "--solvers", "no_such_slot"]).refused(&["no slot `no_such_slot`"]);
    meniscus(["stress", "--solvers", "surface"]).refused(&["declares an independent truth"]);
}
