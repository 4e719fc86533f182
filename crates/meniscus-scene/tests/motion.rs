//! Laws of things that move.

mod common;

use common::{built_in, load, text_with};
use glam::{DMat3, DVec3};
use meniscus_scene::{Motion, Scene, Setting};

const MOTIONS: [&str; 4] = [
    "velocity: (0.3, -0.2, 0.1)",
    "turn: (20, -50, 130)",
    "heave: (amplitude: 0.4, period: 1.7)",
    "velocity: (1, 0, 0), turn: (0, 0, 90), heave: (amplitude: 0.4, period: 1.7)",
];

fn moving(motion: &str, settings: &[&str]) -> Scene {
    let more = format!("translate: (0.5, 0.25, -1), rotate: (10, 20, 30), motion: ({motion})");
    load(&text_with("Box(size: (1, 2, 3))", &more), settings).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn at_time_zero_everything_stands_where_it_is_placed() {
    for motion in MOTIONS {
        let placed = moving("", &[]);
        assert!(placed.moving.is_empty());
        let scene = moving(motion, &[]);
        assert_eq!(scene.mesh, placed.mesh, "{motion}");
        assert_ne!(scene.at_time(0.6).mesh, placed.mesh, "{motion}");
        assert_eq!(
            scene.at_time(0.6).at_time(0.0).mesh,
            placed.mesh,
            "{motion}"
        );
    }
}

#[test]
fn the_way_to_a_moment_does_not_matter() {
    for motion in MOTIONS {
        let mut scene = moving(motion, &[]);
        for time in [3.0, -2.0, 1e4, 0.75] {
            scene.set_time(time);
            let straight = moving(motion, &[&format!("water.time={time}")]);
            assert_eq!(scene, straight, "{motion} {time}");
            scene.check().unwrap();
        }
    }
}

#[test]
fn a_motion_is_rigid() {
    for motion in MOTIONS {
        let scene = moving(motion, &[]);
        let later = scene.at_time(2.3);
        let (a, b) = (&scene.mesh.positions, &later.mesh.positions);
        for i in 0..a.len() {
            for j in 0..i {
                let apart = a[i].as_dvec3().distance(a[j].as_dvec3());
                assert!((b[i].as_dvec3().distance(b[j].as_dvec3()) - apart).abs() < 2e-6);
            }
            // Normals turn with the points.
            let [n, m] = [&scene, &later].map(|s| s.mesh.normals[i].as_dvec3());
            let [p, q] = [a, b].map(|at| at[i].as_dvec3() - at[0].as_dvec3());
            assert!((n.dot(p) - m.dot(q)).abs() < 2e-6, "{motion}");
        }
    }
}

#[test]
fn heave_has_its_period_and_turns_come_round() {
    let motion = Motion {
        turn: DVec3::new(1.0, 2.0, -2.0),
        heave: 0.3,
        period: 1.6,
        ..Motion::default()
    };
    let pivot = DVec3::new(1.0, 2.0, 3.0);
    let point = DVec3::new(-1.0, 0.5, 0.25);
    let at = |time: f64| motion.pose(pivot, time).transform_point3(point);
    for time in [0.0, 0.1, 0.77] {
        let turned = |t: f64| motion.pose(pivot, t).matrix3;
        let round = std::f64::consts::TAU / 3.0;
        let back = |a: DMat3, b: DMat3| (a - b).to_cols_array().iter().all(|x| x.abs() < 1e-9);
        assert!(back(turned(time), turned(time + 1000.0 * round)));
        assert!(!back(turned(time), turned(time + 0.3 * round)));
        let height = |t: f64| motion.pose(pivot, t).transform_point3(pivot).z - pivot.z;
        assert!((height(time) - height(time + 1000.0 * 1.6)).abs() < 1e-9);
        // Half a period on, it is as far below as it was above.
        assert!((height(time) + height(time + 0.8)).abs() < 1e-9);
        assert!(height(time).abs() <= 0.3);
    }
    assert!((at(0.4).z - at(0.0).z).abs() > 1e-3);
    assert!((motion.pose(pivot, 0.4).transform_point3(pivot).z - 3.3).abs() < 1e-12);
}

#[test]
fn going_back_undoes_going_forth() {
    let motion = Motion {
        velocity: DVec3::new(3.0, -1.0, 0.5),
        turn: DVec3::new(0.3, 1.0, -0.2),
        heave: 0.2,
        period: 2.0,
    };
    let pivot = DVec3::new(4.0, 0.0, -1.0);
    for time in [0.3, -5.0, 123.4] {
        let there = motion.pose(pivot, time);
        // The pivot moves only by velocity and heave; about it, −t undoes the turn.
        let undone = motion.pose(pivot, -time).matrix3 * there.matrix3;
        assert!(
            (undone - DMat3::IDENTITY)
                .to_cols_array()
                .iter()
                .all(|x| x.abs() < 1e-12)
        );
        let sum = there.transform_point3(pivot) + motion.pose(pivot, -time).transform_point3(pivot);
        assert!((sum - 2.0 * pivot).length() < 1e-9);
    }
}

#[test]
fn bounds_of_height_hold_at_all_times() {
    for motion in MOTIONS {
        let mut scene = moving(motion, &[]);
        for step in 0..200 {
            scene.set_time(0.37 * f64::from(step));
            let [low, high] = scene.moving.bodies()[0].heights(scene.water.time);
            let z = || scene.mesh.positions.iter().map(|p| f64::from(p.z));
            let [least, most] = [z().fold(f64::MAX, f64::min), z().fold(f64::MIN, f64::max)];
            assert!(
                low <= least + 1e-6 && most <= high + 1e-6,
                "{motion} {step}"
            );
        }
    }
}

#[test]
fn the_scene_says_what_moved() {
    let mut scene = built_in()
        .load("moving", &[Setting::new("water.time", "1")])
        .unwrap();
    scene.check().unwrap();
    let names = |scene: &Scene, since: f64| -> Vec<String> {
        let ids = scene.moving.since(since);
        ids.map(|id| scene.objects[id as usize].name.clone())
            .collect()
    };
    assert!(names(&scene, 1.0).is_empty());
    assert_eq!(names(&scene, 0.5), ["buoy", "stems", "ring", "bird"]);
    let still = scene.mesh.clone();
    scene.set_time(2.0);
    let moved: Vec<usize> = (0..still.positions.len())
        .filter(|&i| still.positions[i] != scene.mesh.positions[i])
        .collect();
    let bodies = scene.moving.bodies().iter();
    let owned: Vec<u32> = bodies.flat_map(|body| body.vertices().to_vec()).collect();
    assert!(moved.iter().all(|&i| owned.contains(&(i as u32))));
    assert!(moved.len() * 10 > owned.len() * 9);
    assert_eq!(still.triangles, scene.mesh.triangles);
}

#[test]
fn what_goes_too_far_is_told() {
    let scene = moving("velocity: (1000, 0, 0)", &[]);
    assert_eq!(scene.lost_at(500.0), None);
    assert_eq!(scene.lost_at(1500.0), Some(0));
    assert_eq!(scene.lost_at(f64::NAN), Some(0));
    let text = text_with("Box(size: (1, 2, 3))", "motion: (velocity: (1000, 0, 0))");
    let message = load(&text, &["water.time=2000"]).unwrap_err().to_string();
    assert!(
        message.contains("test.ron:5:") && message.contains("2000 s (water.time)"),
        "{message}"
    );
}

#[test]
fn mistakes_in_motions_are_placed_and_explained() {
    for (motion, words) in [
        (
            "velocity: (2000, 0, 0)",
            &["test.ron:5:", "velocity", "-1000 to 1000"][..],
        ),
        (
            "turn: (0, 0, inf)",
            &["test.ron:5:", "turn", "not a finite number"],
        ),
        ("turn: 3", &["test.ron:5:"]),
        ("heave: (amplitude: 1)", &["test.ron:5:", "period"]),
        (
            "heave: (amplitude: 1, period: 0)",
            &["test.ron:5:", "period", "0.01 to 100000"],
        ),
        (
            "heave: (amplitude: -1, period: 1)",
            &["test.ron:5:", "amplitude", "0 to 10000"],
        ),
        ("speed: 3", &["test.ron:5:", "speed", "velocity"]),
    ] {
        let text = text_with("Box(size: (1, 2, 3))", &format!("motion: ({motion})"));
        let message = load(&text, &[]).map(drop).unwrap_err().to_string();
        for word in words {
            assert!(message.contains(word), "`{word}` is missing in\n{message}");
        }
    }
}

#[test]
fn exports_say_how_things_move() {
    let scene = moving(
        "turn: (0, 0, 90), heave: (amplitude: 0.4, period: 1.7)",
        &["water.time=3"],
    );
    let export = scene.export(&scene.camera.view(glam::UVec2::splat(8)));
    let motion = export.objects[0].motion.as_ref().unwrap();
    assert_eq!(
        (motion.pivot, motion.heave, motion.period),
        ([0.5, 0.25, -1.0], 0.4, 1.7)
    );
    assert!((motion.turn[2] - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
    assert_eq!(export.positions[3], scene.mesh.positions[3].to_array());
}

#[test]
fn motions_can_be_given_by_code() {
    let mut scene = load(&text_with("Box(size: (1, 2, 3))", ""), &["water.time=2"]).unwrap();
    let placed = scene.mesh.clone();
    let motion = Motion {
        velocity: DVec3::X,
        ..Motion::default()
    };
    assert!(
        !scene.set_motion(7, motion, DVec3::ZERO),
        "there is no such object"
    );
    assert!(scene.set_motion(0, motion, DVec3::ZERO));
    let moved = scene.mesh.positions[0] - placed.positions[0];
    assert!(
        (moved - glam::Vec3::new(2.0, 0.0, 0.0)).length() < 1e-6,
        "{moved}"
    );
    assert_eq!(scene.motion_of(0), Some(&motion));
    // A vertex that belongs to two objects cannot move with one of them.
    scene.mesh.triangles[0].object = 1;
    assert!(!scene.set_motion(1, motion, DVec3::ZERO));
}
