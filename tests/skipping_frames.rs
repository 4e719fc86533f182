//! What frames leave out, by counters, which do not depend on the machine's load.

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::{DVec2, DVec3, UVec2, Vec3};
use meniscus::gpu::{Counters, Frame, Gpu, PipelineCache, SceneBuffers, Skipping};
use meniscus::pipeline::{Facts, Plan, Pruning};
use meniscus::scene::{Mesh, Scene, Setting, Triangle};
use meniscus::{Project, Sources, facts_of};

const SIZE: UVec2 = UVec2::new(1280, 720);

struct Bench {
    project: Project,
    gpu: Gpu,
    cache: PipelineCache,
}

impl Bench {
    fn new() -> Self {
        let project = Project::open(&Sources::default()).unwrap_or_else(|e| panic!("{e}"));
        let gpu = Gpu::open(None).unwrap_or_else(|e| panic!("{e}"));
        Self {
            project,
            gpu,
            cache: PipelineCache::default(),
        }
    }

    fn scene(&self, settings: &[&str]) -> Scene {
        let parsed = settings.iter().map(|text| Setting::parse("test", text));
        let settings: Vec<Setting> = parsed.collect::<Result<_, _>>().unwrap();
        let scene = self.project.scene("pool", &settings);
        scene.unwrap_or_else(|e| panic!("{e}"))
    }

    fn facts(&self, scene: &Scene) -> Facts {
        facts_of(scene, SIZE.to_array())
    }

    fn frame(&self, pipeline: &str, scene: &Scene) -> Frame {
        self.frame_with(pipeline, scene, Pruning::default(), Skipping::ALL)
    }

    fn frame_with(
        &self,
        pipeline: &str,
        scene: &Scene,
        pruning: Pruning,
        skipping: Skipping,
    ) -> Frame {
        let pipeline = self.project.pipeline(pipeline).unwrap();
        let facts = self.facts(scene);
        let plan = Plan::pruned(&pipeline, &self.project.composer, &facts, pruning, false);
        let plan = plan.unwrap_or_else(|e| panic!("{e}"));
        let buffers = Arc::new(SceneBuffers::new(&self.gpu, scene).unwrap());
        Frame::with(&self.gpu, &plan, buffers, SIZE, &self.cache, skipping).unwrap()
    }

    fn counters(&self, pipeline: &str, scene: &Scene) -> Counters {
        self.frame(pipeline, scene).counters().unwrap()
    }
}

/// Runs of a pass's shader over pixels.
fn fragments(counters: &Counters, pass: &str) -> u64 {
    let pass = counters.passes.iter().find(|p| p.name == pass);
    pass.and_then(|p| p.fragment_invocations)
        .expect("a pass of that name, and an adapter that counts")
}

/// How many pixels show water: those where its rest plane is before what stands on the camera's side.
fn wet_pixels(bench: &Bench, scene: &Scene) -> u64 {
    let mut frame = bench.frame_with(
        "refraction/ray-traced",
        scene,
        Pruning::None,
        Skipping::NONE,
    );
    frame.render().unwrap();
    let near = frame.read("front_depth").unwrap();
    let view = scene.camera.view(SIZE);
    let level = scene.water.level;
    let pixels = (0..SIZE.y).flat_map(|y| (0..SIZE.x).map(move |x| (x, y)));
    let wet = pixels.filter(|&(x, y)| {
        let way = view.direction(DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5));
        let distance = (level - view.eye.z) / way.z;
        let depth = f64::from(near.at(x, y).unwrap()[0]);
        distance > 0.0 && depth * distance * way.dot(view.forward) < view.near
    });
    wet.count() as u64
}

