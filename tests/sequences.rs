//! Pictures at several moments: those that rendering each by itself makes, with less work.

mod common;

use common::{folder, meniscus, text, words};
use meniscus::gpu::Gpu;
use meniscus::pipeline::Pruning;
use meniscus::scene::{Scene, Setting};
use meniscus::{Picture, Project, Sequence, Sources};

const SIZE: [u32; 2] = [96, 54];

struct Bench {
    project: Project,
    gpu: Gpu,
}

impl Bench {
    fn new() -> Self {
        Self {
            project: Project::open(&Sources::default()).unwrap_or_else(|e| panic!("{e}")),
            gpu: Gpu::open(None).unwrap_or_else(|e| panic!("{e}")),
        }
    }

    fn pool(&self) -> Scene {
        let coarse = [Setting::new("pool.triangles", "2000")];
        let scene = self.project.scene("pool", &coarse);
        scene.unwrap_or_else(|e| panic!("{e}"))
    }

    fn sequence(&self, pipeline: &str, scene: &Scene, pruning: Pruning) -> Sequence<'_> {
        let pipeline = self.project.pipeline(pipeline).unwrap();
        let made = Sequence::new(&self.project, &self.gpu, &pipeline, scene, SIZE, pruning);
        made.unwrap_or_else(|e| panic!("{e}"))
    }

    fn alone(&self, pipeline: &str, scene: &Scene) -> Picture {
        let pipeline = self.project.pipeline(pipeline).unwrap();
        Picture::render(&self.project, &self.gpu, &pipeline, scene, SIZE).unwrap()
    }
}

#[test]
fn pictures_are_those_that_are_rendered_one_by_one_and_nothing_runs_for_nothing() {
    let there = folder();
    let path = |name: &str| there.path().join(name);
    let line = "render refraction/bounded --set water.geometry=flat --set pool.triangles=2000 \
        --size 96x54";
    let several = path("several/at-{}.png");
    let mut arguments = words(line);
    arguments.extend(["--times", "0,-1.5,-1.5,0", "-o", text(&several)]);
    let said = meniscus(&arguments).done();
    let lines: Vec<&str> = said.lines().collect();
    assert_eq!(lines.len(), 5, "{said}");
    for (number, time) in [(1, "0"), (2, "-1.5"), (3, "-1.5"), (4, "0")] {
        let file = path(&format!("several/at-{number}.png"));
        assert!(lines[number - 1].contains(&format!("at-{number}.png at {time} s: ")));
        let alone = path("alone.png");
        let time = format!("water.time={time}");
        let mut arguments = words(line);
        arguments.extend(["--set", &time, "-o", text(&alone)]);
        meniscus(&arguments).done();
        let [one, other] = [&file, &alone].map(|file| image::open(file).unwrap().to_rgb8());
        assert_eq!(one, other, "{number}");
    }
    let ran = |line: &str| {
        let told = line.split(" s: ").nth(1).expect("what ran");
        let (number, _) = told.split_once(" of ").expect("of how many");
        number.parse::<usize>().ok()
    };
    let first = ran(lines[0]).expect("all ran");
    // Only the water moves: what stands in it is not drawn again.
    let second = ran(lines[1]).expect("some ran");
    assert!(0 < second && second < first, "{said}");
    assert!(!lines[1].contains("broad"), "{said}");
    assert!(lines[2].contains(": none of ") && lines[2].contains("nothing has changed"));
    assert_eq!(ran(lines[3]), Some(second), "{said}");
}

#[test]
fn moments_that_cannot_be_rendered_are_refused() {
    let said = |more: &str| meniscus(words(&format!("render refraction/none --size 16x9 {more}")));
    said("--times 0,1 -o one.png").refused(&["2 pictures", "`one.png`", "frame-{}.png"]);
    said("--times 0,inf -o {}.png").refused(&["inf", "no moment"]);
    said("--times 0,1e9 -o {}.png").refused(&["no moment"]);
    said("--times 0,then -o {}.png").refused(&["then"]);
}

#[test]
fn a_plan_that_was_seen_before_compiles_nothing() {
    let bench = Bench::new();
    for name in ["refraction/bounded", "refraction/refined"] {
        let pool = bench.pool();
        // Other facts, thus other plans: no water in sight, and an eye under water.
        let mut up = pool.clone();
        up.camera.target.z = up.camera.eye.z + 8.0;
        let mut under = pool.clone();
        under.camera.eye.z = -0.5;
        under.camera.target.z = -0.6;
        let mut sequence = bench.sequence(name, &pool, Pruning::default());
        let mut plans = Vec::new();
        for scene in [&pool, &up, &under] {
            let before = bench.gpu.compiled();
            plans.push(sequence.shot(scene).unwrap().passes);
            // What is nearest is drawn alike in all of them.
            assert!(bench.gpu.compiled() > before || scene == &up, "{name}");
        }
        assert_ne!(plans[0], plans[1], "{name}: one plan");
        let alone = [&pool, &up, &under].map(|scene| bench.alone(name, scene));
        let compiled = bench.gpu.compiled();
        for (index, scene) in [&pool, &up, &under].into_iter().enumerate() {
            let shot = sequence.shot(scene).unwrap();
            assert_eq!(shot.passes, plans[index], "{name}");
            assert_eq!(shot.picture, alone[index], "{name}");
        }
        assert_eq!(bench.gpu.compiled(), compiled, "{name}");
    }
}

#[test]
fn where_nothing_may_be_left_out_nothing_is() {
    let bench = Bench::new();
    // Where textures do share memory otherwise.
    let under = bench.project.scene("underwater", &[]).unwrap();
    for name in ["refraction/combined", "refraction/bounded"] {
        let mut whole = bench.sequence(name, &under, Pruning::None);
        let mut exact = bench.sequence(name, &under, Pruning::Exact);
        for _ in 0..2 {
            let shot = whole.shot(&under).unwrap();
            assert_eq!(shot.ran.len(), shot.passes, "{name}");
            let exact = exact.shot(&under).unwrap();
            assert_eq!(shot.picture, exact.picture, "{name}");
        }
        let bytes = |sequence: &mut Sequence| {
            let counted = sequence.last_frame().expect("a frame").counters().unwrap();
            (counted.texture_bytes, counted.texture_sum_bytes)
        };
        let (allocated, sum) = bytes(&mut whole);
        assert_eq!(allocated, sum, "{name}");
        let (allocated, sum) = bytes(&mut exact);
        assert!(allocated < sum, "{name}: {allocated} {sum}");
    }
}
