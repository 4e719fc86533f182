//! Marches through what was drawn, and where lines leave the picture.

use glam::{DVec2, DVec3};
use meniscus_stress::Lanes;
use meniscus_stress::modules::{Choice, Host};

use crate::lab::*;

const LANES: usize = 2000;
const SIZE: [usize; 2] = [672, 392];
const FLOOR: f64 = -2.0;
/// The host's camera.
const EYE: DVec3 = DVec3::new(0.3, -4.0, 1.7);
const FORWARD: DVec3 = DVec3::new(0.0, 0.8, -0.6);
const UP: DVec3 = DVec3::new(0.0, 0.6, 0.8);

/// A direction, not of length 1, through a place of the seen buffers.
fn towards(texel: DVec2) -> DVec3 {
    let centred = (texel - DVec2::new(336.0, 196.0)) / 500.0;
    FORWARD + DVec3::X * centred.x - UP * centred.y
}

fn appears(point: DVec3) -> DVec2 {
    let offset = point - EYE;
    let depth = offset.dot(FORWARD);
    DVec2::new(336.0, 196.0) + DVec2::new(offset.x, -offset.dot(UP)) * 500.0 / depth
}

/// 1 / depth of the floor, where a place of the seen buffers shows it.
fn floor_inverse(texel: DVec2) -> f64 {
    // The direction is one metre deep.
    (towards(texel).z / (FLOOR - EYE.z)).max(0.0)
}

/// What is drawn is the floor, without refraction.
fn draw_floor(host: &mut Host) {
    let middle = |x: usize, y: usize| DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
    let mut depths = Vec::new();
    for y in 0..SIZE[1] {
        for x in 0..SIZE[0] {
            let depth = 0.05 * floor_inverse(middle(x, y));
            depths.push([depth as f32, 0.0, 0.0, 1.0]);
        }
    }
    for tile in 0..84 * 49 {
        let (x, y) = (tile % 84 * 8, tile / 84 * 8);
        let corners = [(x, y), (x + 7, y), (x, y + 7), (x + 7, y + 7)];
        let inverse = corners.map(|(x, y)| floor_inverse(middle(x, y)));
        let nearest = inverse.into_iter().fold(0.0, f64::max);
        let farthest = inverse.into_iter().fold(f64::INFINITY, f64::min);
        for (member, value) in [("nearest", nearest), ("farthest", farthest)] {
            let path = format!("depth_tiles[{tile}].{member}");
            host.set(&path, &[value]).unwrap_or_else(|e| panic!("{e}"));
        }
    }
    host.texture("seen_depth", SIZE.map(|s| s as u32), &depths);
}

const MARCHES: [&str; 3] = [
    "screen/march",
    "screen/hierarchical_march",
    "screen/curved_march",
];

fn march(module: &str) -> Lab {
    let mut choice = Choice::default();
    if module == "screen/curved_march" {
        // As far and as near as the others go.
        choice.numbers.insert("refinements".to_owned(), 6.0);
        choice.numbers.insert("march_steps".to_owned(), 1024.0);
    }
    Lab::with(&composer(&[]), module, &choice)
}

#[test]
fn marches_meet_a_floor_where_the_ray_does() {
    let mut rng = rng();
    let (mut origin, mut direction, mut ends) = (vec![], vec![], vec![]);
    while origin.len() < LANES {
        let place = |rng: &mut fastrand::Rng| {
            DVec2::new(40.0 + 590.0 * rng.f64(), 100.0 + 270.0 * rng.f64())
        };
        let on =
            |texel: DVec2, level: f64| EYE + towards(texel) * ((level - EYE.z) / towards(texel).z);
        let (from, to) = (on(place(&mut rng), 0.0), on(place(&mut rng), FLOOR));
        // Rays from the water down, not along the line of sight, nor farther than marches reach.
        if (to - from).length() < 25.0 && appears(from).distance(appears(to)) > 20.0 {
            origin.push(from);
            direction.push((to - from).normalize());
            ends.push(to);
        }
    }
    for module in MARCHES {
        let mut lab = march(module);
        draw_floor(&mut lab.host);
        let ray = structure(&[vectors(&origin), vectors(&direction)]);
        let found: Lanes<f32> = lab.call("intersect", &[ray, Lanes::vectors(&[[0.0; 2]; LANES])]);
        let leaf = |path: &str| lab.leaf("intersect", path);
        let mut met = 0;
        for (lane, &end) in ends.iter().enumerate() {
            let texel = DVec2::from(
                ["x", "y"].map(|axis| number(&found, leaf(&format!(".texel.{axis}")), lane)),
            );
            let position = vec3(&found, leaf(".position.x"), lane);
            // Along the ray: where it sinks slowly, a level says little of the way.
            let apart = (position - end).length() / (end - EYE).length();
            met += usize::from(apart < 2e-3 && texel.distance(appears(end)) < 0.5);
        }
        // A floor at a slant is drawn in steps: where the ray sinks more slowly than they do, it may be taken
        // to pass behind one.
        assert!(met > LANES * 97 / 100, "{module}: {met} of {LANES}");
    }
}

