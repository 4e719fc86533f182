//! Laws of the scenes that come with the program, and of what is set in them.

mod common;

use common::{built_in, load, text_with};
use glam::{DVec2, UVec2};
use meniscus_scene::{Pattern, Scene, Setting, WaterGeometry};
use proptest::prelude::*;

fn scene(name: &str, settings: &[&str]) -> Scene {
    let settings: Vec<Setting> = settings
        .iter()
        .map(|s| Setting::parse("--set", s).unwrap())
        .collect();
    built_in()
        .load(name, &settings)
        .unwrap_or_else(|report| panic!("{name}: {report}"))
}

#[test]
fn all_scenes_are_sound() {
    let library = built_in();
    let names: Vec<&str> = library.iter().map(|source| source.name.as_str()).collect();
    for name in [
        "pool",
        "pool-128k",
        "clutter",
        "straddle",
        "underwater",
        "grazing",
        "deep",
        "coarse",
        "moving",
    ] {
        assert!(names.contains(&name), "{name} is not among {names:?}");
    }
    for source in library.iter() {
        let scene = scene(&source.name, &[]);
        scene.check().unwrap();
        assert_eq!(scene.name, source.name);
        assert!(!source.about().unwrap().is_empty());
        assert!(
            (scene.water.rms_slope() - 0.05).abs() < 1e-12,
            "{}",
            source.name
        );
    }
}

#[test]
fn the_pool_is_what_pictures_and_measurements_count_on() {
    for (name, triangles) in [("pool", 16e3), ("pool-128k", 128e3)] {
        let scene = scene(name, &[]);
        let count = scene.mesh.triangles.len() as f64;
        assert!((count / triangles - 1.0).abs() < 0.02, "{name}: {count}");
        assert_eq!(scene.sides().across, 0);
        assert!((scene.camera.eye.z - scene.water.level - 1.7).abs() < 1e-12);
        let lengths: Vec<f64> = scene
            .water
            .waves
            .iter()
            .map(|wave| std::f64::consts::TAU / wave.wave_vector.length())
            .collect();
        assert!(lengths.len() >= 4 && lengths.iter().all(|length| (0.5..=2.0).contains(length)));
        let basin = object(&scene, "basin");
        let size = basin.1 - basin.0;
        assert!(size.x >= 6.0 && size.y >= 4.0 && (basin.0.z + 2.0).abs() < 1e-6);
        let pillar = object(&scene, "pillar");
        assert!(
            pillar.0.z < -0.5 && pillar.1.z > 0.5,
            "it stands through the water line"
        );
        let row = scene
            .mesh
            .positions
            .iter()
            .filter(|p| p.z == 0.0 && p.x > 0.5 && p.x < 1.0);
        assert!(row.count() > 8, "a row of vertices on the water line");
        assert!(object(&scene, "hovering ball").0.z > 0.1);
    }
    // Edges that are straight without water bow little through it.
    let scene = scene("pool", &[]);
    for index in 0..scene.mesh.triangles.len() {
        let corners = scene.mesh.corners(index);
        if corners.iter().any(|corner| corner.z < 0.0) {
            let [a, b, c] = corners;
            let mut sides = [(b - a).length(), (c - b).length(), (a - c).length()];
            sides.sort_by(f64::total_cmp);
            assert!(sides[1] < 0.15);
        }
    }
}

fn object(scene: &Scene, name: &str) -> (glam::DVec3, glam::DVec3) {
    let id = scene
        .objects
        .iter()
        .position(|object| object.name == name)
        .expect(name);
    let mut mesh = scene.mesh.clone();
    mesh.triangles
        .retain(|triangle| triangle.object as usize == id);
    mesh.bounds().unwrap()
}

#[test]
fn same_content_in_more_triangles() {
    let (few, many) = (scene("pool", &[]), scene("pool-128k", &[]));
    assert_eq!(few.objects, many.objects);
    for (id, object_of) in few.objects.iter().enumerate() {
        let (a, b) = (
            object(&few, &object_of.name),
            object(&many, &object_of.name),
        );
        assert!((a.0 - b.0).abs().max_element() < 0.02 && (a.1 - b.1).abs().max_element() < 0.02);
        assert!(many.triangles_of(id as u32) >= few.triangles_of(id as u32));
    }
}