#[test]
fn where_water_covers_a_twentieth_the_narrow_phase_covers_little_more() {
    let bench = Bench::new();
    // High over the garden, inside of the hedges: the pool is a small part of the picture.
    let small = [
        "camera.position.x=-4",
        "camera.position.y=-4.5",
        "camera.height=18",
        "camera.target.x=0.5",
        "camera.target.y=0.5",
        "camera.target.z=0",
        "camera.field_of_view=55",
    ];
    // Out on open water, with the horizon low in the picture.
    let low = [
        "camera.position.x=60",
        "camera.position.y=60",
        "camera.height=2",
        "camera.target.x=100",
        "camera.target.y=100",
        "camera.target.z=25.8",
        "camera.field_of_view=50",
    ];
    for (settings, name) in [(&small[..], "small"), (&low[..], "low")] {
        let scene = bench.scene(settings);
        let covered = wet_pixels(&bench, &scene);
        let share = covered as f64 / (SIZE.x * SIZE.y) as f64;
        assert!((0.02..0.12).contains(&share), "{name}: {share}");
        for pipeline in ["refraction/combined", "refraction/bounded"] {
            let counters = bench.counters(pipeline, &scene);
            let ran = fragments(&counters, "narrow");
            let ratio = ran as f64 / covered as f64;
            assert!(
                ratio <= 1.3,
                "{name}, {pipeline}: {ran} for {covered}: {ratio}"
            );
        }
    }
}

/// A grid of triangles over a square at a height; with vertices of its own each, or sharing them.
fn grid(mesh: &mut Mesh, cells: u32, corner: [f32; 2], height: f32, shared: bool) {
    let object = u32::from(height > 0.0);
    let first = mesh.positions.len() as u32;
    let at = |i: u32, j: u32| {
        let along = |k: u32| 2.0 * k as f32 / cells as f32;
        Vec3::new(corner[0] + along(i), corner[1] + along(j), height)
    };
    let row = cells + 1;
    if shared {
        mesh.positions
            .extend((0..row * row).map(|k| at(k % row, k / row)));
    }
    for cell in 0..cells * cells {
        let (x, y) = (cell % cells, cell / cells);
        for [b, c] in [[[1, 0], [1, 1]], [[1, 1], [0, 1]]] {
            let corners = [[0, 0], b, c].map(|[i, j]| [x + i, y + j]);
            let corners = match shared {
                true => corners.map(|[i, j]| first + j * row + i),
                false => {
                    let next = mesh.positions.len() as u32;
                    mesh.positions.extend(corners.map(|[i, j]| at(i, j)));
                    [next, next + 1, next + 2]
                }
            };
            mesh.triangles.push(Triangle { corners, object });
        }
    }
    mesh.normals.resize(mesh.positions.len(), Vec3::Z);
}

#[test]
fn where_half_the_triangles_are_under_water_only_those_are_transformed() {
    let bench = Bench::new();
    // Where triangles share vertices, adapters transform some of them again, batch by batch. This one's
    // batches are of 341 triangles, which hold no fewer than 1.16 vertices for each of a square grid
    // that is cut into such; row by row it would be 1.34.
    for (shared, most) in [(false, 1.0), (true, 1.25)] {
        let mut scene = bench.scene(&["water.geometry=flat"]);
        // From high enough above both halves to see all of them.
        scene.camera.eye = DVec3::new(0.0, -3.0, 5.0);
        scene.camera.target = DVec3::new(0.0, 1.0, 0.0);
        scene.mesh = Mesh::default();
        grid(&mut scene.mesh, 60, [-1.0, 1.0], -1.0, shared);
        let submerged = scene.mesh.positions.len() as u64;
        grid(&mut scene.mesh, 60, [-1.0, -1.0], 0.5, shared);
        let half = scene.mesh.triangles.len() as u64 / 2;
        for pipeline in ["refraction/combined", "refraction/bounded"] {
            let counters = bench.counters(pipeline, &scene);
            let broad = counters.passes.iter().find(|p| p.name == "broad").unwrap();
            assert_eq!(broad.triangles, half, "{pipeline}");
            let ran = broad.vertex_invocations.expect("an adapter that counts");
            let ratio = ran as f64 / submerged as f64;
            assert!(ratio <= most, "{pipeline}: {ran} of {submerged}: {ratio}");
            // None of them is drawn on the near side again.
            assert_eq!(counters.triangles, 2 * half, "{pipeline}");
        }
    }
}

