//! The water's surface, and where a ray meets it first.

use glam::{DVec2, DVec3};
use meniscus_scene::{Water, WaterGeometry};

/// Steps along one ray before the march gives up. Only a ray that skims crests for kilometres
/// needs that many; it is then said to meet nothing.
const MAX_STEPS: usize = 100_000;

/// Beyond this distance (metres) along a ray there is no water; it keeps points finite.
const FARTHEST: f64 = 1e15;

/// What a ray runs through.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Medium {
    /// Above the surface, and on it.
    Air,
    /// Below it.
    Water,
}

impl Medium {
    /// The medium on the other side of the surface.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::Air => Self::Water,
            Self::Water => Self::Air,
        }
    }

    /// +1 above the surface, −1 below.
    pub(crate) fn sign(self) -> f64 {
        match self {
            Self::Air => 1.0,
            Self::Water => -1.0,
        }
    }
}

/// A wave at one moment.
#[derive(Debug, Clone, Copy)]
struct Term {
    amplitude: f64,
    wave_vector: DVec2,
    phase: f64,
}

/// The surface at the scene's time.
#[derive(Debug, Clone)]
pub(crate) struct Surface {
    level: f64,
    index: f64,
    displaced: bool,
    terms: Vec<Term>,
    /// No wave reaches farther from the rest plane, metres.
    reach: f64,
}

impl Surface {
    pub(crate) fn new(water: &Water) -> Self {
        let terms: Vec<Term> = water
            .waves
            .iter()
            .filter(|wave| wave.amplitude != 0.0)
            .map(|wave| Term {
                amplitude: wave.amplitude,
                wave_vector: wave.wave_vector,
                phase: wave.phase - wave.angular_frequency * water.time,
            })
            .collect();
        Self {
            level: water.level,
            index: water.refractive_index,
            displaced: water.geometry == WaterGeometry::Displaced && !terms.is_empty(),
            reach: terms.iter().map(|term| term.amplitude.abs()).sum(),
            terms,
        }
    }

    /// Absolute refractive index, air being 1.
    pub(crate) fn index(&self, medium: Medium) -> f64 {
        match medium {
            Medium::Air => 1.0,
            Medium::Water => self.index,
        }
    }

    /// Whether rays meet the waves themselves, not the rest plane.
    pub(crate) fn displaced(&self) -> bool {
        self.displaced
    }

    /// Height of the waves over the rest plane (metres) and its gradient.
    fn waves(&self, at: DVec2) -> (f64, DVec2) {
        let mut height = 0.0;
        let mut gradient = DVec2::ZERO;
        for term in &self.terms {
            let (sine, cosine) = (term.wave_vector.dot(at) + term.phase).sin_cos();
            height += term.amplitude * sine;
            gradient += term.amplitude * cosine * term.wave_vector;
        }
        (height, gradient)
    }

    /// Unit normal of the waves, upwards.
    pub(crate) fn normal(&self, at: DVec2) -> DVec3 {
        let (_, gradient) = self.waves(at);
        DVec3::new(-gradient.x, -gradient.y, 1.0).normalize()
    }

    /// The medium at a point.
    pub(crate) fn medium(&self, point: DVec3) -> Medium {
        let waves = if self.displaced {
            self.waves(point.truncate()).0
        } else {
            0.0
        };
        if point.z - self.level >= waves {
            Medium::Air
        } else {
            Medium::Water
        }
    }

    /// Distance along a ray (unit direction) that runs in `medium` to where it leaves that medium,
    /// if it does before `limit`.
    pub(crate) fn meet(
        &self,
        origin: DVec3,
        direction: DVec3,
        medium: Medium,
        limit: f64,
    ) -> Option<f64> {
        let limit = limit.min(FARTHEST);
        if self.displaced {
            return self.march(origin, direction, medium, limit);
        }
        let height = medium.sign() * (origin.z - self.level);
        let climb = medium.sign() * direction.z;
        // A ray that starts on the plane, or by rounding behind it, meets it where it starts.
        let t = height.max(0.0) / -climb;
        (climb < 0.0 && t < limit).then_some(t)
    }

    /// The first meeting with the waves.
    ///
    /// The distance to the surface along the vertical, f(t), falls no faster than the waves' slope
    /// bound allows and no faster than the parabola through its value and derivative with the
    /// waves' bound on curvature. Stepping to where the later of the two bounds reaches zero can
    /// therefore not overshoot; near a crossing the parabola's step is Newton's, so that the march
    /// converges quadratically from outside and needs no bisection.
    fn march(&self, origin: DVec3, direction: DVec3, medium: Medium, limit: f64) -> Option<f64> {
        let sign = medium.sign();
        let climb = sign * direction.z;
        let start = sign * (origin.z - self.level);
        let along = direction.truncate();
        let (mut slope, mut curvature) = (0.0, 0.0);
        for term in &self.terms {
            let rate = term.wave_vector.dot(along);
            slope += (term.amplitude * rate).abs();
            curvature += term.amplitude.abs() * rate * rate;
        }
        // Outside the waves' reach nothing can be met.
        let mut t = 0.0;
        let mut limit = limit;
        if start > self.reach {
            if climb >= 0.0 {
                return None;
            }
            t = (start - self.reach) / -climb;
        } else if climb > 0.0 {
            limit = limit.min((self.reach - start) / climb);
        }
        for _ in 0..MAX_STEPS {
            if t >= limit {
                return None;
            }
            let point = origin + t * direction;
            let (height, gradient) = self.waves(point.truncate());
            let f = sign * (point.z - self.level - height);
            let rate = climb - sign * gradient.dot(along);
            if f <= self.rounding(origin, t) && rate < 0.0 {
                return Some(t);
            }
            if climb >= slope {
                return None;
            }
            let f = f.max(0.0);
            let root = (rate * rate + 2.0 * curvature * f).sqrt();
            let parabola = if rate < 0.0 {
                2.0 * f / (root - rate)
            } else {
                // A curvature of 0 lets the ray run straight away from the surface.
                (rate + root) / curvature
            };
            let straight = f / (slope - climb);
            let shortest = 1e-15 + 4.0 * f64::EPSILON * t;
            // `max` ignores the NaN of 0 / 0.
            t += shortest.max(straight).max(parabola);
        }
        None
    }

    /// How far rounding alone can put a point of the ray off the surface, metres.
    fn rounding(&self, origin: DVec3, t: f64) -> f64 {
        let place = origin.abs().max_element() + t;
        let slope: f64 = self
            .terms
            .iter()
            .map(|term| (term.amplitude * term.wave_vector.length()).abs())
            .sum();
        4.0 * f64::EPSILON * (1.0 + self.level.abs() + (1.0 + slope) * place)
    }
}
