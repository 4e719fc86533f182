//! Laws of optics that every path obeys.

mod common;

use common::{EYES, height, pixels, pool, view};
use glam::DVec3;
use meniscus_reference::{MAX_EVENTS, Medium, Path, Tracer, apparent_pixel, mirrored_pixel};
use meniscus_scene::{Scene, WaterGeometry};

const GEOMETRIES: [WaterGeometry; 2] = [WaterGeometry::Flat, WaterGeometry::Displaced];

/// Calls `check` with the path of every pixel of every eye.
fn each_path(scene: &Scene, mut check: impl FnMut(&Tracer, Path)) {
    let tracer = Tracer::new(scene);
    for (eye, target) in EYES {
        let view = view(scene, eye, target);
        for pixel in pixels(&view) {
            check(&tracer, tracer.trace_pixel(&view, pixel));
        }
    }
}

#[test]
fn snells_law_holds_at_every_event() {
    for geometry in GEOMETRIES {
        let scene = pool(geometry, 0.15);
        let (mut transmitted, mut reflected) = (0, 0);
        each_path(&scene, |_, path| {
            let mut medium = path.medium;
            let mut direction = None;
            for event in &path.events {
                assert_eq!(event.medium, medium);
                assert_eq!(*direction.get_or_insert(event.incident), event.incident);
                let (_, gradient) = height(&scene.water, event.point.truncate());
                let normal = DVec3::new(-gradient.x, -gradient.y, 1.0).normalize();
                assert!((normal - event.normal).length() < 1e-12);

                let index = |medium| if medium == Medium::Air { 1.0 } else { 1.333 };
                let after = if event.total { medium } else { medium.other() };
                // Sines by cross products; their equality as vectors includes coplanarity.
                let before = index(medium) * event.incident.cross(normal);
                assert!((before - index(after) * event.deflected.cross(normal)).length() < 1e-12);
                if event.total {
                    assert!(before.length() > index(medium.other()));
                    reflected += 1;
                } else {
                    transmitted += 1;
                }
                // On to the right side of the surface.
                let side = if after == Medium::Air { 1.0 } else { -1.0 };
                assert!(side * event.deflected.dot(normal) > 0.0);
                medium = after;
                direction = Some(event.deflected);
            }
            if let Some(direction) = direction
                && path.undefined.is_none()
            {
                assert_eq!(path.direction, direction);
            }
        });
        assert!(
            transmitted > 5000 && reflected > 500,
            "{transmitted} {reflected}"
        );
    }
}

#[test]
fn a_ray_sent_back_from_what_it_met_passes_through_the_eye() {
    for geometry in GEOMETRIES {
        let scene = pool(geometry, 0.15);
        let (mut retraced, mut several) = (0, 0);
        each_path(&scene, |tracer, path| {
            let Some(hit) = path.hit else { return };
            // Near grazing, rounding is magnified without bound; after the last event allowed, the
            // ray may have passed through water without noticing.
            let grazing = path.events.iter().any(|event| {
                event.incident.dot(event.normal).abs() < 0.02
                    || event.deflected.dot(event.normal).abs() < 0.02
            });
            let start = hit.point - 1e-9 * path.direction;
            let wet = start.z < height(&scene.water, start.truncate()).0;
            let at_line = start.z.abs() < 1e-6 || wet != (start.z < 0.0);
            if grazing || at_line || path.events.len() == MAX_EVENTS {
                return;
            }
            let back = tracer.follow(start, -path.direction, 0.0);
            let count = path.events.len();
            assert!(back.events.len() >= count);
            for (there, back) in path.events.iter().rev().zip(&back.events) {
                assert!((there.point - back.point).length() < 1e-6);
                assert!((there.incident + back.deflected).length() < 1e-6);
                assert_eq!(there.total, back.total);
            }
            let last = count
                .checked_sub(1)
                .map_or((start, -path.direction), |last| {
                    (back.events[last].point, back.events[last].deflected)
                });
            assert!((path.origin - last.0).cross(last.1).length() < 1e-6);
            retraced += 1;
            several += usize::from(count > 1);
        });
        assert!(retraced > 10_000, "{retraced}");
        assert!(geometry == WaterGeometry::Flat || several > 20, "{several}");
    }
}

