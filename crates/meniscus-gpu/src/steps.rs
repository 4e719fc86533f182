//! A plan's passes as steps that only need to be recorded.

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::UVec2;
use meniscus_pipeline::{Cull, Geometry, PassKind, Plan, PlannedPass, Rect, Size};
use meniscus_shader::{Binding, BindingKind, Entry};

use crate::bindings::Binder;
use crate::host_scene::{HostScene, Views};
use crate::host_uses::HostUse;
use crate::moving::Drawn;
use crate::pipelines::{Pipeline, Stages};
use crate::region::Region;
use crate::resources::{Resources, Target};
use crate::runs::Runs;
use crate::scene_buffers::{GeometryBuffers, SceneBuffers};
use crate::sight::Sight;
use crate::tiles::{TilePipelines, Tiles};
use crate::uses::{Uses, reads, writes};
use crate::{Gpu, GpuError, formats, uses};

/// One pass, ready to be recorded.
#[derive(Debug)]
pub(crate) struct Step {
    pub name: String,
    /// Buffers to be zeroed before it.
    pub zeroes: Vec<wgpu::Buffer>,
    /// Textures to be cleared before it.
    pub clears: Vec<Clear>,
    pub pipeline: Arc<Pipeline>,
    pub bindings: wgpu::BindGroup,
    /// What it reads of the host's buffers.
    pub host_uses: Vec<HostUse>,
    pub work: Work,
    /// What it draws of objects that move.
    pub moving: Option<Drawn>,
}

/// What a step does.
#[derive(Debug)]
pub(crate) enum Work {
    Render {
        colours: Vec<Attachment>,
        depth: Option<Box<Attachment>>,
        /// The tiles that are drawn in place of a triangle over everything.
        tiles: Option<Box<Tiles>>,
        draw: Draw,
    },
    Compute(Workgroups),
}

/// A texture that is rendered to.
#[derive(Debug)]
pub(crate) struct Attachment {
    pub view: wgpu::TextureView,
    /// What it is cleared to; none where its content stays.
    pub clear: Option<wgpu::Color>,
}

/// A texture that is cleared by itself.
#[derive(Debug)]
pub(crate) struct Clear {
    pub view: wgpu::TextureView,
    pub depth: bool,
    pub to: wgpu::Color,
}

/// What is drawn.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Draw {
    /// Triangles of the scene: ranges of indices.
    Scene(GeometryBuffers, Runs),
    /// One triangle that covers everything, in each of these rectangles.
    Screen(Vec<Rect>),
    /// Nothing; the targets are cleared all the same.
    Nothing,
}

impl Draw {
    /// How many draws it takes.
    pub fn count(&self) -> u64 {
        match self {
            Self::Scene(_, ranges) => ranges.len() as u64,
            Self::Screen(rects) => rects.len() as u64,
            Self::Nothing => 0,
        }
    }

    /// A scene's triangles, or some of them.
    pub fn scene(
        gpu: &Gpu,
        scene: &SceneBuffers,
        geometry: Geometry,
        sight: &Sight,
        cull: Option<&Cull>,
    ) -> Result<Self, GpuError> {
        let drawing = scene.drawing(gpu, geometry, sight, cull)?;
        Ok(drawing.map_or(Self::Nothing, |(buffers, ranges)| {
            Self::Scene(buffers, ranges)
        }))
    }

    /// How many triangles of the scene.
    pub fn triangles(&self) -> u64 {
        match self {
            Self::Scene(_, ranges) => ranges.iter().map(|r| (r.len() / 3) as u64).sum(),
            _ => 0,
        }
    }
}

/// How many workgroups run.
#[derive(Debug)]
pub(crate) enum Workgroups {
    Direct([u32; 3]),
    Indirect(wgpu::Buffer),
}

/// What all steps are built from.
pub(crate) struct Builder<'a> {
    pub gpu: &'a Gpu,
    pub plan: &'a Plan,
    pub pipelines: &'a [Arc<Pipeline>],
    pub resources: &'a Resources,
    pub uses: &'a Uses<'a>,
    pub scene: &'a SceneBuffers,
    pub sight: Sight,
    /// Where the eye and the water are; none where clusters out of view are drawn too.
    pub culling: Option<&'a HostScene>,
    pub region: &'a Region,
    /// What tiles are listed with; none where none are drawn.
    pub tiles: Option<&'a TilePipelines>,
}