#[test]
fn what_leaves_the_picture_without_a_hit_shows_the_very_edge() {
    let mut rng = rng();
    let (mut origin, mut direction) = (vec![], vec![]);
    for _ in 0..LANES {
        let texel = DVec2::new(5.0 + 660.0 * rng.f64(), 5.0 + 380.0 * rng.f64());
        origin.push(EYE + towards(texel) * (0.5 + 3.0 * rng.f64()));
        // Across the picture, and down, so that the water does not send it back.
        let angle = std::f64::consts::TAU * rng.f64();
        let across = DVec3::X * angle.cos() + UP * angle.sin() * 0.5 - DVec3::Z * 0.6;
        direction.push(across.normalize());
    }
    for module in MARCHES {
        let mut lab = march(module);
        // Nothing was drawn.
        lab.host.texture(
            "seen_depth",
            SIZE.map(|s| s as u32),
            &[[0.0; 4]; SIZE[0] * SIZE[1]],
        );
        let ray = structure(&[vectors(&origin), vectors(&direction)]);
        let texel = Lanes::vectors(&[[1.0, 2.0]; LANES]);
        let found: Lanes<f32> = lab.call("intersect", &[ray, texel]);
        let [x, y, hit] =
            [".texel.x", ".texel.y", ".found"].map(|path| lab.leaf("intersect", path));
        let mut left = 0;
        for lane in 0..LANES {
            assert_eq!(
                number(&found, hit, lane),
                0.0,
                "{module}: nothing is there to be met"
            );
            let texel = DVec2::new(number(&found, x, lane), number(&found, y, lane));
            let edge = texel.x == 0.0 || texel.y == 0.0 || texel.x == 672.0 || texel.y == 392.0;
            assert!(edge || texel == DVec2::new(1.0, 2.0), "{module}: {texel}");
            left += usize::from(edge);
        }
        assert!(left > LANES / 2, "{module}: {left}");
    }
}

#[test]
fn lines_leave_a_rectangle_on_its_side_and_on_the_line() {
    let lab = Lab::of("screen/leaving");
    let mut rng = rng();
    let pairs = |rng: &mut fastrand::Rng, low: f32, high: f32| -> Vec<[f32; 2]> {
        let mut one = || low + (high - low) * rng.f32();
        (0..LANES).map(|_| [one(), one()]).collect()
    };
    let (at, way) = (pairs(&mut rng, 0.0, 1.0), pairs(&mut rng, -20.0, 20.0));
    let (low, high) = ([[-1.0_f32, -2.0]; LANES], [[3.0_f32, 2.0]; LANES]);
    let arguments = [&at[..], &way[..], &low[..], &high[..]].map(Lanes::<f32>::vectors);
    let (place, part) = (
        lab.call("leaving_place", &arguments),
        lab.call("leaving_part", &arguments),
    );
    let mut left = 0;
    for lane in 0..LANES {
        let [x, y] = [0, 1].map(|axis| number(&place, axis, lane));
        let part = number(&part, 0, lane);
        for (axis, found) in [x, y].into_iter().enumerate() {
            let right = f64::from(at[lane][axis]) + part * f64::from(way[lane][axis]);
            assert!((found - right).abs() < 1e-5, "{found} is not {right}");
        }
        let inside = (-1.0..=3.0).contains(&x) && (-2.0..=2.0).contains(&y);
        assert!(inside || part == 1.0, "({x}, {y}) after {part}");
        if part < 1.0 {
            assert!(
                x == -1.0 || x == 3.0 || y == -2.0 || y == 2.0,
                "({x}, {y}) lies on no side"
            );
            left += 1;
        }
    }
    assert!(left > LANES / 2);
}

#[test]
fn depths_between_texels_are_those_of_the_plane_that_was_drawn() {
    let mut lab = Lab::of("screen/drawn");
    draw_floor(&mut lab.host);
    let mut rng = rng();
    let texels: Vec<[f32; 2]> = (0..LANES)
        .map(|_| [1.0 + 670.0 * rng.f32(), 60.0 + 330.0 * rng.f32()])
        .collect();
    let found: Lanes<f32> = lab.call("drawn_between", &[Lanes::vectors(&texels)]);
    for (lane, [x, y]) in texels.iter().enumerate() {
        let right = floor_inverse(DVec2::new(f64::from(*x), f64::from(*y)));
        assert!((number(&found, 0, lane) - right).abs() < 1e-6, "{x}, {y}");
    }
}

