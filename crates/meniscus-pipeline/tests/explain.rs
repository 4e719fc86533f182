//! What is said of pipelines and scenes that come with meniscus.

use std::path::{Path, PathBuf};

use glam::UVec2;
use meniscus_pipeline::{Explanation, Outlook, Pipelines, Plan, Pruning, SceneBounds};
use meniscus_scene::{Scene, SceneSource, Setting};
use meniscus_shader::{Composer, Library};
use meniscus_source::read_tree;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn composer() -> Composer {
    let modules = read_tree(&root().join("shader-modules"), "wgsl").unwrap();
    let (library, report) = Library::new(modules.iter().map(|(n, f)| (n.as_str(), f.clone())));
    assert!(report.is_ok(), "{report}");
    Composer::new(library)
}

fn pipelines() -> Pipelines {
    let files = read_tree(&root().join("pipelines"), "ron").unwrap();
    Pipelines::new(files.iter().map(|(n, f)| (n.as_str(), f.clone())))
}

fn scene(name: &str, settings: &[(&str, &str)]) -> Scene {
    let path = root().join(format!("examples/scenes/{name}.ron"));
    let text = std::fs::read_to_string(&path).unwrap();
    let settings: Vec<Setting> = settings
        .iter()
        .map(|(key, value)| Setting::new(*key, *value))
        .collect();
    let source = SceneSource::embedded(&format!("{name}.ron"), &text);
    let scene = source.load(&settings);
    scene.unwrap_or_else(|report| panic!("{report}"))
}

fn outlook(scene: &Scene) -> Outlook {
    Outlook::new(scene, &SceneBounds::new(scene), UVec2::new(640, 360))
}

fn explained(pipeline: &str, scene: &Scene, pruning: Pruning) -> Explanation {
    let pipeline = pipelines().load(pipeline).unwrap();
    let said = Explanation::new(&pipeline, &composer(), &outlook(scene), pruning);
    said.unwrap_or_else(|report| panic!("{report}"))
}

fn said(pipeline: &str, scene: &Scene) -> String {
    explained(pipeline, scene, Pruning::Approximate).to_string()
}

const STILL: (&str, &str) = ("water.rms_slope", "0");
const UP: (&str, &str) = ("camera.target.z", "8");

#[test]
fn waves_leave_little_to_leave_out() {
    let pool = scene("pool", &[]);
    insta::assert_snapshot!("pool_with_waves", said("refraction/combined", &pool));
}

#[test]
fn flat_water_takes_the_shortcut() {
    let pool = scene("pool", &[STILL]);
    insta::assert_snapshot!("pool_flat", said("refraction/combined", &pool));
}

#[test]
fn flat_water_takes_no_shortcut_that_moves_anything_when_all_is_to_be_exact() {
    let pool = scene("pool", &[STILL]);
    let exact = explained("refraction/combined", &pool, Pruning::Exact);
    assert_eq!(exact.within_px, 0.0);
    insta::assert_snapshot!("pool_flat_exact", exact.to_string());
}

#[test]
fn without_water_in_view_only_what_is_near_remains() {
    let pool = scene("pool", &[UP]);
    insta::assert_snapshot!("no_water_in_view", said("refraction/bounded", &pool));
}

#[test]
fn without_anything_in_the_water_nothing_is_transformed() {
    let mut pool = scene("pool", &[]);
    pool.water.level = -5.0;
    insta::assert_snapshot!("all_objects_dry", said("refraction/combined", &pool));
}

#[test]
fn under_water_the_mirror_is_drawn() {
    let submerged = scene("underwater", &[STILL]);
    insta::assert_snapshot!("camera_under_water", said("refraction/bounded", &submerged));
}

#[test]
fn what_is_left_out_is_grey_in_the_graph() {
    let (pipeline, composer) = (pipelines().load("refraction/combined").unwrap(), composer());
    let facts = outlook(&scene("pool", &[STILL])).facts;
    let plan = |pruning| Plan::pruned(&pipeline, &composer, &facts, pruning, false).unwrap();
    let (kept, whole) = (plan(Pruning::Approximate), plan(Pruning::None));
    insta::assert_snapshot!("graph_flat", kept.dot_over(&pipeline, &whole));
    assert_eq!(whole.dot_over(&pipeline, &whole), whole.dot(&pipeline));
}

#[test]
fn sums_are_those_of_the_parts() {
    for (name, settings) in [("pool", &[][..]), ("pool", &[STILL]), ("underwater", &[])] {
        let scene = scene(name, settings);
        for pipeline in pipelines().names() {
            let said = explained(pipeline, &scene, Pruning::Approximate);
            let [kept, whole] = said.total;
            let running = || said.passes.iter().filter(|pass| pass.kept);
            assert_eq!(kept.passes, running().count() as u64, "{pipeline}");
            assert_eq!(kept.draws, running().map(|p| p.work.draws).sum::<u64>());
            let bytes = said.resources.iter().filter(|r| r.kept).map(|r| r.bytes);
            assert_eq!(kept.bytes, bytes.sum::<u64>(), "{pipeline}");
            assert!(kept.triangles <= whole.triangles && kept.bytes <= whole.bytes);
            for pass in said.passes {
                assert_eq!(pass.kept, pass.dropped.is_none(), "{}", pass.name);
            }
            for resource in said.resources {
                assert_eq!(
                    resource.kept,
                    resource.dropped.is_none(),
                    "{}",
                    resource.name
                );
            }
        }
    }
}
