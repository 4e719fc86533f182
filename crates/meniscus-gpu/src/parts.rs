//! What a frame is made of for one pair of views, and what it may leave out.

use std::sync::Arc;

use glam::UVec2;
use meniscus_pipeline::Plan;

use crate::bindings::Binder;
use crate::host_buffers::HostBuffers;
use crate::host_scene::HostScene;
use crate::pipelines::Pipeline;
use crate::resources::Resources;
use crate::reuse::Reuse;
use crate::scene_buffers::SceneBuffers;
use crate::steps::{self, Step};
use crate::uses::{Use, Uses};
use crate::{Gpu, GpuError, record};

/// What a frame may leave out without changing a bit of what comes out of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Skipping {
    /// Textures that are never needed at once share memory. What they held cannot be read after
    /// the frame; what comes out of it can.
    pub sharing: bool,
}

impl Skipping {
    /// All that can be left out.
    pub const ALL: Self = Self { sharing: true };
    /// Nothing is left out.
    pub const NONE: Self = Self { sharing: false };
}

/// What parts are made from.
#[derive(Clone, Copy)]
pub(crate) struct Making<'a> {
    pub gpu: &'a Gpu,
    pub plan: &'a Plan,
    pub pipelines: &'a [Arc<Pipeline>],
    pub scene: &'a SceneBuffers,
    pub host: &'a HostScene,
    pub size: UVec2,
    pub skipping: Skipping,
}

/// What depends on the views and on the side of the water that the eye is on.
#[derive(Debug)]
pub(crate) struct Parts {
    pub resources: Resources,
    pub host_buffers: HostBuffers,
    pub steps: Vec<Step>,
    pub reuse: Reuse,
}

impl Parts {
    pub fn new(making: &Making) -> Result<Self, GpuError> {
        let Making {
            gpu,
            plan,
            scene,
            host,
            ..
        } = *making;
        let views = host.views(making.size, scene.heights());
        let resources = Resources::new(gpu, plan, &views, making.skipping.sharing)?;
        let mut binder = Binder {
            gpu,
            resources: &resources,
            scene: host,
            arrays: scene.arrays(),
            host: HostBuffers::default(),
            host_uses: Vec::new(),
        };
        let uses = Uses::new(plan);
        let builder = steps::Builder {
            gpu,
            plan,
            pipelines: making.pipelines,
            resources: &resources,
            uses: &uses,
            scene,
            sight: host.sight(&views),
        };
        let (steps, never_written) = builder.steps(&mut binder)?;
        let host_buffers = binder.host;
        if !never_written.is_empty() {
            gpu.attempt("clearing textures", || {
                let mut encoder = gpu.device().create_command_encoder(&Default::default());
                record::clears(&mut encoder, &never_written, None);
                gpu.queue().submit([encoder.finish()]);
            })?;
        }
        let reuse = reuse(&uses, &resources);
        Ok(Self {
            resources,
            host_buffers,
            steps,
            reuse,
        })
    }

    /// Notes for which passes the host's values have changed.
    pub fn note_changes(&mut self) {
        for (index, step) in self.steps.iter().enumerate() {
            let changed = step.host_uses.iter().any(|u| u.changed(&self.host_buffers));
            if changed {
                self.reuse.touch(index);
            }
        }
    }
}

/// What can be reused, by the memory that textures lie in.
fn reuse(uses: &Uses, resources: &Resources) -> Reuse {
    let textures = resources.textures.len();
    let memory = |index: usize| {
        let texture = resources.textures.get(uses.names[index]);
        texture.map_or(textures + index, |texture| texture.memory)
    };
    let placed = |used: &Use| Use {
        resource: memory(used.resource),
        ..*used
    };
    let passes = uses.passes.iter();
    let passes = passes
        .map(|pass| pass.iter().map(placed).collect())
        .collect();
    let memories = textures + uses.names.len();
    Reuse::new(passes, uses.looks_back.clone(), memories)
}
