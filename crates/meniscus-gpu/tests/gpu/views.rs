//! Host values in shaders: views, blocks in any order, arrays, numbers.

use glam::{DVec3, UVec2};
use meniscus_pipeline::{Format, PassKind, Plan, Size};

use crate::build::{COVER, frame, frame_of, pass, plan, rendered, scene, shader, wave};

/// A plan that writes one expression over the screen.
fn shows(declarations: &str, expression: &str) -> Plan {
    let text = format!(
        "{COVER} {declarations} @fragment fn show() -> @location(0) vec4f {{ return {expression}; }}"
    );
    let show = pass(
        "show",
        PassKind::Screen,
        &shader(&text, &["colour"]),
        &["out"],
    );
    plan(
        &[("out", Format::Rgba32Float, Size::Frame)],
        &[],
        vec![show],
    )
}

fn first(plan: &Plan, scene: &meniscus_scene::Scene) -> Vec<f32> {
    rendered(plan, scene)
        .read("out")
        .unwrap()
        .at(0, 0)
        .unwrap()
        .to_vec()
}

#[test]
fn members_arrive_in_whatever_order_a_struct_declares_them() {
    let mut scene = scene(&[]);
    scene.camera.eye = DVec3::new(3.0, 4.0, 5.0);
    scene.water.level = 0.5;
    scene.water.time = 7.0;
    let expression =
        "vec4f(view_target.eye, view_target.near) + vec4f(water.time, water.level, 0.0, 0.0)";
    for members in [
        "eye: vec3f, near: f32, focal: f32",
        "focal: f32, eye: vec3f, near: f32",
        "near: f32, size: vec2f, focal: f32, eye: vec3f",
    ] {
        let declarations = format!(
            "struct V {{ {members} }} var<uniform> view_target: V;
            struct W {{ time: f32, root_low: f32, level: f32 }} var<uniform> water: W;"
        );
        assert_eq!(
            first(&shows(&declarations, expression), &scene),
            [10.0, 4.5, 5.0, 0.125],
            "{members}"
        );
    }
}

#[test]
fn arrays_arrive_with_their_lengths() {
    let mut scene = scene(&[[[0.0, 2.0, 0.0], [1.0, 2.0, 0.0], [0.0, 2.0, 1.0]]; 2]);
    scene.water.waves = vec![wave(0.25), wave(0.125), wave(0.0625)];
    let declarations = "
        struct Wave { phase: f32, amplitude: f32, wave_vector: vec2f }
        var<storage, read> waves: array<Wave>;
        struct Material { line_width: f32, colour: vec3f }
        var<storage, read> materials: array<Material>;
        struct Thing { material: u32 }
        var<storage, read> objects: array<Thing>;";
    let expression = "vec4f(f32(arrayLength(&waves)), waves[2].amplitude + waves[1].wave_vector.y,
        materials[objects[1].material].colour.g, waves[0].phase)";
    let pixel = first(&shows(declarations, expression), &scene);
    assert_eq!(pixel, [3.0, 8.0625, 0.5, 0.5]);
    scene.water.waves.clear();
    let lengths = "vec4f(f32(arrayLength(&waves)), waves[0].amplitude, 0.0, 0.0)";
    let waves = "struct Wave { amplitude: f32, phase: f32 } var<storage, read> waves: array<Wave>;";
    assert_eq!(
        first(&shows(waves, lengths), &scene),
        [1.0, 0.0, 0.0, 0.0],
        "one wave of no height"
    );
}

#[test]
fn numbers_arrive() {
    let mut plan = shows(
        "override bound: f32 = 1.0; override taps: u32 = 2u; override on: bool = false;",
        "vec4f(bound, f32(taps), select(0.0, 1.0, on), 0.0)",
    );
    assert_eq!(first(&plan, &scene(&[])), [1.0, 2.0, 0.0, 0.0]);
    let numbers = [("bound", 0.25), ("taps", 5.0), ("on", 1.0)];
    plan.passes[0].numbers = numbers.map(|(n, v)| (n.to_owned(), v)).into();
    assert_eq!(first(&plan, &scene(&[])), [0.25, 5.0, 1.0, 0.0]);
}

