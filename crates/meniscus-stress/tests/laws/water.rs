//! Waves, where rays meet them, and light.

use glam::{DVec2, DVec3};
use meniscus_stress::{Column, Lanes};

use crate::lab::*;

const LANES: usize = 4000;

/// Height and gradient of the host's three waves, written apart from the module.
fn waves(host: &meniscus_stress::modules::Host, at: DVec2) -> (f64, DVec2) {
    let mut shape = (0.0, DVec2::ZERO);
    for (k, amplitude, phase) in [
        ((3.0, 1.0), 0.02, 0.3),
        ((-1.0, 4.0), 0.015, 1.7),
        ((5.0, -2.0), 0.008, 4.1),
    ] {
        let k = DVec2::from(k);
        let angle = k.dot(at) + phase;
        shape.0 += amplitude * angle.sin();
        shape.1 += amplitude * angle.cos() * k;
    }
    assert_eq!(host.number("waves[2].amplitude"), Some(0.008));
    shape
}

fn places(reach: f64) -> Vec<[f32; 2]> {
    let mut rng = rng();
    points(&mut rng, reach, LANES)
        .iter()
        .map(|p| [p.x as f32, p.y as f32])
        .collect()
}

#[test]
fn the_gradient_is_the_slope_of_the_height() {
    let lab = Lab::of("water/wave_sum");
    let places = places(50.0);
    let moved = |axis: usize, step: f64| -> Lanes<f64> {
        let column = |i: usize| {
            let by = if i == axis { step } else { 0.0 };
            Column::Float(places.iter().map(|p| f64::from(p[i]) + by).collect())
        };
        lab.call(
            "surface",
            &[Lanes {
                columns: vec![column(0), column(1)],
            }],
        )
    };
    let here = moved(0, 0.0);
    let step = 1e-3;
    for axis in 0..2 {
        let (after, before) = (moved(axis, step), moved(axis, -step));
        for lane in 0..LANES {
            let slope = (number(&after, 0, lane) - number(&before, 0, lane)) / (2.0 * step);
            assert!((slope - number(&here, 1 + axis, lane)).abs() < 2e-5);
            // The second derivatives are xx, xy and yy.
            for along in 0..2 {
                let change = number(&after, 1 + along, lane) - number(&before, 1 + along, lane);
                let bend = number(&here, 3 + axis + along, lane);
                assert!(
                    (change / (2.0 * step) - bend).abs() < 2e-5,
                    "{change} {bend}"
                );
            }
        }
    }
}

#[test]
fn waves_stay_within_the_sum_of_their_amplitudes_and_are_where_they_should_be() {
    let lab = Lab::of("water/wave_sum");
    let places = places(50.0);
    let found: Lanes<f32> = lab.call("surface", &[Lanes::vectors(&places)]);
    for (lane, place) in places.iter().enumerate() {
        let height = number(&found, 0, lane);
        assert!(height.abs() <= 0.043 + 1e-6);
        let (right, gradient) = waves(
            &lab.host,
            DVec2::new(f64::from(place[0]), f64::from(place[1])),
        );
        // The phase k · x is a float of up to 350 radians.
        assert!((height - right).abs() < 3e-6, "{height} {right}");
        let slope = DVec2::new(number(&found, 1, lane), number(&found, 2, lane));
        assert!((slope - gradient).length() < 2e-5);
    }
}

#[test]
fn the_normal_is_unit_upwards_and_perpendicular_to_the_slope() {
    let lab = Lab::of("water/shape");
    let slopes = places(5.0);
    let bend = Lanes::vectors(&vec![[0.0f32; 3]; LANES]);
    let height = scalars::<f32>(&vec![0.3; LANES]);
    let shape = structure(&[height, Lanes::vectors(&slopes), bend]);
    let found = lab.call("shape_normal", &[shape]);
    for (lane, [x, y]) in slopes.iter().enumerate() {
        let n = vec3(&found, 0, lane);
        assert!((n.length() - 1.0).abs() < 2e-7 && n.z > 0.0);
        assert!(n.dot(DVec3::new(1.0, 0.0, f64::from(*x))).abs() < 1e-6);
        assert!(n.dot(DVec3::new(0.0, 1.0, f64::from(*y))).abs() < 1e-6);
    }
}