#[test]
fn a_budget_is_met_nearly() {
    for (budget, triangles) in [("4k", 4e3), ("16k", 16e3), ("50000", 5e4), ("1M", 1e6)] {
        let scene = scene("pool", &[&format!("pool.triangles={budget}")]);
        let count = scene.mesh.triangles.len() as f64;
        assert!((count / triangles - 1.0).abs() < 0.06, "{budget}: {count}");
        scene.check().unwrap();
    }
}

#[test]
fn the_coarse_pool_has_under_a_hundred_vertices() {
    assert!(scene("coarse", &[]).mesh.positions.len() < 100);
}

#[test]
fn straddle_alone_has_large_triangles_across_the_water() {
    assert!(scene("straddle", &[]).sides().across > 50);
    for name in ["pool", "clutter", "underwater", "grazing", "deep", "coarse"] {
        assert_eq!(scene(name, &[]).sides().across, 0, "{name}");
    }
}

/// Lines of tiles that lie in a wall's plane would flicker.
#[test]
fn tile_lines_keep_off_the_corners_of_the_basins() {
    for name in [
        "pool",
        "clutter",
        "straddle",
        "underwater",
        "grazing",
        "deep",
        "coarse",
    ] {
        let scene = scene(name, &[]);
        let Pattern::Tiles {
            size, line, offset, ..
        } = scene.materials[scene.objects[0].material as usize].pattern
        else {
            panic!("{name}: the basin has no tiles");
        };
        let (low, high) = object(&scene, &scene.objects[0].name);
        for at in [low.x, high.x, low.y, high.y, low.z, scene.water.level] {
            let phase = (at + f64::from(offset)).rem_euclid(f64::from(size));
            let nearest = [0.0, f64::from(line), f64::from(size)].map(|edge| (phase - edge).abs());
            assert!(
                nearest.into_iter().all(|distance| distance > 1e-3),
                "{name}: {at}"
            );
        }
    }
}

/// No ray from the eye passes above the terrace and meets the water that reaches the horizon.
#[test]
fn the_frame_shows_no_water_outside_the_basin() {
    for name in ["pool", "clutter", "straddle", "grazing", "deep", "coarse"] {
        let scene = scene(name, &[]);
        let (low, high) = object(&scene, &scene.objects[0].name);
        let view = scene.camera.view(UVec2::new(64, 36));
        for pixel in 0..64 * 36 {
            let direction = view.direction(DVec2::new(
                f64::from(pixel % 64) + 0.5,
                f64::from(pixel / 64) + 0.5,
            ));
            if direction.z >= 0.0 {
                continue;
            }
            let distance = (scene.water.level - view.eye.z) / direction.z;
            let at = view.eye + distance * direction;
            if at.x > low.x && at.x < high.x && at.y > low.y && at.y < high.y {
                continue;
            }
            let covered = (0..scene.mesh.triangles.len()).any(|t| {
                let [a, b, c] = scene.mesh.corners(t);
                let (p, q, s) = (b - a, c - a, view.eye - a);
                let across = direction.cross(q);
                let (u, v) = (
                    s.dot(across) / p.dot(across),
                    direction.dot(s.cross(p)) / p.dot(across),
                );
                let hit = q.dot(s.cross(p)) / p.dot(across);
                u > -1e-9 && v > -1e-9 && u + v < 1.0 + 1e-9 && hit > 0.0 && hit < distance
            });
            assert!(covered, "{name}: pixel {pixel}");
        }
    }
}

#[test]
fn settings_change_what_they_say() {
    let set = [
        "water.rms_slope=0.1",
        "water.time=1.5",
        "water.geometry=flat",
        "water.refractive_index=1.5",
        "water.level=0.5",
        "camera.height=2",
        "camera.target.x=1",
        "camera.field_of_view=60",
        "sun.elevation=90",
    ];
    let scene = scene("pool", &set);
    assert!((scene.water.rms_slope() - 0.1).abs() < 1e-12);
    assert_eq!(scene.water.time, 1.5);
    assert_eq!(scene.water.geometry, WaterGeometry::Flat);
    assert_eq!(scene.water.refractive_index, 1.5);
    assert_eq!(
        scene.camera.eye.z, 2.5,
        "height counts from the water's level"
    );
    assert_eq!(scene.camera.target.x, 1.0);
    assert!((scene.camera.field_of_view.to_degrees() - 60.0).abs() < 1e-12);
    assert!((scene.sun.direction - glam::DVec3::Z).length() < 1e-12);
    // The last one wins.
    let again = self::scene("pool", &["water.time=1", "water.time=2"]);
    assert_eq!(again.water.time, 2.0);
    assert_eq!(again.at_time(7.0), self::scene("pool", &["water.time=7"]));
}

