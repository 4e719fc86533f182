//! A pipeline made ready on a GPU.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::UVec2;
use meniscus_gpu::{Frame, Gpu, PipelineCache, SceneBuffers};
use meniscus_measure::Seen;
use meniscus_pipeline::{Facts, Pipeline, Plan, Pruning};
use meniscus_scene::Scene;
use meniscus_shader::Composer;

use crate::AblationError;
use crate::lists::listed;

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
    pub pruning: Pruning,
}

impl Stage<'_> {
    fn plan(&self, pipeline: &Pipeline, shown: bool) -> Result<Plan, AblationError> {
        let plan = Plan::pruned(pipeline, self.composer, &self.facts, self.pruning, shown);
        Ok(plan?)
    }

    fn frame(&self, plan: &Plan) -> Result<Frame, AblationError> {
        let (scene, skipping) = (self.scene.clone(), self.pruning.into());
        let frame = Frame::with(self.gpu, plan, scene, self.size, self.cache, skipping);
        Ok(frame?)
    }
}

impl Subject {
    pub fn new(pipeline: &Pipeline, stage: &Stage) -> Result<Self, AblationError> {
        Ok(Self {
            name: pipeline.name.clone(),
            frame: stage.frame(&stage.plan(pipeline, false)?)?,
            shown: stage.plan(pipeline, true)?,
        })
    }

    /// Renders once and reads the colours, linear RGB.
    pub fn colours(&mut self) -> Result<Vec<[f32; 3]>, AblationError> {
        self.frame.render()?;
        colours(&self.frame)
    }

    /// The pixels that the last frame listed, by the name of the list.
    pub fn lists(
        &self,
        [width, height]: [u32; 2],
    ) -> Result<BTreeMap<String, Vec<bool>>, AblationError> {
        let mut lists = BTreeMap::new();
        for name in self.frame.plan().lists.keys() {
            let mut on_list = vec![false; width as usize * height as usize];
            for [x, y] in listed(&self.frame, name, [width, height])? {
                on_list[y as usize * width as usize + x as usize] = true;
            }
            lists.insert(name.clone(), on_list);
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
        let mut frame = stage.frame(&self.shown)?;
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

/// What came out of a frame, linear RGB.
pub(crate) fn colours(frame: &Frame) -> Result<Vec<[f32; 3]>, AblationError> {
    let pixels = frame.read(&frame.plan().output)?;
    Ok(pixels.data.chunks_exact(pixels.channels).map(rgb).collect())
}

/// The first three channels, or as many as there are.
fn rgb(texel: &[f32]) -> [f32; 3] {
    std::array::from_fn(|channel| texel.get(channel).copied().unwrap_or(0.0))
}

/// Texels of a `shown` buffer as points.
pub(crate) fn seen(shown: &[[f32; 4]]) -> Vec<Seen> {
    shown.iter().copied().map(Seen::from_texel).collect()
}
