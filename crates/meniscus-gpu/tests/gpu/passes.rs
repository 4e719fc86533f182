//! Passes: screen and compute, clearing, buffers, what is made when.

use std::sync::Arc;

use glam::UVec2;
use meniscus_gpu::{Frame, PipelineCache, SceneBuffers, run_compute};
use meniscus_pipeline::{Buffer, Format, PassKind, Plan, Size};

use crate::build::{COVER, buffer, frame_of, gpu, pass, plan, rendered, scene, shader};

const COLOUR: Format = Format::Rgba16Float;

fn screen(body: &str) -> Arc<meniscus_shader::Shader> {
    shader(&format!("{COVER} {body}"), &["colour"])
}

#[test]
fn a_screen_pass_runs_as_fragments_and_as_threads_alike() {
    let value = "vec4f(f32(p.x) * 0.5, f32(p.y), 3.0, 1.0)";
    let drawn = screen(&format!(
        "@fragment fn show(@builtin(position) at: vec4f) -> @location(0) vec4f {{ let p = vec2u(at.xy); return {value}; }}"
    ));
    let stored = shader(
        &format!(
            "var colour: texture_storage_2d<rgba16float, write>;
            @compute @workgroup_size(8, 4) fn show(@builtin(global_invocation_id) id: vec3u) {{
                let p = id.xy;
                if all(p < textureDimensions(colour)) {{ textureStore(colour, p, {value}); }}
            }}"
        ),
        &["colour"],
    );
    let textures = [
        ("drawn", COLOUR, Size::Frame),
        ("stored", COLOUR, Size::Frame),
    ];
    let passes = vec![
        pass("drawn", PassKind::Screen, &drawn, &["drawn"]),
        pass("stored", PassKind::ScreenCompute, &stored, &["stored"]),
    ];
    let mut frame = frame_of(
        &plan(&textures, &[], passes),
        &scene(&[]),
        UVec2::new(13, 7),
    )
    .unwrap();
    frame.render().unwrap();
    let drawn = frame.read("drawn").unwrap();
    assert_eq!(drawn, frame.read("stored").unwrap());
    assert_eq!(drawn.at(12, 6).unwrap(), [6.0, 6.0, 3.0, 1.0]);
}

#[test]
fn the_first_write_clears_and_later_ones_keep() {
    let left = screen(
        "@fragment fn show(@builtin(position) p: vec4f) -> @location(0) vec4f { if p.x > 4.0 { discard; } return vec4f(1.0); }",
    );
    let top = screen(
        "@fragment fn show(@builtin(position) p: vec4f) -> @location(0) vec4f { if p.y > 4.0 { discard; } return vec4f(2.0); }",
    );
    let both = vec![
        pass("left", PassKind::Screen, &left, &["out"]),
        pass("top", PassKind::Screen, &top, &["out"]),
    ];
    let mut frame = crate::build::frame(
        &plan(&[("out", COLOUR, Size::Frame)], &[], both),
        &scene(&[]),
    )
    .unwrap();
    for _ in 0..2 {
        frame.render().unwrap();
        let out = frame.read("out").unwrap();
        let corners = [(0, 0), (7, 0), (0, 7), (7, 7)].map(|(x, y)| out.at(x, y).unwrap()[0]);
        assert_eq!(corners, [2.0, 2.0, 1.0, 0.0]);
    }
}

#[test]
fn what_is_read_before_it_is_written_is_empty_in_every_frame() {
    let copy = screen(
        "var later: texture_2d<f32>; var never: texture_2d<f32>;
        @fragment fn show(@builtin(position) p: vec4f) -> @location(0) vec4f {
            return textureLoad(later, vec2u(p.xy), 0) + textureLoad(never, vec2u(p.xy), 0);
        }",
    );
    let fill = screen("@fragment fn show() -> @location(0) vec4f { return vec4f(9.0); }");
    let textures = [
        ("out", Format::Rgba32Float, Size::Frame),
        ("later", Format::Rgba32Float, Size::Frame),
        ("never", Format::Rgba32Float, Size::Frame),
    ];
    let passes = vec![
        pass("copy", PassKind::Screen, &copy, &["out"]),
        pass("fill", PassKind::Screen, &fill, &["later"]),
    ];
    let mut frame = crate::build::frame(&plan(&textures, &[], passes), &scene(&[])).unwrap();
    for _ in 0..2 {
        frame.render().unwrap();
        assert_eq!(
            frame.read("out").unwrap().at(3, 3).unwrap(),
            [0.0, 0.0, 0.0, -2.0]
        );
        assert_eq!(frame.read("later").unwrap().at(3, 3).unwrap(), [9.0; 4]);
    }
}

