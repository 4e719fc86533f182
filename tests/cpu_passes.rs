//! Every built-in compute and screen pass on the CPU beside the GPU, from the same inputs.

mod common;

use std::collections::BTreeSet;

use common::{folder, meniscus, program_without_adapter, run, text, words, write};
use meniscus::gpu::Gpu;
use meniscus::pipeline::{PassKind, Pipeline};
use meniscus::scene::{Scene, Setting};
use meniscus::{Device, Passes, Project, Sources};

/// Pipelines of the folder that every method of refraction is in.
const ALL: &str = "refraction/*";

/// The share of a texture's texels that may differ by more than the format's bound: where rounding
/// decides which of two surfaces is hit, at edges, the whole colour differs.
const EDGES: f64 = 0.01;

/// A small picture, of uneven width so that quads and workgroups stand over its edge.
const SIZE: [u32; 2] = [49, 32];

fn project() -> Project {
    Project::open(&Sources::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn scene(project: &Project, settings: &[&str]) -> Scene {
    let settings: Vec<Setting> = settings
        .iter()
        .chain(&["pool.triangles=4k"])
        .map(|s| Setting::parse("a test", s).unwrap_or_else(|e| panic!("{e:?}")))
        .collect();
    project
        .scene("pool", &settings)
        .unwrap_or_else(|e| panic!("{e}"))
}

fn pipelines(project: &Project) -> Vec<Pipeline> {
    let names = project.pipeline_names(&[ALL.to_owned()]);
    let names = names.unwrap_or_else(|e| panic!("{e}"));
    let load = |name: &String| project.pipeline(name).unwrap_or_else(|e| panic!("{e}"));
    names.iter().map(load).collect()
}

#[test]
fn all_passes_that_draw_nothing_make_on_the_cpu_what_they_make_on_the_gpu() {
    let project = project();
    let gpu = Gpu::open(None).unwrap_or_else(|e| panic!("{e}"));
    let pipelines = pipelines(&project);
    assert!(pipelines.len() >= 6);
    let (mut kinds, mut compared, mut moments) = (BTreeSet::new(), BTreeSet::new(), 0);
    for settings in [
        &["water.geometry=displaced"][..],
        &["water.geometry=flat", "water.rms_slope=0.1"],
        &["water.rms_slope=0"],
        &["camera.height=-0.6"],
    ] {
        let scene = scene(&project, settings);
        moments += 1;
        for pipeline in &pipelines {
            let name = &pipeline.name;
            let mut passes = Passes::new(&project, Some(&gpu), pipeline, &scene, SIZE)
                .unwrap_or_else(|e| panic!("{name}: {e}"));
            for index in 0..passes.plan().passes.len() {
                let pass = passes.plan().passes[index].clone();
                let said = format!("{settings:?}: {name}: {}", pass.name);
                if passes.is_drawn(index) {
                    let drawn = passes.run(index, Device::Gpu);
                    drawn.unwrap_or_else(|e| panic!("{said}: {e}"));
                    continue;
                }
                let found = passes.compare(index);
                let found = found.unwrap_or_else(|e| panic!("{said}: {e}"));
                assert!(!found.is_empty(), "{said} writes nothing");
                for difference in found {
                    let share = difference.beyond as f64 / difference.texels.max(1) as f64;
                    assert!(
                        share <= EDGES || difference.beyond <= 1,
                        "{said}: {difference:?}"
                    );
                }
                kinds.insert(kind(&pass.kind));
                compared.insert(format!("{name}: {}", pass.name));
            }
        }
    }
    assert_eq!(moments, 4);
    assert!(
        kinds.len() >= 3,
        "screen passes, and two kinds of compute passes: {kinds:?}"
    );
    assert!(compared.len() >= pipelines.len(), "{compared:?}");
}

fn kind(kind: &PassKind) -> &'static str {
    match kind {
        PassKind::Draw(_) => "draw",
        PassKind::Screen => "screen",
        PassKind::ScreenCompute => "screen as compute",
        PassKind::Dispatch(_) => "pixels",
        PassKind::DispatchIndirect(_) => "indirect",
        PassKind::DispatchFixed(_) => "fixed",
    }
}

#[test]
fn two_runs_on_the_cpu_are_equal() {
    let project = project();
    let gpu = Gpu::open(None).unwrap_or_else(|e| panic!("{e}"));
    let scene = scene(&project, &["water.rms_slope=0.1"]);
    for pipeline in pipelines(&project) {
        let name = &pipeline.name;
        let textures = || {
            let mut passes = Passes::new(&project, Some(&gpu), &pipeline, &scene, SIZE)
                .unwrap_or_else(|e| panic!("{name}: {e}"));
            for index in 0..passes.plan().passes.len() {
                let device = match passes.is_drawn(index) {
                    true => Device::Gpu,
                    false => Device::Cpu,
                };
                let ran = passes.run(index, device);
                ran.unwrap_or_else(|e| panic!("{name}: {e}"));
            }
            let store = passes.store().unwrap_or_else(|e| panic!("{name}: {e}"));
            store.textures.clone()
        };
        let (once, again) = (textures(), textures());
        assert!(!once.is_empty());
        assert!(once == again, "{name}");
    }
}

#[test]
fn a_picture_made_on_the_cpu_is_the_gpu_s_picture() {
    let there = folder();
    let path = |name: &str| there.path().join(name);
    let (cpu, gpu) = (path("cpu.png"), path("gpu.png"));
    let line = "refraction/bounded --set pool.triangles=4k --size 96x64";
    let mut run = words("run --device cpu");
    run.extend(words(line));
    run.extend(["-o", text(&cpu)]);
    let said = meniscus(&run).done();
    assert!(said.contains("on the CPU"), "{said}");
    assert!(said.contains("on the GPU"), "{said}");
    let mut render = words("render");
    render.extend(words(line));
    render.extend(["-o", text(&gpu)]);
    meniscus(&render).done();
    let picture = |path: &std::path::Path| image::open(path).expect("a picture").to_rgb8();
    let (cpu, gpu) = (picture(&cpu), picture(&gpu));
    assert_eq!(cpu.dimensions(), (96, 64));
    let pairs = cpu.pixels().zip(gpu.pixels());
    let far = pairs.filter(|(a, b)| a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > 2));
    let share = far.count() as f64 / (96.0 * 64.0);
    assert!(share <= EDGES, "{share}");
    let colours: BTreeSet<[u8; 3]> = cpu.pixels().map(|p| p.0).collect();
    assert!(colours.len() > 100, "{} colours", colours.len());
}

