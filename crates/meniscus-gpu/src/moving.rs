//! What a frame has to know of what moves in its scene.

use std::ops::Range;

use meniscus_pipeline::{Geometry, PassKind, Plan};
use meniscus_scene::Scene;
use meniscus_shader::Binding;

use crate::bodies::Versions;
use crate::parts::{Making, Parts};
use crate::scene_arrays::{SceneArrays, is_of_distances};
use crate::scene_buffers::{GeometryBuffers, SceneBuffers};
use crate::sight::Sight;
use crate::{Gpu, GpuError};

/// What the last [`crate::Frame::update`] did about objects that move.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Moved {
    /// How many objects stand elsewhere than before it.
    pub objects: usize,
    /// Bytes of their triangles, and of what rays are traced through, that were uploaded.
    pub bytes: u64,
    /// All that the update took, the water's included, milliseconds.
    pub ms: f64,
    /// What of that went into giving the trees for rays new boxes.
    pub tree_ms: f64,
}

/// What a plan reads of triangles beside drawing them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Reads {
    /// Arrays that are made of triangles.
    pub arrays: bool,
    /// Among them those that are made anew for every moment.
    pub distances: bool,
}

impl Reads {
    pub fn of(plan: &Plan) -> Self {
        let any = |wanted: fn(&str) -> bool| {
            let mut bindings = plan.passes.iter().flat_map(|pass| &pass.shader.bindings);
            bindings.any(|b| wanted(&b.resource))
        };
        Self {
            arrays: any(SceneArrays::has),
            distances: any(is_of_distances),
        }
    }
}

/// Triangles of objects that move, as a pass draws them: a range of indices.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Drawn(GeometryBuffers, Range<u32>);

impl Drawn {
    /// What a pass draws; none where there is nothing.
    pub fn of(
        gpu: &Gpu,
        scene: &SceneBuffers,
        kind: &PassKind,
        sight: &Sight,
    ) -> Result<Option<Self>, GpuError> {
        let PassKind::Draw(geometry) = kind else {
            return Ok(None);
        };
        let drawing = scene.moving_drawing(gpu, *geometry, sight)?;
        Ok(drawing.map(|(buffers, range)| Self(buffers, range)))
    }

    pub fn triangles(&self) -> u64 {
        (self.1.len() / 3) as u64
    }

    pub fn record(&self, pass: &mut wgpu::RenderPass) {
        let Self(buffers, range) = self;
        pass.set_vertex_buffer(0, buffers.vertices.slice(..));
        pass.set_index_buffer(buffers.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(range.clone(), 0, 0..1);
    }
}

/// Whether a scene's water and its objects are at one moment that there is.
///
/// # Errors
/// When they are not.
pub(crate) fn check(scene: &Scene) -> Result<(), GpuError> {
    let (stand, water) = (scene.moving.time(), scene.water.time);
    match scene.moving.is_empty() || stand == water && water.is_finite() {
        true => Ok(()),
        false => Err(GpuError::Scene(format!(
            "the objects stand as at {stand} s and the water as at {water} s: move both with \
             `Scene::set_time`, to a time that is finite"
        ))),
    }
}

impl Parts {
    /// Has the passes draw and read what has moved between two counts, for this camera.
    pub fn show_moved(
        &mut self,
        making: &Making,
        sight: &Sight,
        [old, new]: [&Versions; 2],
    ) -> Result<(), GpuError> {
        for (index, pass) in making.plan.passes.iter().enumerate() {
            let drawn = Drawn::of(making.gpu, making.scene, &pass.kind, sight)?;
            let moved = |geometry: &Geometry| old.differ(new, *geometry, sight.eye_above());
            let step = &mut self.steps[index];
            let mut touched = match &pass.kind {
                PassKind::Draw(geometry) => moved(geometry) || drawn != step.moving,
                _ => false,
            };
            step.moving = drawn;
            let reads = |b: &Binding| SceneArrays::has(&b.resource);
            touched |= old.rays != new.rays && pass.shader.bindings.iter().any(reads);
            if touched {
                self.reuse.touch(index);
            }
        }
        Ok(())
    }
}