#[test]
fn what_is_out_of_view_is_not_drawn_and_no_bit_of_the_picture_changes() {
    let bench = Bench::new();
    let corner = [
        "camera.target.x=2.5",
        "camera.target.y=0.5",
        "camera.target.z=-1",
    ];
    let narrow = "camera.field_of_view=25";
    let under = ["camera.height=-0.6", "camera.target.z=1"];
    let all_but_clusters = Skipping {
        clusters: false,
        ..Skipping::ALL
    };
    for settings in [&corner[..], &under[..]] {
        let scene = bench.scene(&[settings, &[narrow]].concat());
        for pipeline in ["none", "combined", "bounded", "screen-space"] {
            let pipeline = format!("refraction/{pipeline}");
            let frame = |skipping| {
                let pruning = Pruning::default();
                let mut frame = bench.frame_with(&pipeline, &scene, pruning, skipping);
                frame.render().unwrap();
                (frame.counters().unwrap(), frame.read("frame").unwrap())
            };
            let (ours, picture) = frame(Skipping::ALL);
            let (whole, expected) = frame(all_but_clusters);
            assert_eq!(picture, expected, "{pipeline}");
            for (ours, whole) in ours.passes.iter().zip(&whole.passes) {
                let name = &ours.name;
                assert!(ours.triangles <= whole.triangles, "{pipeline}, {name}");
                assert!(
                    ours.vertex_invocations <= whole.vertex_invocations,
                    "{pipeline}, {name}"
                );
            }
            assert!(
                4 * ours.triangles < 3 * whole.triangles,
                "{pipeline}: {ours:?}"
            );
        }
    }
}

#[test]
fn where_a_module_does_not_say_where_points_appear_all_are_drawn() {
    let bench = Bench::new();
    let scene = bench.scene(&["camera.field_of_view=25"]);
    let counters = bench.counters("steps/path-length", &scene);
    let broad = counters.passes.iter().find(|p| p.name == "broad").unwrap();
    let whole = bench.frame_with(
        "steps/path-length",
        &scene,
        Pruning::default(),
        Skipping::NONE,
    );
    let whole = whole.counters().unwrap();
    let all = whole.passes.iter().find(|p| p.name == "broad").unwrap();
    assert_eq!(broad.triangles, all.triangles);
    assert!(counters.triangles < whole.triangles, "others say it");
}

#[test]
fn variants_share_what_they_have_in_common() {
    let bench = Bench::new();
    let scene = bench.scene(&["pool.triangles=500"]);
    let shaders = |pipeline: &str| {
        let frame = bench.frame(pipeline, &scene);
        let passes = frame.plan().passes.iter();
        passes
            .map(|p| p.shader.hash.clone())
            .collect::<BTreeSet<_>>()
    };
    let first = shaders("refraction/combined");
    let compiled = bench.gpu.compiled();
    let second = shaders("refraction/paper");
    let new = second.difference(&first).count() as u64;
    assert_eq!(bench.gpu.compiled() - compiled, new);
    assert!(new < second.len() as u64, "nothing in common");
    let compiled = bench.gpu.compiled();
    shaders("refraction/combined");
    assert_eq!(bench.gpu.compiled(), compiled);
}

#[test]
fn where_only_the_water_moves_the_seen_buffer_stays() {
    let bench = Bench::new();
    for pipeline in [
        "refraction/combined",
        "refraction/bounded",
        "refraction/refined",
        "refraction/screen-space",
    ] {
        let mut scene = bench.scene(&["water.geometry=flat", "pool.triangles=500"]);
        let mut frame = bench.frame(pipeline, &scene);
        let all = frame.refresh().unwrap().passes;
        for _ in 0..2 {
            scene.water.time += 0.3;
            frame.update(&scene).unwrap();
            let ran = frame.refresh().unwrap().passes;
            let names: Vec<&str> = frame.refreshed().collect();
            assert!(ran < all, "{pipeline}: {names:?}");
            assert!(
                !names.contains(&"broad") && !names.contains(&"far"),
                "{names:?}"
            );
            assert!(names.contains(&"narrow"), "{names:?}");
            let output = frame.read("frame").unwrap();
            let mut anew = bench.frame(pipeline, &scene);
            anew.render().unwrap();
            assert_eq!(output, anew.read("frame").unwrap(), "{pipeline}");
        }
    }
}

