//! A few modules and a pipeline of them.
#![allow(dead_code, reason = "each test uses its part")]

use glam::{DVec3, Vec3};
use meniscus_pipeline::{Facts, Pipeline, Pipelines, Plan};
use meniscus_scene::{
    Camera, Material, Mesh, Object, Pattern, Scene, Sky, Sun, Triangle, Water, WaterGeometry,
};
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

/// A tetrahedron about a point, of this size.
fn tetrahedron(scene: &mut Scene, centre: DVec3, size: f64) {
    let corners = [[-1, -1, -1], [1, 1, -1], [1, -1, 1], [-1, 1, 1]];
    let first = scene.mesh.positions.len() as u32;
    let object = scene.objects.len() as u32;
    scene.objects.push(Object {
        name: format!("object {object}"),
        material: 0,
    });
    for corner in corners {
        let offset = DVec3::from_array(corner.map(f64::from)) * size;
        scene.mesh.positions.push((centre + offset).as_vec3());
        scene.mesh.normals.push(offset.normalize().as_vec3());
    }
    for corners in [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]] {
        let corners = corners.map(|corner| first + corner);
        scene.mesh.triangles.push(Triangle { corners, object });
    }
}

/// Water at z = 0, the eye at (0, −4, 2) looking along +y and down, and an object above, across and
/// under the water, in that order.
pub fn scene() -> Scene {
    let mut scene = Scene {
        name: "three".to_owned(),
        about: String::new(),
        objects: Vec::new(),
        materials: vec![Material {
            colour: Vec3::ONE,
            pattern: Pattern::Plain,
        }],
        mesh: Mesh::default(),
        moving: meniscus_scene::Moving::default(),
        water: Water {
            level: 0.0,
            refractive_index: 1.333,
            waves: Vec::new(),
            time: 0.0,
            geometry: WaterGeometry::Displaced,
        },
        camera: Camera {
            eye: DVec3::new(0.0, -4.0, 2.0),
            target: DVec3::new(0.0, 2.0, -1.0),
            field_of_view: 1.0,
            near: 0.05,
        },
        sun: Sun {
            direction: DVec3::Z,
            colour: Vec3::ONE,
            ambient: Vec3::ZERO,
        },
        sky: Sky {
            horizon: Vec3::ONE,
            zenith: Vec3::ONE,
            deep: Vec3::ZERO,
        },
    };
    for height in [1.0, 0.0, -1.0] {
        tetrahedron(&mut scene, DVec3::new(height, 2.0, height), 0.3);
    }
    scene
}
