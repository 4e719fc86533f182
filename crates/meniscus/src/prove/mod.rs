//! Whether what is left out is missed: pictures with all pruning beside pictures with none.

mod cases;
mod compare;

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

use glam::UVec2;
use meniscus_gpu::{Frame, Gpu, PipelineCache, SceneBuffers};
use meniscus_pipeline::{Facts, Pipeline, Plan, PlanCache, Pruning};
use meniscus_scene::{Scene, Setting};
use meniscus_source::Report;

use crate::AblationError;
use crate::facts::facts_of;
use crate::project::Project;

pub use cases::Case;
pub use compare::Place;
use compare::{Seen, compare_bits, compare_shown};

/// What is to be proved: that a pipeline's pictures are the same whatever is left out.
#[derive(Debug, Clone)]
pub struct Proof<'a> {
    /// The pipeline.
    pub pipeline: &'a Pipeline,
    /// The scene's name or file.
    pub scene: &'a str,
    /// Settings of the scene, which every case has.
    pub settings: &'a [Setting],
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// How many cases are drawn at random, beside the scene as it stands.
    pub cases: u32,
    /// Equal seeds draw equal cases.
    pub seed: u64,
}

/// What was found.
#[derive(Debug, Clone, Default)]
pub struct Proved {
    /// How many cases were tried, the scene as it stands included.
    pub cases: u32,
    /// How many pictures were compared: each case is looked at in several moments.
    pub pictures: u64,
    /// In how many cases something was left out that may move what is shown.
    pub approximate: u32,
    /// The largest such move, pixels.
    pub largest_px: f64,
    /// Passes that ran with all pruning, and with none.
    pub passes: [u64; 2],
    /// What differs by more than it may.
    pub differences: Vec<Difference>,
}

/// A difference that must not be.
#[derive(Debug, Clone)]
pub struct Difference {
    /// The case.
    pub case: Case,
    /// What was done since the case's first picture.
    pub moment: &'static str,
    /// What is different.
    pub output: String,
    /// By how many pixels it may differ; none where every bit has to be the same.
    pub within_px: Option<f64>,
    /// In how many pixels.
    pub pixels: usize,
    /// The first of them.
    pub first: Place,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Place {
            pixel: [x, y],
            pruned,
            whole,
        } = &self.first;
        write!(
            f,
            "case {}, {}: {}",
            self.case.number, self.moment, self.output
        )?;
        match self.within_px {
            Some(px) => write!(f, " is off by more than {px} px")?,
            None => write!(f, " differs")?,
        }
        write!(
            f,
            " in {} pixels; at ({x}, {y}) it is {pruned} with all pruning, and {whole} with none",
            self.pixels
        )
    }
}

/// The most differences that are told; one is enough to look into.
const MOST_TOLD: usize = 20;

/// What all cases share.
struct Bench<'a> {
    project: &'a Project,
    gpu: &'a Gpu,
    proof: &'a Proof<'a>,
    cache: PipelineCache,
    /// Of each kind of plan, with and without what is shown.
    plans: BTreeMap<Kind, PlanCache>,
}

/// How much is left out, and whether the plan tells what is shown.
type Kind = (Pruning, bool);

impl Proof<'_> {
    /// Renders every case with all pruning and with none, and compares.
    ///
    /// # Errors
    /// When the pipeline or the scene is wrong, and when the GPU refuses.
    pub fn run(
        &self,
        project: &Project,
        gpu: &Gpu,
        progress: &crate::Progress,
    ) -> Result<Proved, AblationError> {
        crate::picture::check_size(gpu, self.size)?;
        let mut bench = Bench {
            project,
            gpu,
            proof: self,
            cache: PipelineCache::default(),
            plans: BTreeMap::new(),
        };
        let mut proved = Proved::default();
        let cases = cases::drawn(self);
        for (done, case) in cases.iter().enumerate() {
            progress("comparing", done as f64 / cases.len() as f64);
            bench.try_case(case, &mut proved)?;
            proved.cases += 1;
            if proved.differences.len() >= MOST_TOLD {
                break;
            }
        }
        Ok(proved)
    }
}

