//! What is promised of whole pictures.

mod common;

use std::sync::Mutex;

use common::{EYES, height, pixels, pool, view};
use glam::{DVec2, DVec3, UVec2, Vec3};
use meniscus_reference::{Tracer, apparent_pixel, trace};
use meniscus_scene::WaterGeometry;

const GEOMETRIES: [WaterGeometry; 2] = [WaterGeometry::Flat, WaterGeometry::Displaced];

#[test]
fn nothing_is_ever_other_than_finite() {
    for geometry in GEOMETRIES {
        for slope in [0.0, 0.2] {
            for index in [0.4, 1.0 - 1e-7, 1.0, 1.333, 2.5] {
                let mut scene = pool(geometry, slope);
                scene.water.refractive_index = index;
                let targets = [DVec3::X, DVec3::Z, DVec3::NEG_Z, DVec3::new(1.0, 0.5, -0.2)];
                for (z, towards) in [0.0, -0.0, 1e-7, -1e-7]
                    .into_iter()
                    .flat_map(|z| targets.map(|towards| (z, towards)))
                {
                    // On the rest plane, or on the waves.
                    let at = DVec2::new(-0.4, -0.2);
                    let surface = match geometry {
                        WaterGeometry::Flat => 0.0,
                        WaterGeometry::Displaced => height(&scene.water, at).0,
                    };
                    let eye = at.extend(surface + z);
                    let mut view = view(&scene, eye, eye + towards);
                    // An odd size has rays along the axes.
                    view.size = UVec2::new(17, 9);
                    let truth = trace(&scene, &view, &|_| ());
                    assert!(
                        truth
                            .colour
                            .iter()
                            .flatten()
                            .all(|c| c.is_finite() && *c >= 0.0)
                    );
                    assert!(truth.point.iter().flatten().all(|c| c.is_finite()));
                    for (point, object) in truth.point.iter().zip(&truth.object) {
                        if let Some(pixel) = apparent_pixel((*point).into(), &scene, &view) {
                            assert!(*object < 0 || pixel.is_finite(), "{point:?} {pixel}");
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn an_eye_on_the_surface_sees_what_eyes_beside_it_see() {
    // In air, straight down and aslant: the view is continuous in the height of the eye.
    let scene = pool(WaterGeometry::Flat, 0.0);
    let tracer = Tracer::new(&scene);
    let seen = |z: f64| {
        let eye = DVec3::new(-1.5, -1.0, z);
        let view = view(&scene, eye, eye + DVec3::new(0.3, 0.4, -1.0));
        pixels(&view)
            .map(|pixel| tracer.trace_pixel(&view, pixel))
            .collect::<Vec<_>>()
    };
    let mut same = 0;
    let (on, over) = (seen(0.0), seen(1e-7));
    for (a, b) in on.iter().zip(&over) {
        let (Some(a), Some(b)) = (a.hit, b.hit) else {
            panic!("the pool has a floor")
        };
        same += usize::from((a.point - b.point).length() < 1e-5);
    }
    // The rest look past an edge.
    assert!(same + 20 > on.len(), "{same} of {}", on.len());
}

#[test]
fn either_face_of_a_triangle_looks_the_same() {
    let scene = pool(WaterGeometry::Flat, 0.05);
    let mut turned = scene.clone();
    for triangle in &mut turned.mesh.triangles {
        triangle.corners.swap(1, 2);
    }
    for normal in &mut turned.mesh.normals {
        *normal = -*normal;
    }
    for (eye, target) in EYES {
        let view = view(&scene, eye, target);
        let [a, b] = [&scene, &turned].map(|scene| trace(scene, &view, &|_| ()));
        assert_eq!(a.object, b.object);
        let differ = a
            .colour
            .iter()
            .zip(&b.colour)
            .filter(|(a, b)| (Vec3::from_array(**a) - Vec3::from_array(**b)).length() > 1e-5)
            .count();
        // Where rounding decides whether a point is on a tile's line.
        assert!(differ <= 2, "{differ}");
    }
}

#[test]
fn nothing_is_brighter_than_its_light_allows() {
    let scene = pool(WaterGeometry::Displaced, 0.1);
    for (eye, target) in EYES {
        let truth = trace(&scene, &view(&scene, eye, target), &|_| ());
        for (colour, object) in truth.colour.iter().zip(&truth.object) {
            if *object >= 0 {
                let material = &scene.materials[scene.objects[*object as usize].material as usize];
                let most = material.colour * (scene.sun.colour + scene.sun.ambient);
                assert!(Vec3::from_array(*colour).cmple(most + 1e-6).all());
            }
        }
    }
}

#[test]
fn solids_before_the_water_hide_it_and_the_near_plane_hides_solids() {
    let scene = pool(WaterGeometry::Displaced, 0.05);
    // Through the board's centre.
    let mut view = view(
        &scene,
        DVec3::new(0.0, -1.9, 1.7),
        DVec3::new(0.0, -1.15, 0.6),
    );
    let centre = view.size / 2;
    let tracer = Tracer::new(&scene);
    let board = tracer.trace_pixels(&view, &[centre])[0];
    assert_eq!(
        (board.object, board.water_first, board.events),
        (3, false, 0)
    );
    view.near = 1.6;
    let beyond = tracer.trace_pixels(&view, &[centre])[0];
    assert_eq!(
        (beyond.object, beyond.water_first, beyond.events),
        (0, true, 1)
    );
    // Water is seen, and what it shows, however far the near plane.
    view.near = 50.0;
    assert_eq!(tracer.trace_pixels(&view, &[centre])[0], beyond);
}

#[test]
fn flat_geometry_has_no_answer_only_where_waves_are_steep() {
    let steep = pool(WaterGeometry::Flat, 0.5);
    let (eye, target) = EYES[1];
    let truth = trace(&steep, &view(&steep, eye, target), &|_| ());
    let undefined = truth
        .undefined
        .iter()
        .filter(|&&undefined| undefined)
        .count();
    assert!(undefined > 100, "{undefined}");
    for i in 0..truth.object.len() {
        if truth.undefined[i] {
            assert!(truth.water_first[i] && truth.object[i] == -1 && truth.colour[i] == [0.0; 3]);
        }
    }
    for scene in [
        pool(WaterGeometry::Flat, 0.05),
        pool(WaterGeometry::Displaced, 0.5),
    ] {
        let (eye, target) = EYES[0];
        let truth = trace(&scene, &view(&scene, eye, target), &|_| ());
        assert!(truth.undefined.iter().all(|&undefined| !undefined));
        assert!(truth.water_first.iter().any(|&water| water));
    }
}

#[test]
fn a_picture_is_its_pixels_and_progress_ends_at_one() {
    let scene = pool(WaterGeometry::Displaced, 0.1);
    let (eye, target) = EYES[0];
    let view = view(&scene, eye, target);
    let calls = Mutex::new(Vec::new());
    let truth = trace(&scene, &view, &|share| calls.lock().unwrap().push(share));
    let mut calls = calls.into_inner().unwrap();
    calls.sort_by(f64::total_cmp);
    assert_eq!(calls.len(), 54);
    assert_eq!(calls.last(), Some(&1.0));

    let some = [UVec2::new(3, 50), UVec2::new(40, 30), UVec2::new(95, 0)];
    for (pixel, sample) in some
        .iter()
        .zip(Tracer::new(&scene).trace_pixels(&view, &some))
    {
        let i = (pixel.y * 96 + pixel.x) as usize;
        assert_eq!(truth.colour[i], sample.colour);
        assert_eq!(truth.point[i], sample.point);
        assert_eq!(truth.object[i], sample.object);
    }
    // Guard pixels surround the same picture.
    let guarded = trace(&scene, &view.guarded(UVec2::splat(5)), &|_| ());
    assert_eq!(guarded.object[(106 * 5 + 5) as usize], truth.object[0]);

    let mut nothing = view;
    nothing.size = UVec2::ZERO;
    assert!(trace(&scene, &nothing, &|_| ()).colour.is_empty());
}