#[test]
fn draws_say_that_they_take_a_gpu() {
    let line = "run refraction/combined --pass near --size 16x9 --device cpu";
    meniscus(words(line)).refused(&["`near` draws triangles", "--device gpu"]);
    let line = "run refraction/combined --pass far_away --size 16x9";
    meniscus(words(line)).refused(&["no pass `far_away`", "narrow"]);
}

const SCREEN: &str = "\
// The world direction of each pixel's ray as a colour.
//
// skeleton: screen
// outputs: colour
// needs: screen/target

fn screen(pixel: vec2f) -> vec3f {
    return 0.5 + 0.5 * view_ray(view_target, pixel).direction;
}

fn write_colour(direction: vec3f) -> vec4f {
    return vec4f(direction, 1.0);
}
";

const PIPELINE: &str = r#"Pipeline(
    about: "Directions.",
    textures: { "frame": (format: Rgba16Float, size: Frame) },
    sequence: [
        Screen(name: "directions", skeleton: "passes/directions", writes: { "colour": "frame" }),
    ],
    output: (colour: "frame"),
)
"#;

#[test]
fn without_an_adapter_passes_run_that_need_no_draw() {
    let there = folder();
    let path = |name: &str| there.path().join(name);
    write(&path("modules/passes/directions.wgsl"), SCREEN);
    write(&path("pipelines/mine/directions.ron"), PIPELINE);
    let (modules, pipelines) = (path("modules"), path("pipelines"));
    let known = ["--modules", text(&modules), "--pipelines", text(&pipelines)];
    let mut pictures = Vec::new();
    for (mut command, file) in [
        (program_without_adapter(), "without.png"),
        (common::program(), "with.png"),
    ] {
        let out = path(file);
        let line = "run mine/directions --size 31x17 --set pool.triangles=4k -o";
        command.args(known).args(words(line)).arg(&out);
        let said = run(&mut command).done();
        assert!(said.contains("directions: on the CPU"), "{said}");
        pictures.push(image::open(&out).expect("a picture").to_rgb8());
    }
    assert_eq!(pictures[0], pictures[1]);
    let corners = [(0, 0), (30, 0), (0, 16)].map(|(x, y)| pictures[0].get_pixel(x, y).0);
    assert!(
        corners[0] != corners[1] && corners[0] != corners[2],
        "{corners:?}"
    );
}

#[test]
fn without_an_adapter_what_hangs_on_a_draw_is_refused() {
    let line = "run refraction/combined --pass narrow --size 16x9 --set pool.triangles=4k";
    let said = run(program_without_adapter().args(words(line)));
    said.ended(1, &["`narrow`", "drawing takes a GPU"]);
    let line = "run refraction/combined --size 16x9 --device gpu";
    let said = run(program_without_adapter().args(words(line)));
    said.ended(1, &["adapter"]);
}