/// Rays from above or below the waves, some flat.
fn rays(above: bool) -> (Vec<DVec3>, Vec<DVec3>) {
    let mut rng = rng();
    let side = if above { 1.0 } else { -1.0 };
    let origin = points(&mut rng, 4.0, LANES);
    let origin = origin.iter().map(|p| {
        DVec3::new(p.x, p.y, side * (0.08 + p.z.abs() / 3.0))
            .as_vec3()
            .as_dvec3()
    });
    let direction = (0..LANES).map(|_| {
        let v = unit(&mut rng);
        let fall = 0.03 + v.z.abs();
        DVec3::new(v.x, v.y, -side * fall)
            .normalize()
            .as_vec3()
            .as_dvec3()
    });
    (origin.collect(), direction.collect())
}

#[test]
fn the_plane_is_met_on_the_plane_and_on_the_ray() {
    for above in [true, false] {
        let lab = Lab::of("slots/meet").water(1.333, above);
        let (origin, direction) = rays(above);
        let found: Lanes<f32> = lab.call(
            "meet",
            &[structure(&[vectors(&origin), vectors(&direction)])],
        );
        for lane in 0..LANES {
            let point = vec3(&found, 0, lane);
            let way = origin[lane].z / -direction[lane].z;
            assert_eq!(number(&found, 6, lane), 1.0);
            assert!((point - (origin[lane] + way * direction[lane])).length() < 3e-7 * (5.0 + way));
            assert!(point.z.abs() < 3e-7 * (5.0 + way));
        }
        let away: Vec<DVec3> = direction.iter().map(|d| -*d).collect();
        let found: Lanes<f32> = lab.call("meet", &[structure(&[vectors(&origin), vectors(&away)])]);
        assert!((0..LANES).all(|lane| number(&found, 6, lane) == 0.0));
        let level: Vec<DVec3> = direction
            .iter()
            .map(|d| DVec3::new(d.x, d.y, 0.0))
            .collect();
        let found: Lanes<f32> =
            lab.call("meet", &[structure(&[vectors(&origin), vectors(&level)])]);
        assert!((0..LANES).all(|lane| number(&found, 6, lane) == 0.0));
        assert!((0..LANES).all(|lane| vec3(&found, 0, lane).is_finite()));
    }
}

#[test]
fn waves_are_met_on_their_surface_and_not_earlier() {
    let composer = composer(&[]);
    for above in [true, false] {
        let slots = choice(&[("surface", "water/wave_sum")]);
        let lab = Lab::with(&composer, "water/displaced_surface", &slots).water(1.333, above);
        let (origin, direction) = rays(above);
        let found: Lanes<f32> = lab.call(
            "meet",
            &[structure(&[vectors(&origin), vectors(&direction)])],
        );
        let side = if above { 1.0 } else { -1.0 };
        let mut met = 0;
        for lane in 0..LANES {
            if number(&found, 6, lane) == 0.0 {
                continue;
            }
            met += 1;
            let point = vec3(&found, 0, lane);
            let way = (point - origin[lane]).length();
            let (height, gradient) = waves(&lab.host, point.truncate());
            assert!(
                (point.z - height).abs() < 1e-5 * (1.0 + way),
                "{} off",
                point.z - height
            );
            let normal = DVec3::new(-gradient.x, -gradient.y, 1.0).normalize();
            assert!((vec3(&found, 3, lane) - normal).length() < 1e-4 * (1.0 + way));
            // Nothing in between, as far as points 1,000 times as dense can tell.
            let apart = |t: f64| {
                let at = origin[lane] + t * direction[lane];
                side * (at.z - waves(&lab.host, at.truncate()).0)
            };
            let crossed =
                (0..1000).find(|i| apart(way * f64::from(*i) / 1000.0 * (1.0 - 1e-3)) < -1e-5);
            assert_eq!(
                crossed, None,
                "lane {lane}: {} towards {}",
                origin[lane], direction[lane]
            );
        }
        assert!(met > LANES * 99 / 100, "{met}");
    }
}

