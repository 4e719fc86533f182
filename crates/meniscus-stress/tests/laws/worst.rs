//! The worst inputs that were found stay as harmless as they were.
//!
//! The files of `tests/data/worst` are written by
//! `meniscus stress --samples 65536 --worst crates/meniscus-stress/tests/data/worst`.

use std::path::Path;

use meniscus_stress::modules::{Host, Worst, declared};

use crate::lab::composer;

fn kept() -> Vec<Worst> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/worst");
    let files = std::fs::read_dir(&folder).expect("the worst inputs");
    let mut paths: Vec<_> = files.map(|file| file.expect("a file").path()).collect();
    paths.sort();
    let read = |path: &std::path::PathBuf| {
        let text = std::fs::read_to_string(path).expect("a text file");
        serde_json::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
    };
    paths.iter().map(read).collect()
}

#[test]
fn the_worst_inputs_known_are_no_worse_than_when_they_were_found() {
    let composer = composer(&[]);
    let (all, report) = declared(composer.library());
    assert!(report.0.is_empty(), "{report}");
    let files = kept();
    assert!(files.len() > 30, "{}", files.len());
    let mut worse = Vec::new();
    for file in &files {
        let found = file
            .again(&composer, &all, &Host::default())
            .unwrap_or_else(|e| panic!("{e}"));
        for (kept, found) in file.cases.iter().zip(found) {
            let name = format!("{}:{}", file.module, file.function);
            assert_eq!(found.non_finite, 0, "{name}: {kept:?}");
            // None was kept where the error was infinite.
            let before = kept.case.scaled.unwrap_or(f64::INFINITY);
            if found.scaled.max > 1.01 * before + 0.5 {
                worse.push(format!(
                    "{name}: {} ulp, {before} before: {kept:?}",
                    found.scaled.max
                ));
            }
        }
    }
    assert!(worse.is_empty(), "{}", worse.join("\n"));
}
