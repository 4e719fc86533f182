//! What a camera sees, told from boxes: never that something is not seen which is.

mod common;

use glam::{DVec2, DVec3, UVec2};
use meniscus_pipeline::{Outlook, Rect, SceneBounds};
use meniscus_scene::{Scene, WaterGeometry, Wave};
use proptest::prelude::*;

const SIZE: UVec2 = UVec2::new(64, 36);

fn outlook(scene: &Scene) -> Outlook {
    Outlook::new(scene, &SceneBounds::new(scene), SIZE)
}

/// Which facts hold, of those that are asked for.
fn held<'a>(scene: &Scene, names: &[&'a str]) -> Vec<&'a str> {
    let facts = outlook(scene).facts;
    names
        .iter()
        .copied()
        .filter(|name| facts.has(name))
        .collect()
}

const SEEN: [&str; 4] = [
    "water_visible",
    "dry_visible",
    "near_visible",
    "far_visible",
];

fn look(scene: &mut Scene, eye: [f64; 3], target: [f64; 3]) {
    scene.camera.eye = eye.into();
    scene.camera.target = target.into();
}

fn wave(amplitude: f64) -> Wave {
    Wave {
        amplitude,
        wave_vector: DVec2::new(2.0, 0.0),
        angular_frequency: 4.4,
        phase: 0.0,
    }
}

#[test]
fn objects_are_counted_on_their_sides() {
    let mut scene = common::scene();
    let counts = |scene: &Scene| {
        let outlook = outlook(scene);
        [outlook.near, outlook.far, outlook.straddling].map(|c| (c.objects, c.triangles))
    };
    assert_eq!(counts(&scene), [(1, 4); 3]);
    // From below, the sides change places.
    scene.camera.eye.z = -3.0;
    assert_eq!(counts(&scene), [(1, 4); 3]);
    scene.water.level = 0.9;
    scene.camera.eye.z = 3.0;
    assert_eq!(counts(&scene), [(0, 0), (2, 8), (1, 4)]);
    scene.camera.eye.z = -3.0;
    assert_eq!(counts(&scene), [(2, 8), (0, 0), (1, 4)]);
    // Waves that rays meet reach as far as all their amplitudes.
    scene.water.level = 0.0;
    scene.water.waves = vec![wave(0.5), wave(-0.3)];
    assert_eq!(counts(&scene), [(0, 0), (0, 0), (3, 12)]);
    scene.water.geometry = WaterGeometry::Flat;
    assert_eq!(counts(&scene), [(1, 4); 3]);
}

#[test]
fn what_is_in_view_is_told_from_above_and_below() {
    let mut scene = common::scene();
    assert_eq!(
        held(&scene, &SEEN),
        ["water_visible", "near_visible", "far_visible"]
    );
    for (eye, target, expected) in [
        ([0.0, -4.0, 2.0], [0.0, 2.0, 2.0], &SEEN[..]),
        // Up, and up under water; down under water.
        ([0.0, -4.0, 2.0], [0.0, 0.0, 9.0], &["dry_visible"]),
        (
            [0.0, -4.0, -2.0],
            [0.0, 0.0, 9.0],
            &["water_visible", "near_visible", "far_visible"],
        ),
        ([0.0, -4.0, -2.0], [0.0, 0.0, -9.0], &["dry_visible"]),
        // Away from the objects: the water may still mirror one.
        (
            [0.0, -4.0, 2.0],
            [0.0, -9.0, -9.0],
            &["water_visible", "near_visible", "far_visible"],
        ),
    ] {
        look(&mut scene, eye, target);
        assert_eq!(held(&scene, &SEEN), expected, "{eye:?} {target:?}");
    }
    // Straight up at one that hangs there.
    look(&mut scene, [1.0, 2.0, 0.5], [1.0, 2.0, 3.0]);
    assert_eq!(held(&scene, &SEEN), ["dry_visible", "near_visible"]);
}

#[test]
fn sides_without_objects_are_not_seen() {
    let mut scene = common::scene();
    scene.water.level = -3.0;
    assert_eq!(held(&scene, &SEEN[2..]), ["near_visible"]);
    scene.water.level = 1.7;
    assert_eq!(held(&scene, &SEEN[2..]), ["far_visible"]);
    scene.mesh.triangles.clear();
    assert!(held(&scene, &SEEN[2..]).is_empty());
}

