//! A pipeline made ready on a GPU.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::UVec2;
use meniscus_gpu::{Frame, Gpu, PipelineCache, SceneBuffers};
use meniscus_measure::Seen;
use meniscus_pipeline::{Facts, Pipeline, Plan};
use meniscus_scene::Scene;
use meniscus_shader::Composer;

use crate::AblationError;

/// A pipeline, and its frames: one to time and look at, one that tells what is shown.
pub(crate) struct Subject {
    pub name: String,
    pub frame: Frame,
    shown: Plan,
}

/// What subjects share.
pub(crate) struct Stage<'a> {
    pub gpu: &'a Gpu,
    pub composer: &'a Composer,
    pub cache: &'a PipelineCache,
    pub scene: Arc<SceneBuffers>,
    pub size: UVec2,
    pub facts: Facts,
}

impl Subject {
    pub fn new(pipeline: &Pipeline, stage: &Stage) -> Result<Self, AblationError> {
        let plan = Plan::new(pipeline, stage.composer, &stage.facts, false)?;
        let shown = Plan::new(pipeline, stage.composer, &stage.facts, true)?;
        Ok(Self {
            name: pipeline.name.clone(),
            frame: Frame::new(
                stage.gpu,
                &plan,
                stage.scene.clone(),
                stage.size,
                stage.cache,
            )?,
            shown,
        })
    }

    /// Renders once and reads the colours, linear RGB.
    pub fn colours(&mut self) -> Result<Vec<[f32; 3]>, AblationError> {
        self.frame.render()?;
        let pixels = self.frame.read(&self.frame.plan().output)?;
        Ok(pixels.data.chunks_exact(pixels.channels).map(rgb).collect())
    }

    /// The pixels that the last frame listed, by the name of the list.
    pub fn lists(
        &self,
        [width, height]: [u32; 2],
    ) -> Result<BTreeMap<String, Vec<bool>>, AblationError> {
        let mut lists = BTreeMap::new();
        for (name, buffer) in &self.frame.plan().lists {
            // A plan that adds nothing to a list has no buffer for it.
            if !self.frame.plan().buffers.contains_key(buffer) {
                let nothing = vec![false; width as usize * height as usize];
                lists.insert(name.clone(), nothing);
                continue;
            }
            let bytes = self.frame.read_buffer(buffer)?;
            let mut words = bytes
                .chunks_exact(4)
                .map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
            let count = words.next().unwrap_or(0) as usize;
            let mut listed = vec![false; width as usize * height as usize];
            for pixel in words.take(count) {
                let (x, y) = (pixel & 0xffff, pixel >> 16);
                if x < width && y < height {
                    listed[(y * width + x) as usize] = true;
                }
            }
            lists.insert(name.clone(), listed);
        }
        Ok(lists)
    }

    /// Renders, in a frame of its own that is gone afterwards, which points the colours show.
    /// At another moment than that of the stage's scene if one is given.
    pub fn shown(
        &self,
        stage: &Stage,
        moment: Option<&Scene>,
    ) -> Result<Vec<[f32; 4]>, AblationError> {
        let Some(texture) = self.shown.shown.clone() else {
            return Ok(Vec::new());
        };
        let mut frame = Frame::new(
            stage.gpu,
            &self.shown,
            stage.scene.clone(),
            stage.size,
            stage.cache,
        )?;
        if let Some(scene) = moment {
            frame.update(scene)?;
        }
        frame.render()?;
        let pixels = frame.read(&texture)?;
        Ok(pixels
            .data
            .chunks_exact(4)
            .map(|p| [p[0], p[1], p[2], p[3]])
            .collect())
    }
}

/// The first three channels, or as many as there are.
pub(crate) fn rgb(texel: &[f32]) -> [f32; 3] {
    std::array::from_fn(|channel| texel.get(channel).copied().unwrap_or(0.0))
}

/// Texels of a `shown` buffer as points.
pub(crate) fn seen(shown: &[[f32; 4]]) -> Vec<Seen> {
    shown.iter().copied().map(Seen::from_texel).collect()
}
