//! Laws of generated shapes.

mod common;

use common::{is_closed, load, text_with, volume};
use proptest::prelude::*;

const TAU: f64 = std::f64::consts::TAU;

/// Solids with their volumes when infinitely fine.
fn solids() -> Vec<(&'static str, f64)> {
    vec![
        ("Box(size: (1.2, 0.7, 2.3))", 1.2 * 0.7 * 2.3),
        ("Sphere(radius: 0.8)", TAU * 2.0 / 3.0 * 0.512),
        ("Cylinder(radius: 0.4, height: 2.5)", TAU / 2.0 * 0.16 * 2.5),
        (
            "Torus(radius: 0.9, tube: 0.3)",
            TAU * 0.9 * TAU / 2.0 * 0.09,
        ),
        (
            "Frame(inner: (1, 0.5), outer: (1.6, 1.3), height: 0.4)",
            (1.6 * 1.3 - 0.5) * 0.4,
        ),
        (
            "Bars(size: (2, 1.5), count: (4, 3), thickness: 0.1)",
            (4.0 * 1.5 + 3.0 * 2.0) * 0.01,
        ),
    ]
}

#[test]
fn solids_are_closed_face_outwards_and_have_their_volume() {
    for (shape, exact) in solids() {
        let mut worse = f64::INFINITY;
        for edge in [0.5, 0.11, 0.03] {
            let scene = load(&text_with(shape, &format!("edge: {edge}")), &[]).unwrap();
            scene.check().unwrap();
            assert!(is_closed(&scene), "{shape} with edge {edge}");
            let miss = 1.0 - volume(&scene) / exact;
            // Inscribed in what is curved, and nearer to it the finer.
            assert!(
                (-1e-6..0.5).contains(&miss),
                "{shape} with edge {edge}: {miss}"
            );
            assert!(miss <= worse + 1e-6);
            worse = miss;
        }
        assert!(worse < 2e-2, "{shape}: {worse}");
    }
}

#[test]
fn shading_normals_stand_on_the_outside() {
    for (shape, _) in solids() {
        let scene = load(
            &text_with(shape, "rotate: (20, 30, 40), scale: (1, 2, 0.5)"),
            &[],
        )
        .unwrap();
        for (index, triangle) in scene.mesh.triangles.iter().enumerate() {
            let [a, b, c] = scene.mesh.corners(index);
            let face = (b - a).cross(c - a);
            for corner in triangle.corners {
                let normal = scene.mesh.normals[corner as usize].as_dvec3();
                assert!(face.dot(normal) > 0.0, "{shape}");
            }
        }
    }
}

#[test]
fn upright_shapes_have_no_triangle_across_the_water_unless_told() {
    for (shape, _) in solids()
        .into_iter()
        .filter(|(s, _)| !s.starts_with(['S', 'T']))
    {
        for place in [
            "translate: (0, 0, 0.037)",
            "translate: (1, 2, -0.013), rotate: (0, 0, 33), scale: (1, 1, 1.7)",
        ] {
            for level in ["0", "0.1", "-7.3"] {
                let set = format!("water.level={level}");
                let scene = load(&text_with(shape, place), &[&set]).unwrap();
                assert_eq!(scene.sides().across, 0, "{shape} {place} {level}");
                assert!(is_closed(&scene), "{shape} {place} {level}");
            }
        }
        let crossing = load(
            &text_with(shape, "translate: (0, 0, 0.037), waterline: false, edge: 9"),
            &[],
        )
        .unwrap();
        assert!(crossing.sides().across > 0, "{shape}");
    }
}

#[test]
fn straight_edges_are_no_longer_than_asked() {
    for edge in [0.5, 0.15] {
        let text = text_with(
            "Box(size: (1.2, 0.7, 2.3))",
            &format!("edge: {edge}, scale: (1, 2, 1)"),
        );
        let scene = load(&text, &[]).unwrap();
        for index in 0..scene.mesh.triangles.len() {
            let [a, b, c] = scene.mesh.corners(index);
            let mut sides = [(b - a).length(), (c - b).length(), (a - c).length()];
            sides.sort_by(f64::total_cmp);
            // The longest one is a cell's diagonal.
            assert!(sides[1] <= edge * (1.0 + 1e-6));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn reeds_are_closed_whatever_the_seed(seed in 0_u64..u64::MAX / 2, count in 1_u32..9, lean in 0.0..90.0) {
        let shape = format!(
            "Reeds(count: {count}, area: (2, 3), height: 1, radius: 0.02, lean: {lean}, seed: {seed})"
        );
        let scene = load(&text_with(&shape, ""), &[]).unwrap();
        prop_assert!(is_closed(&scene));
        prop_assert!(volume(&scene) > 0.0);
    }
}
