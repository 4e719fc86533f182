//! Times of real frames: they are never 0, whatever the driver tells.

use glam::UVec2;
use meniscus_gpu::{FrameTiming, Timer};
use meniscus_pipeline::{Format, PassKind, Plan, Size};

use crate::build::{COVER, buffer, frame_of, gpu, pass, plan, scene, shader};

fn times(plan: &Plan) -> Vec<FrameTiming> {
    let mut frame = frame_of(plan, &scene(&[]), UVec2::new(256, 128)).unwrap();
    (0..5).map(|_| frame.render().unwrap()).collect()
}

fn check(frames: &[FrameTiming], passes: &[&str]) {
    let timer = Timer::of(frames);
    if !gpu().has_timestamps() {
        assert_eq!(timer, Timer::Wall);
    }
    for frame in frames {
        assert!(frame.ms(timer) > 0.0 && frame.wall_ms > 0.0, "{frame:?}");
        let names: Vec<&str> = frame.passes.iter().map(|p| p.name.as_str()).collect();
        assert_eq!(names, passes);
        assert!(
            frame.passes.iter().all(|p| p.ms.is_none_or(|ms| ms > 0.0)),
            "{frame:?}"
        );
    }
}

fn loops(count: u32) -> String {
    format!("var x = 0.5; for (var i = 0u; i < {count}u; i++) {{ x = fract(x * 1.7 + 0.3); }}")
}

#[test]
fn raster_frames_are_timed() {
    let body = loops(200);
    let text =
        format!("{COVER} @fragment fn show() -> @location(0) vec4f {{ {body} return vec4f(x); }}");
    let show = shader(&text, &["colour"]);
    let textures = [
        ("one", Format::Rgba16Float, Size::Frame),
        ("two", Format::Rgba16Float, Size::Frame),
    ];
    let passes = vec![
        pass("first", PassKind::Screen, &show, &["one"]),
        pass("second", PassKind::Screen, &show, &["two"]),
    ];
    check(&times(&plan(&textures, &[], passes)), &["first", "second"]);
}

#[test]
fn frames_of_compute_passes_are_timed() {
    let body = loops(200);
    let text = format!(
        "var<storage, read_write> sums: array<f32>;
        @compute @workgroup_size(8, 8) fn work(@builtin(global_invocation_id) id: vec3u) {{ {body} sums[id.x] = x; }}"
    );
    let passes = vec![pass(
        "work",
        PassKind::Dispatch(Size::Frame),
        &shader(&text, &[]),
        &[],
    )];
    let frames = times(&plan(&[], &[("sums", buffer(4096))], passes));
    check(&frames, &["work"]);
}

#[test]
fn a_plan_without_passes_runs_by_the_wall() {
    let frames = times(&plan(
        &[("out", Format::Rgba32Float, Size::Frame)],
        &[],
        vec![],
    ));
    check(&frames, &[]);
    assert_eq!(Timer::of(&frames), Timer::Wall);
}
