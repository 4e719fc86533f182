//! What a frame leaves out, and that nothing of it is missed.

use std::sync::Arc;

use glam::{DVec3, UVec2};
use meniscus_gpu::{Frame, PipelineCache, SceneBuffers, Skipping};
use meniscus_pipeline::{Buffer, Covers, Format, Geometry, PassKind, Plan, Size};

use crate::build::{COVER, DRAW, buffer, frame, gpu, pass, plan, scene, shader, wave};

const FLOATS: Format = Format::Rgba32Float;

/// A screen pass that writes `expression`, in which `p` is the pixel.
fn shows(
    name: &str,
    declarations: &str,
    expression: &str,
    target: &str,
) -> meniscus_pipeline::PlannedPass {
    let text = format!(
        "{COVER} {declarations} @fragment fn show(@builtin(position) at: vec4f) -> @location(0) vec4f {{
            let p = vec2u(at.xy); return {expression};
        }}"
    );
    pass(
        name,
        PassKind::Screen,
        &shader(&text, &["colour"]),
        &[target],
    )
}

fn unshared(plan: &Plan) -> Frame {
    let buffers = Arc::new(SceneBuffers::new(gpu(), &scene(&[])).unwrap());
    let cache = PipelineCache::default();
    Frame::with(
        gpu(),
        plan,
        buffers,
        UVec2::splat(8),
        &cache,
        Skipping::NONE,
    )
    .unwrap()
}

/// `a` is made and read, then `b`, then what comes out.
fn chain() -> Plan {
    let passes = vec![
        shows("a", "", "vec4f(f32(p.x))", "a"),
        shows(
            "between",
            "var a: texture_2d<f32>;",
            "2.0 * textureLoad(a, p, 0)",
            "between",
        ),
        shows("b", "", "vec4f(f32(p.y))", "b"),
        shows(
            "out",
            "var b: texture_2d<f32>; var between: texture_2d<f32>;",
            "100.0 * textureLoad(b, p, 0) + textureLoad(between, p, 0)",
            "out",
        ),
    ];
    let textures = ["a", "b", "between", "out"].map(|name| (name, FLOATS, Size::Frame));
    let mut plan = plan(&textures, &[], passes);
    plan.output = "out".to_owned();
    plan
}

#[test]
fn textures_that_are_never_needed_at_once_share_memory_and_nothing_else_changes() {
    let plan = chain();
    let mut shared = frame(&plan, &scene(&[])).unwrap();
    let mut apart = unshared(&plan);
    for _ in 0..2 {
        shared.render().unwrap();
        apart.render().unwrap();
        let pixels = apart.read("out").unwrap();
        assert_eq!(shared.read("out").unwrap(), pixels);
        assert_eq!(pixels.at(3, 5).unwrap()[0], 506.0);
    }
    let (one, two) = (shared.counters().unwrap(), apart.counters().unwrap());
    let texture = 8 * 8 * 16;
    assert_eq!(
        (one.texture_bytes, one.texture_sum_bytes),
        (3 * texture, 4 * texture)
    );
    assert_eq!(
        (two.texture_bytes, two.texture_sum_bytes),
        (4 * texture, 4 * texture)
    );
    assert_eq!(one.texture_peak_bytes, 3 * texture);
}

#[test]
fn what_another_texture_took_over_is_not_handed_out() {
    let plan = chain();
    let mut shared = frame(&plan, &scene(&[])).unwrap();
    shared.render().unwrap();
    let error = shared.read("a").unwrap_err().to_string();
    assert!(error.contains("`a`") && error.contains("`b`"), "{error}");
    shared.read("b").unwrap();
    let mut apart = unshared(&plan);
    apart.render().unwrap();
    assert_eq!(apart.read("a").unwrap().at(3, 5).unwrap(), [3.0; 4]);
}

/// The water's time reaches the second pass alone, although both read the block.
fn timed() -> Plan {
    let water = "struct W { level: f32, time: f32 } var<uniform> water: W;";
    let passes = vec![
        shows("still", water, "vec4f(water.level)", "still"),
        shows(
            "moving",
            &format!("{water} var still: texture_2d<f32>;"),
            "textureLoad(still, p, 0) + water.time",
            "out",
        ),
    ];
    let textures = ["still", "out"].map(|name| (name, FLOATS, Size::Frame));
    let mut plan = plan(&textures, &[], passes);
    plan.output = "out".to_owned();
    plan
}

