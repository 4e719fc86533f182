//! The truth in the words of the measuring crate.

use glam::{DVec2, DVec3};
use meniscus_measure::Seen;
use meniscus_reference::{Truth, apparent_pixel, mirrored_pixel};
use meniscus_scene::{Scene, View};

/// The true points.
pub(crate) fn seen(truth: &Truth) -> Vec<Seen> {
    truth
        .point
        .iter()
        .zip(&truth.object)
        .map(|(point, object)| Seen {
            position: *point,
            object: *object,
        })
        .collect()
}

/// Where points appear through flat water; through the mirrored camera where the true ray was
/// totally reflected.
pub(crate) fn project(
    points: &[Seen],
    truth: &Truth,
    scene: &Scene,
    view: &View,
) -> Vec<Option<[f64; 2]>> {
    points
        .iter()
        .zip(&truth.total)
        .map(|(seen, total)| {
            let point = DVec3::from_array(seen.position);
            let pixel = match total {
                true => mirrored_pixel(point, scene, view),
                false => apparent_pixel(point, scene, view),
            };
            pixel.map(|p: DVec2| p.to_array())
        })
        .collect()
}
