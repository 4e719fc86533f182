//! `meniscus explain`, and `--exact`.

mod common;

use std::sync::Arc;

use common::{folder, meniscus, text, words};
use glam::UVec2;
use meniscus::gpu::{Frame, Gpu, PipelineCache, SceneBuffers};
use meniscus::pipeline::{Plan, Pruning};
use meniscus::scene::Setting;
use meniscus::{Project, Sources, facts_of};
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
fn an_explanation_tells_what_is_out_of_view() {
    let line = "explain refraction/combined --set camera.field_of_view=20";
    let said = meniscus(words(line)).done();
    assert!(said.contains("out of view (exact): leaves out"), "{said}");
    let json: Value =
        serde_json::from_str(&meniscus(words(&format!("{line} --json"))).done()).unwrap();
    let passes = json["passes"].as_array().unwrap();
    let near = &passes.iter().find(|pass| pass["name"] == "near").unwrap()["clusters"];
    assert!(
        near["dropped"].as_u64() > Some(0) && near["dropped"].as_u64() < near["clusters"].as_u64()
    );
    assert_eq!(near["appears"], "in place");
    // Modules that move points and do not say whither.
    let said = meniscus(words("explain steps/path-length")).done();
    assert!(said.contains("do not say where points appear"), "{said}");
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

#[test]
fn memory_is_what_a_frame_allocates() {
    let project = Project::open(&Sources::default()).unwrap_or_else(|e| panic!("{e}"));
    let gpu = Gpu::open(None).unwrap_or_else(|e| panic!("{e}"));
    let cache = PipelineCache::default();
    let size = UVec2::new(160, 90);
    let (mut wider, mut shared) = (0, 0);
    for (name, place, slope, more) in [
        ("refraction/bounded", "pool", "0.1", ""),
        ("refraction/bounded", "pool", "0", "--exact"),
        ("refraction/combined", "pool", "0", ""),
        // The mirror and Snell's window are drawn one after the other.
        ("refraction/bounded", "underwater", "0.1", ""),
    ] {
        let line = format!(
            "explain {name} --scene {place} --set water.rms_slope={slope} --size 160x90 {more}"
        );
        let told = meniscus(words(&format!("{line} --json"))).done();
        let told: Value = serde_json::from_str(&told).unwrap();
        let settings = [Setting::new("water.rms_slope", slope)];
        let scene = project.scene(place, &settings).unwrap();
        let pruning = match more {
            "" => Pruning::Approximate,
            _ => Pruning::Exact,
        };
        let (pipeline, facts) = (project.pipeline(name).unwrap(), facts_of(&scene, [160, 90]));
        let plan = Plan::pruned(&pipeline, &project.composer, &facts, pruning, false).unwrap();
        let buffers = Arc::new(SceneBuffers::new(&gpu, &scene).unwrap());
        let frame = Frame::new(&gpu, &plan, buffers, size, &cache).unwrap();
        let counted = frame.counters().unwrap();
        let buffers = plan.buffers.keys();
        let buffers = buffers.map(|name| frame.read_buffer(name).unwrap().len() as u64);
        let buffers: u64 = buffers.sum();
        let allocated = counted.texture_bytes + buffers;
        let sum = counted.texture_sum_bytes + buffers;
        assert_eq!(told["allocated_bytes"], allocated, "{line}");
        assert_eq!(told["total"][0]["bytes"], sum, "{line}");
        let kept = told["resources"].as_array().unwrap().iter();
        let kept = kept.filter(|resource| resource["kept"] == true);
        let bytes = kept.map(|resource| resource["bytes"].as_u64().unwrap());
        assert_eq!(bytes.sum::<u64>(), sum, "{line}");
        wider += u32::from(told["guarded"] != serde_json::json!([160, 90]));
        shared += u32::from(allocated < sum);
        let text = meniscus(words(&line)).done();
        assert_eq!(text.contains("share memory"), allocated < sum, "{text}");
    }
    // All of it was there to be told.
    assert!(wider > 0 && shared > 0, "{wider} {shared}");
}
