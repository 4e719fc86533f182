//! A plan on a GPU: made once, rendered often.

use std::sync::Arc;
use std::time::Instant;

use glam::UVec2;
use meniscus_pipeline::{Plan, Size};
use meniscus_scene::{Moving, Scene, View};

use crate::bodies::Versions;
use crate::host_buffers::Written;
use crate::host_scene::{HostScene, Views};
use crate::moving::{self, Moved, Reads};
use crate::parts::{Making, Parts, Skipping};
use crate::pipelines::Pipeline;
use crate::queries::Queries;
use crate::readback::{self, Pixels};
use crate::record::{self, Instrument, Stopwatch};
use crate::resources::{Resources, check_size};
use crate::reuse::Reuse;
use crate::scene_buffers::SceneBuffers;
use crate::steps::Step;
use crate::tiles::TilePipelines;
use crate::timing::{self, FrameTiming, Stamps};
use crate::{Gpu, GpuError, PipelineCache, fitting, live, uses};

/// A plan with everything that it needs on a GPU, for one scene and size.
#[derive(Debug)]
pub struct Frame {
    gpu: Gpu,
    plan: Plan,
    pipelines: Vec<Arc<Pipeline>>,
    scene: Arc<SceneBuffers>,
    host: HostScene,
    size: UVec2,
    parts: Parts,
    skipping: Skipping,
    tiles: Arc<TilePipelines>,
    stopwatch: Option<Stopwatch>,
    moving: Moving,
    reads: Reads,
    /// Of what moves, as the parts show it.
    versions: Versions,
    moved: Moved,
    uploaded: u64,
    uploaded_last: u64,
}

impl Frame {
    /// Makes everything that rendering the plan takes. Pipelines that `cache` holds are not made
    /// again; the scene's values come from `scene`, until [`Frame::update`].
    ///
    /// # Errors
    /// When the size is 0 or beyond the adapter's limit (before anything is made), when the plan's
    /// parts do not fit together, and when the graphics library or the adapter refuses something.
    pub fn new(
        gpu: &Gpu,
        plan: &Plan,
        scene: Arc<SceneBuffers>,
        size: UVec2,
        cache: &PipelineCache,
    ) -> Result<Self, GpuError> {
        Self::with(gpu, plan, scene, size, cache, Skipping::ALL)
    }

    /// The same with only some of what a frame may leave out left out.
    ///
    /// # Errors
    /// As [`Frame::new`].
    pub fn with(
        gpu: &Gpu,
        plan: &Plan,
        scene: Arc<SceneBuffers>,
        size: UVec2,
        cache: &PipelineCache,
        skipping: Skipping,
    ) -> Result<Self, GpuError> {
        check_size(gpu, "a picture", size)?;
        let mut pipelines = Vec::with_capacity(plan.passes.len());
        for pass in &plan.passes {
            fitting::check(plan, pass)?;
            let formats = fitting::colour_formats(plan, pass)?;
            let tiled = skipping.regions && uses::front_depth(plan, pass).is_some();
            pipelines.push(cache.get(gpu, pass, &formats, tiled)?);
        }
        let host = scene.host.clone();
        let (moving, reads) = (scene.moving().clone(), Reads::of(plan));
        let (versions, _) = scene.follow(gpu, &moving, reads)?;
        let parts = Parts::new(&Making {
            gpu,
            plan,
            pipelines: &pipelines,
            scene: &scene,
            host: &host,
            size,
            skipping,
            tiles: &cache.tiles,
        })?;
        let stopwatch = Stopwatch::new(gpu, &parts.steps)?;
        Ok(Self {
            gpu: gpu.clone(),
            plan: plan.clone(),
            pipelines,
            scene,
            host,
            size,
            parts,
            skipping,
            tiles: cache.tiles.clone(),
            stopwatch,
            moving,
            reads,
            versions,
            moved: Moved::default(),
            uploaded: 0,
            uploaded_last: 0,
        })
    }

