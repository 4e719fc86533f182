//! Laws that the independent truths obey; functions as someone may write them, held against them.

use fastrand::Rng;
use glam::{DQuat, DVec3};
use meniscus_stress::modules::{Assay, Host, declared, truth, truth_about, truth_names};
use meniscus_stress::{Effort, Findings};

use crate::lab::composer;

fn solved(name: &str, numbers: &[f64]) -> Vec<f64> {
    let solve = truth(name, &Host::default()).unwrap_or_else(|| panic!("no truth `{name}`"));
    solve(numbers)
}

fn around(rng: &mut Rng, size: f64) -> DVec3 {
    let number = |rng: &mut Rng| size * (2.0 * rng.f64() - 1.0);
    DVec3::new(number(rng), number(rng), number(rng))
}

fn direction(rng: &mut Rng) -> DVec3 {
    loop {
        let v = around(rng, 1.0);
        if (0.01..1.0).contains(&v.length_squared()) {
            return v.normalize();
        }
    }
}

fn numbers(vectors: &[DVec3]) -> Vec<f64> {
    vectors.iter().flat_map(|v| v.to_array()).collect()
}

#[test]
fn every_truth_is_told_of() {
    let names: Vec<&str> = truth_names().collect();
    assert!(names.len() >= 10, "{names:?}");
    let readme = include_str!("../../README.md");
    for name in names {
        let about = truth_about(name).unwrap_or_default();
        assert!(about.contains('→'), "{name}: {about}");
        assert!(readme.contains(&format!("| `{name}` |")), "{name}");
        assert!(truth(name, &Host::default()).is_some(), "{name}");
    }
    assert!(truth_about("nothing").is_none());
}

