//! A few modules and a pipeline of them.
#![allow(dead_code, reason = "each test uses its part")]

use meniscus_pipeline::{Facts, Pipeline, Pipelines, Plan};
use meniscus_shader::{Composer, Library};
use meniscus_source::{Report, SourceFile};

/// Modules: a drawing, a screen and a compute skeleton, and what they call.
pub const MODULES: &[(&str, &str)] = &[
    (
        "slots/shade",
        "// Light. By default none.\n\nfn shade(x: f32) -> vec3f {\n    return vec3f(x);\n}\n",
    ),
    (
        "slots/fetch",
        "// What is seen. By default nothing.\n\nfn fetch(at: vec2f) -> vec4f {\n    return vec4f(0.0);\n}\n\nfn fetched(at: vec2f) -> vec4f {\n    return vec4f(0.0, 0.0, 0.0, -1.0);\n}\n",
    ),
    (
        "shading/bright",
        "// Bright.\n//\n// provides: shade\n// number gain: 0 to 4, step 0.1\n// number taps: 1 to 8, step 1\n\noverride gain: f32 = 1.0;\noverride taps: i32 = 1;\n\nfn shade(x: f32) -> vec3f {\n    return vec3f(x * gain * f32(taps));\n}\n",
    ),
    (
        "screen/texel",
        "// The nearest texel.\n//\n// provides: fetch\n\nvar seen: texture_2d<f32>;\nvar shown_of_seen: texture_2d<f32>;\n\nfn fetch(at: vec2f) -> vec4f {\n    return textureLoad(seen, vec2i(at), 0);\n}\n\nfn fetched(at: vec2f) -> vec4f {\n    return textureLoad(shown_of_seen, vec2i(at), 0);\n}\n",
    ),
    (
        "screen/smooth",
        "// Filtered.\n//\n// provides: fetch\n\nvar seen: texture_2d<f32>;\nvar linear_sampler: sampler;\n\nfn fetch(at: vec2f) -> vec4f {\n    return textureSampleLevel(seen, linear_sampler, at, 0.0);\n}\n\nfn fetched(at: vec2f) -> vec4f {\n    return vec4f(0.0);\n}\n",
    ),
    (
        "screen/sum",
        "// Two fetches.\n//\n// provides: fetch\n// slots: first: fetch, then: fetch\n\nfn fetch(at: vec2f) -> vec4f {\n    return first(at) + then(at);\n}\n\nfn fetched(at: vec2f) -> vec4f {\n    return first_fetched(at) + then_fetched(at);\n}\n",
    ),
    (
        "passes/draw",
        "// Draws.\n//\n// skeleton: draw\n// outputs: colour, shown, count\n// slots: shade\n\nstruct Varying {\n    clip: vec4f,\n    height: f32,\n}\n\nfn vertex(position: vec3f) -> Varying {\n    return Varying(vec4f(position, 1.0), position.z);\n}\n\nfn fragment(v: Varying) -> f32 {\n    return v.height;\n}\n\nfn write_colour(x: f32) -> vec4f {\n    return vec4f(shade(x), 1.0);\n}\n\nfn write_shown(x: f32) -> vec4f {\n    return vec4f(x);\n}\n\nfn write_count(x: f32) -> u32 {\n    return 1u;\n}\n",
    ),
    (
        "passes/fetch",
        "// Fetches.\n//\n// skeleton: screen\n// outputs: colour, shown\n// slots: fetch\n\nfn screen(pixel: vec2f) -> vec2f {\n    return pixel;\n}\n\nfn write_colour(at: vec2f) -> vec4f {\n    return fetch(at);\n}\n\nfn write_shown(at: vec2f) -> vec4f {\n    return fetched(at);\n}\n",
    ),
    (
        "passes/store",
        "// Stores.\n//\n// skeleton: compute\n// workgroup: 8, 8\n\nvar stored: texture_storage_2d<rgba16float, write>;\n\nfn compute(thread: vec3u) {\n    textureStore(stored, vec2i(thread.xy), vec4f(1.0));\n}\n",
    ),
];

/// A pipeline that plans; tests replace parts of it.
pub const PIPELINE: &str = r#"Pipeline(
    about: "Draws, then fetches.",
    textures: {
        "seen":  (format: Rgba16Float, size: Guarded),
        "depth": (format: Depth32Float, size: Guarded),
        "frame": (format: Rgba16Float, size: Frame),
    },
    buffers: {
        "list": (bytes: 16),
        "arguments": (bytes: 12, indirect: true),
    },
    sequence: [
        Draw(name: "draw", skeleton: "passes/draw", geometry: All,
            slots: { "shade": ("shading/bright", { "gain": 2.0 }) },
            writes: { "colour": "seen", "depth": "depth" }),
        Screen(name: "fetch", skeleton: "passes/fetch",
            slots: { "fetch": "screen/texel" },
            writes: { "colour": "frame" }),
    ],
    output: (colour: "frame"),
)
"#;

/// A composer over the modules and more of them.
pub fn composer(more: &[(&str, &str)]) -> Composer {
    let sources = MODULES
        .iter()
        .chain(more)
        .map(|(path, text)| (*path, SourceFile::new(format!("{path}.wgsl"), *text)));
    let (library, report) = Library::new(sources);
    assert!(report.0.is_empty(), "{report}");
    Composer::new(library)
}

/// The pipeline with one part replaced.
pub fn changed(from: &str, to: &str) -> String {
    assert!(PIPELINE.contains(from), "{from}");
    PIPELINE.replacen(from, to, 1)
}

/// Pipeline files: the base as `base`, and others.
pub fn pipelines(more: &[(&str, &str)]) -> Pipelines {
    let all = [("base", PIPELINE)];
    Pipelines::new(
        all.iter()
            .chain(more)
            .map(|(name, text)| (*name, SourceFile::new(format!("{name}.ron"), *text))),
    )
}

/// Loads a text as the pipeline `p`.
pub fn load(text: &str) -> Result<Pipeline, Report> {
    pipelines(&[("p", text)]).load("p")
}

/// Plans a text without any fact.
pub fn plan(text: &str) -> Result<Plan, Report> {
    Plan::new(&load(text)?, &composer(&[]), &Facts::default(), false)
}
