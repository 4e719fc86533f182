//! The camera, and what is fetched from seen buffers.

use glam::{DVec2, DVec3};
use meniscus_stress::{Lanes, Scalar};

use crate::lab::*;

const LANES: usize = 10_000;

/// Cameras that look anywhere, as columns of a `View`, and points before them.
struct Cameras {
    eye: Vec<DVec3>,
    axes: Vec<[DVec3; 3]>,
    focal: Vec<f64>,
    near: Vec<f64>,
}

const SIZE: [f64; 2] = [640.0, 360.0];

impl Cameras {
    fn new() -> Self {
        let mut rng = rng();
        let eye = points(&mut rng, 10.0, LANES);
        let axes = (0..LANES).map(|_| {
            loop {
                let forward = unit(&mut rng);
                let right = forward.cross(unit(&mut rng));
                if right.length() > 0.1 {
                    let right = right.normalize();
                    break [right, right.cross(forward), forward];
                }
            }
        });
        let axes = axes.collect();
        let focal = decades(&mut rng, 50.0, 5000.0, LANES);
        let near = decades(&mut rng, 1e-3, 1.0, LANES);
        Self {
            eye,
            axes,
            focal,
            near,
        }
    }

    fn view<S: Scalar>(&self) -> Lanes<S> {
        let axis = |i: usize| vectors(&self.axes.iter().map(|a| a[i]).collect::<Vec<_>>());
        let size = || Lanes::vectors(&vec![SIZE.map(|s| s as f32); LANES]);
        structure(&[
            vectors(&self.eye),
            axis(0),
            axis(1),
            axis(2),
            scalars(&self.focal),
            size(),
            scalars(&self.near),
            size(),
        ])
    }

    fn pixels(&self) -> Vec<[f32; 2]> {
        let mut rng = rng();
        (0..LANES)
            .map(|_| [640.0 * rng.f32(), 360.0 * rng.f32()])
            .collect()
    }
}

#[test]
fn points_along_a_pixels_ray_appear_at_the_pixel() {
    let (lab, cameras) = (Lab::of("screen/camera"), Cameras::new());
    let pixels = cameras.pixels();
    let ray: Lanes<f64> = lab.call("view_ray", &[cameras.view(), Lanes::vectors(&pixels)]);
    let mut rng = rng();
    let way = decades(&mut rng, 0.1, 1e4, LANES);
    let at = |lane: usize| vec3(&ray, 0, lane) + way[lane] * vec3(&ray, 3, lane);
    // In f64, so that what is tested is the law and not the rounding of the points.
    let axis = |i: usize| (0..LANES).map(|lane| at(lane)[i]).collect::<Vec<f64>>();
    let columns = (0..3).map(|i| meniscus_stress::Column::Float(axis(i)));
    let points = Lanes {
        columns: columns.collect(),
    };
    let found = lab.call("view_pixel", &[cameras.view(), points]);
    for (lane, pixel) in pixels.iter().enumerate() {
        for (axis, x) in pixel.iter().enumerate() {
            let error = (number(&found, axis, lane) - f64::from(*x)).abs();
            // The axes are floats: perpendicular to about 1e-7.
            assert!(
                error < 1e-3 * (1.0 + cameras.focal[lane] / 1000.0),
                "{error}"
            );
        }
        let depth = (at(lane) - cameras.eye[lane]).dot(cameras.axes[lane][2]);
        assert!((number(&found, 2, lane) / depth - 1.0).abs() < 1e-5);
        assert!((vec3(&ray, 3, lane).length() - 1.0).abs() < 1e-12);
    }
}