#[test]
fn the_point_of_a_plane_lies_on_it() {
    let mut rng = Rng::with_seed(1);
    for _ in 0..2000 {
        let (origin, way, normal) = (
            around(&mut rng, 9.0),
            direction(&mut rng),
            direction(&mut rng),
        );
        let distance = around(&mut rng, 5.0).x;
        let mut given = numbers(&[origin, way, normal]);
        given.push(distance);
        let t = solved("plane", &given)[0];
        let off = normal.dot(origin + t * way) - distance;
        assert!(off.abs() < 1e-12 * (1.0 + t.abs()), "{given:?}: {off}");
    }
    // Along the plane there is no meeting.
    let along = [0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    assert!(solved("plane", &along)[0].is_nan());
}

#[test]
fn the_point_of_a_sphere_lies_on_it_and_is_the_first() {
    let mut rng = Rng::with_seed(2);
    let (mut met, mut within) = (0, 0);
    for _ in 0..5000 {
        let (origin, way, centre) = (
            around(&mut rng, 4.0),
            direction(&mut rng),
            around(&mut rng, 2.0),
        );
        let radius = 0.5 + 2.0 * rng.f64();
        let mut given = numbers(&[origin, way, centre]);
        given.push(radius);
        let t = solved("sphere", &given)[0];
        let distance = |t: f64| (origin + t * way).distance(centre);
        let inside = distance(0.0) < radius;
        if t.is_nan() {
            let nearest = (centre - origin).dot(way).max(0.0);
            assert!(distance(nearest) >= radius * (1.0 - 1e-9), "{given:?}");
            continue;
        }
        met += 1;
        within += u32::from(inside);
        assert!(
            t >= 0.0 && (distance(t) - radius).abs() < 1e-11,
            "{given:?}: {t}"
        );
        // Up to there the ray stays on the side on which it starts.
        for part in [0.1, 0.5, 0.9, 0.999] {
            assert_eq!(distance(part * t) < radius, inside, "{given:?}: {t}");
        }
    }
    assert!(met > 300 && within > 100, "{met}, {within}");
}

#[test]
fn weights_of_a_triangle_give_back_the_point() {
    let mut rng = Rng::with_seed(3);
    for _ in 0..2000 {
        let (origin, way) = (around(&mut rng, 3.0), direction(&mut rng));
        let corners: [DVec3; 3] = std::array::from_fn(|_| around(&mut rng, 3.0));
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        if normal.normalize_or_zero().dot(way).abs() < 0.02 {
            continue;
        }
        let ray = numbers(&[origin, way]);
        let corner_numbers = numbers(&corners);
        let found = solved("triangle", &[&ray[..], &corner_numbers].concat());
        let point = origin + found[0] * way;
        let from_weights: DVec3 = (0..3).map(|i| found[1 + i] * corners[i]).sum();
        let size = 1.0 + found[0].abs();
        assert!(point.distance(from_weights) < 1e-10 * size, "{found:?}");
        assert!((found[1] + found[2] + found[3] - 1.0).abs() < 1e-12 * size);
        // The same ray, its axes turned and sheared in each of the three ways.
        for turn in 0..3 {
            let turned: [f64; 3] = std::array::from_fn(|i| way[(i + turn) % 3]);
            if turned[2].abs() < 0.1 {
                continue;
            }
            let shear = [
                turned[0] / turned[2],
                turned[1] / turned[2],
                1.0 / turned[2],
            ];
            let ray = [&origin.to_array()[..], &[turn as f64], &shear].concat();
            let again = solved("sheared triangle", &[ray, corner_numbers.clone()].concat());
            for (a, b) in found.iter().zip(&again) {
                assert!((a - b).abs() < 1e-10 * size, "{found:?}, {again:?}");
            }
        }
    }
    let flat = [
        0.0, 0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 2.0, 0.0, 0.0,
    ];
    assert!(solved("triangle", &flat).iter().all(|x| x.is_nan()));
}

#[test]
fn what_is_reflected_at_a_surface_obeys_stokes_and_brewster() {
    let reflectance = |cosine: f64, index: f64| solved("fresnel", &[cosine, index])[0];
    for index in [0.4, 0.75, 1.0, 1.333, 2.5] {
        let straight = ((index - 1.0) / (index + 1.0_f64)).powi(2);
        assert!(
            (reflectance(1.0, index) - straight).abs() < 1e-12,
            "{index}"
        );
        for step in 1..100 {
            let incidence = f64::from(step) * 0.0157;
            let found = reflectance(incidence.cos(), index);
            assert!(
                (0.0..=1.0).contains(&found),
                "{incidence}, {index}: {found}"
            );
            let sine = incidence.sin() / index;
            if sine >= 1.0 {
                assert_eq!(found, 1.0, "{incidence}, {index}");
                continue;
            }
            // Stokes: as much is reflected on the way back.
            let back = reflectance((1.0 - sine * sine).sqrt(), 1.0 / index);
            assert!(
                (found - back).abs() < 1e-9,
                "{incidence}, {index}: {found}, {back}"
            );
        }
        // At Brewster's angle only what swings across the plane of incidence is reflected.
        let brewster = index.atan();
        let across = ((1.0 - index * index) / (1.0 + index * index)).powi(2);
        let found = reflectance(brewster.cos(), index);
        assert!((found - 0.5 * across).abs() < 1e-12, "{index}: {found}");
    }
}

#[test]
fn a_pixel_s_ray_leads_back_to_the_pixel() {
    let mut rng = Rng::with_seed(4);
    for _ in 0..2000 {
        let turned = DQuat::from_axis_angle(direction(&mut rng), 3.0 * rng.f64());
        let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| turned * axis);
        let eye = around(&mut rng, 20.0);
        let focal = 100.0 + 900.0 * rng.f64();
        let mut camera = numbers(&[eye, axes[0], axes[1], axes[2]]);
        camera.extend([focal, 640.0, 360.0, 0.1, 640.0, 360.0]);
        let pixel = [900.0 * rng.f64() - 100.0, 500.0 * rng.f64() - 50.0];
        let ray = solved("camera ray", &[&camera[..], &pixel].concat());
        assert_eq!(ray[..3], eye.to_array());
        let way = DVec3::new(ray[3], ray[4], ray[5]);
        assert!((way.length() - 1.0).abs() < 1e-12);
        let t = 0.5 + 50.0 * rng.f64();
        let point = (eye + t * way).to_array();
        let back = solved("camera pixel", &[&camera[..], &point].concat());
        let depth = t * way.dot(axes[2]);
        for (found, right) in back.iter().zip([pixel[0], pixel[1], depth]) {
            assert!((found - right).abs() < 1e-8, "{back:?}, {pixel:?}, {depth}");
        }
        let behind = (eye - t * way).to_array();
        let behind = solved("camera pixel", &[&camera[..], &behind].concat());
        assert!(behind.iter().all(|x| x.is_nan()));
    }
}

