//! The pipelines that come with meniscus plan under every combination of facts.

use std::path::{Path, PathBuf};

use meniscus_pipeline::{Facts, Pipelines, Plan};
use meniscus_shader::{Composer, Library};
use meniscus_source::read_tree;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn composer() -> Composer {
    let modules = read_tree(&root().join("shader-modules"), "wgsl").unwrap();
    let (library, report) = Library::new(modules.iter().map(|(n, f)| (n.as_str(), f.clone())));
    assert!(report.0.is_empty(), "{report}");
    Composer::new(library)
}

fn pipelines() -> Pipelines {
    let files = read_tree(&root().join("pipelines"), "ron").unwrap();
    Pipelines::new(files.iter().map(|(n, f)| (n.as_str(), f.clone())))
}

#[test]
fn every_pipeline_plans_under_all_facts() {
    let composer = composer();
    let pipelines = pipelines();
    let names: Vec<String> = pipelines.names().map(str::to_owned).collect();
    assert!(names.iter().any(|n| n == "refraction/combined"));
    for name in names {
        let pipeline = pipelines
            .load(&name)
            .unwrap_or_else(|report| panic!("{name}\n{report}"));
        for facts in Facts::all() {
            for shown in [false, true] {
                Plan::new(&pipeline, &composer, &facts, shown)
                    .unwrap_or_else(|report| panic!("{name} under {facts:?}\n{report}"));
            }
        }
    }
}

#[test]
fn every_module_stands_by_itself() {
    let report = composer().check_library();
    assert!(report.0.is_empty(), "{report}");
}