#[test]
fn a_pass_has_two_views() {
    let mut scene = scene(&[[[0.0, 2.0, 0.0], [1.0, 2.0, 0.0], [0.0, 2.0, -2.0]]]);
    scene.water.waves = vec![wave(0.05)];
    let mut plan = shows(
        "struct V { size: vec2f, focal: f32, seen_size: vec2f } var<uniform> view_target: V;",
        "vec4f(view_target.size, view_target.seen_size)",
    );
    plan.passes[0].view_seen = Size::Guarded;
    let mut frame = frame_of(&plan, &scene, UVec2::new(64, 48)).unwrap();
    frame.render().unwrap();
    let guarded = frame.view(Size::Guarded).size;
    let pixels = frame.read("out").unwrap();
    assert_eq!(
        pixels.at(5, 5).unwrap(),
        [64.0, 48.0, guarded.x as f32, guarded.y as f32]
    );
    assert!(
        guarded.x > 64 && guarded.x <= 96 && guarded.y > 48 && guarded.y <= 72,
        "{guarded}"
    );
    assert_eq!(
        (guarded - UVec2::new(64, 48)) % 2,
        UVec2::ZERO,
        "concentric"
    );
}

#[test]
fn a_new_moment_writes_only_what_depends_on_it() {
    let mut scene = scene(&[]);
    scene.water.waves = vec![wave(0.25)];
    let declarations = "
        struct Wave { phase: f32 } var<storage, read> waves: array<Wave>;
        struct W { time: f32 } var<uniform> water: W;
        struct V { eye: vec3f } var<uniform> view_target: V;";
    let plan = shows(
        declarations,
        "vec4f(water.time, waves[0].phase, view_target.eye.x, f32(arrayLength(&waves)))",
    );
    let mut frame = frame(&plan, &scene).unwrap();
    frame.update(&scene).unwrap();
    assert_eq!(frame.uploaded(), 0, "nothing changed");
    scene.water.time = 0.125;
    frame.update(&scene).unwrap();
    assert_eq!(frame.uploaded(), 4 + 4, "time and one phase");
    frame.render().unwrap();
    let pixel = frame.read("out").unwrap().at(0, 0).unwrap().to_vec();
    assert_eq!(pixel, [0.125, 0.125, 0.0, 1.0], "0.5 − 3 · 0.125");
    scene.camera.eye.x = 2.0;
    frame.update(&scene).unwrap();
    assert_eq!(frame.uploaded(), 8 + 16, "and the eye");
    scene.water.waves.push(wave(0.0));
    frame.update(&scene).unwrap();
    frame.render().unwrap();
    let pixel = frame.read("out").unwrap().at(0, 0).unwrap().to_vec();
    assert_eq!(pixel[2..], [2.0, 2.0], "a longer array");
}

#[test]
fn steeper_waves_widen_the_guarded_textures() {
    let mut scene = scene(&[[[0.0, 2.0, 0.0], [1.0, 2.0, 0.0], [0.0, 2.0, -2.0]]]);
    let mut plan = shows(
        "struct V { size: vec2f } var<uniform> view_target: V;",
        "vec4f(view_target.size, 0.0, 0.0)",
    );
    plan.passes[0].view_target = Size::Guarded;
    plan.textures.get_mut("out").unwrap().size = Size::Guarded;
    let mut frame = frame_of(&plan, &scene, UVec2::new(64, 48)).unwrap();
    let mut last = UVec2::ZERO;
    for (amplitude, size) in [
        (0.0, Some(UVec2::new(64, 48))),
        (0.02, None),
        (0.04, None),
        (1e9, None),
    ] {
        scene.water.waves = vec![wave(amplitude)];
        frame.update(&scene).unwrap();
        frame.render().unwrap();
        let out = frame.read("out").unwrap();
        assert!(out.size.cmpgt(last).all(), "{amplitude}: {}", out.size);
        assert!(size.is_none_or(|size| size == out.size));
        assert_eq!(out.at(0, 0).unwrap()[..2], out.size.as_vec2().to_array());
        last = out.size;
    }
    assert_eq!(last, UVec2::new(96, 72), "the cap");
}
