//! Refraction and deflection.

use glam::DVec3;
use meniscus_stress::Lanes;

use crate::lab::*;

const LANES: usize = 20_000;

struct Refracted {
    incident: Vec<DVec3>,
    normal: Vec<DVec3>,
    index: Vec<f64>,
    found: Lanes<f32>,
}

fn refracted() -> Refracted {
    let mut rng = rng();
    let (incident, normal) = (units(&mut rng, LANES), units(&mut rng, LANES));
    let index = within(&mut rng, 0.4, 2.5, LANES);
    let found = Lab::of("optics/snell").call(
        "refracted",
        &[vectors(&incident), vectors(&normal), scalars(&index)],
    );
    Refracted {
        incident,
        normal,
        index,
        found,
    }
}

impl Refracted {
    /// Direction of every lane in which light goes through.
    fn through(&self) -> impl Iterator<Item = (usize, DVec3)> {
        let passes = |lane: &usize| number(&self.found, 3, *lane) == 0.0;
        (0..LANES)
            .filter(passes)
            .map(|lane| (lane, vec3(&self.found, 0, lane)))
    }

    fn sine(&self, lane: usize) -> f64 {
        self.incident[lane].cross(self.normal[lane]).length()
    }
}

#[test]
fn refracted_ray_stays_in_the_plane_of_incidence() {
    let r = refracted();
    let mut seen = 0;
    for (lane, direction) in r.through() {
        let across = r.incident[lane].cross(r.normal[lane]);
        if across.length() > 1e-3 {
            assert!(direction.dot(across.normalize()).abs() < 1e-6 / across.length().min(1.0));
            seen += 1;
        }
    }
    assert!(seen > LANES / 2);
}

#[test]
fn refracted_ray_obeys_snell_and_keeps_unit_length() {
    let r = refracted();
    for (lane, direction) in r.through() {
        let transmitted = direction.cross(r.normal[lane]).length();
        assert!((transmitted * r.index[lane] - r.sine(lane)).abs() < 1e-6);
        assert!((direction.length() - 1.0).abs() < 3e-7);
    }
}

#[test]
fn refracted_ray_goes_on_to_the_other_side() {
    let r = refracted();
    for (lane, direction) in r.through() {
        let (before, behind) = (
            r.incident[lane].dot(r.normal[lane]),
            direction.dot(r.normal[lane]),
        );
        assert!(before * behind >= 0.0, "{before} {behind}");
    }
}

#[test]
fn all_light_is_reflected_just_beyond_the_critical_angle() {
    let r = refracted();
    let mut totals = 0;
    for lane in 0..LANES {
        let excess = r.sine(lane) / r.index[lane] - 1.0;
        if excess.abs() > 1e-6 {
            let total = number(&r.found, 3, lane) == 1.0;
            assert_eq!(total, excess > 0.0, "lane {lane}, {excess}");
            totals += usize::from(total);
            if total {
                assert_eq!(vec3(&r.found, 0, lane), DVec3::ZERO);
            }
        }
    }
    assert!(totals > LANES / 20);
}

#[test]
fn refraction_is_reversible() {
    let r = refracted();
    let lanes: Vec<(usize, DVec3)> = r.through().collect();
    let back: Vec<DVec3> = lanes.iter().map(|(_, d)| -*d).collect();
    let normal: Vec<DVec3> = lanes.iter().map(|(lane, _)| r.normal[*lane]).collect();
    let inverse: Vec<f64> = lanes.iter().map(|(lane, _)| 1.0 / r.index[*lane]).collect();
    let found: Lanes<f32> = Lab::of("optics/snell").call(
        "refracted",
        &[vectors(&back), vectors(&normal), scalars(&inverse)],
    );
    for (at, (lane, _)) in lanes.iter().enumerate() {
        // Rounding of the sine grows by tan on the way back to a grazing angle.
        let cosine = r.incident[*lane].dot(r.normal[*lane]).abs();
        if cosine > 1e-2 {
            let error = (vec3(&found, 0, at) + r.incident[*lane]).length();
            assert!(error < 1e-6 / cosine, "{error} at cosine {cosine}");
        }
    }
}