#[test]
fn clip_space_and_pixels_agree_and_depth_is_reversed() {
    let (lab, cameras) = (Lab::of("screen/camera"), Cameras::new());
    let mut rng = rng();
    let depth = decades(&mut rng, 0.1, 1e3, LANES);
    let points: Vec<DVec3> = (0..LANES)
        .map(|lane| {
            let [right, up, forward] = cameras.axes[lane];
            let mut off = || 2.0 * rng.f64() - 1.0;
            cameras.eye[lane] + depth[lane] * (forward + off() * right + off() * up)
        })
        .collect();
    let pixel: Lanes<f64> = lab.call("view_pixel", &[cameras.view(), vectors(&points)]);
    let clip: Lanes<f64> = lab.call("view_clip", &[cameras.view(), vectors(&points)]);
    for lane in 0..LANES {
        let [x, y, z, w] = [0, 1, 2, 3].map(|i| number(&clip, i, lane));
        let across = SIZE[0] * (0.5 + 0.5 * x / w);
        let down = SIZE[1] * (0.5 - 0.5 * y / w);
        let scale = 1e-9 * cameras.focal[lane];
        assert!((across - number(&pixel, 0, lane)).abs() < scale);
        assert!((down - number(&pixel, 1, lane)).abs() < scale);
        assert!((w / number(&pixel, 2, lane) - 1.0).abs() < 1e-12);
        assert_eq!(z, cameras.near[lane], "reversed: near / distance");
    }
    for (share, nearer) in [(0.5, 1.0), (2.0, 0.0)] {
        let drawn: Vec<f64> = (0..LANES)
            .map(|l| cameras.near[l] / number(&pixel, 2, l) * share)
            .collect();
        let found: Lanes<f32> = lab.call(
            "view_is_nearer",
            &[cameras.view(), vectors(&points), scalars(&drawn)],
        );
        assert!((0..LANES).all(|lane| number(&found, 0, lane) == nearer));
    }
}

#[test]
fn points_behind_the_eye_have_finite_pixels() {
    let (lab, cameras) = (Lab::of("screen/camera"), Cameras::new());
    let behind: Vec<DVec3> = (0..LANES)
        .map(|l| cameras.eye[l] - cameras.axes[l][2] * (l % 7) as f64)
        .collect();
    let found: Lanes<f32> = lab.call("view_pixel", &[cameras.view(), vectors(&behind)]);
    assert!((0..LANES).all(|lane| vec3(&found, 0, lane).is_finite()));
}

#[test]
fn neighbours_are_the_24_texels_around_nearest_first() {
    let lab = Lab::of("screen/neighbours");
    let indices = Lanes::<f32> {
        columns: vec![meniscus_stress::Column::Sint((0..24).collect())],
    };
    let found = lab.call("neighbour", &[indices]);
    let steps: Vec<(i64, i64)> = (0..24)
        .map(|i| (number(&found, 0, i) as i64, number(&found, 1, i) as i64))
        .collect();
    let mut distinct = steps.clone();
    distinct.sort_unstable();
    distinct.dedup();
    assert_eq!(distinct.len(), 24);
    assert!(
        steps
            .iter()
            .all(|(x, y)| (x.abs().max(y.abs())) <= 2 && (*x, *y) != (0, 0))
    );
    let squares: Vec<i64> = steps.iter().map(|(x, y)| x * x + y * y).collect();
    assert!(squares.is_sorted(), "{squares:?}");
}

#[test]
fn the_residual_is_the_distance_from_the_ray_in_pixels() {
    let lab = Lab::of("screen/residual");
    let mut rng = rng();
    let (origin, direction) = (points(&mut rng, 3.0, LANES), units(&mut rng, LANES));
    let along = within(&mut rng, 0.1, 10.0, LANES);
    let off = decades(&mut rng, 1e-4, 1.0, LANES);
    let (mut on, mut beside) = (Vec::new(), Vec::new());
    for lane in 0..LANES {
        let point = origin[lane] + along[lane] * direction[lane];
        on.push(point);
        let across = direction[lane].any_orthonormal_vector();
        beside.push(point + off[lane] * across);
    }
    let ray = || structure(&[vectors(&origin), vectors(&direction)]);
    let none: Lanes<f32> = lab.call("residual_px", &[ray(), vectors(&on)]);
    let some: Lanes<f32> = lab.call("residual_px", &[ray(), vectors(&beside)]);
    let eye = DVec3::new(0.3, -4.0, 1.7);
    for lane in 0..LANES {
        let reach = (origin[lane] - eye).length() + along[lane] / 1.333;
        let pixel = reach / 500.0;
        assert!(number(&none, 0, lane) * pixel < 1e-5);
        let apart = number(&some, 0, lane) * pixel;
        assert!(
            (apart - off[lane]).abs() < 1e-5 + 1e-4 * off[lane],
            "{apart} {}",
            off[lane]
        );
    }
}