#[test]
fn only_passes_run_of_which_an_input_has_changed() {
    let mut scene = scene(&[]);
    scene.water.waves = vec![wave(0.01)];
    scene.water.level = 0.5;
    let mut frame = frame(&timed(), &scene).unwrap();
    assert_eq!(frame.refresh().unwrap().passes, 2);
    assert_eq!(frame.refresh().unwrap().passes, 0);
    frame.update(&scene).unwrap();
    let idle = frame.refresh().unwrap();
    assert_eq!((idle.passes, idle.wall_ms), (0, 0.0));
    scene.water.time = 2.0;
    frame.update(&scene).unwrap();
    assert_eq!(frame.refresh().unwrap().passes, 1);
    assert_eq!(frame.refreshed().collect::<Vec<_>>(), ["moving"]);
    assert_eq!(frame.read("out").unwrap().at(1, 1).unwrap(), [2.5; 4]);
    // All of them, when the whole frame is asked for.
    assert_eq!(frame.render().unwrap().passes.len(), 2);
    assert_eq!(frame.refresh().unwrap().passes, 0);
}

#[test]
fn what_is_drawn_follows_the_camera() {
    let draw = shader(
        &format!(
            "{DRAW} @fragment fn show(v: Varied) -> @location(0) vec4f {{ return vec4f(v.world, f32(v.object)); }}"
        ),
        &["colour"],
    );
    let mut drawn = pass("draw", PassKind::Draw(Geometry::All), &draw, &["out"]);
    drawn.depth = Some("depth".to_owned());
    let textures = [
        ("out", FLOATS, Size::Frame),
        ("depth", Format::Depth32Float, Size::Frame),
    ];
    let plan = plan(&textures, &[], vec![drawn]);
    let mut scene = scene(&[[[-3.0, 4.0, -1.0], [3.0, 4.0, -1.0], [0.0, 4.0, 3.0]]]);
    let mut kept = frame(&plan, &scene).unwrap();
    kept.refresh().unwrap();
    for step in 0..4 {
        scene.camera.eye += DVec3::new(0.25, 0.1, 0.05) * f64::from(step % 3);
        kept.update(&scene).unwrap();
        let moved = step % 3 > 0;
        assert_eq!(kept.refresh().unwrap().passes, usize::from(moved), "{step}");
        let mut anew = frame(&plan, &scene).unwrap();
        anew.render().unwrap();
        assert_eq!(kept.read("out").unwrap(), anew.read("out").unwrap());
    }
}

#[test]
fn lists_begin_empty_whenever_they_are_made_anew() {
    let zeroed = Buffer {
        zeroed: true,
        ..buffer(4)
    };
    let list = shader(
        "var<storage, read_write> list: atomic<u32>;
        @compute @workgroup_size(1) fn count() { atomicAdd(&list, 1u); }",
        &[],
    );
    let water = "struct W { time: f32 } var<uniform> water: W; var<storage, read> list: u32;";
    let passes = vec![
        pass("count", PassKind::DispatchFixed([5, 1, 1]), &list, &[]),
        shows("show", water, "vec4f(f32(list) + water.time)", "out"),
    ];
    let plan = plan(&[("out", FLOATS, Size::Frame)], &[("list", zeroed)], passes);
    let mut scene = scene(&[]);
    let mut frame = frame(&plan, &scene).unwrap();
    for time in [0.0, 1.0, 1.0, 3.0] {
        scene.water.time = time;
        frame.update(&scene).unwrap();
        frame.refresh().unwrap();
        assert_eq!(
            frame.read("out").unwrap().at(0, 0).unwrap()[0],
            5.0 + time as f32
        );
    }
}

#[test]
fn what_the_last_frame_left_is_counted_on_in_every_frame() {
    let count = shader(
        "var<storage, read_write> frames: u32;
        @compute @workgroup_size(1) fn count() { frames = frames + 1u; }",
        &[],
    );
    let passes = vec![
        pass("count", PassKind::DispatchFixed([1, 1, 1]), &count, &[]),
        shows(
            "show",
            "var<storage, read> frames: u32;",
            "vec4f(f32(frames))",
            "out",
        ),
    ];
    let plan = plan(
        &[("out", FLOATS, Size::Frame)],
        &[("frames", buffer(4))],
        passes,
    );
    let mut frame = frame(&plan, &scene(&[])).unwrap();
    for number in 1..4 {
        assert_eq!(frame.refresh().unwrap().passes, 2);
        assert_eq!(
            frame.read("out").unwrap().at(0, 0).unwrap()[0],
            number as f32
        );
    }
}

