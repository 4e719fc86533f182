//! What cannot be done is an error that says so.

use std::sync::Arc;

use glam::UVec2;
use meniscus_gpu::{Frame, GpuError, PipelineCache, SceneBuffers};
use meniscus_pipeline::{Buffer, Format, Geometry, PassKind, Plan, Size};
use meniscus_scene::WaterGeometry;

use crate::build::{COVER, buffer, frame, gpu, pass, plan, rendered, scene, shader, wave};

const OUT: [(&str, Format, Size); 1] = [("out", Format::Rgba16Float, Size::Frame)];

fn fill(declarations: &str, value: &str) -> Plan {
    let text = format!(
        "{COVER} {declarations} @fragment fn show() -> @location(0) vec4f {{ return {value}; }}"
    );
    plan(
        &OUT,
        &[],
        vec![pass(
            "fill",
            PassKind::Screen,
            &shader(&text, &["colour"]),
            &["out"],
        )],
    )
}

fn error(plan: &Plan) -> String {
    frame(plan, &scene(&[])).map(drop).unwrap_err().to_string()
}

#[test]
fn a_size_beyond_the_limit_is_told_before_anything_is_made() {
    let plan = fill("", "vec4f(1.0)");
    for size in [UVec2::ZERO, UVec2::splat(100_000), UVec2::new(5, 0)] {
        let cache = PipelineCache::default();
        let buffers = Arc::new(SceneBuffers::new(gpu(), &scene(&[])).unwrap());
        let error = Frame::new(gpu(), &plan, buffers, size, &cache).unwrap_err();
        assert!(matches!(error, GpuError::Size(_)));
        let text = error.to_string();
        assert!(text.contains(&format!("{}×{}", size.x, size.y)), "{text}");
        assert!(text.contains("max_texture_dimension_2d"), "{text}");
        assert!(text.contains(&gpu().max_size().to_string()), "{text}");
        assert_eq!(cache.sizes(), (0, 0));
    }
}

#[test]
fn a_shader_that_the_library_refuses_is_named() {
    let text =
        format!("{COVER} @fragment fn show() -> @location(0) vec4f {{ return vec4f(1.0); }}");
    let mut plan = fill("", "vec4f(1.0)");
    let mut broken = Arc::into_inner(shader(&text, &["colour"])).unwrap();
    broken.module.entry_points[1].function.result = None;
    broken.hash = "broken".to_owned();
    plan.passes[0].shader = Arc::new(broken);
    let error = error(&plan);
    assert!(
        error.starts_with("creating the shader of `fill`: "),
        "{error}"
    );
}

#[test]
fn an_output_that_does_not_fit_its_texture_is_told() {
    let mut plan = fill("", "vec4f(1.0)");
    plan.textures.get_mut("out").unwrap().format = Format::R32Uint;
    let error = error(&plan);
    assert!(
        error.starts_with("creating the pipeline of `fill`: "),
        "{error}"
    );
}

#[test]
fn a_texture_that_is_read_and_written_by_one_pass_is_named() {
    let plan = fill("var out: texture_2d<f32>;", "textureLoad(out, vec2u(), 0)");
    assert_eq!(
        error(&plan),
        "pass `fill` reads the texture `out` while it writes it"
    );
}

#[test]
fn names_that_lead_nowhere_are_told() {
    let nowhere = fill(
        "var other: texture_2d<f32>;",
        "textureLoad(other, vec2u(), 0)",
    );
    assert!(error(&nowhere).contains("connects `other` to `other`, a texture that is not there"));
    let nowhere = fill(
        "struct S { a: f32 } var<uniform> other: S;",
        "vec4f(other.a)",
    );
    assert!(error(&nowhere).contains("cannot read `other`"));
    let member = fill(
        "struct S { a: f32 } var<uniform> water: S;",
        "vec4f(water.a)",
    );
    assert!(error(&member).contains("pass `fill` cannot read `water`: the host has no member `a`"));
    let frame = rendered(&fill("", "vec4f(1.0)"), &scene(&[]));
    assert_eq!(
        frame.read("depth").unwrap_err().to_string(),
        "there is no texture `depth`; there is out"
    );
    assert!(frame.read_buffer("list").is_err());
}