#[test]
fn only_texels_of_the_seen_buffers_are_seen() {
    let lab = Lab::of("screen/residual");
    let places = [
        [0.0, 0.0],
        [671.9, 391.9],
        [-0.1, 5.0],
        [5.0, -0.1],
        [672.0, 5.0],
        [5.0, 392.0],
    ];
    let found: Lanes<f32> = lab.call("is_seen", &[Lanes::vectors(&places)]);
    let seen: Vec<f64> = (0..6).map(|lane| number(&found, 0, lane)).collect();
    assert_eq!(seen, [1.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
}

/// Texels that hold their own place (x + ½, y + ½, slope · x), of one object left of a column and of
/// another right of it.
fn places(border: usize) -> Vec<[f32; 4]> {
    let texel = |i: usize| {
        let (x, y) = ((i % 16) as f32 + 0.5, (i / 16) as f32 + 0.5);
        [
            x,
            y,
            -1.0 - 0.25 * x,
            if i % 16 < border { 3.0 } else { 8.0 },
        ]
    };
    (0..256).map(texel).collect()
}

/// As many neighbours as there are to ask, in every lane.
fn neighbours(lanes: usize) -> Lanes<f32> {
    Lanes {
        columns: vec![meniscus_stress::Column::Sint(vec![24; lanes])],
    }
}

#[test]
fn positions_between_texels_of_one_object_are_those_of_the_plane() {
    let mut lab = Lab::of("screen/seen");
    lab.host.texture("seen_position", [16, 16], &places(16));
    lab.host.texture("seen_normal", [16, 16], &[[0.0; 4]; 256]);
    let mut rng = rng();
    let texels: Vec<[f32; 2]> = (0..LANES)
        .map(|_| [0.5 + 15.0 * rng.f32(), 0.5 + 15.0 * rng.f32()])
        .collect();
    let found: Lanes<f32> = lab.call(
        "seen_at",
        &[Lanes::vectors(&texels), neighbours(texels.len())],
    );
    let leaf = |path: &str| lab.leaf("seen_at", path);
    for (lane, [x, y]) in texels.iter().enumerate() {
        let position = vec3(&found, leaf(".position.x"), lane);
        let right = DVec3::new(f64::from(*x), f64::from(*y), -1.0 - 0.25 * f64::from(*x));
        assert!(
            (position - right).length() < 5e-6,
            "{position} is not {right}"
        );
        assert_eq!(vec3(&found, leaf(".normal.x"), lane), DVec3::Z);
        assert_eq!(number(&found, leaf(".object"), lane), 3.0);
    }
}

#[test]
fn positions_do_not_mix_objects() {
    let mut lab = Lab::of("screen/seen");
    lab.host.texture("seen_position", [16, 16], &places(8));
    lab.host.texture("seen_normal", [16, 16], &[[0.0; 4]; 256]);
    let mut rng = rng();
    let texels: Vec<[f32; 2]> = (0..LANES)
        .map(|_| [7.0 + 2.0 * rng.f32(), 0.5 + 15.0 * rng.f32()])
        .collect();
    let found: Lanes<f32> = lab.call(
        "seen_at",
        &[Lanes::vectors(&texels), neighbours(texels.len())],
    );
    let (position, object) = (
        lab.leaf("seen_at", ".position.x"),
        lab.leaf("seen_at", ".object"),
    );
    for (lane, [x, _]) in texels.iter().enumerate() {
        let at = number(&found, position, lane);
        if *x < 8.0 {
            assert_eq!(number(&found, object, lane), 3.0);
            assert!(at <= 7.5 + 1e-5, "{at}");
        } else {
            assert_eq!(number(&found, object, lane), 8.0);
            assert!(at >= 8.5 - 1e-5, "{at}");
        }
    }
}

#[test]
fn a_plane_is_met_where_flat_water_bends_the_pixels_ray_to() {
    for (index, above) in [(1.333, true), (2.5, true), (1.0, true)] {
        let slots = choice(&[("deflect", "optics/refracted_ray")]);
        let mut lab = Lab::with(&composer(&[]), "screen/seen_planes", &slots).water(index, above);
        let eye = DVec3::new(0.3, -4.0, 1.7);
        // The floor z = −2: its distance from the eye along the normal (0, 0, 1).
        let distance = (-2.0 - eye.z) as f32;
        lab.host.texture_of_words(
            "seen_plane",
            [16, 16],
            &[[distance.to_bits(), 0, 0, 4]; 256],
        );
        let mut rng = rng();
        // Below the horizon.
        let texels: Vec<[f32; 2]> = (0..LANES)
            .map(|_| [672.0 * rng.f32(), 80.0 + 312.0 * rng.f32()])
            .collect();
        let found: Lanes<f32> = lab.call("seen", &[Lanes::vectors(&texels)]);
        let leaf = |path: &str| lab.leaf("seen", path);
        for (lane, [x, y]) in texels.iter().enumerate() {
            let position = vec3(&found, leaf(".position.x"), lane);
            assert!((position.z + 2.0).abs() < 1e-5, "{position}");
            assert_eq!(number(&found, leaf(".object"), lane), 3.0);
            let centred = DVec2::new(f64::from(*x) - 336.0, f64::from(*y) - 196.0) / 500.0;
            let ray = DVec3::new(0.0, 0.8, -0.6) + DVec3::X * centred.x
                - DVec3::new(0.0, 0.6, 0.8) * centred.y;
            let ray = ray.normalize();
            let crossing = eye + ray * (eye.z / -ray.z);
            let sine = ray.truncate() / index;
            let bent = sine / (1.0 - sine.length_squared()).sqrt();
            let right = crossing.truncate() + 2.0 * bent;
            let scale = 1e-5 * (1.0 + crossing.length() / -ray.z);
            assert!(
                (position.truncate() - right).length() < scale,
                "{position} is not {right}"
            );
        }
    }
}

#[test]
fn what_is_shown_is_fetched_with_the_weights_of_the_colour() {
    let mut lab = Lab::of("screen/resampled");
    let border = 8;
    let shown = places(border);
    let colours: Vec<[f32; 4]> = shown.iter().map(|t| [t[0], t[1], t[2], 1.0]).collect();
    lab.host.texture("seen_colour", [16, 16], &colours);
    lab.host.texture("shown_of_seen_colour", [16, 16], &shown);
    let mut rng = rng();
    let texels: Vec<[f32; 2]> = (0..LANES)
        .map(|_| [0.5 + 15.0 * rng.f32(), 0.5 + 15.0 * rng.f32()])
        .collect();
    let function = lab.specimen.function("shown").expect("a function");
    let (_, hit) = function.arguments().next().expect("a hit");
    let mut hits = Lanes::<f32>::zeros(hit, LANES);
    for (leaf, (path, _)) in hit.leaves().iter().enumerate() {
        let column = &mut hits.columns[leaf];
        match (path.as_str(), column) {
            (".texel.x", meniscus_stress::Column::Float(c)) => {
                *c = texels.iter().map(|t| t[0]).collect()
            }
            (".texel.y", meniscus_stress::Column::Float(c)) => {
                *c = texels.iter().map(|t| t[1]).collect()
            }
            (".found", meniscus_stress::Column::Bool(c)) => c.fill(true),
            _ => {}
        }
    }
    let ray = || {
        structure(&[
            vectors(&vec![DVec3::ZERO; LANES]),
            vectors(&vec![DVec3::Z; LANES]),
        ])
    };
    let colour = lab.call("colour", &[hits.clone(), ray()]);
    let shown = lab.call("shown", &[hits, ray()]);
    for (lane, [x, _]) in texels.iter().enumerate() {
        let mixed = (*x - border as f32).abs() < 0.5;
        if mixed {
            // Two objects: the nearest texel's point, and never one between.
            let at = number(&shown, 0, lane);
            assert_eq!(at.fract(), 0.5, "{at}");
            assert_eq!(
                number(&shown, 3, lane),
                if *x < border as f32 { 3.0 } else { 8.0 }
            );
        } else {
            let apart = (vec3(&shown, 0, lane) - vec3(&colour, 0, lane)).length();
            assert!(apart < 1e-5, "{apart}");
        }
    }
}

/// How many of many rays from the water to a level `end` are taken to be hidden where all that is
/// seen lies at a level `seen`.
fn hidden(seen: f32, end: f64) -> usize {
    let mut lab = Lab::of("screen/hidden").water(1.333, true);
    let [width, height] = [672_u32, 392];
    let texels = vec![[seen, 0.0, 0.0, 0.0]; (width * height) as usize];
    lab.host.texture("seen_height", [width, height], &texels);
    let eye = DVec3::new(0.3, -4.0, 1.7);
    let mut rng = rng();
    let (mut origins, mut directions, mut ends, mut places) = (vec![], vec![], vec![], vec![]);
    while origins.len() < LANES {
        let centred = DVec2::new(600.0 * rng.f64() - 300.0, 300.0 * rng.f64() - 100.0) / 500.0;
        let ray = DVec3::new(0.0, 0.8, -0.6) + DVec3::X * centred.x
            - DVec3::new(0.0, 0.6, 0.8) * centred.y;
        let ray = ray.normalize();
        let origin = eye + ray * (eye.z / -ray.z);
        // Any way down that refraction by waves could take.
        let tilt = DVec2::new(rng.f64() - 0.5, rng.f64() - 0.5);
        let direction = (ray.truncate() / 1.333 + 0.4 * tilt)
            .extend(-0.8)
            .normalize();
        origins.push(origin);
        directions.push(direction);
        ends.push(origin + direction * (end / direction.z));
        let centred = centred * DVec2::new(500.0, 500.0);
        places.push([336.0 + centred.x as f32, 196.0 + centred.y as f32]);
    }
    let projected: Lanes<f32> = Lab::of("screen/through_flat_water")
        .water(1.333, true)
        .call("reproject", &[vectors(&ends)]);
    let function = lab.specimen.function("occluded").expect("a function");
    let (_, hit) = function.arguments().nth(1).expect("a hit");
    let mut hits = Lanes::<f32>::zeros(hit, LANES);
    for (leaf, (path, _)) in hit.leaves().iter().enumerate() {
        let values: Option<Vec<f32>> = match path.as_str() {
            ".texel.x" => Some(
                (0..LANES)
                    .map(|i| number(&projected, 0, i) as f32)
                    .collect(),
            ),
            ".texel.y" => Some(
                (0..LANES)
                    .map(|i| number(&projected, 1, i) as f32)
                    .collect(),
            ),
            ".position.x" => Some(ends.iter().map(|p| p.x as f32).collect()),
            ".position.y" => Some(ends.iter().map(|p| p.y as f32).collect()),
            ".position.z" => Some(ends.iter().map(|p| p.z as f32).collect()),
            _ => None,
        };
        match (&mut hits.columns[leaf], values) {
            (meniscus_stress::Column::Float(column), Some(values)) => *column = values,
            (meniscus_stress::Column::Bool(found), _) => found.fill(true),
            _ => {}
        }
    }
    let rays = structure(&[vectors(&origins), vectors(&directions)]);
    let found: Lanes<f32> = lab.call("occluded", &[rays, hits, Lanes::vectors(&places)]);
    match &found.columns[0] {
        meniscus_stress::Column::Bool(hidden) => hidden.iter().filter(|hidden| **hidden).count(),
        _ => panic!("a truth value is expected"),
    }
}

#[test]
fn only_what_lies_deeper_than_all_that_is_seen_may_be_hidden() {
    // The floor, on which the rays end; and where nothing was drawn.
    assert_eq!(hidden(-2.0, -2.0), 0);
    assert_eq!(hidden(0.0, -2.0), 0);
    // What is deeper than the end of the way cannot stand before it.
    assert_eq!(hidden(-3.0, -2.0), 0);
    // Under a ceiling that is seen everywhere, every way passes, unless it is a pixel long.
    assert!(hidden(-1.0, -2.0) > LANES * 9 / 10);
}