/// What stands before the water, then the water on its rest plane; where neither is, the sky.
fn over_water() -> Plan {
    let draw = shader(
        &format!(
            "{DRAW} @fragment fn show(v: Varied) -> @location(0) vec4f {{
                if v.world.z < 0.0 {{ discard; }}
                return vec4f(v.world, 1.0);
            }}"
        ),
        &["colour"],
    );
    let mut near = pass("near", PassKind::Draw(Geometry::NearSide), &draw, &["out"]);
    near.depth = Some("front".to_owned());
    let text = format!(
        "{COVER}
        struct View {{ eye: vec3f, right: vec3f, up: vec3f, forward: vec3f, focal: f32, size: vec2f, near: f32 }}
        var<uniform> view_target: View;
        struct W {{ level: f32 }} var<uniform> water: W;
        var front_depth: texture_depth_2d;
        @fragment fn show(@builtin(position) at: vec4f) -> @location(0) vec4f {{
            let centred = at.xy - 0.5 * view_target.size;
            let way = normalize(view_target.forward * view_target.focal
                + view_target.right * centred.x - view_target.up * centred.y);
            let distance = -(view_target.eye.z - water.level) / way.z;
            let depth = textureLoad(front_depth, vec2u(at.xy), 0);
            let wet = distance > 0.0 && distance < 1e9
                && depth * distance * dot(way, view_target.forward) < view_target.near;
            if !wet && depth > 0.0 {{ discard; }}
            return select(vec4f(way, 5.0), vec4f(distance, at.xy, 2.0), wet);
        }}"
    );
    let pixels = |name: &str, covers: Covers| {
        let mut pass = pass(
            name,
            PassKind::Screen,
            &shader(&text, &["colour"]),
            &["out"],
        );
        for binding in &mut Arc::get_mut(&mut pass.shader).expect("its own").bindings {
            if binding.variable == "front_depth" {
                binding.resource = "front".to_owned();
            }
        }
        pass.covers = covers;
        pass
    };
    let textures = [
        ("out", FLOATS, Size::Frame),
        ("front", Format::Depth32Float, Size::Frame),
    ];
    let dry = pixels("dry", Covers::Dry);
    plan(
        &textures,
        &[],
        vec![near, dry, pixels("wet", Covers::Water)],
    )
}

#[test]
fn what_cannot_show_water_is_left_out_to_the_bit() {
    let plan = over_water();
    // A deck just above the water with a hole in it, and a wall.
    let (low, inner, outer) = (0.1, 0.7, 30.0);
    let side = |turn: u32| {
        let corner = |r: f32, k: u32| {
            let signs = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]][k as usize % 4];
            [r * signs[0], 4.0 + r * signs[1], low]
        };
        let (a, b) = (corner(inner, turn), corner(inner, turn + 1));
        let (c, d) = (corner(outer, turn + 1), corner(outer, turn));
        [[a, d, b], [d, c, b]]
    };
    let mut triangles: Vec<_> = (0..4).flat_map(side).collect();
    triangles.push([[0.4, 4.0, -1.0], [0.8, 4.0, -1.0], [0.6, 4.0, 0.6]]);
    let mut scene = scene(&triangles);
    let cache = PipelineCache::default();
    let buffers = Arc::new(SceneBuffers::new(gpu(), &scene).unwrap());
    let size = UVec2::new(192, 128);
    let made =
        |skipping| Frame::with(gpu(), &plan, buffers.clone(), size, &cache, skipping).unwrap();
    let (mut some, mut all) = (made(Skipping::ALL), made(Skipping::NONE));
    for (height, target) in [
        (1.0, [0.0, 4.0, 0.0]),
        (3.0, [0.0, 4.0, 0.0]),
        (1.0, [0.0, 4.0, 2.5]),
        (1.0, [0.0, 4.0, 5.9]),
        (0.3, [3.0, 4.0, 0.0]),
        (0.11, [0.0, 4.0, 0.1]),
        (-1.0, [0.0, 4.0, 0.0]),
        (2.0, [0.0, 0.001, 0.0]),
        (0.0, [0.0, 4.0, 0.0]),
        (1e-4, [0.0, 4.0, 0.0]),
    ] {
        scene.camera.eye.z = height;
        scene.camera.target = DVec3::from_array(target);
        for frame in [&mut some, &mut all] {
            frame.update(&scene).unwrap();
            frame.refresh().unwrap();
        }
        let (one, two) = (some.read("out").unwrap(), all.read("out").unwrap());
        assert_eq!(one, two, "{height} {target:?}");
        let Some(confined) = some.counters().unwrap().fragment_invocations else {
            continue;
        };
        let everywhere = all.counters().unwrap().fragment_invocations.unwrap();
        assert!(
            confined < everywhere,
            "{height} {target:?}: {confined} {everywhere}"
        );
    }
}
