//! Numbers that change while a plan runs.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use glam::UVec2;
use meniscus_gpu::{Frame, PipelineCache, SceneBuffers};
use meniscus_pipeline::{Format, PassKind, Size};
use meniscus_shader::{Composer, Library, Output, Recipe, Shader, Stage};
use meniscus_source::SourceFile;
use meniscus_source::ron::Spanned;

use crate::build::{gpu, pass, plan, scene};

const LEVEL: &str = "// A level everywhere.\n//\n// skeleton: screen\n// outputs: colour\n// number level: 0 to 9 m, live\n// number times: 0 to 4, live\n\noverride level: f32 = 2.0;\noverride times: u32 = 1u;\n\nfn screen(pixel: vec2f) -> f32 {\n    return level * f32(times);\n}\n\nfn write_colour(x: f32) -> vec4f {\n    return vec4f(x, 0.0, 0.0, 1.0);\n}\n";

fn shader() -> Arc<Shader> {
    let file = SourceFile::new("passes/level.wgsl", LEVEL);
    let (library, report) = Library::new([("passes/level", file)]);
    assert!(report.is_ok(), "{report}");
    let recipe = Recipe {
        skeleton: Spanned::unplaced("passes/level".to_owned()),
        slots: BTreeMap::new(),
        reads: BTreeMap::new(),
        outputs: vec![Output {
            name: Spanned::unplaced("colour".to_owned()),
            format: "rgba16float".to_owned(),
        }],
        facts: BTreeSet::new(),
        stage: Stage::Render,
    };
    let composed = Composer::new(library).compose(&recipe);
    composed.unwrap_or_else(|report| panic!("{report}"))
}

#[test]
fn a_live_number_changes_without_a_new_pipeline() {
    let gpu = gpu();
    let shader = shader();
    let textures = [
        ("a", Format::Rgba16Float, Size::Frame),
        ("b", Format::Rgba16Float, Size::Frame),
    ];
    let mut passes = vec![
        pass("a", PassKind::Screen, &shader, &["a"]),
        pass("b", PassKind::Screen, &shader, &["b"]),
    ];
    // As a plan has it that sets the number.
    passes[1].numbers = [("live_numbers.level".to_owned(), 3.0)].into();
    let plan = plan(&textures, &[], passes);
    let scene = scene(&[]);
    let cache = PipelineCache::default();
    let buffers = Arc::new(SceneBuffers::new(gpu, &scene).unwrap());
    let mut frame = Frame::new(gpu, &plan, buffers, UVec2::new(4, 4), &cache).unwrap();
    let made = cache.sizes();
    assert_eq!(made, (1, 1), "both passes have one pipeline");
    let values =
        |frame: &Frame| ["a", "b"].map(|name| frame.read(name).unwrap().at(1, 2).unwrap()[0]);
    frame.refresh().unwrap();
    assert_eq!(values(&frame), [2.0, 3.0]);
    frame.set_number("a", "level", 5.0).unwrap();
    // Only the pass that reads it runs again.
    assert_eq!(frame.refresh().unwrap().passes, 1);
    assert_eq!(values(&frame), [5.0, 3.0]);
    frame.set_number("a", "level", 5.0).unwrap();
    assert_eq!(frame.refresh().unwrap().passes, 0);
    frame.set_number("b", "times", 4.0).unwrap();
    frame.render().unwrap();
    assert_eq!(values(&frame), [5.0, 12.0]);
    // What was set outlives another moment.
    frame.update(&scene).unwrap();
    frame.render().unwrap();
    assert_eq!(values(&frame), [5.0, 12.0]);
    assert_eq!(cache.sizes(), made);
    for (pass, path, value, words) in [
        ("a", "level", 9.5, "goes from 0 to 9"),
        ("a", "level", f64::NAN, "goes from 0 to 9"),
        ("a", "leve", 1.0, "it has level, times"),
        ("c", "level", 1.0, "is not there"),
    ] {
        let wrong = frame.set_number(pass, path, value).unwrap_err().to_string();
        assert!(wrong.contains(words), "{wrong}");
    }
    assert_eq!(values(&frame), [5.0, 12.0]);
}
