//! Rotations, unit vectors in two numbers, planes, and combinators of intersections.

use glam::{DVec2, DVec3};
use meniscus_stress::modules::Choice;
use meniscus_stress::{Lanes, Scalar};

use crate::lab::*;

const LANES: usize = 20_000;

#[test]
fn rotation_carries_source_to_goal_keeps_lengths_and_can_be_undone() {
    let lab = Lab::of("geometry/rotation");
    let mut rng = rng();
    let (v, source) = (units(&mut rng, LANES), units(&mut rng, LANES));
    let goal: Vec<DVec3> = source
        .iter()
        .map(|s| {
            loop {
                let goal = unit(&mut rng);
                // Opposite vectors have no smallest rotation.
                if s.dot(goal) > -0.95 {
                    break goal;
                }
            }
        })
        .collect();
    let turn = |v: &[DVec3], from: &[DVec3], to: &[DVec3]| -> Vec<DVec3> {
        let found: Lanes<f32> =
            lab.call("rotate_between", &[vectors(v), vectors(from), vectors(to)]);
        (0..LANES).map(|lane| vec3(&found, 0, lane)).collect()
    };
    let turned = turn(&v, &source, &goal);
    let back = turn(&turned, &goal, &source);
    let arrived = turn(&source, &source, &goal);
    for lane in 0..LANES {
        assert!((turned[lane].length() - 1.0).abs() < 2e-5);
        assert!((back[lane] - v[lane]).length() < 4e-5);
        let open = 1.0 + source[lane].dot(goal[lane]);
        assert!((arrived[lane] - goal[lane]).length() < 5e-7 / open);
        let axis = source[lane].cross(goal[lane]);
        assert!((axis.dot(turned[lane]) - axis.dot(v[lane])).abs() < 2e-6);
    }
}

#[test]
fn unit_vectors_survive_the_octahedral_map() {
    let lab = Lab::of("geometry/octahedral");
    let mut rng = rng();
    let mut v = units(&mut rng, LANES);
    for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
        v.extend([axis, -axis]);
    }
    let encoded: Lanes<f32> = lab.call("octahedral_encoded", &[vectors(&v)]);
    let decoded = lab.call("octahedral_decoded", std::slice::from_ref(&encoded));
    for (lane, v) in v.iter().enumerate() {
        assert!(number(&encoded, 0, lane).abs() <= 1.0 && number(&encoded, 1, lane).abs() <= 1.0);
        let back = vec3(&decoded, 0, lane);
        assert!((back - *v).length() < 4e-7, "{v} becomes {back}");
        assert!((back.length() - 1.0).abs() < 2e-7);
    }
}

#[test]
fn every_pair_in_the_square_is_a_unit_vector_of_its_own() {
    let lab = Lab::of("geometry/octahedral");
    let mut rng = rng();
    let pairs: Vec<[f32; 2]> = (0..LANES)
        .map(|_| {
            [
                0.999 * (2.0 * rng.f32() - 1.0),
                0.999 * (2.0 * rng.f32() - 1.0),
            ]
        })
        .collect();
    let decoded = lab.call::<f32>("octahedral_decoded", &[Lanes::vectors(&pairs)]);
    let encoded = lab.call("octahedral_encoded", std::slice::from_ref(&decoded));
    for (lane, pair) in pairs.iter().enumerate() {
        let v = vec3(&decoded, 0, lane);
        // At the fold the two halves of the square share their edges.
        if v.z.abs() > 1e-5 {
            for (axis, x) in pair.iter().enumerate() {
                assert!((number(&encoded, axis, lane) - f64::from(*x)).abs() < 1e-6);
            }
        }
    }
}

#[test]
fn the_zero_vector_becomes_upwards() {
    let lab = Lab::of("geometry/octahedral");
    let encoded: Lanes<f32> = lab.call("octahedral_encoded", &[Lanes::vectors(&[[0.0; 3]])]);
    let decoded = lab.call("octahedral_decoded", &[encoded]);
    assert_eq!(vec3(&decoded, 0, 0), DVec3::Z);
}

/// One plane wherever one looks, x + 2y + 2z = −3, and places that are world coordinates.
const SEEN_PLANE: &str = "// A plane.
//
// provides: seen
// needs: screen/seen_point

fn seen(texel: vec2f) -> Seen {
    var point: Seen;
    point.normal = vec3f(1.0, 2.0, 2.0) / 3.0;
    point.shading_normal = point.normal;
    point.position = vec3f(texel, 0.5 * (-3.0 - texel.x - 2.0 * texel.y));
    point.object = 5.0;
    return point;
}
";
const FROM_ABOVE: &str = "// Straight down.
//
// provides: reproject

fn reproject(point: vec3f) -> vec2f {
    return point.xy;
}
";

fn rays(count: usize) -> (Vec<DVec3>, Vec<DVec3>) {
    let mut rng = rng();
    (points(&mut rng, 4.0, count), units(&mut rng, count))
}

fn hits<S: Scalar>(lab: &Lab, origin: &[DVec3], direction: &[DVec3], texel: &[DVec2]) -> Lanes<S> {
    let texel: Vec<[f32; 2]> = texel.iter().map(|t| t.as_vec2().to_array()).collect();
    lab.call(
        "intersect",
        &[
            structure(&[vectors(origin), vectors(direction)]),
            Lanes::vectors(&texel),
        ],
    )
}

