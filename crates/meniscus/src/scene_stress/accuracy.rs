//! Frames held to the truth, where the scene is one for which the modules promise it.

use meniscus_measure::{Comparison, Picture, Verdict};
use meniscus_reference::{Tracer, Truth};
use meniscus_scene::{Scene, View};

use super::Fault;
use super::examine::{Rendered, has_sheet_in_water};
use crate::{subject, truth};

/// Nothing of a scene may lie further from the origin than what modules' domains reach, metres.
const REACH: f64 = 1e4;
/// The eye's least distance from the water, metres.
const CLOSEST: f64 = 1e-3;
/// The steepest waves that accuracy is told for (findings: tables up to a root mean square of 0.29).
const STEEPEST: f64 = 0.3;
/// The largest phase of a wave that its sum is promised for, radians.
const TURNED: f64 = 7e3;
/// Of pictures smaller than this a share of pixels says nothing, pixels.
const SMALLEST: u32 = 8;
/// Pixels further than half a pixel from the truth that are accepted: so many, and a share.
const ACCEPTED: (usize, f64) = (2, 0.02);

/// The truth of one scene and view.
pub(crate) struct Standard<'a> {
    scene: &'a Scene,
    view: &'a View,
    truth: Truth,
    points: Vec<meniscus_measure::Seen>,
    projected: Vec<Option<[f64; 2]>>,
}

/// How far a frame is from the truth.
#[derive(Debug, Clone, Copy, Default, serde::Serialize)]
pub struct Distance {
    /// Pixels that were judged.
    pub pixels: usize,
    /// Those of them that are off by more than half a pixel.
    pub far: usize,
    /// The mean error of all, pixels.
    pub mean_px: f64,
}

/// Whether all modules are inside their domains.
pub(crate) fn is_inside(scene: &Scene, size: [u32; 2]) -> bool {
    let water = &scene.water;
    let camera = &scene.camera;
    let reach = scene.bounds().map_or(0.0, |(low, high)| {
        low.abs().max_element().max(high.abs().max_element())
    });
    let waves = water.waves.iter().filter(|wave| wave.amplitude > 0.0);
    let shortest = waves.map(|wave| wave.wave_vector.length());
    let shortest = shortest.fold(0.0, f64::max);
    let above = camera.eye.z - water.level;
    reach <= REACH
        && !has_sheet_in_water(scene)
        && camera.eye.abs().max_element() <= REACH
        && above.abs() >= CLOSEST + 2.0 * water.height_bound()
        && water.rms_slope() <= STEEPEST
        && shortest * reach.max(camera.eye.abs().max_element()) <= TURNED
        && (10.0..=130.0).contains(&camera.field_of_view.to_degrees())
        && camera.near <= 0.1
        && size.iter().all(|&side| side >= SMALLEST)
}

impl<'a> Standard<'a> {
    /// Traces the truth.
    pub fn trace(scene: &'a Scene, view: &'a View) -> Self {
        let traced = Tracer::new(scene).trace(view, &|_| {});
        let points = truth::seen(&traced);
        let projected = truth::project(&points, &traced, scene, view);
        Self {
            scene,
            view,
            truth: traced,
            points,
            projected,
        }
    }

    /// Holds what is shown to the truth.
    ///
    /// # Errors
    /// Where too much of it is wrong.
    pub fn judge(&self, rendered: &Rendered) -> Result<Distance, Fault> {
        let points = subject::seen(&rendered.shown);
        let projected = truth::project(&points, &self.truth, self.scene, self.view);
        let size = self.truth.size.to_array();
        let judgement = Comparison {
            size,
            border_px: 0,
            scene_diagonal_m: 1.0,
            water: &self.truth.water_first,
            undefined: &self.truth.undefined,
            // Points are judged, not colours.
            shown: Picture {
                points: &points,
                projected: &projected,
                colours: &self.truth.colour,
            },
            truth: Picture {
                points: &self.points,
                projected: &self.projected,
                colours: &self.truth.colour,
            },
        }
        .judge()
        .map_err(|error| Fault::Inaccurate(error.to_string()))?;
        let errors: Vec<f64> = judgement
            .verdicts
            .iter()
            .filter_map(|verdict| match verdict {
                Verdict::Error { px, .. } => Some(*px),
                _ => None,
            })
            .collect();
        let far = errors.iter().filter(|px| **px > 0.5).count();
        let distance = Distance {
            pixels: errors.len(),
            far,
            mean_px: errors.iter().sum::<f64>() / errors.len().max(1) as f64,
        };
        let (some, share) = ACCEPTED;
        if far as f64 > some as f64 + share * errors.len() as f64 {
            return Err(Fault::Inaccurate(format!(
                "{far} of {} pixels show points that are more than half a pixel off (mean {:.2} pixels)",
                errors.len(),
                distance.mean_px
            )));
        }
        Ok(distance)
    }
}
