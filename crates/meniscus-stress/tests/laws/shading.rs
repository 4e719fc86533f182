//! Light: of hits, of tiles, of the sky, and the grey that shows an estimate.

use glam::DVec3;
use meniscus_stress::{Column, Lanes};

use crate::lab::*;

const LANES: usize = 1000;

/// Arguments of a kind, of which some numbers are set: by the ends of their paths.
fn filled(lab: &Lab, function: &str, index: usize, set: &[(&str, Vec<f64>)]) -> Lanes<f32> {
    let function = lab
        .specimen
        .function(function)
        .unwrap_or_else(|e| panic!("{e}"));
    let (_, shape) = function.arguments().nth(index).expect("an argument");
    let lanes = set[0].1.len();
    let mut filled = Lanes::<f32>::zeros(shape, lanes);
    for (path, values) in set {
        let leaves = shape.leaves();
        let leaf = leaves.iter().position(|(leaf, _)| leaf == path);
        let leaf = leaf.unwrap_or_else(|| panic!("no {path} in {leaves:?}"));
        match &mut filled.columns[leaf] {
            Column::Float(column) => *column = values.iter().map(|&v| v as f32).collect(),
            Column::Bool(column) => *column = values.iter().map(|&v| v != 0.0).collect(),
            other => panic!("{path} is {other:?}"),
        }
    }
    filled
}

fn axis(vectors: &[DVec3], axis: usize) -> Vec<f64> {
    vectors.iter().map(|v| v[axis]).collect()
}

#[test]
fn each_doubling_of_an_estimate_is_a_fortieth_of_grey() {
    let lab = Lab::of("shading/residual");
    let mut rng = rng();
    let mut residuals = decades(&mut rng, 1e-6, 5e5, LANES);
    residuals.extend([0.0, 1e-9, f64::exp2(-20.0), f64::exp2(20.0), 1e30]);
    let grey = |factor: f64| -> Lanes<f32> {
        let residuals = residuals.iter().map(|r| r * factor).collect();
        let hit = filled(&lab, "colour", 0, &[(".residual", residuals)]);
        let ray = filled(&lab, "colour", 1, &[(".origin.x", vec![0.0; LANES + 5])]);
        lab.call("colour", &[hit, ray])
    };
    let (once, twice) = (grey(1.0), grey(2.0));
    for lane in 0..LANES {
        let step = number(&twice, 0, lane) - number(&once, 0, lane);
        assert!((step - 1.0 / 40.0).abs() < 1e-6, "{step}");
        assert_eq!(vec3(&once, 0, lane), DVec3::splat(number(&once, 0, lane)));
    }
    let ends: Vec<f64> = (LANES..LANES + 5)
        .map(|lane| number(&once, 0, lane))
        .collect();
    assert_eq!(ends, [0.0, 0.0, 0.0, 1.0, 1.0]);
}

#[test]
fn hits_are_shaded_on_the_face_that_is_seen_and_misses_show_the_sky() {
    let lab = Lab::with(
        &composer(&[]),
        "shading/at_hit",
        &choice(&[("shade", "shading/diffuse")]),
    );
    let (sky, mut rng) = (Lab::of("sky/gradient"), rng());
    let (normals, ways) = (units(&mut rng, LANES), units(&mut rng, LANES));
    let seen = |found: f64, turned: f64| -> Lanes<f32> {
        let mut set = vec![(".found", vec![found; LANES])];
        for (index, name) in ["x", "y", "z"].iter().enumerate() {
            let turned = axis(&normals, index)
                .iter()
                .map(|n| turned * n)
                .collect::<Vec<f64>>();
            let paths = [".normal", ".shading_normal", ".direction"].map(|p| format!("{p}.{name}"));
            let paths = paths.map(|path| &*path.leak());
            set.push((paths[0], turned.clone()));
            set.push((paths[1], turned));
            set.push((paths[2], axis(&ways, index)));
        }
        let hit = filled(&lab, "colour", 0, &set);
        let ray = filled(&lab, "colour", 1, &[(".origin.x", vec![0.0; LANES])]);
        lab.call("colour", &[hit, ray])
    };
    let above: Lanes<f32> = sky.call("sky_colour", &[vectors(&ways)]);
    assert_eq!(seen(0.0, 1.0), above);
    // Whichever way its normal points, a surface has the light of the side that the ray comes to.
    assert_eq!(seen(1.0, 1.0), seen(1.0, -1.0));
    assert_ne!(seen(1.0, 1.0), above);
}

#[test]
fn tiles_repeat_in_the_plane_that_the_normal_is_nearest_to() {
    let mut lab = Lab::of("shading/diffuse");
    lab.host
        .set("materials[0].tile_size", &[0.25])
        .expect("a length");
    let mut rng = rng();
    // On a grid, so that sums are exact.
    let mut grid = || f64::from(rng.u32(0..4096)) / 1024.0;
    let places: Vec<DVec3> = (0..LANES)
        .map(|_| DVec3::new(grid(), grid(), grid()))
        .collect();
    let shaded = |axis_of_normal: usize, move_by: DVec3| -> Lanes<f32> {
        let mut set = Vec::new();
        for (index, name) in ["x", "y", "z"].iter().enumerate() {
            let along = if index == axis_of_normal { 1.0 } else { 0.1 };
            let place: Vec<f64> = places.iter().map(|p| p[index] + move_by[index]).collect();
            let paths =
                [".position", ".geometric_normal", ".normal"].map(|p| format!("{p}.{name}"));
            let paths = paths.map(|path| &*path.leak());
            set.push((paths[0], place));
            set.push((paths[1], vec![along; LANES]));
            set.push((paths[2], vec![0.5; LANES]));
        }
        set.push((".facing", vec![1.0; LANES]));
        lab.call("shade", &[filled(&lab, "shade", 0, &set)])
    };
    for normal in 0..3 {
        let here = shaded(normal, DVec3::ZERO);
        for along in 0..3 {
            let mut tile = DVec3::ZERO;
            tile[along] = 0.75;
            assert_eq!(here, shaded(normal, tile));
            // Along the normal nothing changes; in the plane other places have other light.
            tile[along] = 0.125;
            assert_eq!(here == shaded(normal, tile), along == normal);
        }
        // Lines of 2 cm cover 1 − (23 / 25)² of tiles of 25 cm.
        let light: Vec<f64> = (0..LANES).map(|lane| number(&here, 0, lane)).collect();
        let least = light.iter().copied().fold(f64::INFINITY, f64::min);
        let share = light.iter().filter(|x| **x == least).count() as f64 / LANES as f64;
        assert!((share - 0.154).abs() < 0.04, "{share}");
    }
}