#[test]
fn the_tangent_plane_is_met_on_the_plane_and_on_the_ray() {
    let composer = composer(&[("stub/plane", SEEN_PLANE), ("stub/above", FROM_ABOVE)]);
    let slots = choice(&[("seen", "stub/plane"), ("reproject", "stub/above")]);
    let lab = Lab::with(&composer, "geometry/tangent_plane", &slots);
    let (origin, direction) = rays(LANES);
    let texel = vec![DVec2::new(1.0, 1.0); LANES];
    let found = hits::<f32>(&lab, &origin, &direction, &texel);
    let leaf = |path: &str| lab.leaf("intersect", path);
    let normal = DVec3::new(1.0, 2.0, 2.0) / 3.0;
    let (mut met, mut missed) = (0, 0);
    for lane in 0..LANES {
        let position = vec3(&found, leaf(".position.x"), lane);
        let scale = 1.0 + position.length();
        assert!(
            (position.dot(normal) + 1.0).abs() < 2e-6 * scale,
            "off the plane: {position}"
        );
        let slope = direction[lane].dot(normal);
        let way = (-1.0 - origin[lane].dot(normal)) / slope;
        let offset = position - origin[lane];
        if way > 1e-3 && slope.abs() > 2e-3 {
            let apart = offset.cross(direction[lane]).length();
            assert!(apart < 2e-6 * scale, "{apart} off the ray");
            assert!(offset.dot(direction[lane]) > 0.0, "behind the ray's origin");
            assert!((offset.length() / way - 1.0).abs() < 2e-6 / slope.abs() * (1.0 + 1.0 / way));
            met += 1;
        } else if way < -1e-3 {
            // Behind its origin: the seen point itself.
            assert_eq!(position.truncate(), DVec2::new(1.0, 1.0));
            missed += 1;
        }
    }
    assert!(met > LANES / 4 && missed > LANES / 4);
}

/// A tap that leads from x to 2x − 3, away from where its residual is smallest: at x = 3.
const AWAY: &str = "// A tap that worsens.
//
// provides: intersect
// needs: geometry/ray, geometry/hit

fn intersect(ray: Ray, texel: vec2f) -> Hit {
    var hit = no_hit(ray, vec2f(2.0 * texel.x - 3.0, texel.y));
    hit.residual = abs(texel.x - 3.0);
    hit.position = vec3f(texel, 0.0);
    hit.object = 1.0;
    hit.found = true;
    return hit;
}
";

fn tapped(stub: &str, taps: f64) -> (Vec<f64>, Vec<f64>) {
    let composer = composer(&[("stub/tap", stub)]);
    let mut choice = choice(&[("tap", "stub/tap")]);
    choice.numbers.insert("taps".to_owned(), taps);
    let lab = Lab::with(&composer, "geometry/refined", &choice);
    let (origin, direction) = rays(1000);
    let mut rng = rng();
    let x = within(&mut rng, -20.0, 20.0, 1000);
    let texel: Vec<DVec2> = x.iter().map(|&x| DVec2::new(x, 1.0)).collect();
    let found = hits::<f32>(&lab, &origin, &direction, &texel);
    let leaf = lab.leaf("intersect", ".residual");
    (
        x,
        (0..1000).map(|lane| number(&found, leaf, lane)).collect(),
    )
}

#[test]
fn the_best_tap_is_kept_and_more_taps_are_never_worse() {
    let (x, one) = tapped(AWAY, 1.0);
    let (_, away) = tapped(AWAY, 5.0);
    let towards = AWAY.replace("2.0 * texel.x - 3.0", "0.5 * texel.x + 1.5");
    let (_, two) = tapped(&towards, 2.0);
    let (_, five) = tapped(&towards, 5.0);
    for lane in 0..x.len() {
        let first = (x[lane] - 3.0).abs();
        assert!((one[lane] - first).abs() < 1e-5);
        assert_eq!(away[lane], one[lane], "a tap that is worse is not kept");
        assert!(five[lane] <= two[lane] && two[lane] <= one[lane]);
        if first > 1.0 {
            assert!(
                (five[lane] - first / 16.0).abs() < 1e-5,
                "each of four more halves it"
            );
        }
    }
}

#[test]
fn the_exact_intersection_is_asked_where_the_residual_is_not_within_the_bound() {
    let exact = AWAY.replace("hit.object = 1.0", "hit.object = 7.0");
    let composer = composer(&[("stub/first", AWAY), ("stub/then", &exact)]);
    for bound in [0.0, 0.25, 8.0] {
        let mut choice = choice(&[("first", "stub/first"), ("then", "stub/then")]);
        choice.numbers.insert("bound_px".to_owned(), bound);
        let lab = Lab::with(&composer, "geometry/bounded", &choice);
        let (origin, direction) = rays(1000);
        let texel: Vec<DVec2> = (0..1000)
            .map(|i| DVec2::new(3.0 + f64::from(i - 500) / 32.0, 0.0))
            .collect();
        let found = hits::<f32>(&lab, &origin, &direction, &texel);
        let object = lab.leaf("intersect", ".object");
        for (lane, texel) in texel.iter().enumerate() {
            let cheap = (texel.x - 3.0).abs() < bound;
            let wanted = if cheap { 1.0 } else { 7.0 };
            assert_eq!(
                number(&found, object, lane),
                wanted,
                "bound {bound}, {texel}"
            );
        }
    }
}

#[test]
fn a_choice_refuses_numbers_and_functions_that_are_not_there() {
    let composer = composer(&[]);
    let choice = Choice {
        numbers: [("tabs".to_owned(), 3.0)].into(),
        ..Choice::default()
    };
    let refused = meniscus_stress::modules::Specimen::new(&composer, "geometry/refined", &choice);
    assert!(
        refused
            .expect_err("no such number")
            .to_string()
            .contains("`taps`")
    );
    let lab = Lab::of("geometry/rotation");
    let unknown = lab
        .specimen
        .function("rotate_betwixt")
        .expect_err("no such function");
    assert!(unknown.to_string().contains("rotate_between"));
}
