//! The pipelines that come with meniscus plan under every combination of facts.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use meniscus_pipeline::{Facts, KNOWN_FACTS, Pipelines, Plan, Pruning, check_facts};
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

/// Every combination of facts of what is seen, over still and moving water and under it.
fn all_that_may_be_seen() -> Vec<Facts> {
    let seen: Vec<&str> = KNOWN_FACTS
        .iter()
        .map(|(name, _)| *name)
        .filter(|name| name.ends_with("_visible") || *name == "fine_edges")
        .collect();
    let mut all: Vec<Facts> = [&[][..], &["waves", "displaced"]]
        .iter()
        .flat_map(|water| [water.to_vec(), [water, &["camera_submerged"][..]].concat()])
        .map(Facts::new)
        .collect();
    for name in seen {
        let without: Vec<Facts> = all.iter().map(|facts| facts.with(name, false)).collect();
        all.extend(without);
    }
    all
}

#[test]
fn whatever_is_left_out_the_rest_is_whole() {
    let composer = composer();
    let pipelines = pipelines();
    let facts = all_that_may_be_seen();
    assert_eq!(facts.len(), 32 * 4);
    for name in pipelines.names() {
        let pipeline = pipelines
            .load(name)
            .unwrap_or_else(|r| panic!("{name}\n{r}"));
        let mut whole: BTreeMap<Facts, Vec<String>> = BTreeMap::new();
        for facts in &facts {
            // What is far is seen through the water, and a pixel without water is dry.
            let wet = facts.has("water_visible");
            if !wet && (facts.has("far_visible") || !facts.has("dry_visible")) {
                continue;
            }
            let passes = |pruning| {
                let plan = Plan::pruned(&pipeline, &composer, facts, pruning, false);
                let plan = plan.unwrap_or_else(|r| panic!("{name} under {facts:?}\n{r}"));
                let targets = plan.passes.iter().flat_map(|pass| &pass.targets);
                for target in targets.chain([&plan.output]) {
                    assert!(plan.textures.contains_key(target), "{name}: {target}");
                }
                let passes = plan.passes.into_iter().map(|pass| pass.name);
                passes.collect::<Vec<String>>()
            };
            let whole = whole.entry(facts.unpruned());
            let whole = whole.or_insert_with(|| passes(Pruning::None));
            let exact = passes(Pruning::Exact);
            assert!(
                exact.iter().all(|pass| whole.contains(pass)),
                "{name} under {facts:?}: {exact:?} of {whole:?}"
            );
            let short = passes(Pruning::Approximate);
            assert!(
                short.len() <= exact.len() && (wet || exact.len() <= 2),
                "{name} under {facts:?}: {short:?} for {exact:?}"
            );
        }
    }
}

#[test]
fn every_fact_that_a_module_names_is_known() {
    let report = check_facts(composer().library());
    assert!(report.0.is_empty(), "{report}");
}

#[test]
fn every_module_stands_by_itself() {
    let report = composer().check_library();
    assert!(report.0.is_empty(), "{report}");
}
