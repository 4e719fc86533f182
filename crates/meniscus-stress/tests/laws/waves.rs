//! Waves that displace the surface: where rays meet them, first and again.

use glam::DVec3;
use meniscus_stress::modules::{Choice, Host, truth};
use meniscus_stress::{Column, Dual, Lanes, Scalar};

use crate::lab::*;

const LANES: usize = 2000;

fn lab(path: &str) -> Lab {
    Lab::with(&composer(&[]), path, &Choice::of_waves())
}

/// The host's waves with another amplitude, `scale` times as large, seen from one side.
fn set_waves(host: &mut Host, scale: f64) {
    for (index, amplitude) in [0.02, 0.015, 0.008].into_iter().enumerate() {
        let path = format!("waves[{index}].amplitude");
        host.set(&path, &[scale * amplitude]).expect("an amplitude");
    }
    for (bound, value) in [
        ("height_bound", 0.06),
        ("slope_bound", 0.2),
        ("curvature_bound", 1.2),
    ] {
        let path = format!("water.{bound}");
        host.set(&path, &[scale * value]).expect("a bound");
    }
}

/// Rays from up to 4 m above or under the waves that come down on them, or up; some skim them.
fn rays(above: bool, least_fall: f64) -> (Vec<DVec3>, Vec<DVec3>) {
    let mut rng = rng();
    let side = if above { 1.0 } else { -1.0 };
    let float = |v: DVec3| v.as_vec3().as_dvec3();
    let origin = points(&mut rng, 4.0, LANES);
    let origin = origin
        .iter()
        .map(|p| float(DVec3::new(p.x, p.y, side * (0.08 + p.z.abs()))));
    let direction = (0..LANES).map(|_| {
        let v = unit(&mut rng);
        float(DVec3::new(v.x, v.y, -side * (least_fall + v.z.abs())).normalize())
    });
    (origin.collect(), direction.collect())
}

fn ray<S: Scalar>(origin: &[DVec3], direction: &[DVec3]) -> Lanes<S> {
    structure(&[vectors(origin), vectors(direction)])
}

/// What `meet` and `leave` give: points, normals, and whether there are any.
fn meetings(found: &Lanes<f32>) -> (Vec<DVec3>, Vec<DVec3>, Vec<bool>) {
    let lanes = found.columns[0].len();
    let all = |first: usize| (0..lanes).map(|lane| vec3(found, first, lane)).collect();
    let met = (0..lanes).map(|lane| number(found, 6, lane) != 0.0);
    (all(0), all(3), met.collect())
}

#[test]
fn waves_are_met_where_an_independent_search_finds_them() {
    for above in [true, false] {
        let lab = lab("water/displaced_surface").water(1.333, above);
        let solve = truth("waves", &lab.host).expect("known");
        let (origin, direction) = rays(above, 0.02);
        let single: Lanes<f32> = lab.call("meet", &[ray(&origin, &direction)]);
        let double: Lanes<f64> = lab.call("meet", &[ray(&origin, &direction)]);
        let mut compared = 0;
        for lane in 0..LANES {
            let given = [origin[lane].to_array(), direction[lane].to_array()].concat();
            let right = solve(&given);
            if right[0].is_nan() {
                continue;
            }
            compared += 1;
            let (point, normal) = (
                DVec3::from_slice(&right[..3]),
                DVec3::from_slice(&right[3..]),
            );
            // Along the ray an error is magnified where it grazes the water.
            let grazing = normal.dot(direction[lane]).abs();
            let way = 1.0 + (point - origin[lane]).length();
            for (found, unit) in [
                (&vec3(&single, 0, lane), 1e-6),
                (&vec3(&double, 0, lane), 1e-8),
            ] {
                let off = (*found - point).length();
                assert!(
                    off < unit * way / grazing,
                    "{given:?}: {off} of {way}, {grazing}"
                );
            }
            assert!((vec3(&single, 3, lane) - normal).length() < 4e-6 * way / grazing);
            assert_eq!(number(&single, 6, lane), 1.0);
        }
        assert!(compared > LANES * 9 / 10, "{compared}");
    }
}

