//! Pictures of one pipeline, one moment after the other.

use std::sync::Arc;

use glam::UVec2;
use meniscus_gpu::{Frame, Gpu, PipelineCache, SceneBuffers};
use meniscus_pipeline::{Facts, Pipeline, PlanCache, Pruning};
use meniscus_scene::Scene;

use crate::facts::facts_of;
use crate::picture::{Picture, PictureError, check_size};
use crate::project::Project;
use crate::subject::colours;

/// Renders a scene at one moment after the other. Of each frame only those passes run of which an
/// input has changed since the last one ([`Frame::refresh`]); plans and compiled shaders are kept, so
/// that facts which come and go are met without composing or compiling anything again.
#[derive(Debug)]
pub struct Sequence<'a> {
    project: &'a Project,
    gpu: &'a Gpu,
    size: [u32; 2],
    pruning: Pruning,
    plans: PlanCache,
    cache: PipelineCache,
    buffers: Arc<SceneBuffers>,
    /// The last frame, with the facts that its plan was made for.
    last: Option<(Facts, Frame)>,
}

/// One picture of a sequence.
#[derive(Debug, Clone, PartialEq)]
pub struct Shot {
    /// The picture.
    pub picture: Picture,
    /// The passes that ran for it, in order; none where nothing had changed.
    pub ran: Vec<String>,
    /// How many passes its plan has.
    pub passes: usize,
}

impl<'a> Sequence<'a> {
    /// Uploads a scene. No more is left out than `pruning` says: with [`Pruning::None`] all passes run
    /// for every picture, over all their pixels, and no two textures share memory.
    ///
    /// # Errors
    /// When the size is 0 or too large, or the GPU refuses.
    pub fn new(
        project: &'a Project,
        gpu: &'a Gpu,
        pipeline: &Pipeline,
        scene: &Scene,
        size: [u32; 2],
        pruning: Pruning,
    ) -> Result<Self, PictureError> {
        check_size(gpu, size)?;
        Ok(Self {
            project,
            gpu,
            size,
            pruning,
            plans: PlanCache::new(pipeline.clone(), pruning, false),
            cache: PipelineCache::default(),
            buffers: Arc::new(SceneBuffers::new(gpu, scene)?),
            last: None,
        })
    }

    /// The picture of the scene as it is now: at another moment, from another camera, in another light.
    ///
    /// # Errors
    /// When the pipeline does not compose, when the scene differs from the first one by more than
    /// [`Frame::update`] takes over, or when the GPU refuses.
    pub fn shot(&mut self, scene: &Scene) -> Result<Shot, PictureError> {
        let facts = facts_of(scene, self.size);
        let last = self.last.take().filter(|(known, _)| *known == facts);
        let mut frame = match last {
            Some((_, frame)) => frame,
            None => self.frame(facts)?,
        };
        frame.update(scene)?;
        let ran = match self.pruning {
            Pruning::None => {
                let ran = frame.render()?.passes;
                ran.into_iter().map(|pass| pass.name).collect()
            }
            _ => {
                frame.refresh()?;
                frame.refreshed().map(str::to_owned).collect()
            }
        };
        let shot = Shot {
            picture: Picture {
                size: self.size,
                colours: colours(&frame)?,
            },
            ran,
            passes: frame.plan().passes.len(),
        };
        self.last = Some((facts, frame));
        Ok(shot)
    }

    /// The frame of the last picture; none before the first.
    pub fn last_frame(&mut self) -> Option<&mut Frame> {
        self.last.as_mut().map(|(_, frame)| frame)
    }

    fn frame(&mut self, facts: Facts) -> Result<Frame, PictureError> {
        let plan = self.plans.plan(&self.project.composer, facts)?;
        let (buffers, skipping) = (self.buffers.clone(), self.pruning.into());
        let size = UVec2::from_array(self.size);
        Ok(Frame::with(
            self.gpu,
            plan,
            buffers,
            size,
            &self.cache,
            skipping,
        )?)
    }
}