impl Builder<'_> {
    /// The steps of a frame, and the textures that no pass writes, to be cleared once.
    pub fn steps(&self, binder: &mut Binder) -> Result<(Vec<Step>, Vec<Clear>), GpuError> {
        let mut written = BTreeSet::new();
        let mut steps = Vec::with_capacity(self.plan.passes.len());
        let ever: BTreeSet<&str> = self.plan.passes.iter().flat_map(writes).collect();
        let passes = self.plan.passes.iter().zip(self.pipelines);
        for ((pass, pipeline), zeroed) in passes.zip(&self.uses.zeroes) {
            let mut clears = Vec::new();
            for name in reads(pass) {
                // Read first and written later: what is read is not to be the last frame's.
                if ever.contains(name) && !written.contains(name) {
                    clears.push(clear(self.texture(pass, name)?));
                    written.insert(name);
                }
            }
            let work = match &pass.kind {
                PassKind::Draw(_) | PassKind::Screen => self.render(pass, &mut written)?,
                _ => {
                    for name in writes(pass) {
                        if written.insert(name) {
                            clears.push(clear(self.texture(pass, name)?));
                        }
                    }
                    Work::Compute(self.workgroups(pass)?)
                }
            };
            let bindings = binder.bind(pass, &pipeline.layout)?;
            let buffers = &self.resources.buffers;
            steps.push(Step {
                name: pass.name.clone(),
                zeroes: zeroed
                    .iter()
                    .filter_map(|&name| buffers.get(name).cloned())
                    .collect(),
                clears,
                pipeline: pipeline.clone(),
                bindings,
                host_uses: std::mem::take(&mut binder.host_uses),
                work,
                moving: Drawn::of(self.gpu, self.scene, &pass.kind, &self.sight)?,
            });
        }
        let never = self
            .resources
            .textures
            .iter()
            .filter(|(name, _)| !ever.contains(name.as_str()));
        Ok((steps, never.map(|(_, target)| clear(target)).collect()))
    }

    fn texture(&self, pass: &PlannedPass, name: &str) -> Result<&Target, GpuError> {
        self.resources.textures.get(name).ok_or_else(|| {
            GpuError::Plan(format!(
                "pass `{}` uses the texture `{name}`, which is not there",
                pass.name
            ))
        })
    }

    fn render<'n>(
        &self,
        pass: &'n PlannedPass,
        written: &mut BTreeSet<&'n str>,
    ) -> Result<Work, GpuError> {
        let mut attachment = |name: &'n str| -> Result<Attachment, GpuError> {
            let target = self.texture(pass, name)?;
            let first = written.insert(name);
            Ok(Attachment {
                view: target.view.clone(),
                clear: first.then(|| formats::empty(target.format)),
            })
        };
        let colours = pass
            .targets
            .iter()
            .map(|name| attachment(name))
            .collect::<Result<_, _>>()?;
        let depth = pass.depth.as_deref().map(attachment).transpose()?;
        let draw = match &pass.kind {
            PassKind::Draw(geometry) => {
                let cull = self
                    .culling
                    .and_then(|host| cull(pass, &self.resources.views, host));
                Draw::scene(self.gpu, self.scene, *geometry, &self.sight, cull.as_ref())?
            }
            _ => Draw::Screen(self.rects(pass)?),
        };
        let tiles = match (self.tiles, uses::front_depth(self.plan, pass)) {
            (Some(pipelines), Some(name)) => {
                let front = &self.texture(pass, name)?.view;
                let tiles = Tiles::new(self.gpu, pipelines, front, self.region)?;
                Some(Box::new(tiles))
            }
            _ => None,
        };
        Ok(Work::Render {
            colours,
            depth: depth.map(Box::new),
            tiles,
            draw,
        })
    }

    /// The pixels that a pass over a picture has to touch.
    fn rects(&self, pass: &PlannedPass) -> Result<Vec<Rect>, GpuError> {
        let Some(name) = pass.targets.first().or(pass.depth.as_ref()) else {
            return Ok(vec![]);
        };
        Ok(match pass.view_target {
            Size::Frame => self.region.rects(pass.covers),
            Size::Guarded => vec![Rect::all(self.texture(pass, name)?.size)],
        })
    }

    fn workgroups(&self, pass: &PlannedPass) -> Result<Workgroups, GpuError> {
        let Entry::Compute { workgroup, .. } = pass.shader.entry else {
            return Err(GpuError::Plan(format!(
                "pass `{}` has no compute shader",
                pass.name
            )));
        };
        let covering = |size: UVec2| {
            let groups = |pixels: u32, threads: u32| pixels.div_ceil(threads.max(1));
            [
                groups(size.x, workgroup[0]),
                groups(size.y, workgroup[1]),
                1,
            ]
        };
        let groups = match &pass.kind {
            PassKind::DispatchIndirect(name) => return self.indirect(pass, name),
            PassKind::DispatchFixed(groups) => *groups,
            PassKind::Dispatch(size) => covering(self.resources.views.size(*size)),
            _ => match pass.targets.first() {
                // Threads begin at the first pixel; those behind the last are not begun.
                Some(_) => {
                    let rects = self.rects(pass)?;
                    let ends = rects.iter().map(|rect| rect.high);
                    covering(ends.fold(UVec2::ZERO, UVec2::max))
                }
                None => {
                    return Err(GpuError::Plan(format!(
                        "pass `{}` has no texture to cover",
                        pass.name
                    )));
                }
            },
        };
        let limit = self
            .gpu
            .device()
            .limits()
            .max_compute_workgroups_per_dimension;
        if groups.iter().any(|&g| g > limit) {
            return Err(GpuError::Size(format!(
                "pass `{}` needs {groups:?} workgroups; the adapter allows {limit} along each axis \
                 (max_compute_workgroups_per_dimension)",
                pass.name
            )));
        }
        Ok(Workgroups::Direct(groups))
    }

    fn indirect(&self, pass: &PlannedPass, name: &str) -> Result<Workgroups, GpuError> {
        let wrong = |message: &str| {
            Err(GpuError::Plan(format!(
                "pass `{}` takes its workgroups from `{name}`, {message}",
                pass.name
            )))
        };
        let (Some(buffer), Some(planned)) = (
            self.resources.buffers.get(name),
            self.plan.buffers.get(name),
        ) else {
            return wrong("which is not there");
        };
        if !planned.indirect {
            return wrong("which is not declared as indirect");
        }
        if buffer.size() < 12 {
            return wrong("which is too short: three u32 are needed");
        }
        let writes = |b: &Binding| {
            b.resource == name
                && matches!(
                    b.kind,
                    BindingKind::Storage {
                        read_only: false,
                        ..
                    }
                )
        };
        if pass.shader.bindings.iter().any(writes) {
            return wrong("which it also writes: let an earlier pass write it");
        }
        Ok(Workgroups::Indirect(buffer.clone()))
    }
}

