//! What a frame does, counted: figures that do not depend on the machine's load.

use crate::moving::Drawn;
use crate::queries::Queries;
use crate::record::Instrument;
use crate::steps::{Step, Work};
use crate::tiles::Tiles;
use crate::{Frame, GpuError};

/// Counts of one frame. Invocations are none where the adapter cannot count them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Counters {
    /// Triangles of the scene that were drawn, once for each draw.
    pub triangles: u64,
    /// Draws, those that cover the screen included.
    pub draws: u64,
    /// Dispatches.
    pub dispatches: u64,
    /// Runs of vertex shaders.
    pub vertex_invocations: Option<u64>,
    /// Runs of fragment shaders; drivers count helper fragments too.
    pub fragment_invocations: Option<u64>,
    /// Runs of compute shaders.
    pub compute_invocations: Option<u64>,
    /// Bytes of the textures between passes, as they were made: those that are never needed at once
    /// share memory.
    pub texture_bytes: u64,
    /// Bytes that they would take if each had memory of its own.
    pub texture_sum_bytes: u64,
    /// Bytes of those that are needed at once, in the pass that needs most.
    pub texture_peak_bytes: u64,
    /// Bytes of the buffers between passes.
    pub buffer_bytes: u64,
    /// Bytes of the scene: its vertices and indices, and what was made of them for rays; frames of
    /// the same [`crate::SceneBuffers`] share them.
    pub scene_bytes: u64,
    /// Bytes that the last [`Frame::update`] wrote for this frame.
    pub uploaded_bytes: u64,
    /// The passes in order.
    pub passes: Vec<PassCounters>,
}

/// Counts of one pass.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct PassCounters {
    /// The pass's name.
    pub name: String,
    /// Triangles of the scene that it draws.
    pub triangles: u64,
    /// Runs of its vertex shader.
    pub vertex_invocations: Option<u64>,
    /// Runs of its fragment shader.
    pub fragment_invocations: Option<u64>,
    /// Runs of its compute shader.
    pub compute_invocations: Option<u64>,
}

/// What is asked of the statistics, in the order in which it comes.
fn statistics() -> wgpu::PipelineStatisticsTypes {
    wgpu::PipelineStatisticsTypes::VERTEX_SHADER_INVOCATIONS
        | wgpu::PipelineStatisticsTypes::FRAGMENT_SHADER_INVOCATIONS
        | wgpu::PipelineStatisticsTypes::COMPUTE_SHADER_INVOCATIONS
}

impl Frame {
    /// Counts what the frame does; where the adapter counts invocations, in a run of its own, so
    /// that timed frames are not disturbed.
    ///
    /// # Errors
    /// As [`Frame::render`].
    pub fn counters(&self) -> Result<Counters, GpuError> {
        let steps = self.steps();
        let mut passes: Vec<PassCounters> = steps
            .iter()
            .map(|step| PassCounters {
                name: step.name.clone(),
                triangles: match &step.work {
                    Work::Render { draw, .. } => draw.triangles(),
                    Work::Compute(_) => 0,
                } + step.moving.as_ref().map_or(0, Drawn::triangles),
                ..PassCounters::default()
            })
            .collect();
        if self.gpu().has_statistics() && !steps.is_empty() {
            let ty = wgpu::QueryType::PipelineStatistics(statistics());
            let queries = Queries::new(self.gpu(), ty, steps.len() as u32, 3)?;
            self.run(Instrument::Statistics(&queries.set), Some(&queries), None)?;
            for (pass, numbers) in passes
                .iter_mut()
                .zip(queries.read(self.gpu())?.chunks_exact(3))
            {
                pass.vertex_invocations = Some(numbers[0]);
                pass.fragment_invocations = Some(numbers[1]);
                pass.compute_invocations = Some(numbers[2]);
            }
            // Tiles are listed outside of what is asked; each thread is known.
            for (pass, step) in passes.iter_mut().zip(steps) {
                let threads = step.tiles().map_or(0, Tiles::threads);
                pass.compute_invocations = pass.compute_invocations.map(|n| n + threads);
            }
        }
        let drawing = |work: &Work| match work {
            Work::Render { draw, .. } => draw.count(),
            Work::Compute(_) => 0,
        };
        let total = |count: fn(&PassCounters) -> Option<u64>| passes.iter().map(count).sum();
        Ok(Counters {
            triangles: passes.iter().map(|p| p.triangles).sum(),
            draws: steps
                .iter()
                .map(|s| drawing(&s.work) + u64::from(s.moving.is_some()))
                .sum(),
            dispatches: steps
                .iter()
                .map(|s| u64::from(s.is_compute()) + s.tiles().map_or(0, |_| Tiles::DISPATCHES))
                .sum(),
            vertex_invocations: total(|p| p.vertex_invocations),
            fragment_invocations: total(|p| p.fragment_invocations),
            compute_invocations: total(|p| p.compute_invocations),
            texture_bytes: self.resources().texture_bytes(),
            texture_sum_bytes: self.resources().texture_sum_bytes(),
            texture_peak_bytes: self.resources().texture_peak_bytes(),
            buffer_bytes: self.resources().buffer_bytes()
                + steps
                    .iter()
                    .filter_map(Step::tiles)
                    .map(Tiles::bytes)
                    .sum::<u64>(),
            scene_bytes: self.scene().bytes(),
            uploaded_bytes: self.uploaded_last(),
            passes,
        })
    }
}
