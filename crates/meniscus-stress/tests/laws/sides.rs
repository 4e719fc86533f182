//! What tells rays that pass through the water from those that it reflects, and mirrors.

use glam::DVec3;
use meniscus_shader::Composer;
use meniscus_stress::Lanes;

use crate::lab::*;

const LANES: usize = 2000;

/// Fillings that tell which of them is asked, by a number.
fn stubs(slot: &str) -> Composer {
    let body = |number: i32| match slot {
        "intersect" => format!(
            "fn intersect(ray: Ray, texel: vec2f) -> Hit {{
    var hit = no_hit(ray, texel);
    hit.object = {number}.0;
    return hit;
}}"
        ),
        "occluded" => format!(
            "fn occluded(ray: Ray, hit: Hit, texel: vec2f) -> bool {{
    return {number} == 1;
}}"
        ),
        _ => format!(
            "fn colour(hit: Hit, ray: Ray) -> vec3f {{
    return vec3f({number}.0);
}}

fn shown(hit: Hit, ray: Ray) -> vec4f {{
    return vec4f({number}.0);
}}"
        ),
    };
    let stub = |number: i32| {
        format!(
            "// Number {number}.\n//\n// provides: {slot}\n// needs: geometry/ray, geometry/hit\n\n{}\n",
            body(number)
        )
    };
    composer(&[("stub/behind", &stub(0)), ("stub/before", &stub(1))])
}

/// Which filling each ray asks: 0 for what is behind the water, 1 for what is before it.
fn asked(slot: &str, function: &str, above: bool, direction: &[DVec3]) -> Vec<f64> {
    let module = match slot {
        "intersect" => "geometry/by_side",
        "occluded" => "geometry/hidden_by_side",
        _ => "geometry/colour_by_side",
    };
    let slots = choice(&[("behind", "stub/behind"), ("before", "stub/before")]);
    let lab = Lab::with(&stubs(slot), module, &slots).water(1.333, above);
    let ray = structure(&[
        vectors(&vec![DVec3::ZERO; direction.len()]),
        vectors(direction),
    ]);
    let taken = lab
        .specimen
        .function(function)
        .unwrap_or_else(|e| panic!("{e}"));
    let arguments: Vec<Lanes<f32>> = taken
        .arguments()
        .map(|(name, shape)| match name {
            "ray" => ray.clone(),
            _ => Lanes::zeros(shape, direction.len()),
        })
        .collect();
    let found = lab.call(function, &arguments);
    let leaf = if slot == "intersect" {
        lab.leaf(function, ".object")
    } else {
        0
    };
    (0..direction.len())
        .map(|lane| number(&found, leaf, lane))
        .collect()
}

#[test]
fn rays_that_stay_on_the_cameras_side_ask_what_is_before_the_water() {
    let mut rng = rng();
    let down: Vec<DVec3> = units(&mut rng, LANES);
    let up: Vec<DVec3> = down.iter().map(|v| DVec3::new(v.x, v.y, -v.z)).collect();
    for (slot, function) in [
        ("intersect", "intersect"),
        ("occluded", "occluded"),
        ("colour", "colour"),
        ("colour", "shown"),
    ] {
        let of_air = asked(slot, function, true, &down);
        for (found, way) in of_air.iter().zip(&down) {
            assert_eq!(*found == 1.0, way.z > 0.0, "{slot}:{function}: {way}");
        }
        // The mirror image of a ray, seen from the other side, is the same ray.
        assert_eq!(
            asked(slot, function, false, &up),
            of_air,
            "{slot}:{function}"
        );
    }
}

#[test]
fn nothing_is_hidden_where_nothing_is_asked() {
    let lab = Lab::of("geometry/nothing_hidden");
    let function = lab
        .specimen
        .function("occluded")
        .unwrap_or_else(|e| panic!("{e}"));
    let arguments: Vec<Lanes<f32>> = function
        .arguments()
        .map(|(_, s)| Lanes::zeros(s, 3))
        .collect();
    let found = lab.call("occluded", &arguments);
    assert!((0..3).all(|lane| number(&found, 0, lane) == 0.0));
}

#[test]
fn mirrored_twice_a_point_is_where_it_was_and_as_far_from_the_water() {
    let mut rng = rng();
    let points = points(&mut rng, 50.0, LANES);
    for (module, function) in [
        ("optics/mirrored_point", "mirrored_point"),
        ("optics/mirrored_position", "place"),
    ] {
        let mut lab = Lab::of(module);
        lab.host
            .set("water.level", &[0.75])
            .unwrap_or_else(|e| panic!("{e}"));
        let once: Lanes<f32> = lab.call(function, &[vectors(&points)]);
        let twice = lab.call(function, std::slice::from_ref(&once));
        for (lane, point) in points.iter().enumerate() {
            let mirrored = vec3(&once, 0, lane);
            assert_eq!(mirrored.truncate(), point.truncate());
            assert!(
                (mirrored.z + point.z - 1.5).abs() < 1e-5,
                "{mirrored} of {point}"
            );
            assert!((vec3(&twice, 0, lane) - *point).length() < 1e-5);
        }
    }
}