#[test]
fn a_stored_texture_is_cleared_where_nothing_is_stored() {
    let some = shader(
        "var colour: texture_storage_2d<rgba32float, write>;
        @compute @workgroup_size(4, 4) fn show(@builtin(global_invocation_id) id: vec3u) {
            if id.x == 2u { textureStore(colour, id.xy, vec4f(1.0)); }
        }",
        &["colour"],
    );
    let passes = vec![pass("some", PassKind::ScreenCompute, &some, &["out"])];
    let frame = rendered(
        &plan(&[("out", Format::Rgba32Float, Size::Frame)], &[], passes),
        &scene(&[]),
    );
    let out = frame.read("out").unwrap();
    assert_eq!(out.at(2, 7).unwrap(), [1.0; 4]);
    assert_eq!(out.at(3, 7).unwrap(), [0.0, 0.0, 0.0, -1.0]);
}

#[test]
fn a_sampler_blends_between_texels_and_clamps_at_the_edge() {
    let ramp = screen(
        "@fragment fn show(@builtin(position) p: vec4f) -> @location(0) vec4f { return vec4f(floor(p.x), 0.0, 0.0, 1.0); }",
    );
    let sample = screen(
        "var ramp: texture_2d<f32>; var linear_sampler: sampler;
        @fragment fn show(@builtin(position) p: vec4f) -> @location(0) vec4f {
            return textureSampleLevel(ramp, linear_sampler, (p.xy + vec2f(0.5, 0.0)) / 8.0, 0.0);
        }",
    );
    let textures = [
        ("ramp", COLOUR, Size::Frame),
        ("out", Format::Rgba32Float, Size::Frame),
    ];
    let passes = vec![
        pass("ramp", PassKind::Screen, &ramp, &["ramp"]),
        pass("sample", PassKind::Screen, &sample, &["out"]),
    ];
    let out = rendered(&plan(&textures, &[], passes), &scene(&[]))
        .read("out")
        .unwrap();
    for x in 0..8 {
        let expected = (x as f32 + 0.5).min(7.0);
        assert!((out.at(x, 4).unwrap()[0] - expected).abs() < 0.02, "{x}");
    }
}

#[test]
fn every_format_comes_back_as_numbers() {
    for (format, kind, value, expected) in [
        (Format::R32Float, "f32", "0.1", vec![0.1_f32]),
        (
            Format::Rg32Float,
            "vec2f",
            "vec2f(1e-9, -3.0)",
            vec![1e-9, -3.0],
        ),
        (Format::R32Uint, "u32", "16777215u", vec![16_777_215.0]),
        (
            Format::Rgba8Unorm,
            "vec4f",
            "vec4f(0.2, 1.0, 0.0, 0.6)",
            vec![0.2, 1.0, 0.0, 0.6],
        ),
        (
            Format::Rgba16Float,
            "vec4f",
            "vec4f(0.5, -2.0, 1024.0, 0.0)",
            vec![0.5, -2.0, 1024.0, 0.0],
        ),
        (
            Format::Rgba32Float,
            "vec4f",
            "vec4f(0.3, 1e30, -1e-30, 7.0)",
            vec![0.3, 1e30, -1e-30, 7.0],
        ),
    ] {
        let write = screen(&format!(
            "@fragment fn show() -> @location(0) {kind} {{ return {value}; }}"
        ));
        let plan = plan(
            &[("out", format, Size::Frame)],
            &[],
            vec![pass("write", PassKind::Screen, &write, &["out"])],
        );
        let out = rendered(&plan, &scene(&[])).read("out").unwrap();
        assert_eq!(out.at(7, 7).unwrap(), expected, "{format:?}");
        assert_eq!(out.data.len(), 64 * expected.len());
    }
}

/// Appends the pixels of one column to a list, turns their number into workgroups, and lets these
/// many threads count themselves.
fn indirect() -> Plan {
    let append = shader(
        "var<storage, read_write> count: atomic<u32>;
        @compute @workgroup_size(4, 4) fn append(@builtin(global_invocation_id) id: vec3u) {
            if id.x == 1u && id.y < 5u { atomicAdd(&count, 1u); }
        }",
        &[],
    );
    let prepare = shader(
        "var<storage, read_write> count: u32; var<storage, read_write> arguments: array<u32>;
        @compute @workgroup_size(1) fn prepare() { arguments[0] = count; arguments[1] = 2u; arguments[2] = 1u; }",
        &[],
    );
    let work = shader(
        "var<storage, read_write> done: atomic<u32>;
        @compute @workgroup_size(8) fn work() { atomicAdd(&done, 1u); }",
        &[],
    );
    let zeroed = Buffer {
        zeroed: true,
        ..buffer(4)
    };
    let buffers = [
        ("count", zeroed),
        ("done", zeroed),
        (
            "arguments",
            Buffer {
                indirect: true,
                ..buffer(12)
            },
        ),
    ];
    let passes = vec![
        pass("append", PassKind::Dispatch(Size::Frame), &append, &[]),
        pass("prepare", PassKind::DispatchFixed([1, 1, 1]), &prepare, &[]),
        pass(
            "work",
            PassKind::DispatchIndirect("arguments".to_owned()),
            &work,
            &[],
        ),
    ];
    plan(&[], &buffers, passes)
}