#[test]
fn where_nothing_moves_no_pass_runs_and_the_last_frame_stands() {
    let bench = Bench::new();
    let scene = bench.scene(&["pool.triangles=500"]);
    for pipeline in ["refraction/none", "refraction/bounded", "refraction/offset"] {
        let mut frame = bench.frame(pipeline, &scene);
        frame.render().unwrap();
        let first = frame.read("frame").unwrap();
        let created = bench.gpu.created();
        for _ in 0..3 {
            frame.update(&scene).unwrap();
            assert_eq!(frame.refresh().unwrap().passes, 0, "{pipeline}");
        }
        assert_eq!(frame.uploaded(), 0, "{pipeline}");
        assert_eq!(bench.gpu.created(), created, "{pipeline}");
        assert_eq!(frame.read("frame").unwrap(), first, "{pipeline}");
    }
}

#[test]
fn where_no_water_is_in_view_there_is_no_more_to_do_than_without_refraction() {
    let bench = Bench::new();
    let scene = bench.scene(&["camera.target.z=9", "pool.triangles=500"]);
    let none = bench.counters("refraction/none", &scene);
    for pipeline in [
        "refraction/combined",
        "refraction/bounded",
        "refraction/ray-traced",
    ] {
        let counters = bench.counters(pipeline, &scene);
        let all = |c: &Counters| {
            let runs = [
                c.vertex_invocations,
                c.fragment_invocations,
                c.compute_invocations,
            ];
            let counted = [c.passes.len() as u64, c.draws, c.dispatches, c.triangles];
            counted
                .into_iter()
                .chain(runs.map(|n| n.unwrap_or(0)))
                .collect::<Vec<_>>()
        };
        let (ours, theirs) = (all(&counters), all(&none));
        let more = ours.iter().zip(&theirs).any(|(ours, theirs)| ours > theirs);
        assert!(!more, "{pipeline}: {ours:?} {theirs:?}");
        assert!(counters.texture_bytes <= none.texture_bytes, "{pipeline}");
    }
}

#[test]
fn going_back_and_forth_between_plans_makes_no_pipeline_twice() {
    let bench = Bench::new();
    let look = |settings: &[&str]| {
        let mut all = vec!["pool.triangles=500"];
        all.extend(settings);
        bench.scene(&all)
    };
    let scenes = [
        look(&[]),
        look(&["water.rms_slope=0"]),
        look(&["camera.height=-0.5"]),
        look(&["camera.target.z=9"]),
    ];
    let show = |scene: &Scene| {
        bench.frame("refraction/bounded", scene).render().unwrap();
        bench.cache.sizes()
    };
    let first: Vec<_> = scenes.iter().map(show).collect();
    assert!(first.windows(2).any(|pair| pair[0] < pair[1]), "{first:?}");
    for scene in scenes.iter().rev() {
        assert_eq!(show(scene), first[3]);
    }
}

#[test]
fn a_moving_camera_makes_nothing_anew_and_shows_what_a_new_frame_shows() {
    let bench = Bench::new();
    let mut scene = bench.scene(&["pool.triangles=500", "water.geometry=flat"]);
    // A plan is good for its facts; one for all is needed where they change on the way.
    let (combined, none) = ("refraction/combined", Pruning::None);
    let mut frame = bench.frame_with(combined, &scene, none, Skipping::ALL);
    for step in 0..4 {
        scene.camera.eye += DVec3::new(0.15, 0.05, 0.0);
        scene.camera.target += DVec3::new(0.1 * f64::from(step), 0.0, 0.35);
        frame.update(&scene).unwrap();
        frame.refresh().unwrap();
        let mut anew = bench.frame_with(combined, &scene, none, Skipping::NONE);
        anew.render().unwrap();
        assert_eq!(
            frame.read("frame").unwrap(),
            anew.read("frame").unwrap(),
            "{step}"
        );
    }
}
