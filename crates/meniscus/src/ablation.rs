//! Several pipelines beside each other and beside the truth: time and error in one run.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::UVec2;
use meniscus_gpu::{self as gpu, FrameTiming, Gpu, GpuError, PipelineCache, SceneBuffers};
use meniscus_measure::{
    Counters, Judgement, MeasureError, PassMs, Results, Row, Timer, Timing, TruthGeometry, Verdict,
    median, relative_time, timing_warnings,
};
use meniscus_pipeline::Pipeline;
use meniscus_reference::{Tracer, Truth};
use meniscus_scene::{Scene, View, WaterGeometry};
use meniscus_source::Report;
use serde_json::{Map, Value, json};

use crate::facts::facts_of;
use crate::judging::Judging;
use crate::marginal::{self, Without};
use crate::picture::{check_size, is_finite};
use crate::project::Project;
use crate::provenance::provenance;
use crate::rounds::Rounds;
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
    /// How often each is rendered.
    pub rounds: Rounds,
    /// Those of the pipelines that are others without a filling.
    pub without: Vec<Without>,
    /// Settings that were made, for the results.
    pub settings: Map<String, Value>,
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
    /// Pictures and points of each pipeline, in the order of the results' rows.
    pub rows: Vec<RowOutcome>,
    /// The truth.
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
        };
        let mut subjects = Vec::new();
        for (index, pipeline) in self.pipelines.iter().enumerate() {
            progress(
                "preparing pipelines",
                index as f64 / self.pipelines.len() as f64,
            );
            subjects.push(Subject::new(pipeline, &stage)?);
        }
        let true_scene = Scene {
            water: self.scene.water.with_geometry(self.truth),
            ..self.scene.clone()
        };
        let traced =
            Tracer::new(&true_scene).trace(&view, &|part| progress("tracing the truth", part));
        let timings = self.rounds.time(&mut subjects, self.baseline, progress)?;
        let context = Judging::new(self, &traced, &true_scene, view);
        let mut rows = Vec::new();
        let mut found = Vec::new();
        for (index, subject) in subjects.iter_mut().enumerate() {
            progress(
                "comparing with the truth",
                index as f64 / self.pipelines.len() as f64,
            );
            let outcome = context.judge(subject, &stage)?;
            let row = self.row(subject, index, &timings, &outcome)?;
            found.push(row);
            rows.push(outcome);
        }
        let mut preprocessing = Map::new();
        for (name, ms) in [
            ("bvh_ms", stage.scene.build_ms()),
            ("distance_field_ms", stage.scene.distance_field_ms()),
        ] {
            if let Some(ms) = ms {
                preprocessing.insert(name.to_owned(), json!(ms));
            }
        }
        let mut more = Map::new();
        more.insert("preprocessing".to_owned(), Value::Object(preprocessing));
        more.insert("scene_bytes".to_owned(), json!(stage.scene.bytes()));
        let judged = rows.first().map(|row| &row.judgement);
        let mut results = Results {
            provenance: provenance(gpu),
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
        marginal::note(&mut results, &self.without);
        Ok(Outcome {
            results,
            rows,
            truth: traced,
            scene: self.scene.clone(),
            view,
        })
    }

    /// Of every list: the share of the judged pixels that it holds, and of those that it does not
    /// hold, the share with errors beyond half a pixel and with wrong objects. That tells how far
    /// the estimate can be trusted by which the list was made.
    fn list_errors(&self, outcome: &RowOutcome) -> Map<String, Value> {
        let share = |part: usize, whole: usize| part as f64 / whole.max(1) as f64;
        let mut found = Map::new();
        for (name, list) in &outcome.lists {
            let [mut judged, mut listed, mut far, mut wrong] = [0usize; 4];
            for (verdict, is_listed) in outcome.judgement.verdicts.iter().zip(list) {
                let Verdict::Error {
                    px, wrong_object, ..
                } = verdict
                else {
                    continue;
                };
                judged += 1;
                listed += usize::from(*is_listed);
                far += usize::from(!is_listed && *px > 0.5);
                wrong += usize::from(!is_listed && *wrong_object);
            }
            let figures = json!({
                "listed": share(listed, judged),
                "unlisted_beyond_half_px": share(far, judged),
                "unlisted_wrong_object": share(wrong, judged),
            });
            found.insert(name.clone(), figures);
        }
        found
    }

    fn row(
        &self,
        subject: &Subject,
        index: usize,
        timings: &[Vec<FrameTiming>],
        outcome: &RowOutcome,
    ) -> Result<Row, AblationError> {
        // One clock for all rows, or their ratios would compare clocks.
        let every: Vec<FrameTiming> = timings.iter().flatten().cloned().collect();
        let clock = gpu::Timer::of(&every);
        let timing =
            |index: usize| Timing::new(timings[index].iter().map(|f| f.ms(clock)).collect());
        let own = timing(index)?;
        let warnings = timing_warnings(&own);
        let relative = match self.baseline {
            Some(baseline) => Some(relative_time(
                &own,
                &timing(baseline)?,
                &self.pipelines[baseline].name,
            )?),
            None => None,
        };
        let passes =
            subject
                .frame
                .plan()
                .passes
                .iter()
                .enumerate()
                .filter_map(|(pass, planned)| {
                    let ms: Vec<f64> = timings[index]
                        .iter()
                        .filter_map(|f| f.passes.get(pass)?.ms)
                        .collect();
                    Some(PassMs {
                        name: planned.name.clone(),
                        ms: median(&ms)?,
                    })
                });
        let counted = subject.frame.counters()?;
        let mut more = Map::new();
        more.insert("dispatches".into(), json!(counted.dispatches));
        more.insert(
            "compute_invocations".into(),
            json!(counted.compute_invocations),
        );
        more.insert("texture_bytes".into(), json!(counted.texture_bytes));
        more.insert("buffer_bytes".into(), json!(counted.buffer_bytes));
        let hashes = subject
            .frame
            .plan()
            .passes
            .iter()
            .map(|p| (p.name.clone(), json!(p.shader.hash)));
        for (name, list) in &outcome.lists {
            more.insert(
                name.clone(),
                json!(list.iter().filter(|listed| **listed).count()),
            );
        }
        let mut row_more = Map::new();
        if !outcome.lists.is_empty() {
            row_more.insert("lists".into(), json!(self.list_errors(outcome)));
        }
        if !warnings.is_empty() {
            let told = warnings.iter().map(ToString::to_string);
            row_more.insert("warnings".into(), json!(told.collect::<Vec<_>>()));
        }
        row_more.insert("shaders".into(), Value::Object(hashes.collect()));
        row_more.insert("not_finite_pixels".into(), json!(outcome.not_finite()));
        Ok(Row {
            pipeline: subject.name.clone(),
            timer: match clock {
                gpu::Timer::Gpu => Timer::Gpu,
                gpu::Timer::Wall => Timer::Wall,
            },
            frame_ms: own.frame_ms(),
            relative,
            passes: passes.collect(),
            counters: Counters {
                triangles: Some(counted.triangles),
                vertex_invocations: counted.vertex_invocations,
                fragment_invocations: counted.fragment_invocations,
                draws: Some(counted.draws),
                more,
            },
            error: outcome.judgement.errors.clone(),
            more: row_more,
        })
    }
}
