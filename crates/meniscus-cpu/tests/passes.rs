//! Passes of a small pipeline, on the CPU alone.

use meniscus_cpu::{CpuError, Store, Texels, is_drawn, run_pass, uses, writes};
use meniscus_pipeline::{Facts, Format, Pipelines, Plan, PlannedPass, Pruning, Size};
use meniscus_shader::{Binding, Composer, Library};
use meniscus_source::SourceFile;

const MODULES: &[(&str, &str)] = &[
    (
        "passes/ramp",
        "// A ramp, but for every third pixel of a row.\n//\n// skeleton: screen\n// outputs: colour\n// number gain: 0 to 9, step 1\n\n\
         override gain: f32 = 1.0;\n\n\
         fn screen(pixel: vec2f) -> vec2f {\n    return pixel;\n}\n\n\
         fn keep(pixel: vec2f) -> bool {\n    return u32(pixel.x) % 3u != 2u;\n}\n\n\
         fn write_colour(pixel: vec2f) -> vec4f {\n    return vec4f(gain * pixel, 0.1, 1.0);\n}\n",
    ),
    (
        "passes/list",
        "// Lists the pixels of odd columns.\n//\n// skeleton: compute\n// workgroup: 4, 4\n\n\
         struct Listed {\n    count: atomic<u32>,\n    pixels: array<u32>,\n}\n\n\
         var<storage, read_write> listed: Listed;\nvar source: texture_2d<f32>;\n\n\
         fn compute(thread: vec3u) {\n    let size = textureDimensions(source);\n    \
         if any(thread.xy >= size) || thread.x % 2u == 0u {\n        return;\n    }\n    \
         let place = atomicAdd(&listed.count, 1u);\n    \
         listed.pixels[place] = thread.x + 65536u * thread.y;\n}\n",
    ),
    (
        "passes/groups",
        "// One workgroup for each listed pixel.\n//\n// skeleton: compute\n// workgroup: 1\n\n\
         struct Counted {\n    count: u32,\n    pixels: array<u32>,\n}\n\n\
         var<storage, read> counted: Counted;\nvar<storage, read_write> arguments: array<u32, 3>;\n\n\
         fn compute(thread: vec3u) {\n    arguments[0] = counted.count;\n    arguments[1] = 1u;\n    \
         arguments[2] = 1u;\n}\n",
    ),
    (
        "passes/mark",
        "// Marks the listed pixels.\n//\n// skeleton: compute\n// workgroup: 1\n\n\
         struct Listed {\n    count: u32,\n    pixels: array<u32>,\n}\n\n\
         var<storage, read> listed: Listed;\nvar marked: texture_storage_2d<rgba16float, write>;\n\n\
         fn compute(thread: vec3u) {\n    let pixel = listed.pixels[thread.x];\n    \
         textureStore(marked, vec2u(pixel & 0xffffu, pixel >> 16u), vec4f(1.0));\n}\n",
    ),
    (
        "passes/eye",
        "// The eye's height.\n//\n// skeleton: screen\n// outputs: colour\n\n\
         struct View {\n    eye: vec3f,\n}\n\nvar<uniform> view_target: View;\n\n\
         fn screen(pixel: vec2f) -> f32 {\n    return view_target.eye.z;\n}\n\n\
         fn write_colour(z: f32) -> vec4f {\n    return vec4f(z);\n}\n",
    ),
    (
        "passes/draw",
        "// Draws.\n//\n// skeleton: draw\n// outputs: colour\n\nstruct Varying {\n    clip: vec4f,\n}\n\n\
         fn vertex(position: vec3f) -> Varying {\n    return Varying(vec4f(position, 1.0));\n}\n\n\
         fn fragment(v: Varying) -> f32 {\n    return 1.0;\n}\n\n\
         fn write_colour(x: f32) -> vec4f {\n    return vec4f(x);\n}\n",
    ),
];

const PIPELINE: &str = r#"Pipeline(
    about: "Everything that runs without drawing, and a draw.",
    textures: {
        "ramp":   (format: Rgba16Float, size: Frame),
        "marked": (format: Rgba16Float, size: Frame),
        "height": (format: Rgba32Float, size: Frame),
        "drawn":  (format: Rgba16Float, size: Frame),
        "frame":  (format: Rgba16Float, size: Frame),
    },
    buffers: {
        "pixels":    (bytes: 4, bytes_per_pixel: 4, zeroed: true),
        "arguments": (bytes: 12, indirect: true),
    },
    sequence: [
        Screen(name: "ramp", skeleton: "passes/ramp", slots: { "gain": 2.0 },
            writes: { "colour": "ramp" }),
        Compute(name: "list", skeleton: "passes/list", dispatch: Pixels(Frame),
            reads: { "source": "ramp", "listed": "pixels" }),
        Compute(name: "groups", skeleton: "passes/groups", dispatch: Fixed(1, 1, 1),
            reads: { "counted": "pixels" }),
        Compute(name: "mark", skeleton: "passes/mark", dispatch: Indirect("arguments"),
            reads: { "listed": "pixels" }),
        Screen(name: "eye", skeleton: "passes/eye", writes: { "colour": "height" }),
        Draw(name: "draw", skeleton: "passes/draw", geometry: All, writes: { "colour": "drawn" }),
        Screen(name: "out", skeleton: "passes/ramp", writes: { "colour": "frame" }),
    ],
    output: (colour: "frame"),
)
"#;

const SIZE: [u32; 2] = [13, 6];

