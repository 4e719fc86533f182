//! Objects that move: the GPU agrees with the truth at every moment, and what is told of it.

mod common;

use common::{folder, meniscus, text, untimed, words};
use meniscus::gpu::Gpu;
use meniscus::measure::{Errors, Verdict};
use meniscus::pipeline::Pipeline;
use meniscus::scene::Setting;
use meniscus::{Outcome, Project, Proof, Sources};
use serde_json::Value;

const TIMES: [f64; 3] = [0.6, 1.9, 4.3];

fn project() -> Project {
    Project::open(&Sources::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn gpu() -> Gpu {
    Gpu::open(None).unwrap_or_else(|error| panic!("{error}"))
}

/// A pipeline; distances are measured at few voxels, which takes less time.
fn pipeline(project: &Project, name: &str) -> Pipeline {
    let mut pipeline = project.pipeline(name).unwrap();
    if name == "refraction/distance-field" {
        let voxels = "trace.intersect.inside.field_voxels";
        pipeline.set(voxels, "65536").unwrap();
    }
    pipeline
}

/// Runs pipelines on the scene in which things move, from a time on.
fn run(pipelines: &[&str], own: f64, moments: &[f64], size: [u32; 2]) -> Outcome {
    let project = project();
    let settings = [Setting::new("water.time", own.to_string())];
    let scene = project.scene("moving", &settings).unwrap();
    let pipelines = pipelines.iter().map(|name| pipeline(&project, name));
    let mut ablation = untimed(pipelines.collect(), scene, size);
    ablation.moments = moments.to_vec();
    let outcome = ablation.run(&project, &gpu(), &|_, _| ());
    outcome.unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn traced_rays_agree_with_the_truth_wherever_things_are() {
    for time in TIMES {
        let outcome = run(&["refraction/ray-traced"], time, &[], [240, 135]);
        let verdicts = &outcome.rows[0].judgement.verdicts;
        let errors = verdicts.iter().filter_map(|verdict| match verdict {
            Verdict::Error {
                px, wrong_object, ..
            } => Some(*px <= 0.05 && !wrong_object),
            _ => None,
        });
        let [all, good] = errors.fold([0_usize, 0], |[all, good], agrees| {
            [all + 1, good + usize::from(agrees)]
        });
        assert!(all > 5000, "only {all} pixels show water");
        assert!(
            all - good <= all / 2000,
            "{time} s: {} of {all}",
            all - good
        );
    }
}

/// The errors of a row at each moment.
fn at_moments(outcome: &Outcome, row: usize) -> Vec<Errors> {
    let moments = outcome.results.rows[row].more["moments"]
        .as_array()
        .unwrap();
    let error = |moment: &Value| serde_json::from_value(moment["error"].clone()).unwrap();
    moments.iter().map(error).collect()
}

/// From one moment to the next a frame follows; it shows no less than one that is made there.
#[test]
fn frames_that_follow_are_as_right_as_frames_made_anew() {
    let pipelines = [
        "refraction/bounded",
        "refraction/ray-traced",
        "refraction/distance-field",
    ];
    let size = [96, 54];
    let followed = run(&pipelines, 0.0, &TIMES, size);
    for (moment, time) in TIMES.into_iter().enumerate() {
        let anew = run(&pipelines, time, &[], size);
        for (row, name) in pipelines.iter().enumerate() {
            let followed = &at_moments(&followed, row)[moment];
            let anew = anew.results.rows[row].error.as_ref().unwrap();
            let off = (followed.position_px.mean - anew.position_px.mean).abs();
            assert!(off < 1e-3, "{name} at {time} s: {off}");
            assert!(
                (followed.wrong_object - anew.wrong_object).abs() < 1e-3,
                "{name} {time}"
            );
            assert!((followed.rmse - anew.rmse).abs() < 1e-3, "{name} {time}");
        }
    }
    // The moments differ, or nothing was tested.
    let first = at_moments(&followed, 0);
    assert_ne!(first[0], first[1]);
}

#[test]
fn nothing_that_is_left_out_is_missed_where_things_move() {
    let (project, gpu) = (project(), gpu());
    for (pipeline, cases) in [("refraction/bounded", 20), ("refraction/ray-traced", 8)] {
        let pipeline = project.pipeline(pipeline).unwrap();
        let proof = Proof {
            pipeline: &pipeline,
            scene: "moving",
            settings: &[Setting::new("pool.triangles", "2k")],
            size: [40, 30],
            cases,
            seed: 11,
        };
        let proved = proof.run(&project, &gpu, &|_, _| {}).unwrap();
        let told: Vec<String> = proved.differences.iter().map(ToString::to_string).collect();
        assert!(told.is_empty(), "{}:\n{}", pipeline.name, told.join("\n"));
    }
}

#[test]
fn what_following_takes_is_told() {
    let there = folder();
    let file = there.path().join("results.json");
    let line = "ablate refraction/none refraction/ray-traced refraction/distance-field \
        --scene moving --size 48x27 --rounds 1 --times 0,0.5 --wide \
        --with trace.intersect.inside.field_voxels=32768 --json";
    let mut arguments = words(line);
    arguments.push(text(&file));
    let said = meniscus(arguments).done();
    assert!(said.contains("update in ms"), "{said}");
    let results: Value = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
    let rows = results["rows"].as_array().unwrap();
    for row in rows {
        let update = &row["update"];
        assert_eq!(update["objects"], 4, "{row}");
        let number = |key: &str| update[key].as_f64().unwrap();
        assert!(number("bytes") > 0.0 && number("ms") > 0.0);
        // Nobody traces rays for plain triangles.
        match row["pipeline"].as_str() {
            Some("refraction/none") => assert_eq!(number("tree_ms"), 0.0),
            Some("refraction/ray-traced") => assert!(number("tree_ms") > 0.0),
            _ => {}
        }
        let uploaded = row["counters"]["uploaded_bytes"].as_f64().unwrap();
        assert!(uploaded >= number("bytes"));
    }
    let bytes = |index: usize| rows[index]["update"]["bytes"].as_u64().unwrap();
    assert!(
        bytes(1) > bytes(0),
        "triangles and trees are uploaded where rays are traced"
    );
    // Where nothing moves, nothing is said.
    let line = "ablate refraction/none --size 48x27 --rounds 1 --times 0,0.5 --json";
    let mut arguments = words(line);
    arguments.push(text(&file));
    meniscus(arguments).ended(0, &[]);
    let results: Value = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
    assert!(results["rows"][0].get("update").is_none());
}

#[test]
fn moments_at_which_something_is_lost_are_refused() {
    let line = "ablate refraction/none --scene moving --size 48x27 --rounds 1 --times 0,1e6";
    meniscus(words(line)).ended(0, &[]);
    let there = folder();
    let file = there.path().join("fast.ron");
    common::write(
        &file,
        r#"Scene(about: "Gone soon.", camera: (position: (0, -3), height: 1, target: (0, 0, 0)),
            materials: {"m": (colour: (1, 1, 1))},
            objects: [(name: "bird", material: "m", shape: Box(size: (1, 1, 1)),
                motion: (velocity: (900, 0, 0)))])"#,
    );
    let mut arguments =
        words("ablate refraction/none --size 48x27 --rounds 1 --times 0,9000 --scene");
    arguments.push(text(&file));
    meniscus(arguments).refused(&["9000 s", "`bird`", "1000 km"]);
}