#[test]
fn a_ray_that_falls_meets_the_waves_however_little_it_falls() {
    for above in [true, false] {
        let lab = lab("water/displaced_surface").water(1.333, above);
        let side = if above { 1.0 } else { -1.0 };
        let mut rng = rng();
        let origin: Vec<DVec3> = points(&mut rng, 5.0, LANES)
            .iter()
            .map(|p| {
                DVec3::new(p.x, p.y, side * (0.07 + 0.1 * p.z.abs()))
                    .as_vec3()
                    .as_dvec3()
            })
            .collect();
        let fall = decades(&mut rng, 1e-5, 1.0, LANES);
        let way = |sign: f64| -> Vec<DVec3> {
            let tilted = |&f: &f64| DVec3::new(1.0, 0.3, -sign * side * f).normalize();
            fall.iter()
                .map(|f| tilted(f).as_vec3().as_dvec3())
                .collect()
        };
        let (points, _, met) = meetings(&lab.call("meet", &[ray(&origin, &way(1.0))]));
        assert!(met.iter().all(|&met| met));
        assert!(points.iter().all(|p| p.z.abs() <= 0.0431), "on no wave");
        let (_, _, met) = meetings(&lab.call("meet", &[ray(&origin, &way(-1.0))]));
        assert!(
            !met.contains(&true),
            "a ray that rises from above all waves meets none"
        );
    }
}

#[test]
fn waves_without_height_are_the_rest_plane() {
    for above in [true, false] {
        let (origin, direction) = rays(above, 0.001);
        let call = |path: &str, function: &str| -> Lanes<f32> {
            let mut lab = match path {
                "slots/meet" => Lab::of(path),
                _ => lab(path),
            }
            .water(1.333, above);
            set_waves(&mut lab.host, 0.0);
            lab.call(function, &[ray(&origin, &direction)])
        };
        let (waves, plane) = (
            call("water/displaced_surface", "meet"),
            call("slots/meet", "meet"),
        );
        let (points, normals, met) = meetings(&waves);
        for lane in 0..LANES {
            let right = vec3(&plane, 0, lane);
            assert!(met[lane] && normals[lane] == DVec3::Z);
            let way = (right - origin[lane]).length();
            assert!((points[lane] - right).length() < 4e-7 * (4.0 + way));
            assert_eq!(points[lane].z, 0.0);
        }
        // A ray that starts on the plane never meets it again.
        let mut again = lab("water/leaves_waves").water(1.333, above);
        set_waves(&mut again.host, 0.0);
        let on: Vec<DVec3> = origin.iter().map(|o| DVec3::new(o.x, o.y, 0.0)).collect();
        let (_, _, met) = meetings(&again.call("leave", &[ray(&on, &direction)]));
        assert!(!met.contains(&true));
    }
}

#[test]
fn mirrored_waves_are_met_by_mirrored_rays_at_mirrored_points() {
    let (origin, direction) = rays(true, 0.001);
    let mirror = |v: &DVec3| DVec3::new(-v.x, v.y, v.z);
    let mirrored = |all: &[DVec3]| -> Vec<DVec3> { all.iter().map(mirror).collect() };
    let plain = lab("water/displaced_surface");
    let mut other = lab("water/displaced_surface");
    for (index, k) in [[-3.0, 1.0], [1.0, 4.0], [-5.0, -2.0]].iter().enumerate() {
        let path = format!("waves[{index}].wave_vector");
        other.host.set(&path, k).expect("a wave vector");
    }
    let (points, normals, met) = meetings(&plain.call("meet", &[ray(&origin, &direction)]));
    let given = [ray(&mirrored(&origin), &mirrored(&direction))];
    let there = meetings(&other.call("meet", &given));
    // To the last bit: signs are all that differs.
    assert_eq!((mirrored(&points), mirrored(&normals), met), there);
}