fn plan() -> Plan {
    let files = MODULES.iter().map(|(path, text)| {
        let file = SourceFile::new(format!("{path}.wgsl"), *text);
        (*path, file)
    });
    let (library, report) = Library::new(files);
    assert!(report.is_ok(), "{report}");
    let pipelines = Pipelines::new([("p", SourceFile::new("p.ron", PIPELINE))]);
    let pipeline = pipelines.load("p").unwrap_or_else(|e| panic!("{e}"));
    let plan = Plan::pruned(
        &pipeline,
        &Composer::new(library),
        &Facts::new(["water_visible"]),
        // Most passes here lead to nothing that comes out.
        Pruning::None,
        false,
    );
    plan.unwrap_or_else(|e| panic!("{e}"))
}

fn pass<'a>(plan: &'a Plan, name: &str) -> &'a PlannedPass {
    let found = plan.passes.iter().find(|pass| pass.name == name);
    found.unwrap_or_else(|| panic!("no pass {name}"))
}

fn host(_: &PlannedPass, binding: &Binding) -> Result<Vec<u8>, String> {
    match binding.resource.as_str() {
        "view_target" => Ok([0.0_f32, 0.0, 1.75, 0.0]
            .iter()
            .flat_map(|n| n.to_le_bytes())
            .collect()),
        _ => Err("which is unknown".to_owned()),
    }
}

fn run(plan: &Plan, name: &str, store: &mut Store) -> Result<(), CpuError> {
    run_pass(pass(plan, name), store, &host, &|_: Size| SIZE)
}

fn store(plan: &Plan) -> Store {
    Store::new(plan, |_| SIZE)
}

fn numbers(texels: &Texels, x: u32, y: u32) -> [f32; 4] {
    texels.words[(y * texels.size[0] + x) as usize].map(f32::from_bits)
}

#[test]
fn screen_passes_write_where_they_keep_and_leave_the_rest() {
    let plan = plan();
    let mut store = store(&plan);
    run(&plan, "ramp", &mut store).unwrap();
    let ramp = &store.textures["ramp"];
    for y in 0..SIZE[1] {
        for x in 0..SIZE[0] {
            let found = numbers(ramp, x, y);
            let (px, py) = (x as f32 + 0.5, y as f32 + 0.5);
            let expected = match x % 3 {
                2 => [0.0; 4],
                // What a half float keeps of 0.1.
                _ => [2.0 * px, 2.0 * py, 0.099_975_586, 1.0],
            };
            assert_eq!(found, expected, "{x}, {y}");
        }
    }
}

#[test]
fn lists_are_made_counted_and_worked_off() {
    let plan = plan();
    let mut store = store(&plan);
    for name in ["list", "groups", "mark"] {
        run(&plan, name, &mut store).unwrap();
    }
    let odd = SIZE[0] / 2 * SIZE[1];
    assert_eq!(store.buffers["pixels"][0], odd);
    assert_eq!(store.buffers["arguments"], [odd, 1, 1]);
    let marked = &store.textures["marked"];
    for y in 0..SIZE[1] {
        for x in 0..SIZE[0] {
            let expected = f32::from(u8::from(x % 2 == 1));
            assert_eq!(numbers(marked, x, y)[0], expected, "{x}, {y}");
        }
    }
}

#[test]
fn the_host_is_asked_for_its_blocks_and_says_what_it_lacks() {
    let plan = plan();
    let mut store = store(&plan);
    run(&plan, "eye", &mut store).unwrap();
    let height = &store.textures["height"];
    assert!((0..13).all(|x| numbers(height, x, 5) == [1.75; 4]));
    let nothing = |_: &PlannedPass, _: &Binding| Err("which is unknown".to_owned());
    let refused = run_pass(pass(&plan, "eye"), &mut store, &nothing, &|_: Size| SIZE);
    let said = refused.unwrap_err().to_string();
    assert!(
        said.contains("`eye`") && said.contains("`view_target`, which is unknown"),
        "{said}"
    );
}

#[test]
fn draws_and_missing_textures_are_told() {
    let plan = plan();
    let mut store = store(&plan);
    assert!(is_drawn(pass(&plan, "draw")) && !is_drawn(pass(&plan, "ramp")));
    let said = run(&plan, "draw", &mut store).unwrap_err().to_string();
    assert!(
        said.contains("`draw` draws triangles, which takes a GPU"),
        "{said}"
    );
    store.textures.remove("ramp");
    for name in ["ramp", "list"] {
        let said = run(&plan, name, &mut store).unwrap_err().to_string();
        assert!(said.contains("`ramp`"), "{said}");
    }
}

#[test]
fn what_a_pass_uses_and_writes_is_told() {
    let plan = plan();
    let names = |set: std::collections::BTreeSet<&str>| {
        set.into_iter().map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(names(uses(pass(&plan, "list"))), ["pixels", "ramp"]);
    assert_eq!(names(writes(pass(&plan, "list"))), ["pixels"]);
    assert_eq!(
        names(uses(pass(&plan, "mark"))),
        ["arguments", "marked", "pixels"]
    );
    assert_eq!(names(writes(pass(&plan, "mark"))), ["marked"]);
    assert_eq!(names(writes(pass(&plan, "ramp"))), ["ramp"]);
}

#[test]
fn an_empty_store_is_what_a_frame_begins_with() {
    let plan = plan();
    let store = store(&plan);
    assert_eq!(store.textures["height"].format, Format::Rgba32Float);
    assert_eq!(
        numbers(&store.textures["height"], 0, 0),
        [0.0, 0.0, 0.0, -1.0]
    );
    assert_eq!(store.buffers["pixels"].len(), 1 + 13 * 6);
}
