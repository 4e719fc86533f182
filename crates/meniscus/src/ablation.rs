//! Several pipelines beside each other and beside the truth: time and error in one run.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::UVec2;
use meniscus_gpu::{Gpu, GpuError, PipelineCache, SceneBuffers};
use meniscus_measure::{Judgement, MeasureError, Results, TruthGeometry};
use meniscus_pipeline::{Pipeline, Pruning};
use meniscus_reference::{Tracer, Truth};
use meniscus_scene::{Scene, View, WaterGeometry};
use meniscus_source::Report;
use serde_json::{Map, Value, json};

use crate::costs;
use crate::facts::facts_of;
use crate::judging::Judging;
use crate::marginal::{self, Without};
use crate::moments::Moments;
use crate::picture::{check_size, is_finite};
use crate::project::Project;
use crate::provenance::provenance;
use crate::rivalry::{self, Rivalry};
use crate::rounds::Rounds;
use crate::rows::Timings;
use crate::subject::{Stage, Subject};

/// What is to be compared.
#[derive(Debug, Clone)]
pub struct Ablation {
    /// The pipelines, with their changes.
    pub pipelines: Vec<Pipeline>,
    /// Index of the pipeline that times are relative to.
    pub baseline: Option<usize>,
    /// The scene that is rendered.
    pub scene: Scene,
    /// The water's geometry in the truth.
    pub truth: WaterGeometry,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// What of the pipelines may be left out.
    pub pruning: Pruning,
    /// How often each is rendered.
    pub rounds: Rounds,
    /// Those of the pipelines that are others without a filling.
    pub without: Vec<Without>,
    /// Settings that were made, for the results.
    pub settings: Map<String, Value>,
    /// The moments of the scene, seconds, at which it runs; at the scene's own where there is none.
    pub moments: Vec<f64>,
    /// Pipelines that are held against others.
    pub rivalry: Option<Rivalry>,
}

/// Why an ablation came to no end.
#[derive(Debug)]
pub enum AblationError {
    /// Something that was written is wrong.
    Source(Report),
    /// The GPU cannot do it.
    Gpu(GpuError),
    /// Figures could not be made or written.
    Measure(MeasureError),
}