#[test]
fn tiles_cover_the_texture_and_none_lies_beside_it() {
    let lab = Lab::of("screen/depth_tiles");
    let sizes: Vec<[f32; 2]> = (1..=400).map(|i| [i as f32, (401 - i) as f32]).collect();
    let found: Lanes<f32> = lab.call("depth_tiles_across", &[Lanes::vectors(&sizes)]);
    for (lane, size) in sizes.iter().enumerate() {
        for (axis, texels) in size.iter().enumerate() {
            let covered = 8.0 * number(&found, axis, lane);
            assert!(covered >= f64::from(*texels) && covered < f64::from(*texels) + 8.0);
        }
    }
}

#[test]
fn a_ray_that_goes_straight_on_is_not_shifted() {
    let mut lab = Lab::of("screen/offset");
    draw_floor(&mut lab.host);
    let mut rng = rng();
    let place = |_| DVec2::new(20.0 + 630.0 * rng.f64(), 80.0 + 300.0 * rng.f64());
    // The middles of texels, of which the depths are.
    let places: Vec<DVec2> = (0..LANES).map(place).map(|p| p.floor() + 0.5).collect();
    let ways: Vec<DVec3> = places.iter().map(|&p| towards(p)).collect();
    let origin: Vec<DVec3> = ways
        .iter()
        .map(|way| EYE + *way * (EYE.z / -way.z))
        .collect();
    let direction: Vec<DVec3> = ways.iter().map(|way| way.normalize()).collect();
    let texels: Vec<[f32; 2]> = places.iter().map(|p| p.as_vec2().to_array()).collect();
    let ray = structure(&[vectors(&origin), vectors(&direction)]);
    let found: Lanes<f32> = lab.call("intersect", &[ray, Lanes::vectors(&texels)]);
    let leaf = |path: &str| lab.leaf("intersect", path);
    for (lane, place) in places.iter().enumerate() {
        let texel = DVec2::new(
            number(&found, leaf(".texel.x"), lane),
            number(&found, leaf(".texel.y"), lane),
        );
        assert!(texel.distance(*place) < 1e-2, "{texel} is not {place}");
        assert!((number(&found, leaf(".position.z"), lane) - FLOOR).abs() < 1e-3);
    }
}

#[test]
fn a_floor_drawn_through_flat_water_is_seen_where_it_is() {
    for (index, above) in [(1.333, true), (2.5, true), (1.0, true)] {
        let slots = choice(&[("deflect", "optics/refracted_ray")]);
        let mut lab = Lab::with(&composer(&[]), "screen/seen_depths", &slots).water(index, above);
        let mut depths = vec![[0.0_f32; 4]; SIZE[0] * SIZE[1]];
        for (i, depth) in depths.iter_mut().enumerate() {
            let way = towards(DVec2::new(
                (i % SIZE[0]) as f64 + 0.5,
                (i / SIZE[0]) as f64 + 0.5,
            ));
            let ray = way.normalize();
            if ray.z > -0.02 {
                continue;
            }
            // By Snell's law in sines: how far the ray goes on behind the water until it meets the floor.
            let sine = ray.truncate().length() / index;
            let ashore = EYE.z * ray.truncate().length() / -ray.z
                - FLOOR * sine / (1.0 - sine * sine).sqrt();
            // It appears on the straight ray, above where it is.
            let reach = ashore / way.truncate().length();
            depth[0] = (0.05 / reach) as f32;
        }
        lab.host
            .texture("seen_depth", SIZE.map(|s| s as u32), &depths);
        lab.host.texture(
            "seen_object",
            SIZE.map(|s| s as u32),
            &[[4.0, 0.0, 0.0, 0.0]; SIZE[0] * SIZE[1]],
        );
        lab.host.texture(
            "seen_normal",
            SIZE.map(|s| s as u32),
            &[[0.0; 4]; SIZE[0] * SIZE[1]],
        );
        let mut rng = rng();
        let texels: Vec<[f32; 2]> = (0..LANES)
            .map(|_| [5.0 + 660.0 * rng.f32(), 80.0 + 300.0 * rng.f32()])
            .collect();
        let found: Lanes<f32> = lab.call("seen", &[Lanes::vectors(&texels)]);
        let leaf = |path: &str| lab.leaf("seen", path);
        for (lane, texel) in texels.iter().enumerate() {
            let position = vec3(&found, leaf(".position.x"), lane);
            let far = (position - EYE).length();
            assert!(
                (position.z - FLOOR).abs() < 2e-5 * far,
                "index {index}, {texel:?}: {position}"
            );
            assert_eq!(vec3(&found, leaf(".normal.x"), lane), DVec3::Z);
            assert_eq!(number(&found, leaf(".object"), lane), 3.0);
            assert_eq!(number(&found, leaf(".edge"), lane), 0.0);
        }
    }
}