#[test]
fn nothing_bends_where_the_indices_are_equal() {
    let mut rng = rng();
    let (incident, normal) = (units(&mut rng, LANES), units(&mut rng, LANES));
    let found: Lanes<f32> = Lab::of("optics/snell").call(
        "refracted",
        &[
            vectors(&incident),
            vectors(&normal),
            scalars(&vec![1.0; LANES]),
        ],
    );
    for lane in 0..LANES {
        let cosine = incident[lane].dot(normal[lane]).abs();
        if cosine > 1e-3 {
            let error = (vec3(&found, 0, lane) - incident[lane]).length();
            assert!(error < 5e-7 / cosine, "{error} at cosine {cosine}");
        }
    }
}

#[test]
fn either_side_of_the_normal_is_the_same_surface() {
    let r = refracted();
    let turned: Vec<DVec3> = r.normal.iter().map(|n| -*n).collect();
    let found: Lanes<f32> = Lab::of("optics/snell").call(
        "refracted",
        &[vectors(&r.incident), vectors(&turned), scalars(&r.index)],
    );
    assert_eq!(found, r.found);
}

/// Rays down onto water, and normals tilted by up to 45°.
fn onto_water(above: bool) -> (Vec<DVec3>, Vec<DVec3>, Vec<DVec3>) {
    let mut rng = rng();
    let down = if above { -1.0 } else { 1.0 };
    let incident = (0..LANES).map(|_| {
        let v = unit(&mut rng);
        DVec3::new(v.x, v.y, down * v.z.abs().max(1e-3)).normalize()
    });
    let incident = incident.collect();
    let normal = (0..LANES)
        .map(|_| (unit(&mut rng) + DVec3::Z * 1.5).normalize())
        .collect();
    (points(&mut rng, 1e3, LANES), incident, normal)
}

fn deflected(
    path: &str,
    index: f64,
    above: bool,
    flat: bool,
) -> (Vec<DVec3>, Vec<DVec3>, Lanes<f32>) {
    let (origin, incident, normal) = onto_water(above);
    let normal = if flat { vec![DVec3::Z; LANES] } else { normal };
    let ray = structure(&[vectors(&origin), vectors(&incident)]);
    let found: Lanes<f32> = Lab::of(path)
        .water(index, above)
        .call("deflect", &[ray, vectors(&normal)]);
    for (lane, origin) in origin.iter().enumerate() {
        assert_eq!(
            vec3(&found, 0, lane),
            origin.as_vec3().as_dvec3(),
            "rays go on where they are"
        );
        let length = vec3(&found, 3, lane).length();
        assert!((length - 1.0).abs() < 1e-6, "{path}: {length}");
    }
    (incident, normal, found)
}

#[test]
fn totally_reflected_rays_leave_as_they_came() {
    let (incident, normal, found) = deflected("optics/refracted_ray", 1.333, false, false);
    let mut totals = 0;
    for lane in 0..LANES {
        if number(&found, 6, lane) == 1.0 {
            let (n, direction) = (normal[lane], vec3(&found, 3, lane));
            assert!((direction.dot(n) + incident[lane].dot(n)).abs() < 1e-6);
            assert!((direction.cross(n) - incident[lane].cross(n)).length() < 1e-6);
            totals += 1;
        }
    }
    assert!(totals > LANES / 20, "{totals}");
}

#[test]
fn a_flat_normal_refracts_as_flat_water() {
    for (index, above) in [(1.333, true), (1.333, false), (0.4, true), (2.5, false)] {
        let (_, _, truth) = deflected("optics/refracted_ray", index, above, true);
        let (_, _, turned) = deflected("optics/rotated_refracted_ray", index, above, true);
        for lane in 0..LANES {
            let error = (vec3(&truth, 3, lane) - vec3(&turned, 3, lane)).length();
            assert!(error < 5e-7, "{error}");
        }
    }
}

#[test]
fn a_flat_normal_leaves_the_camera_ray_where_it_is_turned_or_sheared() {
    for path in ["optics/rotated_camera_ray", "optics/offset_by_normal"] {
        let (incident, _, found) = deflected(path, 1.333, true, true);
        for (lane, incident) in incident.iter().enumerate() {
            assert!((vec3(&found, 3, lane) - *incident).length() < 5e-7);
        }
    }
}

#[test]
fn turned_rays_make_the_angle_with_the_wave_that_they_made_with_the_flat_water() {
    let (_, _, flat) = deflected("optics/rotated_refracted_ray", 1.333, true, true);
    let (_, normal, found) = deflected("optics/rotated_refracted_ray", 1.333, true, false);
    for (lane, normal) in normal.iter().enumerate() {
        let angle = vec3(&found, 3, lane).dot(*normal);
        assert!((angle - vec3(&flat, 3, lane).z).abs() < 1e-6);
    }
}