/// What of the scene a pass cannot show in these views; none where it does not say where its points
/// appear.
pub(crate) fn cull(pass: &PlannedPass, views: &Views, host: &HostScene) -> Option<Cull> {
    let view = views.get(pass.view_target);
    let appears = pass.appears?;
    Some(Cull::new(view, host.water(), host.eye_above(), appears))
}

fn clear(target: &Target) -> Clear {
    Clear {
        view: target.view.clone(),
        depth: formats::is_depth(target.format),
        to: formats::empty(target.format),
    }
}

impl Builder<'_> {
    /// Has a step touch the pixels that are its to touch now; whether those are others than before.
    pub fn confine(&self, pass: &PlannedPass, step: &mut Step) -> Result<bool, GpuError> {
        match (&pass.kind, &mut step.work) {
            (
                PassKind::Screen,
                Work::Render {
                    draw: Draw::Screen(held),
                    ..
                },
            ) => {
                let rects = self.rects(pass)?;
                let changed = *held != rects;
                *held = rects;
                Ok(changed)
            }
            (PassKind::ScreenCompute, Work::Compute(Workgroups::Direct(held))) => {
                if let Workgroups::Direct(groups) = self.workgroups(pass)? {
                    let changed = *held != groups;
                    *held = groups;
                    return Ok(changed);
                }
                Ok(false)
            }
            _ => Ok(false),
        }
    }
}

impl Step {
    /// The tiles that it draws.
    pub fn tiles(&self) -> Option<&Tiles> {
        match &self.work {
            Work::Render { tiles, .. } => tiles.as_deref(),
            Work::Compute(_) => None,
        }
    }

    /// Whether a compute pass is part of it.
    pub fn has_compute(&self) -> bool {
        self.is_compute() || self.tiles().is_some()
    }

    /// Whether it is recorded as a compute pass.
    pub fn is_compute(&self) -> bool {
        matches!(self.pipeline.stages, Stages::Compute(_))
    }
}