#[test]
fn an_eye_among_the_waves_may_see_anything() {
    let mut scene = common::scene();
    scene.water.waves = vec![wave(0.5)];
    for height in [-0.5, -0.1, 0.0, 0.3, 0.5] {
        look(&mut scene, [0.0, -4.0, height], [0.0, 0.0, 9.0]);
        let outlook = outlook(&scene);
        assert_eq!(outlook.water, Some(Rect::all(SIZE)), "{height}");
        assert_eq!(outlook.straddling.objects, 3);
    }
    // The fact tells the side of the surface above or below the eye.
    let submerged = |height: f64| {
        let mut scene = scene.clone();
        scene.camera.eye = DVec3::new(0.25 * std::f64::consts::PI, 0.0, height);
        outlook(&scene).facts.has("camera_submerged")
    };
    assert!(submerged(0.49) && !submerged(0.51));
}

#[test]
fn edges_count_as_fine_for_an_eye_that_is_not_at_the_water() {
    let mut scene = common::scene();
    let near = scene.camera.near;
    for (height, fine) in [
        (2.0, true),
        (2.5 * near, true),
        (0.5 * near, false),
        (0.0, false),
    ] {
        for side in [1.0, -1.0] {
            look(&mut scene, [0.0, -4.0, side * height], [0.0, 2.0, -1.0]);
            assert_eq!(outlook(&scene).facts.has("fine_edges"), fine, "{height}");
        }
    }
}

#[test]
fn the_rectangle_ends_at_the_horizon() {
    let mut scene = common::scene();
    look(&mut scene, [0.0, -4.0, 2.0], [0.0, 2.0, 2.0]);
    let water = outlook(&scene).water.unwrap();
    assert_eq!(
        water.low,
        UVec2::new(0, SIZE.y / 2 - 2),
        "a row for rounding, one whole"
    );
    assert_eq!(water.high, SIZE);
    assert!(water.pixels() < Rect::all(SIZE).pixels());
}

proptest! {
    /// Every pixel whose ray meets the water lies in the rectangle, and points of objects in view
    /// belong to a side that is seen.
    #[test]
    fn nothing_that_is_seen_is_denied(
        eye in prop::array::uniform3(-3.0f64..3.0),
        target in prop::array::uniform3(-3.0f64..3.0),
        level in -1.0f64..1.0,
        amplitude in prop_oneof![Just(0.0), 0.01f64..0.5],
        field_of_view in 0.2f64..2.0,
    ) {
        let mut scene = common::scene();
        look(&mut scene, eye, target);
        prop_assume!(scene.camera.eye.distance(scene.camera.target) > 0.1);
        scene.camera.field_of_view = field_of_view;
        scene.water.level = f64::from(level as f32);
        scene.water.waves = vec![wave(amplitude)];
        let outlook = outlook(&scene);
        let view = scene.camera.view(SIZE);
        let above = |point: DVec3| {
            point.z > scene.water.level + scene.water.height(point.truncate())
        };
        let meets = |direction: DVec3| (1..400).any(|step| {
            above(view.eye + 0.05 * f64::from(step) * direction) != above(view.eye)
        });
        for y in 0..SIZE.y {
            for x in (0..SIZE.x).step_by(7) {
                let direction = view.direction(DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5));
                let inside = outlook.water.is_some_and(|water| {
                    (water.low.x..water.high.x).contains(&x) && (water.low.y..water.high.y).contains(&y)
                });
                prop_assert!(inside || !meets(direction), "{x} {y}");
            }
        }
        prop_assert_eq!(outlook.facts.has("water_visible"), outlook.water.is_some());
        for point in &scene.mesh.positions {
            let point = point.as_dvec3();
            let Some(pixel) = view.project(point) else { continue };
            let in_frame = pixel.cmpge(DVec2::ZERO).all() && pixel.cmple(SIZE.as_dvec2()).all();
            if in_frame && (point - view.eye).dot(view.forward) > view.near {
                let side = match above(point) == above(view.eye) {
                    true => "near_visible",
                    false => "far_visible",
                };
                prop_assert!(outlook.facts.has(side), "{side} {point}");
            }
        }
    }
}
