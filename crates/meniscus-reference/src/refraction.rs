//! What an interface between two media does to a ray.

use glam::DVec3;

/// The ray that goes on from an interface, as a unit direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Deflected {
    /// Into the other medium.
    Transmitted(DVec3),
    /// Back into its own: beyond the critical angle nothing is transmitted.
    Reflected(DVec3),
}

/// Deflects a ray by the boundary condition of the fields: the part of the wave vector along the
/// interface is the same on both sides (Born and Wolf, *Principles of Optics*, 1.5.1).
///
/// `incident` and `normal` are unit vectors with `incident · normal` < 0. The indices are absolute
/// and positive: `incident_index` on the side of the normal, `transmitted_index` beyond.
pub(crate) fn deflect(
    incident: DVec3,
    normal: DVec3,
    incident_index: f64,
    transmitted_index: f64,
) -> Deflected {
    let cosine = -incident.dot(normal);
    let tangential = incident + cosine * normal;
    // Wave vectors have the length of their medium's index. What the tangential part leaves of the
    // transmitted one is n2² − n1² sin² = (n2 − n1)(n2 + n1) + n1² cos², without cancellation.
    let axial_squared = (transmitted_index - incident_index) * (transmitted_index + incident_index)
        + (incident_index * cosine).powi(2);
    if axial_squared > 0.0 {
        let wave_vector = incident_index * tangential - axial_squared.sqrt() * normal;
        Deflected::Transmitted(wave_vector.normalize())
    } else {
        Deflected::Reflected((tangential + cosine * normal).normalize())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Unit directions that fall on a surface with this normal, at all angles up to grazing.
    fn incidents(normal: DVec3) -> impl Iterator<Item = (f64, DVec3)> {
        let (a, b) = normal.any_orthonormal_pair();
        (0..2000).map(move |i| {
            let angle = std::f64::consts::FRAC_PI_2 * (f64::from(i) + 0.5) / 2000.0;
            let (s, c) = (f64::from(i) * 2.4).sin_cos();
            (angle, angle.sin() * (c * a + s * b) - angle.cos() * normal)
        })
    }

    #[test]
    fn sines_are_as_the_indices_and_the_ray_stays_in_the_plane_of_incidence() {
        let normal = DVec3::new(0.3, -0.2, 0.9).normalize();
        for (n1, n2) in [
            (1.0, 1.333),
            (1.333, 1.0),
            (1.0, 0.4),
            (2.5, 1.0),
            (1.0, 1.0 + 1e-7),
        ] {
            for (angle, incident) in incidents(normal) {
                match deflect(incident, normal, n1, n2) {
                    Deflected::Transmitted(out) => {
                        let sine = out.cross(normal).length();
                        assert!((n1 * angle.sin() - n2 * sine).abs() < 1e-12);
                        assert!(out.dot(normal) < 0.0);
                        assert!(out.dot(incident.cross(normal)).abs() < 1e-12);
                        assert!((out.length() - 1.0).abs() < 1e-12);
                    }
                    Deflected::Reflected(out) => {
                        assert!(n1 * angle.sin() >= n2 * (1.0 - 1e-12));
                        assert!((out.dot(normal) + incident.dot(normal)).abs() < 1e-12);
                        assert!((out.cross(normal) - incident.cross(normal)).length() < 1e-12);
                    }
                }
            }
        }
    }

    #[test]
    fn a_transmitted_ray_sent_back_retraces_its_path() {
        let normal = DVec3::new(-0.5, 0.1, 0.8).normalize();
        for (_, incident) in incidents(normal) {
            if let Deflected::Transmitted(out) = deflect(incident, normal, 1.0, 1.333) {
                let Deflected::Transmitted(back) = deflect(-out, -normal, 1.333, 1.0) else {
                    panic!("what came in must get out");
                };
                assert!((back + incident).length() < 1e-9);
            }
        }
    }

    #[test]
    fn equal_indices_deflect_nothing() {
        let normal = DVec3::Z;
        for (_, incident) in incidents(normal) {
            let Deflected::Transmitted(out) = deflect(incident, normal, 1.0, 1.0) else {
                panic!("nothing to reflect from");
            };
            assert!((out - incident).length() < 1e-12);
        }
    }

    #[test]
    fn reflection_is_total_just_beyond_the_critical_angle() {
        let critical = (1.0_f64 / 1.333).asin();
        for (offset, total) in [(-1e-9, false), (1e-9, true)] {
            let (s, c) = (critical + offset).sin_cos();
            let out = deflect(DVec3::new(s, 0.0, c), DVec3::NEG_Z, 1.333, 1.0);
            assert_eq!(matches!(out, Deflected::Reflected(_)), total);
        }
    }
}