#[test]
fn what_is_mirrored_appears_where_its_image_does() {
    let mut rng = rng();
    let lab = Lab::of("screen/through_mirror");
    let points: Vec<DVec3> = points(&mut rng, 2.0, LANES)
        .iter()
        .map(|p| DVec3::new(p.x, p.y + 4.0, p.z.abs()))
        .collect();
    let images: Vec<DVec3> = points.iter().map(|p| DVec3::new(p.x, p.y, -p.z)).collect();
    let mirrored: Lanes<f32> = lab.call("reproject", &[vectors(&points)]);
    let straight: Lanes<f32> = Lab::of("screen/plain").call("reproject", &[vectors(&images)]);
    assert_eq!(mirrored.columns, straight.columns);
}

#[test]
fn reflection_turns_the_part_along_the_normal_and_undoes_itself() {
    let mut rng = rng();
    let (incident, normal) = (units(&mut rng, LANES), units(&mut rng, LANES));
    let lab = Lab::of("optics/mirrored_ray");
    let origin = || vectors(&vec![DVec3::ONE; LANES]);
    let deflected = |direction: Lanes<f64>| -> Lanes<f64> {
        lab.call(
            "deflect",
            &[structure(&[origin(), direction]), vectors(&normal)],
        )
    };
    let leaf = lab.leaf("deflect", ".ray.direction.x");
    let once = deflected(vectors(&incident));
    let direction = structure(&[Lanes {
        columns: once.columns[leaf..leaf + 3].to_vec(),
    }]);
    let twice = deflected(direction);
    for lane in 0..LANES {
        let (into, out, n) = (incident[lane], vec3(&once, leaf, lane), normal[lane]);
        // Normals are floats: of length 1 to about 1e-7.
        assert!((out.dot(n) + into.dot(n)).abs() < 1e-6);
        assert!((out.cross(n) - into.cross(n)).length() < 1e-6);
        assert!((vec3(&twice, leaf, lane) - into).length() < 1e-6);
        assert_eq!(number(&once, lab.leaf("deflect", ".total"), lane), 1.0);
    }
}

#[test]
fn a_ray_towards_a_point_of_a_box_enters_the_box_before_it() {
    let mut rng = rng();
    let lab = Lab::of("geometry/box");
    let (origin, low) = (points(&mut rng, 20.0, LANES), points(&mut rng, 5.0, LANES));
    let sizes: Vec<f64> = decades(&mut rng, 1e-3, 10.0, LANES);
    let high: Vec<DVec3> = low
        .iter()
        .zip(&sizes)
        .map(|(l, s)| (*l + *s).as_vec3().as_dvec3())
        .collect();
    // Corners and points of faces too: a triangle may lie there.
    let goal: Vec<DVec3> = (0..LANES)
        .map(|lane| {
            let share = |rng: &mut fastrand::Rng| [0.0, 1.0, rng.f64()][rng.usize(0..3)];
            let part = DVec3::new(share(&mut rng), share(&mut rng), share(&mut rng));
            low[lane] + part * (high[lane] - low[lane])
        })
        .collect();
    let direction: Vec<DVec3> = goal
        .iter()
        .zip(&origin)
        .map(|(g, o)| (*g - *o).normalize())
        .collect();
    let inverse: Lanes<f32> = lab.call("box_inverse", &[vectors(&direction)]);
    let way: Vec<f64> = goal
        .iter()
        .zip(&origin)
        .map(|(g, o)| (*g - *o).length())
        .collect();
    let entry = |farthest: &[f64]| -> Lanes<f32> {
        let numbers = [
            vectors(&origin),
            inverse.clone(),
            vectors(&low),
            vectors(&high),
            scalars(farthest),
        ];
        lab.call("box_entry", &numbers)
    };
    let far = entry(&[1e30; LANES]);
    let near = entry(&way.iter().map(|w| 0.5 * w).collect::<Vec<_>>());
    for lane in 0..LANES {
        let (low, high) = (low[lane], high[lane]);
        let found = number(&far, 0, lane);
        let at = origin[lane] + found * direction[lane];
        // The rays' directions are rounded: one towards a corner may pass beside it.
        let inside = goal[lane].cmpgt(low + 1e-3 * sizes[lane]).all()
            && goal[lane].cmplt(high - 1e-3 * sizes[lane]).all();
        if found >= 1e30 {
            assert!(
                !inside || way[lane] * 1e-7 > 1e-4 * sizes[lane],
                "missed: {:?}",
                goal[lane]
            );
            continue;
        }
        assert!(
            found <= way[lane] * (1.0 + 1e-5),
            "{found} is beyond the goal at {}",
            way[lane]
        );
        let outside = (low - at).max(at - high).max_element();
        assert!(
            outside < 1e-5 * (1.0 + way[lane]),
            "entered beside the box: {outside}"
        );
        if found > 0.51 * way[lane] {
            assert_eq!(
                number(&near, 0, lane),
                f64::from(1e30_f32),
                "entered beyond the farthest"
            );
        }
    }
}