    /// Takes over another moment, camera, water, light or materials of the same mesh. Only buffers
    /// whose content changes are written; textures are made anew only where the guard band
    /// changes, which depends on the camera's distance from the water and on the waves, not on time.
    /// Of objects that move, what other frames of the scene share is put where they are now.
    ///
    /// # Errors
    /// When the heights between which the water may lie, or the mesh beside what moves, are not those
    /// with which the scene was uploaded; when a value is not finite; when the water's time is not
    /// that of the objects.
    pub fn update(&mut self, scene: &Scene) -> Result<(), GpuError> {
        if !self.scene.fits(scene) {
            return Err(GpuError::Scene(
                "the mesh, what moves, the water's level or its amplitudes have changed: upload the scene anew"
                    .to_owned(),
            ));
        }
        moving::check(scene)?;
        let (start, before) = (Instant::now(), self.scene.written());
        let objects = scene.moving.since(self.moving.time()).count();
        self.moving = scene.moving.clone();
        let (versions, tree_ms) = self.scene.follow(&self.gpu, &self.moving, self.reads)?;
        let measured_anew = self.reads.distances && versions.rays != self.versions.rays;
        let host = HostScene::new(scene);
        let views = host.views(self.size, self.scene.heights());
        let remade = [Size::Frame, Size::Guarded]
            .iter()
            .any(|&s| views.size(s) != self.views().size(s))
            || host.eye_above() != self.host.eye_above()
            || measured_anew;
        let written = if remade {
            Written::Outgrown
        } else {
            self.parts.host_buffers.update(&self.gpu, &host, &views)?
        };
        let making = Making {
            gpu: &self.gpu,
            plan: &self.plan,
            pipelines: &self.pipelines,
            scene: &self.scene,
            host: &host,
            size: self.size,
            skipping: self.skipping,
            tiles: &self.tiles,
        };
        self.uploaded_last = 0;
        match written {
            Written::Bytes(bytes) => {
                self.parts.note_changes();
                let sight = host.sight(&views);
                let turned = sight != self.host.sight(&self.parts.resources.views);
                if turned || versions != self.versions {
                    let versions = [&self.versions, &versions];
                    self.parts.show_moved(&making, &sight, versions)?;
                }
                if turned {
                    self.parts.redraw(&making, &sight, &views)?;
                }
                self.uploaded_last = bytes + self.parts.confine(&making)?;
                self.uploaded += self.uploaded_last;
            }
            Written::Outgrown => self.parts = Parts::new(&making)?,
        }
        self.parts.resources.views = views;
        self.host = host;
        self.versions = versions;
        self.moved = Moved {
            objects,
            bytes: self.scene.written() - before,
            ms: start.elapsed().as_secs_f64() * 1e3,
            tree_ms,
        };
        self.uploaded_last += self.moved.bytes;
        self.uploaded += self.moved.bytes;
        Ok(())
    }

    /// Puts what the scene's frames share back where it is at this frame's moment, if another frame
    /// has moved it.
    pub(crate) fn keep_up(&mut self) -> Result<(), GpuError> {
        let (versions, _) = self.scene.follow(&self.gpu, &self.moving, self.reads)?;
        if versions == self.versions {
            return Ok(());
        }
        let making = Making {
            gpu: &self.gpu,
            plan: &self.plan,
            pipelines: &self.pipelines,
            scene: &self.scene,
            host: &self.host,
            size: self.size,
            skipping: self.skipping,
            tiles: &self.tiles,
        };
        if self.reads.distances && versions.rays != self.versions.rays {
            self.parts = Parts::new(&making)?;
        } else {
            let sight = self.host.sight(&self.parts.resources.views);
            let versions = [&self.versions, &versions];
            self.parts.show_moved(&making, &sight, versions)?;
        }
        self.versions = versions;
        Ok(())
    }

    /// What the last [`Frame::update`] did about objects that move.
    pub fn moved(&self) -> &Moved {
        &self.moved
    }

    /// Sets a live number of a pass (and of its twin that tells what is shown) by its path:
    /// `intersect.bound_px`. No pipeline is made for it; the next frame has it.
    ///
    /// # Errors
    /// When there is no such pass or live number, when the value lies outside the number's range,
    /// and when the graphics library refuses.
    pub fn set_number(&mut self, pass: &str, path: &str, value: f64) -> Result<(), GpuError> {
        self.uploaded_last = 0;
        for index in live::set(&mut self.plan, pass, path, value)? {
            let pass = &self.plan.passes[index];
            self.uploaded_last += self.parts.live.write(&self.gpu, pass)?;
            self.parts.reuse.touch(index);
        }
        self.uploaded += self.uploaded_last;
        Ok(())
    }