#[test]
fn the_normal_is_that_of_the_height_s_derivatives() {
    let heights = lab("water/wave_level");
    let (origin, direction) = rays(true, 0.1);
    let surface = lab("water/displaced_surface");
    let (points, normals, _) = meetings(&surface.call("meet", &[ray(&origin, &direction)]));
    let slope = |axis: usize| -> Vec<f64> {
        let column = |of: usize| {
            let dual = |p: &DVec3| Dual::new(p[of], f64::from(u8::from(of == axis)));
            Column::Float(points.iter().map(dual).collect())
        };
        let at = Lanes {
            columns: vec![column(0), column(1)],
        };
        let level: Lanes<Dual> = heights.call("level", &[at]);
        let column = level.floats(0).expect("a height");
        column.iter().map(|level| level.slope).collect()
    };
    let (along_x, along_y) = (slope(0), slope(1));
    for lane in 0..LANES {
        let right = DVec3::new(-along_x[lane], -along_y[lane], 1.0).normalize();
        assert!(
            (normals[lane] - right).length() < 1e-5,
            "{}",
            normals[lane] - right
        );
    }
}

/// Rays that start on the waves and run nearly along them, so that many meet them again; and the
/// normals at their starts.
fn skimming() -> (Vec<DVec3>, Vec<DVec3>, Vec<DVec3>) {
    let (origin, direction) = rays(true, 0.2);
    let given = [ray(&origin, &direction)];
    let (start, normals, _) = meetings(&lab("water/displaced_surface").call("meet", &given));
    let mut rng = rng();
    let way = normals.iter().map(|n| {
        let v = unit(&mut rng);
        let level = (v - v.dot(*n) * *n).normalize();
        let tilt = 0.08 * (2.0 * rng.f64() - 1.0);
        (level + tilt * *n).normalize().as_vec3().as_dvec3()
    });
    let way = way.collect();
    (start, way, normals)
}

#[test]
fn a_ray_reversed_meets_the_point_that_it_came_from() {
    let waves = lab("water/leaves_waves");
    let (start, way, normal) = skimming();
    let (there, normals, met) = meetings(&waves.call("leave", &[ray(&start, &way)]));
    let back: Vec<DVec3> = way.iter().map(|d| -*d).collect();
    let (home, _, returned) = meetings(&waves.call("leave", &[ray(&there, &back)]));
    let mut compared = 0;
    for lane in 0..LANES {
        // A ray that touches the water at either end turns errors into ways.
        let grazing = normals[lane]
            .dot(way[lane])
            .abs()
            .min(normal[lane].dot(way[lane]).abs());
        if !met[lane] || grazing < 0.01 {
            continue;
        }
        compared += 1;
        let off = (home[lane] - start[lane]).length();
        assert!(
            returned[lane] && off < 4e-6 / grazing,
            "lane {lane}: {off}, {grazing}"
        );
    }
    assert!(compared > LANES / 10, "{compared}");
}

#[test]
fn what_lies_beyond_the_waves_is_occluded_and_what_lies_before_them_is_not() {
    let occluded = lab("water/meets_again");
    let leave = lab("water/leaves_waves");
    let (origin, direction, _) = skimming();
    let (points, _, met) = meetings(&leave.call("leave", &[ray(&origin, &direction)]));
    let far = |lane: usize| met[lane] && (points[lane] - origin[lane]).length() > 0.01;
    assert!((0..LANES).filter(|&lane| far(lane)).count() > LANES / 10);
    for (share, right) in [(0.9, 0.0), (1.1, 1.0)] {
        let function = occluded
            .specimen
            .function("occluded")
            .unwrap_or_else(|e| panic!("{e}"));
        let (_, shape) = function.arguments().nth(1).expect("a hit");
        let mut hit = Lanes::<f32>::zeros(shape, LANES);
        for (leaf, (path, _)) in shape.leaves().iter().enumerate() {
            let axis = ["x", "y", "z"].iter().position(|axis| path.ends_with(axis));
            match (&mut hit.columns[leaf], path.split('.').nth(1), axis) {
                (Column::Float(column), Some("position"), Some(axis)) => {
                    for (lane, x) in column.iter_mut().enumerate() {
                        *x = (origin[lane] + share * (points[lane] - origin[lane]))[axis] as f32;
                    }
                }
                (Column::Bool(column), ..) => column.fill(true),
                _ => {}
            }
        }
        let texel = Lanes::vectors(&vec![[0.0f32; 2]; LANES]);
        let found: Lanes<f32> = occluded.call("occluded", &[ray(&origin, &direction), hit, texel]);
        for lane in (0..LANES).filter(|&lane| far(lane)) {
            assert_eq!(number(&found, 0, lane), right, "lane {lane}");
        }
    }
}

