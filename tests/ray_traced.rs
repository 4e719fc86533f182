//! Tracing every water pixel on the GPU agrees with the truth to the limits of single precision.

mod common;

use common::untimed;
use meniscus::gpu::Gpu;
use meniscus::measure::Verdict;
use meniscus::scene::{Setting, WaterGeometry};
use meniscus::{Outcome, Project, Sources};

/// Runs one pipeline that needs no times.
fn traced(scene: &str, settings: &[(&str, &str)], geometry: WaterGeometry) -> Outcome {
    run(&Sources::default(), None, scene, settings, geometry)
}

fn run(
    sources: &Sources,
    filling: Option<(&str, &str)>,
    scene: &str,
    settings: &[(&str, &str)],
    geometry: WaterGeometry,
) -> Outcome {
    let project = Project::open(sources).unwrap();
    let mut pipeline = project.pipeline("refraction/ray-traced").unwrap();
    if let Some((slot, module)) = filling {
        pipeline.set(slot, module).unwrap();
    }
    let settings: Vec<Setting> = settings.iter().map(|(k, v)| Setting::new(*k, *v)).collect();
    let mut scene = project.scene(scene, &settings).unwrap();
    scene.water.geometry = geometry;
    let ablation = untimed(vec![pipeline], scene, [160, 90]);
    let gpu = Gpu::open(None).unwrap_or_else(|error| panic!("{error}"));
    ablation.run(&project, &gpu, &|_, _| ()).unwrap()
}

/// Water pixels with an answer, and those of them within so many pixels of the truth.
fn agreeing(outcome: &Outcome, bound_px: f64) -> [usize; 2] {
    let verdicts = &outcome.rows[0].judgement.verdicts;
    let errors = verdicts.iter().filter_map(|verdict| match verdict {
        Verdict::Error {
            px, wrong_object, ..
        } => Some(*px <= bound_px && !wrong_object),
        _ => None,
    });
    errors.fold([0, 0], |[all, good], agrees| {
        [all + 1, good + usize::from(agrees)]
    })
}

/// Few enough pixels are counted here that one on the very edge of an object may fall either way.
fn assert_agrees(scene: &str, slope: &str, geometry: WaterGeometry) -> Outcome {
    let outcome = traced(scene, &[("water.rms_slope", slope)], geometry);
    let [all, good] = agreeing(&outcome, 0.05);
    assert!(all > 1000, "{scene}: only {all} pixels show water");
    let wrong = all - good;
    assert!(
        wrong <= 2 + all / 2000,
        "{scene}, slope {slope}, {geometry:?}: {wrong} of {all}"
    );
    outcome
}

#[test]
fn flat_water_with_the_normals_of_waves_agrees() {
    for slope in ["0", "0.19"] {
        assert_agrees("pool", slope, WaterGeometry::Flat);
    }
}

#[test]
fn crests_hide_what_lies_behind_them() {
    assert_agrees("grazing", "0.19", WaterGeometry::Displaced);
}

#[test]
fn rays_that_meet_the_water_again_agree() {
    let outcome = assert_agrees("underwater", "0.3", WaterGeometry::Displaced);
    let events = |most: u8| outcome.truth.events.iter().filter(|&&e| e >= most).count();
    assert!(events(2) > 500, "only {} rays meet it again", events(2));
    assert!(events(3) > 10, "only {} rays meet it thrice", events(3));
}

#[test]
fn total_reflection_and_the_window_agree_from_under_water() {
    for geometry in [WaterGeometry::Flat, WaterGeometry::Displaced] {
        let outcome = assert_agrees("underwater", "0.1", geometry);
        let total = outcome.truth.total.iter().filter(|&&t| t).count();
        assert!(total > 1000 && total < outcome.truth.total.len() - 1000);
    }
}

#[test]
fn colours_at_hits_are_those_of_the_truth() {
    let outcome = assert_agrees("pool", "0.1", WaterGeometry::Displaced);
    let same = |(shown, truth): (&[f32; 3], &[f32; 3])| {
        let off = shown.iter().zip(truth).map(|(a, b)| (a - b).abs());
        off.fold(0.0, f32::max) < 4e-3
    };
    let water = outcome.rows[0].colours.iter().zip(&outcome.truth.colour);
    let water = water
        .zip(&outcome.truth.water_first)
        .filter(|(_, wet)| **wet);
    let (all, good) = water.fold((0, 0), |(all, good), (pair, _)| {
        (all + 1, good + usize::from(same(pair)))
    });
    // Half floats round, and lines between tiles have edges.
    assert!(all - good <= all / 200, "{} of {all}", all - good);
}

/// Tests every triangle: what a tree of boxes must agree with, to the last bit.
const EVERY_TRIANGLE: &str = "\
// What a ray meets first, by a look at every triangle.
//
// provides: intersect
// needs: geometry/hit, geometry/ray, geometry/triangle, geometry/triangles

fn intersect(ray: Ray, texel: vec2f) -> Hit {
    let sheared = sheared_ray(ray);
    var distance = 1e30;
    var nearest = no_hit(ray, texel);
    for (var i = 0u; i < min(arrayLength(&triangles), 4096u); i++) {
        let triangle = triangles[i];
        let hit = triangle_hit(sheared, triangle.first, triangle.second, triangle.third);
        if hit.found && hit.distance >= 0.0 && hit.distance < distance {
            distance = hit.distance;
            nearest = triangle_surface(ray, i, hit.weights, texel);
        }
    }
    return nearest;
}
";

#[test]
fn the_tree_finds_what_a_look_at_every_triangle_finds() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("test/every_triangle.wgsl");
    std::fs::create_dir_all(file.parent().unwrap()).unwrap();
    std::fs::write(file, EVERY_TRIANGLE).unwrap();
    let sources = Sources {
        modules: vec![folder.path().to_owned()],
        ..Sources::default()
    };
    let settings = [("pool.triangles", "3k"), ("water.rms_slope", "0.19")];
    for scene in ["pool", "underwater"] {
        let filling = ("trace.intersect.inside", "test/every_triangle");
        let [tree, all] = [None, Some(filling)].map(|filling| {
            let outcome = run(
                &sources,
                filling,
                scene,
                &settings,
                WaterGeometry::Displaced,
            );
            assert!(outcome.scene.mesh.triangles.len() <= 4096);
            outcome
        });
        let shown = |outcome: &Outcome| outcome.rows[0].shown.clone();
        let pairs = shown(&tree).into_iter().zip(shown(&all));
        let differing = pairs.filter(|(a, b)| a != b).count();
        // Two triangles at the same distance, on an edge that they share, are equally right.
        assert!(differing <= 5, "{scene}: {differing}");
    }
}
