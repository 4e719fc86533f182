//! Where points behind flat water appear.

use fastrand::Rng;
use glam::DVec3;
use meniscus_stress::Lanes;
use meniscus_stress::modules::truth;

use crate::lab::*;

const LANES: usize = 4000;
const WATERS: [(f64, bool); 4] = [(1.333, true), (1.333, false), (2.5, true), (0.4, true)];

/// An eye, points on the other side of the plane z = 0, and the water's index and side.
struct Case {
    eye: DVec3,
    side: f64,
    eye_low: bool,
    points: Vec<DVec3>,
    /// Tangents of the angles at the eye and behind the water.
    tangents: Vec<(f64, f64)>,
    lab: Lab,
}

fn case(path: &str, index: f64, above: bool, slots: &[(&str, &str)], rng: &mut Rng) -> Case {
    let mut lab = Lab::with(&composer(&[]), path, &choice(slots)).water(index, above);
    let side = if above { 1.0 } else { -1.0 };
    let eye = DVec3::new(3.5, -2.25, side * f64::from(0.1_f32 + 20.0 * rng.f32()));
    lab.host
        .set("view_target.eye", &eye.to_array())
        .expect("an eye");
    let mut at = || f64::from((30.0 * (2.0 * rng.f64() - 1.0)) as f32);
    let points: Vec<DVec3> = (0..LANES)
        .map(|_| DVec3::new(at(), at(), -side * (at().abs() / 5.0 + 1e-3)))
        .collect();
    let solve = truth("crossing", &lab.host).expect("a truth");
    let relative = if above { index } else { 1.0 / index };
    let eye_low = relative >= 1.0;
    let tangents = points.iter().map(|point| {
        let (near, far) = (eye.z.abs(), point.z.abs());
        let apart = (point.truncate() - eye.truncate()).length();
        let (low, high) = if eye_low { (near, far) } else { (far, near) };
        let found = solve(&[low, high, apart]);
        let (tangent, other) = (found[0], found[0] * found[1]);
        if eye_low {
            (tangent, other)
        } else {
            (other, tangent)
        }
    });
    let tangents = tangents.collect();
    Case {
        eye,
        side,
        eye_low,
        points,
        tangents,
        lab,
    }
}

fn placed(case: &Case) -> Lanes<f32> {
    case.lab.call("place", &[vectors(&case.points)])
}

#[test]
fn apparent_points_stand_on_their_verticals_and_on_the_straightened_camera_rays() {
    let mut rng = rng();
    for (index, above) in WATERS {
        for crossing in ["optics/crossing_split", "slots/crossing"] {
            let slots = [("crossing", crossing)];
            let slots = if crossing.starts_with("slots") {
                &slots[..0]
            } else {
                &slots[..]
            };
            let case = case("optics/apparent_position", index, above, slots, &mut rng);
            let found = placed(&case);
            for (lane, point) in case.points.iter().enumerate() {
                let apparent = vec3(&found, 0, lane);
                assert_eq!(apparent.truncate(), point.as_vec3().as_dvec3().truncate());
                let apart = (apparent.truncate() - case.eye.truncate()).length();
                let fall = case.side * (case.eye.z - apparent.z);
                let tangent = case.tangents[lane].0;
                let error = (apart - tangent * fall) / apart.hypot(fall) / (1.0 + tangent);
                assert!(
                    error.abs() < 1e-5,
                    "{index} {above} {error}: {point} from {}",
                    case.eye
                );
            }
        }
    }
}

#[test]
fn path_lengths_lie_on_the_same_rays_as_far_as_the_light_goes() {
    let mut rng = rng();
    for (index, above) in WATERS {
        let case = case("optics/path_length", index, above, &[], &mut rng);
        let found = placed(&case);
        for (lane, point) in case.points.iter().enumerate() {
            let (near, far) = case.tangents[lane];
            let offset = vec3(&found, 0, lane) - case.eye;
            let length = case.eye.z.abs() * near.hypot(1.0) + point.z.abs() * far.hypot(1.0);
            assert!(
                (offset.length() / length - 1.0).abs() < 2e-5,
                "{index} {above}"
            );
            let horizontal = (*point - case.eye).truncate().normalize();
            let ray = DVec3::from((horizontal * near, -case.side)).normalize();
            let error = (offset.normalize() - ray).length();
            assert!(
                error < 2e-5,
                "{index} {above} low {}: {error}",
                case.eye_low
            );
        }
    }
}

#[test]
fn points_on_the_eyes_side_stay_where_they_are() {
    let mut rng = rng();
    for path in [
        "optics/apparent_position",
        "optics/path_length",
        "optics/in_place",
    ] {
        for (index, above) in WATERS {
            let mut case = case(path, index, above, &[], &mut rng);
            case.points.iter_mut().for_each(|point| point.z = -point.z);
            let found = placed(&case);
            for (lane, point) in case.points.iter().enumerate() {
                assert_eq!(vec3(&found, 0, lane), point.as_vec3().as_dvec3());
            }
        }
    }
}

#[test]
fn seen_from_the_air_the_picture_is_continuous_at_the_plane() {
    let mut rng = rng();
    for path in ["optics/apparent_position", "optics/path_length"] {
        let mut case = case(path, 1.333, true, &[], &mut rng);
        for depth in [1e-7, 1e-5, 1e-3] {
            case.points.iter_mut().for_each(|point| point.z = -depth);
            let found = placed(&case);
            for (lane, point) in case.points.iter().enumerate() {
                let moved = (vec3(&found, 0, lane) - *point).length();
                // The path's length is rounded as a whole.
                assert!(moved <= 2.0 * depth + 1e-5, "{path}: {moved} at {depth}");
            }
        }
    }
}

#[test]
fn the_eye_may_be_in_the_surface_and_the_point_under_the_eye() {
    for path in ["optics/apparent_position", "optics/path_length"] {
        for height in [0.0, 1e-30, 1e-7, -1e-7, 1.0] {
            for (index, above) in WATERS {
                let mut lab = Lab::of(path).water(index, above);
                lab.host
                    .set("view_target.eye", &[0.0, 0.0, height])
                    .expect("an eye");
                let side = if above { -1.0 } else { 1.0 };
                let points: Vec<DVec3> = [
                    (0.0, 1.0),
                    (0.0, 0.0),
                    (1e-30, 1e-30),
                    (1.0, 1e-7),
                    (1e4, 1e4),
                ]
                .map(|(x, depth)| DVec3::new(x, 0.0, side * depth))
                .to_vec();
                let found: Lanes<f32> = lab.call("place", &[vectors(&points)]);
                for lane in 0..points.len() {
                    let place = vec3(&found, 0, lane);
                    assert!(
                        place.is_finite(),
                        "{path} {height} {index} {above} {lane}: {place}"
                    );
                }
            }
        }
    }
}