#[test]
fn as_many_workgroups_run_as_an_earlier_pass_counted() {
    let mut frame = crate::build::frame(&indirect(), &scene(&[])).unwrap();
    for _ in 0..2 {
        frame.render().unwrap();
        let number = |name: &str| {
            u32::from_le_bytes(frame.read_buffer(name).unwrap()[..4].try_into().unwrap())
        };
        assert_eq!((number("count"), number("done")), (5, 5 * 2 * 8));
    }
    let counters = frame.counters().unwrap();
    assert_eq!((counters.draws, counters.dispatches), (0, 3));
    if let Some(threads) = counters.compute_invocations {
        assert_eq!(threads, 64 + 1 + 80);
        assert_eq!(counters.passes[2].compute_invocations, Some(80));
    }
    assert_eq!(counters.buffer_bytes, 4 + 4 + 12);
}

#[test]
fn nothing_is_made_by_rendering_and_equal_pipelines_are_shared() {
    // Only this test's own objects may be counted: it opens an adapter for itself.
    let gpu = meniscus_gpu::Gpu::open(None).unwrap_or_else(|e| panic!("{e}"));
    let fill = screen(
        "override level: f32 = 1.0; @fragment fn show() -> @location(0) vec4f { return vec4f(level); }",
    );
    let make = |level: f64| {
        let mut fill = pass("fill", PassKind::Screen, &fill, &["out"]);
        fill.numbers.insert("level".to_owned(), level);
        plan(&[("out", COLOUR, Size::Frame)], &[], vec![fill])
    };
    let cache = PipelineCache::default();
    let buffers = Arc::new(SceneBuffers::new(&gpu, &scene(&[])).unwrap());
    let frame = |level: f64| {
        Frame::new(&gpu, &make(level), buffers.clone(), UVec2::splat(8), &cache).unwrap()
    };
    let mut first = frame(3.0);
    let created = gpu.created();
    for _ in 0..3 {
        first.render().unwrap();
    }
    assert_eq!(gpu.created(), created);
    assert_eq!(cache.sizes(), (1, 1));
    frame(3.0);
    assert_eq!(cache.sizes(), (1, 1), "the same once more");
    frame(4.0);
    assert_eq!(
        cache.sizes(),
        (1, 2),
        "another number: the shader is shared, the pipeline is not"
    );
    assert_eq!(first.read("out").unwrap().at(0, 0).unwrap(), [3.0; 4]);
}

#[test]
fn invocations_are_counted() {
    let fill = screen("@fragment fn show() -> @location(0) vec4f { return vec4f(1.0); }");
    let frame = rendered(
        &plan(
            &[("out", COLOUR, Size::Frame)],
            &[],
            vec![pass("fill", PassKind::Screen, &fill, &["out"])],
        ),
        &scene(&[]),
    );
    let counters = frame.counters().unwrap();
    assert_eq!(
        (counters.draws, counters.dispatches, counters.triangles),
        (1, 0, 0)
    );
    assert_eq!(counters.texture_bytes, 64 * 8);
    assert_eq!(
        counters.fragment_invocations.is_some(),
        gpu().has_statistics()
    );
    if let Some(fragments) = counters.fragment_invocations {
        assert!((64..=128).contains(&fragments), "{fragments}");
        assert_eq!(counters.vertex_invocations, Some(3));
    }
}

#[test]
fn a_function_runs_over_plain_bytes() {
    let text = "
        @group(0) @binding(0) var<storage, read> input: array<f32>;
        @group(0) @binding(1) var<storage, read_write> output: array<f32>;
        @compute @workgroup_size(64) fn double(@builtin(global_invocation_id) id: vec3u) {
            if id.x < arrayLength(&input) { output[id.x] = 2.0 * input[id.x]; }
        }";
    let module = naga::front::wgsl::parse_str(text).unwrap();
    let input: Vec<u8> = (0..100).flat_map(|i| (i as f32).to_le_bytes()).collect();
    let output = run_compute(gpu(), &module, "double", &input, 400, 100).unwrap();
    let expected: Vec<u8> = (0..100)
        .flat_map(|i| (2.0 * i as f32).to_le_bytes())
        .collect();
    assert_eq!(output, expected);
    for (entry, len, threads, message) in [
        ("triple", 400, 100, "no compute entry point `triple`"),
        ("double", 0, 100, "output of 0 bytes"),
        ("double", 400, 0, "0 workgroups"),
        ("double", 400, u32::MAX, "at most"),
    ] {
        let error = run_compute(gpu(), &module, entry, &input, len, threads)
            .unwrap_err()
            .to_string();
        assert!(error.contains(message), "{error}");
    }
}