#[test]
fn water_that_refracts_like_the_air_lets_rays_go_straight() {
    let surface = lab("water/through_surface").water(1.0, true);
    let (start, way, _) = skimming();
    let texel = Lanes::vectors(&vec![[0.0f32; 2]; LANES]);
    let found: Lanes<f32> = surface.call("intersect", &[ray(&start, &way), texel]);
    let first = surface.leaf("intersect", ".direction.x");
    let straight = |lane: &usize| (vec3(&found, first, *lane) - way[*lane]).length() < 1e-5;
    let count = (0..LANES).filter(straight).count();
    // Next to grazing even the refraction of nothing is ill conditioned.
    assert!(count > LANES * 98 / 100, "{count}");
}

#[test]
fn every_point_is_on_one_side_of_the_waves() {
    let (near, far) = (lab("water/near_side"), lab("water/far_side"));
    let level = lab("water/wave_level");
    let mut rng = rng();
    let mut points = points(&mut rng, 3.0, LANES);
    for point in &mut points {
        point.z *= 0.03;
    }
    let columns: Vec<[f32; 2]> = points.iter().map(|p| [p.x as f32, p.y as f32]).collect();
    let heights: Lanes<f32> = level.call("level", &[Lanes::vectors(&columns)]);
    let at = [vectors(&points)];
    let (near, far): (Lanes<f32>, Lanes<f32>) = (near.call("side", &at), far.call("side", &at));
    for (lane, point) in points.iter().enumerate() {
        let above = f64::from(point.z as f32) >= number(&heights, 0, lane);
        assert_eq!(number(&near, 0, lane), f64::from(u8::from(above)));
        assert_eq!(number(&far, 0, lane), f64::from(u8::from(!above)));
    }
}

#[test]
fn waves_in_storage_have_the_shape_of_those_in_the_block() {
    let mut rng = rng();
    let places: Vec<[f32; 2]> = points(&mut rng, 1e4, LANES)
        .iter()
        .map(|p| [p.x as f32, p.y as f32])
        .collect();
    let call = |path: &str| -> Lanes<f32> { lab(path).call("surface", &[Lanes::vectors(&places)]) };
    assert_eq!(call("water/wave_sum"), call("water/long_wave_sum"));
}

#[test]
fn sine_is_odd_cosine_is_even_and_their_squares_make_one() {
    let mut rng = rng();
    let angles = within(&mut rng, 0.0, 3e5, 20_000);
    let turned: Vec<f64> = angles.iter().map(|a| -a).collect();
    let lab = Lab::of("water/sine");
    let found: Lanes<f32> = lab.call("cosine_and_sine", &[scalars(&angles)]);
    let back: Lanes<f32> = lab.call("cosine_and_sine", &[scalars(&turned)]);
    for lane in 0..angles.len() {
        let (cosine, sine) = (number(&found, 0, lane), number(&found, 1, lane));
        assert!((cosine * cosine + sine * sine - 1.0).abs() < 3e-7);
        assert_eq!(
            (number(&back, 0, lane), number(&back, 1, lane)),
            (cosine, -sine)
        );
    }
}