impl std::fmt::Display for AblationError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Source(report) => report.fmt(f),
            Self::Gpu(error) => error.fmt(f),
            Self::Measure(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for AblationError {}

impl From<Report> for AblationError {
    fn from(report: Report) -> Self {
        Self::Source(report)
    }
}

impl From<GpuError> for AblationError {
    fn from(error: GpuError) -> Self {
        Self::Gpu(error)
    }
}

impl From<MeasureError> for AblationError {
    fn from(error: MeasureError) -> Self {
        Self::Measure(error)
    }
}

/// Told while an ablation runs: what is being done, and how much of it is done (0 to 1).
pub type Progress<'a> = dyn Fn(&str, f64) + Sync + 'a;

/// What an ablation found.
#[derive(Debug)]
pub struct Outcome {
    /// The figures.
    pub results: Results,
    /// Pictures and points of each pipeline at the first moment, in the order of the results' rows.
    pub rows: Vec<RowOutcome>,
    /// The truth at the first moment.
    pub truth: Truth,
    /// The scene that was rendered.
    pub scene: Scene,
    /// The view of the frame.
    pub view: View,
}

/// What one pipeline shows.
#[derive(Debug)]
pub struct RowOutcome {
    /// Linear RGB.
    pub colours: Vec<[f32; 3]>,
    /// World point and object id of which the colour is displayed.
    pub shown: Vec<[f32; 4]>,
    /// Pixels that the pipeline listed, by the name of the list.
    pub lists: BTreeMap<String, Vec<bool>>,
    /// What the comparison says of each pixel.
    pub judgement: Judgement,
}

impl RowOutcome {
    /// Pixels of which the colour, or the point that it shows, holds a NaN or an infinity.
    pub fn not_finite(&self) -> usize {
        let pixels = self.colours.iter().zip(&self.shown);
        let points = |shown: &[f32; 4]| shown.iter().all(|number| number.is_finite());
        let wrong = pixels.filter(|(colour, shown)| !is_finite(colour) || !points(shown));
        wrong.count()
    }
}

impl Ablation {
    /// Renders everything, traces the truth, and compares.
    ///
    /// # Errors
    /// See [`AblationError`].
    pub fn run(
        &self,
        project: &Project,
        gpu: &Gpu,
        progress: &Progress,
    ) -> Result<Outcome, AblationError> {
        check_size(gpu, self.size)?;
        let size = UVec2::from_array(self.size);
        let view = self.scene.camera.view(size);
        let cache = PipelineCache::default();
        let stage = Stage {
            gpu,
            composer: &project.composer,
            cache: &cache,
            scene: Arc::new(SceneBuffers::new(gpu, &self.scene)?),
            size,
            facts: facts_of(&self.scene, self.size),
            pruning: self.pruning,
        };
        let mut subjects = Vec::new();
        for (index, pipeline) in self.pipelines.iter().enumerate() {
            progress(
                "preparing pipelines",
                index as f64 / self.pipelines.len() as f64,
            );
            subjects.push(Subject::new(pipeline, &stage)?);
        }
        let mut moments = Moments::new(&self.scene, &self.moments, &stage.facts, self.size)?;
        let timings = self
            .rounds
            .time(&mut subjects, self.baseline, &mut moments, progress)?;
        let (truth, judged) = self.judge(&mut subjects, &stage, &mut moments, progress)?;
        let timings = Timings::new(timings);
        let mut found = Vec::new();
        for (index, (subject, outcomes)) in subjects.iter_mut().zip(&judged).enumerate() {
            let timed = (index, &timings);
            found.push(self.row(subject, timed, outcomes, &stage, &mut moments)?);
        }
        let mut more = costs::of_scene(&stage.scene);
        if moments.are_several() {
            more.insert("moments".to_owned(), json!(moments.times()));
        }
        let rows: Vec<RowOutcome> = judged
            .into_iter()
            .filter_map(|outcomes| outcomes.into_iter().next())
            .collect();
        let judged = rows.first().map(|row| &row.judgement);
        let mut results = Results {
            provenance: provenance(gpu, self.pruning),
            scene: self.scene.name.clone(),
            settings: self.settings.clone(),
            size: self.size,
            truth: match self.truth {
                WaterGeometry::Flat => TruthGeometry::Flat,
                WaterGeometry::Displaced => TruthGeometry::Displaced,
            },
            water_pixels: judged.map_or(0, |j| j.water_pixels),
            undefined_pixels: judged.map_or(0, |j| j.undefined_pixels),
            rows: found,
            more,
        };
        rivalry::note(&mut results, self.rivalry.as_ref())?;
        marginal::note(&mut results, &self.without);
        Ok(Outcome {
            results,
            rows,
            truth,
            scene: moments.at(0).clone(),
            view,
        })
    }

    /// The truth at the first moment, and of every subject what it shows at each moment.
    fn judge(
        &self,
        subjects: &mut [Subject],
        stage: &Stage,
        moments: &mut Moments,
        progress: &Progress,
    ) -> Result<(Truth, Vec<Vec<RowOutcome>>), AblationError> {
        let view = self.scene.camera.view(stage.size);
        let count = moments.times().len();
        let mut judged: Vec<Vec<RowOutcome>> = subjects.iter().map(|_| Vec::new()).collect();
        let mut first = None;
        for moment in 0..count {
            let several = moments.are_several();
            let scene = moments.at(moment);
            let true_scene = Scene {
                water: scene.water.with_geometry(self.truth),
                ..scene.clone()
            };
            let part = |part: f64| (moment as f64 + part) / count as f64;
            let traced =
                Tracer::new(&true_scene).trace(&view, &|p| progress("tracing the truth", part(p)));
            let context = Judging::new(self, &traced, &true_scene, view);
            let all = subjects.len() as f64;
            for (index, subject) in subjects.iter_mut().enumerate() {
                progress("comparing with the truth", part(index as f64 / all));
                let outcome = context.judge(subject, stage, several.then_some(scene))?;
                judged[index].push(outcome);
            }
            first.get_or_insert(traced);
        }
        let none = || GpuError::Plan("an ablation without a moment".to_owned());
        Ok((first.ok_or_else(none)?, judged))
    }
}
