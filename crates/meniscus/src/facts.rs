//! What holds of a scene at its moment.

use glam::UVec2;
use meniscus_pipeline::{Facts, Outlook, SceneBounds};
use meniscus_scene::Scene;

/// What a scene's camera sees in a frame of `size` pixels. Whoever asks for each frame keeps the
/// scene's [`SceneBounds`] and asks [`Outlook::new`].
pub fn outlook_of(scene: &Scene, size: [u32; 2]) -> Outlook {
    Outlook::new(scene, &SceneBounds::new(scene), UVec2::from_array(size))
}

/// The facts of a scene in a frame of `size` pixels: see [`meniscus_pipeline::KNOWN_FACTS`].
pub fn facts_of(scene: &Scene, size: [u32; 2]) -> Facts {
    outlook_of(scene, size).facts
}