/// Functions as someone may write them, and the same with a mistake.
const WRITTEN: &[(&str, &str, &str)] = &[
    (
        "// A plane.
//
// domain: meets(o -9 to 9 linear, d unit, n unit, k -5 to 5 linear) against plane

fn meets(o: vec3f, d: vec3f, n: vec3f, k: f32) -> f32 {
    return (k - dot(n, o)) / dot(n, d);
}
",
        "(k - dot(n, o))",
        "(k + dot(n, o))",
    ),
    (
        "// A ball that the ray starts in.
//
// domain: meets(o -1 to 1 linear, d unit, c -1 to 1 linear, r 4 to 9) against sphere

fn meets(o: vec3f, d: vec3f, c: vec3f, r: f32) -> f32 {
    let to = o - c;
    let a = dot(d, d);
    let b = dot(to, d);
    return (sqrt(b * b - a * (dot(to, to) - r * r)) - b) / a;
}
",
        "- b) / a",
        "+ b) / a",
    ),
    (
        "// What a surface reflects.
//
// domain: meets(c 0.01 to 1 linear, n 1.1 to 2.5) against fresnel

fn meets(c: f32, n: f32) -> f32 {
    let g = sqrt(n * n - 1.0 + c * c);
    let s = (g - c) / (g + c);
    let p = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
    return 0.5 * s * s * (1.0 + p * p);
}
",
        "(1.0 + p * p)",
        "(1.0 - p * p)",
    ),
    (
        "// A triangle that is far from its edge on, by Cramer's rule (Möller, Trumbore 1997).
//
// domain: meets(o is 0.5 0.25 3, d unit, a is 1 0 0, b is 0 1 0, c is 0 0 0.25) against triangle

fn meets(o: vec3f, d: vec3f, a: vec3f, b: vec3f, c: vec3f) -> vec4f {
    let p = cross(d, c - a);
    let t = o - a;
    let q = cross(t, b - a);
    let uvt = vec3f(dot(t, p), dot(d, q), dot(c - a, q)) / dot(b - a, p);
    return vec4f(uvt.z, 1.0 - uvt.x - uvt.y, uvt.xy);
}
",
        "cross(t, b - a)",
        "cross(b - a, t)",
    ),
];

fn assayed(text: &str) -> Findings {
    let composer = composer(&[("mine/meets", text)]);
    let (all, report) = declared(composer.library());
    assert!(report.0.is_empty(), "{report}");
    let own = all.iter().find(|d| d.module == "mine/meets");
    let effort = Effort {
        random: 2000,
        special: 0,
        climb: 0,
        ..Effort::default()
    };
    let own = own.expect("declared");
    let assay = Assay::run(&composer, &all, own, &Host::default(), &[], &effort);
    assay.unwrap_or_else(|e| panic!("{e}")).found
}

#[test]
fn other_formulas_agree_and_mistakes_are_found() {
    for (text, right, wrong) in WRITTEN {
        let found = assayed(text).method_scaled.expect("a truth");
        assert!(found.p99 < 1e-3, "{text}: {found:?}");
        assert!(text.contains(right), "{text}");
        let mistaken = assayed(&text.replace(right, wrong));
        let mistaken = mistaken.method_scaled.expect("a truth");
        assert!(mistaken.median > 1e4, "{text}: {mistaken:?}");
    }
}