#[test]
fn a_format_that_cannot_be_filtered_is_told() {
    let mut plan = fill(
        "var wide: texture_2d<f32>; var linear_sampler: sampler;",
        "textureSampleLevel(wide, linear_sampler, vec2f(), 0.0)",
    );
    plan.textures.insert(
        "wide".to_owned(),
        meniscus_pipeline::Texture {
            format: Format::Rgba32Float,
            size: Size::Frame,
        },
    );
    let error = error(&plan);
    assert!(
        error.contains("`wide`, whose format Rgba32Float cannot be filtered"),
        "{error}"
    );
}

#[test]
fn targets_of_two_sizes_are_told() {
    let text = format!(
        "{COVER} struct O {{ @location(0) a: vec4f, @location(1) b: vec4f }}
        @fragment fn show() -> O {{ return O(vec4f(), vec4f()); }}"
    );
    let show = pass(
        "show",
        PassKind::Screen,
        &shader(&text, &["a", "b"]),
        &["small", "large"],
    );
    let textures = [
        ("small", Format::Rgba16Float, Size::Frame),
        ("large", Format::Rgba16Float, Size::Guarded),
    ];
    let plan = plan(&textures, &[], vec![show]);
    assert_eq!(
        error(&plan),
        "pass `show` writes `small` and `large`, which differ in size"
    );
}

#[test]
fn a_pass_cannot_write_the_arguments_it_runs_by() {
    let text = "var<storage, read_write> list: array<u32>; @compute @workgroup_size(1) fn work() { list[0] = 1u; }";
    let work = pass(
        "work",
        PassKind::DispatchIndirect("list".to_owned()),
        &shader(text, &[]),
        &[],
    );
    let make = |buffer: Buffer| plan(&[], &[("list", buffer)], vec![work.clone()]);
    assert!(
        error(&make(Buffer {
            indirect: true,
            ..buffer(12)
        }))
        .contains("which it also writes")
    );
    assert!(error(&make(buffer(12))).contains("not declared as indirect"));
    assert!(
        error(&make(Buffer {
            indirect: true,
            ..buffer(8)
        }))
        .contains("too short")
    );
    let many = PassKind::DispatchFixed([u32::MAX, 1, 1]);
    let many = plan(
        &[],
        &[("list", buffer(4))],
        vec![pass("work", many, &shader(text, &[]), &[])],
    );
    assert!(error(&many).contains("max_compute_workgroups_per_dimension"));
    for bytes in [0, u64::MAX] {
        assert!(
            error(&plan(&[], &[("list", buffer(bytes))], vec![])).contains("the buffer `list`")
        );
    }
}

#[test]
fn a_shader_of_the_wrong_stage_is_told() {
    let mut plan = fill("", "vec4f(1.0)");
    plan.passes[0].kind = PassKind::ScreenCompute;
    let wrong = error(&plan);
    assert!(
        wrong.contains("pass `fill` has a shader of another stage"),
        "{wrong}"
    );
    plan.passes[0].kind = PassKind::Draw(Geometry::All);
    plan.passes[0].targets.clear();
    assert!(error(&plan).contains("1 outputs and 0 textures"));
}

#[test]
fn a_scene_that_does_not_fit_what_was_uploaded_is_told() {
    let mut scene = scene(&[]);
    let mut frame = frame(&fill("", "vec4f(1.0)"), &scene).unwrap();
    scene.water.waves = vec![wave(0.5)];
    frame.update(&scene).unwrap();
    scene.water.geometry = WaterGeometry::Displaced;
    let error = frame.update(&scene).unwrap_err().to_string();
    assert!(error.contains("upload the scene anew"), "{error}");
    frame.render().unwrap();
}

#[test]
fn a_value_that_is_not_finite_never_reaches_a_shader() {
    let mut scene = scene(&[]);
    let plan = fill(
        "struct S { time: f32 } var<uniform> water: S;",
        "vec4f(water.time)",
    );
    for time in [f64::NAN, f64::INFINITY, 1e300] {
        scene.water.time = time;
        let error = frame(&plan, &scene).unwrap_err().to_string();
        assert!(error.contains("its member `time` is not finite"), "{error}");
    }
}

#[test]
fn after_an_error_the_adapter_still_works() {
    let mut plan = fill("", "vec4f(1.0)");
    plan.textures.get_mut("out").unwrap().format = Format::R32Uint;
    error(&plan);
    let frame = rendered(&fill("", "vec4f(0.5)"), &scene(&[]));
    assert_eq!(frame.read("out").unwrap().at(0, 0).unwrap(), [0.5; 4]);
}
