//! What a frame is made of for one pair of views, and what it may leave out.

use std::sync::Arc;

use glam::UVec2;
use meniscus_pipeline::{PassKind, Plan, Pruning};

use crate::bindings::Binder;
use crate::host_buffers::HostBuffers;
use crate::host_scene::{HostScene, Views};
use crate::live::LiveNumbers;
use crate::pipelines::Pipeline;
use crate::region::Region;
use crate::resources::Resources;
use crate::reuse::Reuse;
use crate::scene_buffers::SceneBuffers;
use crate::sight::Sight;
use crate::steps::{self, Draw, Step, Work};
use crate::tiles::TilePipelines;
use crate::uses::{Use, Uses};
use crate::{Gpu, GpuError, record};

/// What a frame may leave out without changing a bit of what comes out of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Skipping {
    /// Textures that are never needed at once share memory. What they held cannot be read after
    /// the frame; what comes out of it can.
    pub sharing: bool,
    /// Passes over the water touch the pixels that may show it, those over the rest the others.
    pub regions: bool,
    /// Triangles of which nothing can be in a pass's view are not drawn by it: see
    /// [`meniscus_pipeline::Cull`].
    pub clusters: bool,
}

impl Skipping {
    /// All that can be left out.
    pub const ALL: Self = Self {
        sharing: true,
        regions: true,
        clusters: true,
    };
    /// Nothing is left out.
    pub const NONE: Self = Self {
        sharing: false,
        regions: false,
        clusters: false,
    };
}

impl From<Pruning> for Skipping {
    /// As much is left out of a frame as of its plan: all or nothing.
    fn from(pruning: Pruning) -> Self {
        match pruning {
            Pruning::None => Self::NONE,
            Pruning::Exact | Pruning::Approximate => Self::ALL,
        }
    }
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
    pub tiles: &'a TilePipelines,
}

/// What depends on the views and on the side of the water that the eye is on.
#[derive(Debug)]
pub(crate) struct Parts {
    pub resources: Resources,
    pub host_buffers: HostBuffers,
    pub live: LiveNumbers,
    pub steps: Vec<Step>,
    pub reuse: Reuse,
    region: Region,
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
            live: LiveNumbers::default(),
            host_uses: Vec::new(),
        };
        let uses = Uses::new(plan);
        let region = making.region();
        let builder = steps::Builder {
            gpu,
            plan,
            pipelines: making.pipelines,
            resources: &resources,
            uses: &uses,
            scene,
            sight: host.sight(&views),
            culling: making.culling(),
            region: &region,
            tiles: making.tiles(),
        };
        let (steps, never_written) = builder.steps(&mut binder)?;
        let (host_buffers, live) = (binder.host, binder.live);
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
            live,
            steps,
            reuse,
            region,
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

impl Making<'_> {
    fn tiles(&self) -> Option<&TilePipelines> {
        self.skipping.regions.then_some(self.tiles)
    }

    fn culling(&self) -> Option<&HostScene> {
        self.skipping.clusters.then_some(self.host)
    }

    fn region(&self) -> Region {
        match self.skipping.regions {
            true => Region::new(self.host, self.size),
            false => Region::whole(self.size),
        }
    }
}

impl Parts {
    /// Has the passes draw what another camera needs.
    pub fn redraw(
        &mut self,
        making: &Making,
        sight: &Sight,
        views: &Views,
    ) -> Result<(), GpuError> {
        let steps = making.plan.passes.iter().zip(&mut self.steps);
        for (index, (pass, step)) in steps.enumerate() {
            if let (PassKind::Draw(geometry), Work::Render { draw, .. }) =
                (&pass.kind, &mut step.work)
            {
                let cull = making
                    .culling()
                    .and_then(|host| steps::cull(pass, views, host));
                let new = Draw::scene(making.gpu, making.scene, *geometry, sight, cull.as_ref())?;
                if new != *draw {
                    *draw = new;
                    self.reuse.touch(index);
                }
            }
        }
        Ok(())
    }

    /// Has the passes touch the pixels that another camera, or other water, makes theirs; bytes
    /// that were written.
    pub fn confine(&mut self, making: &Making) -> Result<u64, GpuError> {
        let region = making.region();
        if region == self.region {
            return Ok(0);
        }
        let uses = Uses::default();
        let builder = steps::Builder {
            gpu: making.gpu,
            plan: making.plan,
            pipelines: making.pipelines,
            resources: &self.resources,
            uses: &uses,
            scene: making.scene,
            sight: making.host.sight(&self.resources.views),
            culling: None,
            region: &region,
            tiles: making.tiles(),
        };
        let mut written = 0;
        let passes = making.plan.passes.iter().zip(&mut self.steps);
        for (index, (pass, step)) in passes.enumerate() {
            let mut changed = builder.confine(pass, step)?;
            if let Work::Render {
                tiles: Some(tiles), ..
            } = &mut step.work
            {
                written += tiles.update(making.gpu, &region)?;
                changed = true;
            }
            if changed {
                self.reuse.touch(index);
            }
        }
        self.region = region;
        Ok(written)
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
