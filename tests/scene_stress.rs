//! Random scenes, pushed to extremes: they hold, and what is broken is caught and made plain.

mod common;

use common::{folder, json, meniscus, program_without_adapter, run, text, words, write};
use meniscus::gpu::Gpu;
use meniscus::{Project, SceneStress, Sources};

/// A shade that forgets that the sun may be low.
const MODULE: &str = "\
// Grows with the root of the sun's height.
//
// provides: shade
// needs: shading/light, shading/surface_point

fn shade(point: SurfacePoint) -> vec3f {
    return vec3f(sqrt(light.sun_direction.z - 0.1)) + 0.0 * point.position;
}
";

const PIPELINE: &str = r#"Variant(
    of: "refraction/none",
    about: "Broken where the sun is low.",
    set: { "all.shade": "shading/sunlit" },
)
"#;

#[test]
fn random_extreme_scenes_hold() {
    let there = folder();
    let found = there.path().join("found.json");
    let mut line = words("stress --scenes 40 --seed 20 --json");
    line.push(text(&found));
    let said = meniscus(&line);
    assert_eq!(said.code, Some(0), "{}\n{}", said.out, said.err);
    let found = json(&found);
    assert_eq!(found["scenes"], 40);
    assert_eq!(found["failures"].as_array().map(Vec::len), Some(0));
    assert!(found["pictures"].as_u64() >= Some(80), "{found}");
    assert!(found["judged"].as_u64() >= Some(3), "{found}");
    let oddities = found["oddities"].as_object().expect("oddities");
    assert!(oddities.len() >= 25, "{oddities:?}");
}

#[test]
fn equal_seeds_make_equal_scenes_and_others_do_not() {
    let project = Project::open(&Sources::default()).unwrap_or_else(|e| panic!("{e}"));
    let gpu = Gpu::open(None).unwrap_or_else(|e| panic!("{e}"));
    let pipeline = project.pipeline("refraction/none");
    let pipelines = vec![pipeline.unwrap_or_else(|e| panic!("{e}"))];
    let stress = |seed: u64, first: u64, scenes: u64| {
        let stress = SceneStress {
            pipelines: pipelines.clone(),
            each: 1,
            first,
            scenes,
            seed,
            size: [8, 6],
        };
        let found = stress.run(&project, &gpu, &|_, _| {});
        found.unwrap_or_else(|e| panic!("{e}")).oddities
    };
    assert_eq!(stress(5, 0, 12), stress(5, 0, 12));
    assert_ne!(stress(5, 0, 12), stress(6, 0, 12));
    // Parts of a run are the run.
    let mut parts = stress(5, 0, 5);
    for (odd, times) in stress(5, 5, 7) {
        *parts.entry(odd).or_default() += times;
    }
    assert_eq!(parts, stress(5, 0, 12));
}

#[test]
fn a_module_that_is_broken_somewhere_is_caught_and_the_scene_made_plain() {
    let there = folder();
    let path = |name: &str| there.path().join(name);
    write(&path("modules/shading/sunlit.wgsl"), MODULE);
    write(&path("pipelines/mine/broken.ron"), PIPELINE);
    let (modules, pipelines, worst) = (path("modules"), path("pipelines"), path("worst"));
    let known = ["--modules", text(&modules), "--pipelines", text(&pipelines)];
    let found = path("found.json");
    let mut line = words("stress mine/broken --scenes 60 --seed 3 --worst");
    line.extend([text(&worst), "--json", text(&found)]);
    let said = meniscus(known.iter().chain(&line));
    assert_eq!(said.code, Some(1), "{}\n{}", said.out, said.err);
    let found = json(&found);
    let failures = found["failures"].as_array().expect("failures");
    assert!(!failures.is_empty(), "no sun was low");
    for failure in failures {
        let oddities = failure["oddities"].as_array().expect("oddities");
        assert_eq!(oddities.len(), 1, "{failure}");
        let odd = oddities[0].as_str().expect("words");
        assert!(odd.starts_with("sun at an elevation of"), "{odd}");
        let what = failure["what"].as_str().expect("words");
        assert!(what.contains("numbers that are none"), "{what}");
    }
    // What is printed is enough to see it again.
    assert!(said.out.contains("scene.ron"), "{}", said.out);
    let scene = worst.join("scene-0.ron");
    let mut again = words("stress mine/broken --size 24x16 --scene");
    again.push(text(&scene));
    let said = meniscus(known.iter().chain(&again));
    assert_eq!(said.code, Some(1), "{}", said.out);
    assert!(said.out.contains("numbers that are none"), "{}", said.out);
    // The pipeline that it differs from holds there.
    let mut whole = words("stress refraction/none --size 24x16 --scene");
    whole.push(text(&scene));
    meniscus(&whole).done();
}

#[test]
fn what_cannot_be_tried_is_refused() {
    meniscus(words("stress --scenes 0")).refused(&["`--scenes 0`", "from 1"]);
    meniscus(words("stress no/such --scenes 3")).refused(&["no/such"]);
    meniscus(words("stress --scenes 3 --size 0x4")).refused(&["0x4"]);
    meniscus(words("stress --scene no_such_scene")).refused(&["no_such_scene"]);
    let said = run(program_without_adapter().args(words("stress --scenes 3")));
    said.ended(1, &["no graphics adapter"]);
}