fn surface_points(lab: &Lab, facing: f64, normals: &[DVec3]) -> Lanes<f32> {
    let function = lab.specimen.function("shade").expect("a function");
    let (_, shape) = function.arguments().next().expect("a point");
    let mut points = Lanes::<f32>::zeros(shape, normals.len());
    for (leaf, (path, _)) in shape.leaves().iter().enumerate() {
        let Column::Float(column) = &mut points.columns[leaf] else {
            continue;
        };
        let axis = ["x", "y", "z"].iter().position(|axis| path.ends_with(axis));
        match (path.split('.').nth(1), axis) {
            (Some("normal" | "geometric_normal"), Some(axis)) => {
                *column = normals.iter().map(|n| n[axis] as f32).collect();
            }
            (Some("facing"), _) => column.fill(facing as f32),
            (Some("position"), _) => column.fill(0.1),
            _ => {}
        }
    }
    points
}

#[test]
fn diffuse_shading_is_linear_in_light_and_has_two_faces() {
    let mut rng = rng();
    let normals = units(&mut rng, LANES);
    let turned: Vec<DVec3> = normals.iter().map(|n| -*n).collect();
    let mut lab = Lab::of("shading/diffuse");
    let bright = lab.call("shade", &[surface_points(&lab, 1.0, &normals)]);
    let inside = lab.call("shade", &[surface_points(&lab, -1.0, &turned)]);
    assert_eq!(
        bright, inside,
        "from inside, the outside's opposite faces the eye"
    );
    let mut share = |sun: f64, sky: f64| {
        lab.host
            .set("light.sun_colour", &[0.8, 0.75, 0.6].map(|c| c * sun))
            .expect("a colour");
        lab.host
            .set("light.ambient", &[0.2, 0.25, 0.3].map(|c| c * sky))
            .expect("a colour");
        lab.call("shade", &[surface_points(&lab, 1.0, &normals)])
    };
    let (sun, sky, double) = (share(1.0, 0.0), share(0.0, 1.0), share(2.0, 2.0));
    for (lane, normal) in normals.iter().enumerate() {
        let whole = vec3(&bright, 0, lane);
        assert!((vec3(&sun, 0, lane) + vec3(&sky, 0, lane) - whole).length() < 3e-7);
        assert!((vec3(&double, 0, lane) - 2.0 * whole).length() < 6e-7);
        assert!(whole.min_element() >= 0.0, "no negative light");
        // A surface of albedo ½ gives off at most half of what could come in at all.
        assert!(whole.cmple(0.5 * DVec3::new(1.0, 1.0, 0.9) + 1e-6).all());
        let dark = normal.dot(DVec3::new(0.36, 0.48, 0.8)) <= 0.0;
        assert!(
            !dark || vec3(&sun, 0, lane) == DVec3::ZERO,
            "the sun is behind the surface"
        );
    }
}

#[test]
fn the_sky_goes_from_horizon_to_zenith_and_rays_below_see_the_deep() {
    let lab = Lab::of("sky/gradient");
    let directions = [DVec3::X, DVec3::Z, -DVec3::Z, DVec3::new(0.8, 0.0, 0.6)];
    let found: Lanes<f32> = lab.call("sky_colour", &[vectors(&directions)]);
    let (horizon, zenith) = (DVec3::new(0.7, 0.8, 0.9), DVec3::new(0.2, 0.4, 0.8));
    let rights = [
        horizon,
        zenith,
        DVec3::new(0.0, 0.02, 0.05),
        horizon.lerp(zenith, 0.6),
    ];
    for (lane, right) in rights.into_iter().enumerate() {
        assert!((vec3(&found, 0, lane) - right).length() < 2e-7);
    }
}
