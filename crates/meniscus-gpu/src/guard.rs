//! How wide a band around the frame the seen buffers need.
//!
//! A tilted surface shows at a pixel what flat water would show elsewhere, by an angle that is
//! proportional to the tilt. What is shown at the frame's edge may thus stand outside the frame.

use glam::UVec2;
use meniscus_scene::{View, Water};

/// Largest width and height of a guarded view, as a multiple of the frame's.
pub const GUARD_MAX: f64 = 1.5;

/// How many rms slopes the guard band takes account of: beyond it are a few in a thousand surface
/// points, and what they show outside the band is found by other means or clamped.
const RMS_MULTIPLE: f64 = 3.0;

/// Steps in which the angle of incidence is searched for the largest shift.
const STEPS: u32 = 512;

/// What the guard band depends on; nothing of it changes with time alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GuardFacts {
    /// Largest tilt of the surface that counts, radians; 0 for flat water.
    pub tilt: f64,
    /// Refractive index of the far side relative to the camera's side.
    pub relative_index: f64,
    /// Distance of the eye from the rest plane, metres.
    pub eye_distance: f64,
    /// How far the scene reaches beyond the rest plane, metres.
    pub far_reach: f64,
    /// How far the scene reaches on the camera's side, metres; 0 where nothing is totally
    /// reflected.
    pub near_reach: f64,
}

/// The tilt to take account of, radians: the angle of the smaller of the bound Σ|A||k| and three
/// times the rms slope √(½ Σ (A k)²), which is much the smaller one for many waves.
pub fn largest_tilt(water: &Water) -> f64 {
    water
        .slope_bound()
        .min(RMS_MULTIPLE * water.rms_slope())
        .atan()
}

/// Pixels to add on every side (x: left and right, y: top and bottom) so that a point displaced by
/// the largest apparent shift still lies inside; each at most (`guard_max` − 1) / 2 of the frame.
///
/// The shift is the largest over all angles of incidence, so that it depends on the eye's distance
/// from the water but not on where it looks; it is taken as an angle at the frame's edges.
pub fn guard(view: &View, facts: &GuardFacts, guard_max: f64) -> UVec2 {
    let shift = largest_shift(facts) * facts.tilt;
    let side = |size: u32| -> u32 {
        let half = 0.5 * f64::from(size);
        let cap = ((guard_max - 1.0) * half).floor().max(0.0);
        let edge = (half / view.focal).atan();
        // Beyond 89° the band would be without bound; the cap holds there.
        let outer = (edge + shift).min(89_f64.to_radians());
        let wanted = (view.focal * outer.tan() - half).ceil();
        // min and max rather than clamp, which panics where a bound is not a number.
        let whole = if wanted.is_nan() {
            cap
        } else {
            wanted.max(0.0).min(cap)
        };
        whole as u32
    };
    if shift > 0.0 {
        UVec2::new(side(view.size.x), side(view.size.y))
    } else {
        UVec2::ZERO
    }
}

/// Largest apparent shift, in radians per radian of surface tilt.
fn largest_shift(facts: &GuardFacts) -> f64 {
    let refracted = (0..STEPS)
        .map(|i| f64::from(i) / f64::from(STEPS) * std::f64::consts::FRAC_PI_2)
        .map(|incidence| refracted_shift(facts, incidence))
        .fold(0.0, f64::max);
    refracted.max(reflected_shift(facts))
}

/// Apparent shift per radian of tilt of a far point seen at an angle of incidence α (radians);
/// 0 for total reflection.
///
/// Tilting the surface by δ where the ray meets it turns the refracted ray by
/// (1 − cos α / (n cos β)) δ, and so moves the point that it meets, at a depth s beyond the plane,
/// by s sec²β times that along the plane. In flat water's picture that point stands where
/// d = f tan α + s tan β has changed by as much, f being the eye's distance. Deep points shift by
/// n cos β / cos α − 1: 0.33 straight down, 1.0 at 60°, 2.5 at 75° for water.
fn refracted_shift(facts: &GuardFacts, incidence: f64) -> f64 {
    let n = facts.relative_index;
    let sine = incidence.sin() / n;
    if sine.abs() >= 1.0 || facts.far_reach <= 0.0 {
        return 0.0;
    }
    let (cos_in, cos_out) = (incidence.cos(), (1.0 - sine * sine).sqrt());
    let turn = cos_in / (n * cos_out);
    let reach = facts.far_reach / (cos_out * cos_out);
    let spread = facts.eye_distance / (cos_in * cos_in) + reach * turn;
    (reach * (1.0 - turn) / spread).abs()
}