impl Bench<'_> {
    fn try_case(&mut self, case: &Case, proved: &mut Proved) -> Result<(), AblationError> {
        let given = self.proof.settings.iter().cloned();
        let drawn = case.settings.iter();
        let drawn = drawn.map(|(key, value)| Setting::new(*key, value.clone()));
        let settings: Vec<Setting> = given.chain(drawn).collect();
        let mut scene = self.project.scene(self.proof.scene, &settings)?;
        let buffers = Arc::new(SceneBuffers::new(self.gpu, &scene)?);
        let facts = facts_of(&scene, self.proof.size);
        for shown in [false, true] {
            let mut pruned = self.frame((Pruning::Exact, shown), facts, &buffers)?;
            let mut whole = self.frame((Pruning::None, shown), facts, &buffers)?;
            let start = scene.clone();
            for moment in cases::MOMENTS {
                (moment.change)(&mut scene);
                // What holds may change with the moment; then there are other plans to compare.
                if facts_of(&scene, self.proof.size) != facts {
                    break;
                }
                pruned.update(&scene)?;
                whole.update(&scene)?;
                let ran = [pruned.refresh()?.passes, whole.render()?.passes.len()];
                for (sum, ran) in proved.passes.iter_mut().zip(ran) {
                    *sum += ran as u64;
                }
                proved.pictures += 1;
                let found = compare_bits(&pruned, &whole, self.proof.size)?;
                proved.differences.extend(found.map(|found| Difference {
                    case: case.clone(),
                    moment: moment.name,
                    output: found.output,
                    within_px: None,
                    pixels: found.pixels,
                    first: found.first,
                }));
                if shown {
                    // The twins are the same passes: one moment tells.
                    break;
                }
            }
            scene = start;
        }
        self.try_approximate(case, &scene, &buffers, proved)
    }

    /// Compares what is shown where something may be left out that moves it.
    fn try_approximate(
        &mut self,
        case: &Case,
        scene: &Scene,
        buffers: &Arc<SceneBuffers>,
        proved: &mut Proved,
    ) -> Result<(), AblationError> {
        let facts = facts_of(scene, self.proof.size);
        let approximate = (Pruning::Approximate, true);
        // The plan's own word is what it is held to.
        let within_px = self.plan(approximate, facts)?.within_px;
        if within_px == 0.0 {
            return Ok(());
        }
        proved.approximate += 1;
        let mut shows = |kind| -> Result<Seen, AblationError> {
            let mut frame = self.frame(kind, facts, buffers)?;
            frame.render()?;
            Ok(Seen::read(&frame)?)
        };
        let (pruned, whole) = (shows(approximate)?, shows((Pruning::None, true))?);
        let view = scene.camera.view(UVec2::from_array(self.proof.size));
        let (largest, found) = compare_shown(&pruned, &whole, scene, &view, within_px);
        proved.pictures += 1;
        proved.largest_px = proved.largest_px.max(largest);
        proved.differences.extend(found.map(|found| Difference {
            case: case.clone(),
            moment: cases::MOMENTS[0].name,
            output: found.output,
            within_px: Some(within_px),
            pixels: found.pixels,
            first: found.first,
        }));
        Ok(())
    }

    /// A frame from which as much is left out as from its plan: all or nothing.
    fn frame(
        &mut self,
        kind: Kind,
        facts: Facts,
        scene: &Arc<SceneBuffers>,
    ) -> Result<Frame, AblationError> {
        let size = UVec2::from_array(self.proof.size);
        let plan = self.plan(kind, facts)?;
        let (skipping, scene) = (kind.0.into(), scene.clone());
        let frame = Frame::with(self.gpu, &plan, scene, size, &self.cache, skipping)?;
        Ok(frame)
    }

    fn plan(&mut self, kind: Kind, facts: Facts) -> Result<Arc<Plan>, Report> {
        let (pruning, shown) = kind;
        let plans = self.plans.entry(kind);
        let plans =
            plans.or_insert_with(|| PlanCache::new(self.proof.pipeline.clone(), pruning, shown));
        plans.plan(&self.project.composer, facts).cloned()
    }
}
