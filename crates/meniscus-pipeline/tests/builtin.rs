//! The pipelines that come with meniscus plan under every combination of facts.

use std::collections::BTreeSet;
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

/// Every combination of facts of what is seen, on top of those on which shaders depend.
fn all_that_may_be_seen() -> Vec<Facts> {
    let seen: Vec<&str> = KNOWN_FACTS
        .iter()
        .map(|(name, _)| *name)
        .filter(|name| name.ends_with("_visible") || *name == "fine_edges")
        .collect();
    let mut all = Facts::all();
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
    assert_eq!(facts.len(), 32 * Facts::all().len());
    for name in pipelines.names() {
        let pipeline = pipelines
            .load(name)
            .unwrap_or_else(|r| panic!("{name}\n{r}"));
        for facts in &facts {
            let passes = |pruning| {
                let plan = Plan::pruned(&pipeline, &composer, facts, pruning, false);
                let plan = plan.unwrap_or_else(|r| panic!("{name} under {facts:?}\n{r}"));
                let textures: BTreeSet<String> = plan.textures.keys().cloned().collect();
                assert!(textures.contains(&plan.output), "{name} under {facts:?}");
                for target in plan.passes.iter().flat_map(|pass| &pass.targets) {
                    assert!(textures.contains(target), "{name}: {target}");
                }
                let passes = plan.passes.into_iter().map(|pass| pass.name);
                passes.collect::<Vec<String>>()
            };
            let (none, exact) = (passes(Pruning::None), passes(Pruning::Exact));
            assert!(
                exact.iter().all(|pass| none.contains(pass)),
                "{name} under {facts:?}: {exact:?} of {none:?}"
            );
            // What is far is seen through the water, and a pixel without water is dry.
            let wet = facts.has("water_visible");
            if !wet && (facts.has("far_visible") || !facts.has("dry_visible")) {
                continue;
            }
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
