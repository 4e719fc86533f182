//! The water's height field.

use glam::DVec2;

use crate::{Water, WaterGeometry, Wave};

impl Water {
    /// Height of the waves above the rest plane at a point of it, metres; the geometry setting
    /// does not matter here.
    pub fn height(&self, xy: DVec2) -> f64 {
        self.waves
            .iter()
            .map(|wave| wave.amplitude * wave.angle(xy, self.time).sin())
            .sum()
    }

    /// ∂h/∂(x, y) at a point of the rest plane, metres per metre.
    pub fn gradient(&self, xy: DVec2) -> DVec2 {
        self.waves
            .iter()
            .map(|wave| wave.wave_vector * (wave.amplitude * wave.angle(xy, self.time).cos()))
            .sum()
    }

    /// No wave reaches further from the rest plane than this: Σ |A|, metres.
    pub fn height_bound(&self) -> f64 {
        // An empty sum of floats is −0, which would be printed so.
        0.0 + self
            .waves
            .iter()
            .map(|wave| wave.amplitude.abs())
            .sum::<f64>()
    }

    /// No slope is steeper than this: Σ |A| |k|.
    pub fn slope_bound(&self) -> f64 {
        let terms = self.waves.iter();
        0.0 + terms
            .map(|wave| wave.amplitude.abs() * wave.wave_vector.length())
            .sum::<f64>()
    }

    /// √⟨|∇h|²⟩ = √(Σ (A k)² / 2), the mean being over the plane and over time.
    pub fn rms_slope(&self) -> f64 {
        let twice: f64 = self
            .waves
            .iter()
            .map(|wave| wave.amplitude.powi(2) * wave.wave_vector.length_squared())
            .sum();
        (0.0 + 0.5 * twice).sqrt()
    }

    /// Whether the surface is a plane at all times.
    pub fn is_flat(&self) -> bool {
        self.height_bound() == 0.0
    }

    /// The same water at another time, seconds.
    #[must_use]
    pub fn at_time(&self, time: f64) -> Self {
        Self {
            time,
            ..self.clone()
        }
    }

    /// The same water with rays meeting it elsewhere.
    #[must_use]
    pub fn with_geometry(&self, geometry: WaterGeometry) -> Self {
        Self {
            geometry,
            ..self.clone()
        }
    }
}

impl Wave {
    /// The sine's argument, radians.
    fn angle(&self, xy: DVec2, time: f64) -> f64 {
        self.wave_vector.dot(xy) - self.angular_frequency * time + self.phase
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn water() -> Water {
        let wave = |degrees: f64, length: f64, amplitude: f64| {
            let k = std::f64::consts::TAU / length;
            Wave {
                amplitude,
                wave_vector: DVec2::from_angle(degrees.to_radians()) * k,
                angular_frequency: (9.80665 * k).sqrt(),
                phase: degrees,
            }
        };
        Water {
            level: 0.0,
            refractive_index: 1.333,
            waves: vec![
                wave(10.0, 2.0, 0.02),
                wave(75.0, 1.1, 0.01),
                wave(-40.0, 0.5, 0.004),
            ],
            time: 1.25,
            geometry: WaterGeometry::Displaced,
        }
    }

    #[test]
    fn the_gradient_is_the_height_s_derivative() {
        let (water, step) = (water(), 1e-5);
        for i in 0..200 {
            let xy = DVec2::new(0.37 * f64::from(i), -0.21 * f64::from(i));
            let slope = |offset: DVec2| {
                (water.height(xy + offset) - water.height(xy - offset)) / (2.0 * step)
            };
            let expected = DVec2::new(slope(DVec2::X * step), slope(DVec2::Y * step));
            assert!((water.gradient(xy) - expected).length() < 1e-8);
        }
    }

    #[test]
    fn a_wave_travels_along_its_wave_vector_at_its_phase_speed() {
        let mut water = water();
        water.waves.truncate(1);
        let wave = water.waves[0];
        let speed = wave.angular_frequency / wave.wave_vector.length();
        let along = wave.wave_vector.normalize();
        for i in 0..50 {
            let (xy, dt) = (DVec2::new(0.1 * f64::from(i), 0.3), 0.17);
            let later = water.at_time(water.time + dt);
            assert!((later.height(xy + along * speed * dt) - water.height(xy)).abs() < 1e-12);
        }
    }

    #[test]
    fn bounds_hold_everywhere() {
        let water = water();
        for i in 0..20_000 {
            let xy = DVec2::new(0.0137 * f64::from(i), 0.0291 * f64::from(i % 977));
            assert!(water.height(xy).abs() <= water.height_bound());
            assert!(water.gradient(xy).length() <= water.slope_bound());
        }
    }
}
