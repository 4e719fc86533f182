//! One pipeline, one scene, one picture.

use meniscus_gpu::{Gpu, GpuError};
use meniscus_measure::to_srgb8;
use meniscus_pipeline::{Pipeline, Pruning};
use meniscus_scene::Scene;

use crate::ablation::AblationError;
use crate::project::Project;
use crate::sequence::Sequence;

/// Why there is no picture.
pub type PictureError = AblationError;

/// A rendered picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Width and height.
    pub size: [u32; 2],
    /// Linear RGB, row by row from the top left; not clamped.
    pub colours: Vec<[f32; 3]>,
}

impl Picture {
    /// Renders a pipeline.
    ///
    /// # Errors
    /// When the pipeline does not compose, the size is 0 or too large, or the GPU refuses.
    pub fn render(
        project: &Project,
        gpu: &Gpu,
        pipeline: &Pipeline,
        scene: &Scene,
        size: [u32; 2],
    ) -> Result<Self, PictureError> {
        Self::render_pruned(project, gpu, pipeline, scene, size, Pruning::default())
    }

    /// Renders a pipeline, of which no more is left out than `pruning` says; with [`Pruning::None`]
    /// nothing is, and no two textures share memory.
    ///
    /// # Errors
    /// As [`Picture::render`].
    pub fn render_pruned(
        project: &Project,
        gpu: &Gpu,
        pipeline: &Pipeline,
        scene: &Scene,
        size: [u32; 2],
        pruning: Pruning,
    ) -> Result<Self, PictureError> {
        let mut sequence = Sequence::new(project, gpu, pipeline, scene, size, pruning)?;
        Ok(sequence.shot(scene)?.picture)
    }

    /// The picture as 8-bit sRGB; what is not finite shows as magenta, so that it is seen.
    pub fn srgb(&self) -> Vec<u8> {
        srgb(&self.colours)
    }
}

/// Whether every channel is a number.
pub(crate) fn is_finite(colour: &[f32; 3]) -> bool {
    colour.iter().all(|channel| channel.is_finite())
}

/// Linear colours as 8-bit sRGB; what is not finite as magenta, so that it is seen.
pub(crate) fn srgb(colours: &[[f32; 3]]) -> Vec<u8> {
    const MARK: [f32; 3] = [1.0, 0.0, 1.0];
    let marked = |colour: &[f32; 3]| match is_finite(colour) {
        true => *colour,
        false => MARK,
    };
    to_srgb8(&colours.iter().map(marked).collect::<Vec<_>>())
}

/// Refuses sizes that no picture can have, before anything is made.
pub(crate) fn check_size(gpu: &Gpu, [width, height]: [u32; 2]) -> Result<(), GpuError> {
    let most = gpu.max_size();
    if width == 0 || height == 0 || width > most || height > most {
        return Err(GpuError::Size(format!(
            "a picture of {width}×{height} pixels cannot be made: width and height are 1 to {most} on this adapter"
        )));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::srgb;

    #[test]
    fn what_is_not_finite_is_seen() {
        let colours = [[0.0, 1.0, 2.0], [0.0, f32::NAN, 0.0], [f32::INFINITY; 3]];
        assert_eq!(srgb(&colours), [0, 255, 255, 255, 0, 255, 255, 0, 255]);
    }
}
