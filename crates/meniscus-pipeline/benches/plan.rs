//! What deciding costs on the CPU, each frame and once.
//!
//! `cargo bench -p meniscus-pipeline --bench plan`

use std::hint::black_box;
use std::path::Path;

use criterion::{Criterion, criterion_group, criterion_main};
use glam::UVec2;
use meniscus_pipeline::{Outlook, Pipelines, Plan, PlanCache, Pruning, SceneBounds};
use meniscus_scene::{Scene, SceneSource};
use meniscus_shader::{Composer, Library};
use meniscus_source::read_tree;

const SIZE: UVec2 = UVec2::new(1280, 720);

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

fn composer() -> Composer {
    let modules = read_tree(&root().join("shader-modules"), "wgsl").expect("modules");
    let (library, report) = Library::new(modules.iter().map(|(n, f)| (n.as_str(), f.clone())));
    assert!(report.is_ok(), "{report}");
    Composer::new(library)
}

fn pool() -> Scene {
    let path = root().join("examples/scenes/pool.ron");
    let text = std::fs::read_to_string(&path).expect("a scene");
    let source = SceneSource::embedded("pool.ron", &text);
    source.load(&[]).unwrap_or_else(|report| panic!("{report}"))
}

fn deciding(criterion: &mut Criterion) {
    let (composer, mut scene) = (composer(), pool());
    let files = read_tree(&root().join("pipelines"), "ron").expect("pipelines");
    let pipelines = Pipelines::new(files.iter().map(|(n, f)| (n.as_str(), f.clone())));
    let pipeline = pipelines.load("refraction/bounded").expect("a pipeline");
    let bounds = SceneBounds::new(&scene);
    let mut cache = PlanCache::new(pipeline.clone(), Pruning::default(), false);
    let mut frame = 0_u32;
    criterion.bench_function("facts and a known plan, a frame", |bencher| {
        bencher.iter(|| {
            // The camera looks up and down, over the horizon and back.
            frame = frame.wrapping_add(1);
            scene.camera.target.z = f64::from(frame % 64) * 0.2 - 6.0;
            let outlook = Outlook::new(&scene, &bounds, SIZE);
            let plan = cache.plan(&composer, outlook.facts).expect("a plan");
            black_box(plan.passes.len())
        });
    });
    criterion.bench_function("a new plan of composed shaders", |bencher| {
        let facts = Outlook::new(&scene, &bounds, SIZE).facts;
        bencher.iter(|| {
            let plan = Plan::new(&pipeline, &composer, &facts, false);
            black_box(plan.expect("a plan").passes.len())
        });
    });
    criterion.bench_function("boxes around a scene's objects, once", |bencher| {
        bencher.iter(|| black_box(SceneBounds::new(&scene)));
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().without_plots();
    targets = deciding
}
criterion_main!(benches);
