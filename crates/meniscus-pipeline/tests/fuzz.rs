//! Pipeline files that differ a little from honest ones: reading, changing and planning them ends,
//! with a plan or with messages at places in what was written.

mod common;
#[path = "../../meniscus-source/tests/common/mutate.rs"]
mod mutate;

use std::path::Path;

use meniscus_pipeline::{Facts, Pipelines, Plan, diff};
use meniscus_shader::{Composer, Library};
use meniscus_source::{Report, SourceFile, read_tree};
use mutate::Mutator;

const WORDS: &[&str] = &[
    "Pipeline(",
    "Variant(",
    "Draw(",
    "Screen(",
    "Compute(",
    "Repeat(",
    "Remove",
    "insert_after",
    "of",
    "about",
    "set",
    "textures",
    "buffers",
    "sequence",
    "output",
    "name",
    "skeleton",
    "geometry",
    "slots",
    "reads",
    "writes",
    "when",
    "over",
    "runs",
    "dispatch",
    "times",
    "\"not waves\"",
    "\"waves and\"",
    "\"depth\"",
    "\"frame\"",
    "\"narrow.intersect\"",
    "\"narrow.intersect.taps\"",
    "\"../../x\"",
    "\"case\"",
    "Rgba32Float",
    "Depth32Float",
    "Guarded",
    "Frame",
    "NearSide",
    "Pixels(Frame)",
    "Fixed(1, 0, 1)",
    "None",
    "Some(1)",
    "()",
    "{}",
    "[]",
    "-1",
    "1e999",
    "18446744073709551615",
];

fn told_well(report: &Report, shown: bool) {
    for label in report.0.iter().flat_map(|diagnostic| &diagnostic.labels) {
        let place = &label.place;
        assert!(
            place.file.text.get(place.range.clone()).is_some(),
            "{label:?}"
        );
    }
    assert!(!shown || !report.to_string().is_empty());
}

#[test]
fn reading_and_planning_end() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../pipelines");
    let honest = read_tree(&folder, "ron").unwrap_or_else(|report| panic!("{report}"));
    let files = || {
        honest
            .iter()
            .map(|(name, file)| (name.as_str(), file.clone()))
    };
    let known = Pipelines::new(files());
    let mut corpus: Vec<String> = honest.iter().map(|(_, file)| file.text.clone()).collect();
    corpus.push(common::PIPELINE.to_owned());
    let modules = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shader-modules");
    let modules = read_tree(&modules, "wgsl").unwrap_or_else(|report| panic!("{report}"));
    let (library, report) = Library::new(modules.iter().map(|(p, f)| (p.as_str(), f.clone())));
    assert!(report.is_ok(), "{report}");
    let composer = Composer::new(library);
    let other = known
        .names()
        .next()
        .and_then(|name| known.load(name).ok())
        .expect("a pipeline");
    Mutator::new(&corpus, WORDS).run(2, |case, text| {
        let file = SourceFile::new("case.ron", text);
        let mut pipeline = match known.load_file("case", &file) {
            Ok(pipeline) => pipeline,
            Err(report) => return told_well(&report, case.is_multiple_of(64)),
        };
        let _ = (diff(&pipeline, &other), diff(&other, &pipeline));
        if let Err(report) = pipeline.set("narrow.intersect.taps", text) {
            told_well(&report, case.is_multiple_of(64));
        }
        // Much is composed once and kept.
        if case.is_multiple_of(64)
            && let Err(report) = Plan::new(&pipeline, &composer, &Facts::default(), true)
        {
            told_well(&report, case.is_multiple_of(64));
        }
    });
}
