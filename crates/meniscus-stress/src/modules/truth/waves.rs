//! Where a ray first meets a sum of waves: by leaving out what cannot hold a meeting, and halving the rest.

use crate::modules::Host;

/// One wave: wave vector (1/m), amplitude (m), phase (radians).
struct Wave {
    vector: [f64; 2],
    amplitude: f64,
    phase: f64,
}

/// The host's waves, and the side of the water that the eye is on.
pub(super) struct Waves {
    waves: Vec<Wave>,
    level: f64,
    side: f64,
}

/// The height of a ray over the waves, counted towards the ray's side.
struct Gap<'a> {
    waves: &'a Waves,
    ray: &'a [f64],
    /// Nowhere does the height bend more, 1/m.
    bend: f64,
}

impl Waves {
    pub(super) fn of(host: &Host) -> Option<Self> {
        let mut waves = Vec::new();
        while let Some(vector) = host.numbers(&format!("waves[{}].wave_vector", waves.len())) {
            let member = |name: &str| host.number(&format!("waves[{}].{name}", waves.len()));
            waves.push(Wave {
                // Shaders get floats.
                vector: [
                    f64::from(vector[0] as f32),
                    f64::from(*vector.get(1)? as f32),
                ],
                amplitude: f64::from(member("amplitude")? as f32),
                phase: f64::from(member("phase").unwrap_or(0.0) as f32),
            });
        }
        Some(Self {
            waves,
            level: host.number("water.level")?,
            side: host.number("water.camera_side")?,
        })
    }

    /// Height over the rest plane and gradient.
    fn shape(&self, x: f64, y: f64) -> [f64; 3] {
        let mut shape = [0.0; 3];
        for wave in &self.waves {
            let angle = wave.vector[0] * x + wave.vector[1] * y + wave.phase;
            shape[0] += wave.amplitude * angle.sin();
            shape[1] += wave.amplitude * angle.cos() * wave.vector[0];
            shape[2] += wave.amplitude * angle.cos() * wave.vector[1];
        }
        shape
    }

    /// A ray's origin (3) and direction (3), the origin on the eye's side: the point that it first
    /// meets (3), the waves' normal there (3), and 1. No opinion where it meets none, only just
    /// meets one, or starts on the other side.
    pub(super) fn meeting(&self, ray: &[f64]) -> Vec<f64> {
        let bound: f64 = self.waves.iter().map(|w| w.amplitude.abs()).sum();
        let along = |w: &Wave| w.vector[0] * ray[3] + w.vector[1] * ray[4];
        let bend = self
            .waves
            .iter()
            .map(|w| (w.amplitude * along(w).powi(2)).abs());
        let gap = Gap {
            waves: self,
            ray,
            bend: bend.sum(),
        };
        let (height, fall) = (self.side * (ray[2] - self.level), -self.side * ray[5]);
        let (enter, leave) = ((height - bound) / fall, (height + bound) / fall);
        // Only rays that fall through the whole band are asked about, and do so soon; others run on
        // for ever.
        let soon = fall > 0.0 && leave < 1e5 && leave - enter < 100.0;
        if !soon || gap.at(0.0).0 <= 0.0 {
            return vec![f64::NAN; 7];
        }
        let Some(t) = gap.first(enter.max(0.0), leave) else {
            return vec![f64::NAN; 7];
        };
        let at = |axis: usize| ray[axis] + t * ray[axis + 3];
        let shape = self.shape(at(0), at(1));
        let length = (1.0 + shape[1] * shape[1] + shape[2] * shape[2]).sqrt();
        let z = self.level + shape[0];
        let normal = [-shape[1] / length, -shape[2] / length, 1.0 / length];
        vec![at(0), at(1), z, normal[0], normal[1], normal[2], 1.0]
    }
}

impl Gap<'_> {
    /// The gap at a distance along the ray, and how it changes.
    fn at(&self, t: f64) -> (f64, f64) {
        let at = |axis: usize| self.ray[axis] + t * self.ray[axis + 3];
        let [height, x, y] = self.waves.shape(at(0), at(1));
        let rise = self.ray[5] - x * self.ray[3] - y * self.ray[4];
        let side = self.waves.side;
        (side * (at(2) - self.waves.level - height), side * rise)
    }

    /// The first 0 in an interval: none, too, where it cannot be told from a near miss.
    fn first(&self, from: f64, to: f64) -> Option<f64> {
        let mut intervals = vec![(from, to)];
        while let Some((a, b)) = intervals.pop() {
            let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
            let (gap, slope) = self.at(middle);
            // By Taylor's theorem the gap stays above this.
            if gap - slope.abs() * half - 0.5 * self.bend * half * half > 0.0 {
                continue;
            }
            if slope < -self.bend * half {
                // It falls all the way: there is one meeting, or none.
                if self.at(b).0 > 0.0 {
                    continue;
                }
                return (self.at(a).0 > 0.0).then(|| self.halved(a, b));
            }
            if half < 1e-9 * (1.0 + middle) {
                return None;
            }
            intervals.push((middle, b));
            intervals.push((a, middle));
        }
        None
    }

    /// The 0 between a place above the waves and one below.
    fn halved(&self, mut above: f64, mut below: f64) -> f64 {
        loop {
            let middle = 0.5 * (above + below);
            if middle <= above || middle >= below {
                return middle;
            }
            if self.at(middle).0 > 0.0 {
                above = middle;
            } else {
                below = middle;
            }
        }
    }
}