#[test]
fn what_a_variant_sets_gives_way_to_the_command_line() {
    let count = |settings: &[&str]| scene("pool-128k", settings).mesh.triangles.len();
    assert_eq!(
        count(&["pool.triangles=16k"]),
        scene("pool", &[]).mesh.triangles.len()
    );
}

#[test]
fn every_key_can_be_set_at_both_ends_of_its_range() {
    for key in meniscus_scene::keys() {
        let values: Vec<String> = match key.values {
            meniscus_scene::Values::Number { least, most } => {
                vec![least.to_string(), most.to_string()]
            }
            meniscus_scene::Values::Count { least, .. } => vec![least.to_string()],
            meniscus_scene::Values::Choice(words) => {
                words.iter().map(|&word| word.to_owned()).collect()
            }
        };
        for value in values {
            scene("coarse", &[&format!("{}={value}", key.name)])
                .check()
                .unwrap();
        }
    }
}

#[test]
fn still_water_is_flat() {
    let scene = scene("pool", &["water.rms_slope=0"]);
    assert!(scene.water.is_flat());
    assert_eq!(scene.water.slope_bound(), 0.0);
    assert_eq!(scene.water.gradient(DVec2::new(0.3, 0.4)), DVec2::ZERO);
}

#[test]
fn an_export_finds_the_pixels_that_the_view_finds() {
    let scene = scene("pool", &[]);
    let view = scene.camera.view(UVec2::new(640, 360));
    let export = serde_json::to_value(scene.export(&view)).unwrap();
    assert_eq!(
        export["triangles"].as_array().unwrap().len(),
        scene.mesh.triangles.len()
    );
    assert_eq!(
        export["water"]["waves"].as_array().unwrap().len(),
        scene.water.waves.len()
    );
    let rows = &export["camera"]["world_to_pixel"];
    for point in scene
        .mesh
        .positions
        .iter()
        .step_by(97)
        .map(|p| p.as_dvec3())
    {
        let row = |i: usize| -> f64 {
            let at = |j: usize| rows[i][j].as_f64().unwrap();
            at(0) * point.x + at(1) * point.y + at(2) * point.z + at(3)
        };
        if let Some(pixel) = view.project(point) {
            let found = DVec2::new(row(0), row(1)) / row(2);
            assert!((found - pixel).length() < 1e-6 * (1.0 + pixel.length()));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn the_rms_slope_sampled_is_the_one_set(
        slope in 0.001..0.5_f64,
        waves in proptest::collection::vec((0.0..180.0_f64, 0.4..2.5_f64, 0.1..1.0_f64, 0.0..360.0_f64), 1..7),
    ) {
        let listed: Vec<String> = waves
            .iter()
            .map(|(direction, length, weight, phase)| {
                format!("(direction: {direction}, wavelength: {length}, weight: {weight}, phase: {phase})")
            })
            .collect();
        let text = text_with("Box(size: (1, 1, 1))", "")
            .replace("(direction: 10, wavelength: 1)", &listed.join(", "));
        let water = load(&text, &[&format!("water.rms_slope={slope}")]).unwrap().water;
        prop_assert!((water.rms_slope() / slope - 1.0).abs() < 1e-12);
        // Places and times of a plastic-number sequence, far apart against every wave.
        let count = 40_000;
        let mean = (0..count)
            .map(|i| {
                let i = f64::from(i);
                let part = |factor: f64| (i * factor).fract();
                let xy = 4e3 * DVec2::new(part(0.819_172_513_396_164_4), part(0.671_043_606_703_789_2));
                water.at_time(4e3 * part(0.549_700_477_901_960_3)).gradient(xy).length_squared()
            })
            .sum::<f64>() / f64::from(count);
        prop_assert!((mean.sqrt() / slope - 1.0).abs() < 0.02, "{} against {slope}", mean.sqrt());
    }
}