#[test]
fn water_of_index_one_is_not_there() {
    for geometry in GEOMETRIES {
        let mut scene = pool(geometry, 0.1);
        scene.water.refractive_index = 1.0;
        let mut dry = scene.clone();
        dry.water.level = -1e4;
        let dry = Tracer::new(&dry);
        let mut through_water = 0;
        each_path(&scene, |_, path| {
            let first = path
                .events
                .first()
                .map_or(path.direction, |event| event.incident);
            // Waves on a flat plane can have no answer even for equal indices.
            if path.undefined.is_some() {
                return;
            }
            let straight = dry.follow(path.origin, first, 0.0);
            match (path.hit, straight.hit) {
                (Some(a), Some(b)) => {
                    assert!((a.point - b.point).length() < 1e-9);
                    through_water += usize::from(!path.events.is_empty());
                }
                (a, b) => assert_eq!(a.is_some(), b.is_some()),
            }
            assert!(path.events.iter().all(|event| !event.total));
        });
        assert!(through_water > 5000);
    }
}

#[test]
fn waves_are_met_on_the_surface_and_not_before() {
    for slope in [0.02, 0.15, 0.6] {
        let scene = pool(WaterGeometry::Displaced, slope);
        let over = |point: DVec3| point.z - height(&scene.water, point.truncate()).0;
        let mut several = 0;
        each_path(&scene, |_, path| {
            let mut from = path.origin;
            let ends = path.events.iter().map(|event| event.point);
            let mut medium = path.medium;
            for (i, to) in ends.chain(path.hit.map(|hit| hit.point)).enumerate() {
                if i < path.events.len() {
                    assert!(over(to).abs() < 1e-9);
                } else if i == MAX_EVENTS {
                    break;
                }
                let side = if medium == Medium::Air { 1.0 } else { -1.0 };
                for step in 1..200 {
                    let at = from.lerp(to, f64::from(step) / 200.0);
                    assert!(side * over(at) > -1e-9, "{at} {medium:?}");
                }
                if let Some(event) = path.events.get(i)
                    && !event.total
                {
                    medium = medium.other();
                }
                from = to;
            }
            several += usize::from(path.events.len() > 2);
        });
        // Steep waves are left through a trough and met again.
        assert!(slope < 0.5 || several > 100, "{several}");
    }
}

#[test]
fn a_point_seen_through_flat_water_appears_at_the_pixel_that_shows_it() {
    for index in [1.333, 0.7, 1.0 + 1e-7, 2.4] {
        let mut scene = pool(WaterGeometry::Flat, 0.0);
        scene.water.refractive_index = index;
        let tracer = Tracer::new(&scene);
        for (eye, target) in EYES {
            let view = view(&scene, eye, target);
            let mut seen = 0;
            for pixel in pixels(&view) {
                let path = tracer.trace_pixel(&view, pixel);
                let Some(hit) = path.hit else { continue };
                let shown = if path.total() {
                    mirrored_pixel(hit.point, &scene, &view)
                } else {
                    apparent_pixel(hit.point, &scene, &view)
                };
                assert!(
                    (shown.unwrap() - pixel).length() < 1e-6,
                    "{index} {pixel} {shown:?}"
                );
                seen += 1;
            }
            assert!(seen > 1000);
        }
    }
}

#[test]
fn reflection_is_total_exactly_beyond_the_critical_angle() {
    for geometry in GEOMETRIES {
        let scene = pool(geometry, 0.0);
        let (mut total, mut transmitted) = (0, 0);
        each_path(&scene, |_, path| {
            assert!(path.events.len() <= 1, "a plane is met once");
            let Some(event) = path.events.first() else {
                return;
            };
            let beyond = event.incident.truncate().length() > 1.0 / 1.333;
            assert_eq!(event.total, beyond && path.medium == Medium::Water);
            total += usize::from(event.total);
            transmitted += usize::from(!event.total);
        });
        assert!(total > 500 && transmitted > 500, "{total} {transmitted}");
    }
}
