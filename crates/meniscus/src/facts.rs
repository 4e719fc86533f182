//! What holds of a scene at its moment.

use meniscus_pipeline::Facts;
use meniscus_scene::{Scene, WaterGeometry};

/// The facts of a scene: see [`meniscus_pipeline::KNOWN_FACTS`].
pub fn facts_of(scene: &Scene) -> Facts {
    let water = &scene.water;
    let waves = !water.is_flat();
    let displaced = waves && water.geometry == WaterGeometry::Displaced;
    let eye = scene.camera.eye;
    let level = match displaced {
        true => water.level + water.height(eye.truncate()),
        false => water.level,
    };
    let held = [
        ("waves", waves),
        ("displaced", displaced),
        ("camera_submerged", eye.z < level),
    ];
    Facts::new(
        held.into_iter()
            .filter(|(_, holds)| *holds)
            .map(|(name, _)| name),
    )
}
