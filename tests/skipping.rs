//! What a scene does not need is not run, drawn or allocated: counted, not timed.

use std::sync::Arc;

use glam::UVec2;
use meniscus::gpu::{Counters, Frame, Gpu, PipelineCache, SceneBuffers};
use meniscus::pipeline::{Plan, Pruning};
use meniscus::scene::{Scene, Setting};
use meniscus::{Project, Sources, facts_of};

const SIZE: [u32; 2] = [320, 180];

/// What is shared by the frames of a test.
struct Bench {
    project: Project,
    gpu: Gpu,
    cache: PipelineCache,
}

impl Bench {
    fn new() -> Self {
        Self {
            project: Project::open(&Sources::default()).unwrap(),
            gpu: Gpu::open(None).unwrap_or_else(|error| panic!("{error}")),
            cache: PipelineCache::default(),
        }
    }

    fn scene(&self, name: &str, settings: &[(&str, &str)]) -> Scene {
        let settings = settings
            .iter()
            .map(|(key, value)| Setting::new(*key, *value));
        let settings: Vec<Setting> = settings.collect();
        let scene = self.project.scene(name, &settings);
        scene.unwrap_or_else(|report| panic!("{report}"))
    }

    fn count(&self, pipeline: &str, scene: &Scene, pruning: Pruning) -> Counters {
        let pipeline = self.project.pipeline(pipeline).unwrap();
        let facts = facts_of(scene, SIZE);
        let composer = &self.project.composer;
        let plan = Plan::pruned(&pipeline, composer, &facts, pruning, false).unwrap();
        let buffers = SceneBuffers::new(&self.gpu, scene).unwrap();
        let size = UVec2::from_array(SIZE);
        let frame = Frame::new(&self.gpu, &plan, Arc::new(buffers), size, &self.cache);
        let mut frame = frame.unwrap_or_else(|error| panic!("{}: {error}", pipeline.name));
        frame.render().unwrap();
        frame.counters().unwrap()
    }

    /// What a pipeline does of which all is left out that may be.
    fn pruned(&self, pipeline: &str, scene: &Scene) -> Counters {
        self.count(pipeline, scene, Pruning::Approximate)
    }

    fn methods(&self) -> Vec<String> {
        let names = self.project.pipelines.names();
        let methods = names.filter(|name| name.starts_with("refraction/"));
        methods.map(str::to_owned).collect()
    }
}

fn names(counters: &Counters) -> Vec<&str> {
    counters.passes.iter().map(|p| p.name.as_str()).collect()
}

/// That one frame takes no more of anything than another.
#[track_caller]
fn no_more(what: &str, counters: &Counters, than: &Counters) {
    let numbers = |c: &Counters| {
        [
            c.passes.len() as u64,
            c.draws,
            c.dispatches,
            c.triangles,
            c.texture_bytes,
            c.buffer_bytes,
        ]
    };
    let pairs = numbers(counters).into_iter().zip(numbers(than));
    assert!(
        pairs.clone().all(|(a, b)| a <= b),
        "{what}: {counters:?} against {than:?}"
    );
    for count in [
        |c: &Counters| c.vertex_invocations,
        |c: &Counters| c.fragment_invocations,
        |c: &Counters| c.compute_invocations,
    ] {
        // Either is none where the adapter cannot count.
        assert!(
            count(counters) <= count(than),
            "{what}: {counters:?} against {than:?}"
        );
    }
}

#[test]
fn without_water_in_view_no_method_does_more_than_none() {
    let bench = Bench::new();
    for (height, target) in [("1.7", "8"), ("1.2", "3.6")] {
        let settings = [("camera.height", height), ("camera.target.z", target)];
        let scene = bench.scene("pool", &settings);
        assert!(!facts_of(&scene, SIZE).has("water_visible"), "{target}");
        let none = bench.pruned("refraction/none", &scene);
        for method in bench.methods() {
            no_more(&method, &bench.pruned(&method, &scene), &none);
        }
        let whole = bench.count("refraction/combined", &scene, Pruning::None);
        assert!(whole.passes.len() > none.passes.len());
    }
}

#[test]
fn flat_water_needs_no_narrow_phase_and_nothing_for_it() {
    let bench = Bench::new();
    let scene = bench.scene("pool", &[("water.rms_slope", "0")]);
    let broad = bench.pruned("refraction/broad", &scene);
    assert_eq!(broad.passes.len(), 3);
    for method in ["combined", "refined", "bounded", "paper"] {
        let method = format!("refraction/{method}");
        let pruned = bench.pruned(&method, &scene);
        assert_eq!(pruned.dispatches, 0, "{method}");
        no_more(&method, &pruned, &broad);
        // Where no bit may change, and where there are waves, all of it is there.
        let exact = bench.count(&method, &scene, Pruning::Exact);
        assert!(exact.texture_bytes > 2 * broad.texture_bytes, "{method}");
        let waves = bench.pruned(&method, &bench.scene("pool", &[]));
        assert_eq!(waves.dispatches, exact.dispatches, "{method}");
    }
}

#[test]
fn what_is_filled_with_something_that_changes_the_picture_is_not_skipped() {
    let bench = Bench::new();
    let scene = bench.scene("pool", &[("water.rms_slope", "0")]);
    // This one draws the far side where it is, and leaves all to the narrow phase.
    let narrow = bench.pruned("refraction/narrow", &scene);
    let waves = bench.pruned("refraction/narrow", &bench.scene("pool", &[]));
    assert_eq!(names(&narrow), names(&waves));
}

#[test]
fn with_all_objects_on_the_camera_s_side_nothing_is_transformed() {
    let bench = Bench::new();
    let mut scene = bench.scene("pool", &[]);
    scene.water.level = -5.0;
    // Of what draws the scene's triangles: passes over the screen have a few vertices of their own.
    let vertices = |counters: &Counters| -> Option<u64> {
        let drawing = counters.passes.iter().filter(|pass| pass.triangles > 0);
        drawing.map(|pass| pass.vertex_invocations).sum()
    };
    let none = bench.pruned("refraction/none", &scene);
    for method in bench.methods() {
        let pruned = bench.pruned(&method, &scene);
        assert!(pruned.triangles <= none.triangles, "{method}: {pruned:?}");
        assert!(vertices(&pruned) <= vertices(&none), "{method}: {pruned:?}");
        let drawing = pruned.passes.iter().filter(|pass| pass.triangles > 0);
        assert_eq!(drawing.count(), 1, "{method}: {pruned:?}");
    }
    let whole = bench.count("refraction/combined", &scene, Pruning::None);
    assert!(whole.passes.len() > bench.pruned("refraction/combined", &scene).passes.len());
}

#[test]
fn under_water_and_looking_down_there_is_no_surface() {
    let bench = Bench::new();
    let scene = bench.scene("underwater", &[("camera.target.z", "-9")]);
    let facts = facts_of(&scene, SIZE);
    assert!(facts.has("camera_submerged") && !facts.has("water_visible"));
    let none = bench.pruned("refraction/none", &scene);
    for method in bench.methods() {
        let pruned = bench.pruned(&method, &scene);
        no_more(&method, &pruned, &none);
        assert_eq!(pruned.passes.len(), 2, "{method}: {:?}", names(&pruned));
    }
}