/// Apparent shift per radian of tilt of a totally reflected point: the reflected ray turns by
/// twice the tilt, of which the eye sees the part s / (f + s) that lies behind the surface.
fn reflected_shift(facts: &GuardFacts) -> f64 {
    if facts.near_reach > 0.0 {
        2.0 * facts.near_reach / (facts.eye_distance + facts.near_reach)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec2, DVec3};
    use meniscus_scene::{Camera, WaterGeometry, Wave};

    fn view(size: UVec2) -> View {
        let camera = Camera {
            eye: DVec3::new(0.0, 0.0, 1.7),
            target: DVec3::new(0.0, 3.0, 0.0),
            field_of_view: 0.9,
            near: 0.05,
        };
        camera.view(size)
    }

    fn pool(tilt: f64) -> GuardFacts {
        GuardFacts {
            tilt,
            relative_index: 1.333,
            eye_distance: 1.7,
            far_reach: 2.0,
            near_reach: 0.0,
        }
    }

    /// Where flat water shows the point that a ray of this incidence meets on a floor at depth s
    /// through a surface tilted by δ, as an angle; by Snell's law alone.
    fn apparent(facts: &GuardFacts, incidence: f64, tilt: f64) -> f64 {
        let n = facts.relative_index;
        let (f, s) = (facts.eye_distance, facts.far_reach);
        let inside = ((incidence - tilt).sin() / n).asin() + tilt;
        let distance = f * incidence.tan() + s * inside.tan();
        let (mut low, mut high) = (0.0, std::f64::consts::FRAC_PI_2);
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            let d = f * f64::tan(middle) + s * (middle.sin() / n).asin().tan();
            if d < distance {
                low = middle
            } else {
                high = middle
            }
        }
        low
    }

    #[test]
    fn the_shift_is_that_of_snells_law() {
        for incidence in [0.1, 0.5, 1.0, 1.3] {
            for far_reach in [0.1, 2.0, 300.0] {
                let facts = GuardFacts {
                    far_reach,
                    ..pool(0.0)
                };
                let tilt = 1e-5;
                let measured = (apparent(&facts, incidence, tilt) - incidence).abs() / tilt;
                let shift = refracted_shift(&facts, incidence);
                assert!(
                    (measured - shift).abs() < 1e-3 * (1.0 + shift),
                    "{measured} {shift}"
                );
            }
        }
    }

    #[test]
    fn deep_points_shift_as_measured() {
        let facts = GuardFacts {
            far_reach: 1e9,
            ..pool(0.0)
        };
        for (degrees, expected) in [(0.0_f64, 0.33), (60.0, 1.0), (75.0, 2.5)] {
            let shift = refracted_shift(&facts, degrees.to_radians());
            assert!((shift - expected).abs() < 0.06, "{degrees}: {shift}");
        }
    }

    #[test]
    fn flat_water_needs_no_guard_and_steeper_water_never_a_smaller_one() {
        let view = view(UVec2::new(640, 360));
        assert_eq!(guard(&view, &pool(0.0), GUARD_MAX), UVec2::ZERO);
        let mut last = UVec2::ZERO;
        for tilt in [1e-6, 0.01, 0.1, 0.3, 1.0, 1.5] {
            let guard = guard(&view, &pool(tilt), GUARD_MAX);
            assert!(
                guard.cmpge(last).all() && guard.min_element() > 0,
                "{tilt}: {guard}"
            );
            last = guard;
        }
    }

    #[test]
    fn the_guarded_size_stays_within_the_cap() {
        for size in [
            UVec2::ONE,
            UVec2::new(7, 5),
            UVec2::new(640, 360),
            UVec2::new(1, 4000),
        ] {
            let view = view(size);
            let widest = GuardFacts {
                tilt: 1.5,
                eye_distance: 0.0,
                ..pool(0.0)
            };
            let guarded = view
                .guarded(guard(&view, &widest, GUARD_MAX))
                .size
                .as_dvec2();
            assert!(
                guarded.cmple(GUARD_MAX * size.as_dvec2()).all(),
                "{size}: {guarded}"
            );
        }
    }

    #[test]
    fn degenerate_facts_give_a_guard_too() {
        let view = view(UVec2::new(64, 48));
        for relative_index in [0.4, 0.75, 1.0, 1.0 + 1e-7, 2.5] {
            for (eye_distance, far_reach) in [(0.0, 0.0), (0.0, 1.0), (1e-9, 1e9), (1e5, 1e-4)] {
                let facts = GuardFacts {
                    tilt: 0.3,
                    relative_index,
                    eye_distance,
                    far_reach,
                    near_reach: far_reach,
                };
                let guard = guard(&view, &facts, GUARD_MAX);
                assert!(guard.x <= 16 && guard.y <= 12, "{facts:?}: {guard}");
            }
        }
    }

    #[test]
    fn the_tilt_is_bounded_by_the_sum_and_by_the_rms_slope() {
        let wave = Wave {
            amplitude: 0.01,
            wave_vector: DVec2::new(6.0, 8.0),
            angular_frequency: 1.0,
            phase: 0.0,
        };
        let water = |waves: usize| Water {
            level: 0.0,
            refractive_index: 1.333,
            waves: vec![wave; waves],
            time: 0.0,
            geometry: WaterGeometry::Flat,
        };
        assert_eq!(largest_tilt(&water(0)), 0.0);
        assert!((largest_tilt(&water(1)).tan() - 0.1).abs() < 1e-12);
        let many = 3.0 * 0.1 * (0.5 * 32.0_f64).sqrt();
        assert!((largest_tilt(&water(32)).tan() - many).abs() < 1e-12);
    }
}
