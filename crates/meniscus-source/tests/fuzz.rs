//! Whatever a RON text holds, reading it ends, with a value or with messages at places in it.

#[path = "common/mutate.rs"]
mod mutate;

use std::collections::BTreeMap;

use meniscus_source::SourceFile;
use meniscus_source::ron::{Entries, Spanned, from_source};
use mutate::Mutator;
use serde::Deserialize;

/// A file with all that RON has.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(dead_code, reason = "only read")]
struct Everything {
    name: Spanned<String>,
    number: Spanned<f64>,
    #[serde(default)]
    whole: Option<u32>,
    #[serde(default)]
    list: Vec<Choice>,
    #[serde(default)]
    map: BTreeMap<String, (f32, bool)>,
    #[serde(default)]
    entries: Option<Entries<Choice>>,
}

#[derive(Debug, Deserialize)]
#[allow(dead_code, reason = "only read")]
enum Choice {
    Plain,
    Of(i64),
    With { inner: Box<Everything> },
}

const HONEST: &[&str] = &[
    "(name: \"a\", number: 1.5)",
    "// A comment.\n(\n    name: \"é\\n\\u{1F30A}\",\n    number: -2e-3, /* and /* one more */ */\n    whole: Some(7),\n    list: [Plain, Of(-3), With(inner: (name: r#\"raw\"#, number: 1_6.5))],\n    map: { \"one\": (1.0, true), \"two\": (-0.0, false) },\n    entries: Some({ \"x\": Plain, \"y\": Of(1) }),\n)",
    "#![enable(implicit_some)]\n(name: 'c', number: 3, whole: 4, list: [], map: {})",
];

const WORDS: &[&str] = &[
    "name",
    "number",
    "whole",
    "list",
    "map",
    "entries",
    "Some",
    "None",
    "Plain",
    "Of",
    "With",
    "inner",
    "true",
    "false",
    "NaN",
    "inf",
    "-inf",
    "\"\"",
    "()",
    "[]",
    "{}",
    "(name: \"\", number: 0)",
    "4294967296",
    "1_000",
    "0b1",
    "1e400",
    ":",
    ",",
];

#[test]
fn reading_ends_and_places_are_inside_the_text() {
    let corpus: Vec<String> = HONEST.iter().map(|text| (*text).to_owned()).collect();
    for text in &corpus {
        if let Err(report) =
            from_source::<Everything>(&SourceFile::new("honest.ron", text.as_str()))
        {
            // Characters are no strings.
            assert!(text.contains('\''), "{report}");
        }
    }
    Mutator::new(&corpus, WORDS).run(1, |_, text| {
        let file = SourceFile::new("case.ron", text);
        match from_source::<Everything>(&file) {
            Ok(read) => {
                let place = read.name.place.expect("a place");
                assert!(file.text.get(place.range.clone()).is_some());
            }
            Err(report) => {
                assert!(!report.is_ok());
                let labels = report.0.iter().flat_map(|d| &d.labels);
                for label in labels {
                    let range = label.place.range.clone();
                    assert!(file.text.get(range).is_some(), "{label:?}");
                }
                assert!(!report.to_string().is_empty());
            }
        }
    });
}