    /// Renders the whole frame, whatever has changed, waits for it, and tells how long it took.
    /// Nothing is made or uploaded. This is what benchmarks time; [`Frame::refresh`] leaves out
    /// what the last frame already holds.
    ///
    /// # Errors
    /// When the graphics library or the driver refuses, or the device is lost.
    pub fn render(&mut self) -> Result<FrameTiming, GpuError> {
        self.keep_up()?;
        let (instrument, queries) = match &self.stopwatch {
            Some(watch) => (Instrument::Timestamps(watch), Some(&watch.queries)),
            None => (Instrument::Nothing, None),
        };
        let ran = self.run(instrument, queries, None);
        match ran {
            Ok(_) => self.parts.reuse.done(),
            Err(_) => self.parts.reuse.forget(),
        }
        let wall_ms = ran?;
        let ticks = queries.map(|q| q.read(&self.gpu)).transpose()?;
        let stamps: Option<Vec<[u64; 2]>> =
            ticks.map(|ticks| ticks.chunks_exact(2).map(|p| [p[0], p[1]]).collect());
        let period = f64::from(self.gpu.queue().get_timestamp_period());
        let names: Vec<&str> = self.parts.steps.iter().map(|s| s.name.as_str()).collect();
        let stamps = stamps.as_ref().map(|passes| Stamps { passes, period });
        Ok(timing::judge(stamps, &names, wall_ms))
    }

    /// Records and runs the frame, or some of its passes; milliseconds from submission to the end of
    /// waiting.
    pub(crate) fn run(
        &self,
        instrument: Instrument,
        queries: Option<&Queries>,
        chosen: Option<&[bool]>,
    ) -> Result<f64, GpuError> {
        let commands = self.gpu.attempt("recording a frame", || {
            let mut encoder = self
                .gpu
                .device()
                .create_command_encoder(&Default::default());
            for (index, step) in self.parts.steps.iter().enumerate() {
                if chosen.is_none_or(|chosen| chosen[index]) {
                    record::step(&mut encoder, index, step, instrument);
                }
            }
            if let Some(queries) = queries {
                queries.resolve(&mut encoder);
            }
            encoder.finish()
        })?;
        let start = Instant::now();
        self.gpu
            .attempt("running a frame", || self.gpu.queue().submit([commands]))?;
        self.gpu.wait()?;
        Ok(start.elapsed().as_secs_f64() * 1e3)
    }

    /// Reads a texture of the plan as it stands.
    ///
    /// # Errors
    /// When there is none of that name, when another texture has taken over its memory (see
    /// [`Skipping::sharing`]), and when the read-back fails.
    pub fn read(&self, texture: &str) -> Result<Pixels, GpuError> {
        let textures = &self.parts.resources.textures;
        let target = textures.get(texture).ok_or_else(|| {
            let names: Vec<&str> = textures.keys().map(String::as_str).collect();
            GpuError::Plan(format!(
                "there is no texture `{texture}`; there is {}",
                names.join(", ")
            ))
        })?;
        if let Some(other) = self.parts.resources.successor(texture) {
            return Err(GpuError::Plan(format!(
                "the texture `{texture}` is gone at the end of a frame: `{other}` has taken over its \
                 memory; make the frame without `Skipping::sharing` to read it"
            )));
        }
        readback::texture(&self.gpu, &target.texture, target.format, target.size)
    }

    /// Reads a buffer of the plan as it stands; its length is rounded up to whole words.
    ///
    /// # Errors
    /// When there is none of that name, and when the read-back fails.
    pub fn read_buffer(&self, buffer: &str) -> Result<Vec<u8>, GpuError> {
        let buffers = &self.parts.resources.buffers;
        let held = buffers.get(buffer).ok_or_else(|| {
            let names: Vec<&str> = buffers.keys().map(String::as_str).collect();
            GpuError::Plan(format!(
                "there is no buffer `{buffer}`; there is {}",
                names.join(", ")
            ))
        })?;
        readback::buffer(&self.gpu, held)
    }

    /// The plan that is rendered.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// A view of the frame: what its pixels are.
    pub fn view(&self, size: Size) -> View {
        *self.views().get(size)
    }

    /// Bytes that [`Frame::update`] has written so far.
    pub fn uploaded(&self) -> u64 {
        self.uploaded
    }

    /// Bytes that the last [`Frame::update`] wrote.
    pub(crate) fn uploaded_last(&self) -> u64 {
        self.uploaded_last
    }

    pub(crate) fn scene(&self) -> &SceneBuffers {
        &self.scene
    }

    pub(crate) fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    pub(crate) fn parts(&mut self) -> &mut Parts {
        &mut self.parts
    }

    pub(crate) fn reuse(&self) -> &Reuse {
        &self.parts.reuse
    }

    pub(crate) fn steps(&self) -> &[Step] {
        &self.parts.steps
    }

    pub(crate) fn resources(&self) -> &Resources {
        &self.parts.resources
    }

    fn views(&self) -> &Views {
        &self.parts.resources.views
    }
}
