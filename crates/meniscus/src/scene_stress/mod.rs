//! Random scenes, pushed to extremes, and what must hold of their frames.
//!
//! Each scene is an ordinary one made odd in a few named ways (`oddities`), so that a scene that
//! fails can be made less odd until only what makes it fail is left.

mod accuracy;
mod draft;
mod examine;
mod oddities;

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use glam::UVec2;
use meniscus_gpu::Gpu;
use meniscus_pipeline::Pipeline;
use meniscus_scene::{Scene, WaterGeometry};
use meniscus_source::{Diagnostic, Report, SourceFile};

pub use accuracy::Distance;
use accuracy::{Standard, is_inside};
use draft::Draft;
use examine::Examiner;
use oddities::{Oddity, SPLINTERS, SPLINTERS_OBJ};

use crate::ablation::Progress;
use crate::project::Project;

/// The most oddities of one scene.
const MOST_ODDITIES: usize = 6;

/// Scenes to be tried.
#[derive(Debug, Clone)]
pub struct SceneStress {
    /// The pipelines; each scene is rendered by some of them, by turns.
    pub pipelines: Vec<Pipeline>,
    /// How many pipelines render each scene.
    pub each: usize,
    /// The first scene's number; scenes of other numbers are others.
    pub first: u64,
    /// How many scenes.
    pub scenes: u64,
    /// Equal seeds make equal scenes.
    pub seed: u64,
    /// Width and height of pictures whose size is not odd, pixels.
    pub size: [u32; 2],
}

/// What was found.
#[derive(Debug, Clone, Default, serde::Serialize)]
pub struct StressedScenes {
    /// The seed, and how many pipelines took turns.
    pub seed: u64,
    /// See `seed`.
    pub pipelines: usize,
    /// Scenes that were tried.
    pub scenes: u64,
    /// Pictures that were examined; each is several frames.
    pub pictures: u64,
    /// Pictures that were held to the truth, and how far they were from it in all.
    pub judged: u64,
    /// Pixels of these, those that are more than half a pixel off, and the mean error.
    pub distance: Distance,
    /// What was refused in words, and how often.
    pub refused: BTreeMap<String, u64>,
    /// How many scenes had an oddity, by its name and value.
    pub oddities: BTreeMap<String, u64>,
    /// What failed.
    pub failures: Vec<SceneFailure>,
}

/// A scene that fails, made as plain as it can be and still fail.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct SceneFailure {
    /// The scene's number.
    pub number: u64,
    /// The pipeline.
    pub pipeline: String,
    /// What fails.
    pub what: String,
    /// What is odd about the scene, as far as it matters.
    pub oddities: Vec<String>,
    /// The scene file.
    pub ron: String,
    /// A mesh file that the scene names, and its text.
    pub mesh: Option<(String, String)>,
    /// Width and height of the picture.
    pub size: [u32; 2],
}

/// What can be wrong with a frame.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Fault {
    /// A number that is none.
    NotFinite(String),
    /// Equal input, and other output.
    Unequal(String),
    /// The graphics library or the driver objects.
    Driver(String),
    /// Further from the truth than promised.
    Inaccurate(String),
    /// The program itself gave up.
    Panic(String),
    /// The scene is none that can be rendered, and the program says so: no fault.
    Refused(String),
}

impl Fault {
    fn said(&self) -> &str {
        match self {
            Self::NotFinite(what)
            | Self::Unequal(what)
            | Self::Driver(what)
            | Self::Inaccurate(what)
            | Self::Panic(what)
            | Self::Refused(what) => what,
        }
    }

    fn is_like(&self, other: &Self) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(other)
    }
}

/// A scene as it is thought of: a plain one, and what is odd about it.
#[derive(Debug, Clone)]
struct Case {
    plain: Draft,
    oddities: Vec<Oddity>,
}

impl Case {
    fn new(seed: u64, number: u64, size: [u32; 2]) -> Self {
        // Scenes of neighbouring numbers are to have nothing in common.
        let mixed = seed ^ number.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mut random = fastrand::Rng::with_seed(mixed);
        let mut plain = Draft::pool(&mut random);
        plain.size = size;
        let oddities = Oddity::some(&mut random, MOST_ODDITIES);
        Self { plain, oddities }
    }

    fn draft(&self) -> Draft {
        let mut draft = self.plain.clone();
        self.oddities.iter().for_each(|odd| odd.apply(&mut draft));
        // What a scene file may say at most: oddities together reach beyond it.
        let held = |x: f64| x.clamp(-1e5, 1e5);
        draft.position = draft.position.map(held);
        draft.target = draft.target.map(held);
        draft
    }

    /// The scene, and what it was read from.
    fn scene(&self, folder: &Path) -> Result<(Scene, Draft), Report> {
        let load = |draft: &Draft| {
            let file =
                SourceFile::new("scene.ron", draft.ron("made by `meniscus stress --scenes`"));
            Scene::load(&file, Some(folder), &[])
        };
        let mut draft = self.draft();
        let mut scene = load(&draft)?;
        if draft.rides {
            let below = match scene.water.geometry {
                WaterGeometry::Displaced => scene.water.height(scene.camera.eye.truncate()),
                WaterGeometry::Flat => 0.0,
            };
            draft.height += below;
            draft.rides = false;
            scene = load(&draft)?;
        }
        Ok((scene, draft))
    }

    fn said(&self) -> Vec<String> {
        self.oddities.iter().map(Oddity::said).collect()
    }
}

impl SceneStress {
    /// Tries the scenes one after the other.
    ///
    /// # Errors
    /// When there is nothing to render with, and when a mesh file cannot be kept for the time of
    /// the run. What fails in a scene is told in what comes back.
    pub fn run(
        &self,
        project: &Project,
        gpu: &Gpu,
        progress: &Progress,
    ) -> Result<StressedScenes, Report> {
        if self.pipelines.is_empty() {
            return Err(Diagnostic::error("there is no pipeline to render scenes with").into());
        }
        let folder = tempfile::tempdir()
            .and_then(|folder| {
                std::fs::write(folder.path().join(SPLINTERS), SPLINTERS_OBJ)?;
                Ok(folder)
            })
            .map_err(|error| Diagnostic::error(format!("cannot keep a mesh file: {error}")))?;
        let mut run = Run {
            stress: self,
            examiner: Examiner::new(project, gpu, &self.pipelines),
            folder: folder.path(),
            found: StressedScenes {
                seed: self.seed,
                pipelines: self.pipelines.len(),
                ..StressedScenes::default()
            },
        };
        for index in 0..self.scenes {
            let failures = run.found.failures.len();
            let said = match failures {
                0 => "extreme scenes".to_owned(),
                failures => format!("extreme scenes, {failures} failing"),
            };
            progress(&said, index as f64 / self.scenes as f64);
            run.scene(self.first + index);
        }
        Ok(run.found)
    }

    /// The pipelines that render a scene, by their indices.
    fn turn(&self, number: u64) -> impl Iterator<Item = usize> + use<> {
        let count = self.pipelines.len();
        // Far apart, so that relatives do not come together.
        let stride = (count / self.each.max(1)).max(1);
        let first = number as usize;
        (0..self.each.min(count)).map(move |turn| (first + turn * stride) % count)
    }
}

/// A run under way.
struct Run<'a> {
    stress: &'a SceneStress,
    examiner: Examiner<'a>,
    folder: &'a Path,
    found: StressedScenes,
}

impl Run<'_> {
    fn scene(&mut self, number: u64) {
        let case = Case::new(self.stress.seed, number, self.stress.size);
        self.found.scenes += 1;
        for odd in case.said() {
            *self.found.oddities.entry(odd).or_default() += 1;
        }
        for pipeline in self.stress.turn(number) {
            self.found.pictures += 1;
            match self.examine(&case, pipeline) {
                Ok(None) => {}
                Ok(Some(distance)) => {
                    self.found.judged += 1;
                    self.found.distance.add(&distance);
                }
                Err(Fault::Refused(why)) => {
                    // One line of each reason is enough to know it by.
                    let line = why.lines().next().unwrap_or_default().to_owned();
                    *self.found.refused.entry(line).or_default() += 1;
                }
                Err(fault) => {
                    let failure = self.minimised(number, &case, pipeline, fault);
                    self.found.failures.push(failure);
                }
            }
        }
    }

    /// Renders a case with a pipeline, and tells how far it is from the truth where that is held to
    /// it.
    fn examine(&mut self, case: &Case, pipeline: usize) -> Result<Option<Distance>, Fault> {
        let (examiner, folder) = (&mut self.examiner, self.folder);
        // What was being made when something gave up is thrown away; caches hold whole things.
        let outcome = catch_unwind(AssertUnwindSafe(|| {
            let refused = |report: Report| Fault::Refused(report.to_string());
            let (scene, draft) = case.scene(folder).map_err(refused)?;
            scene
                .check()
                .map_err(|report| Fault::Panic(report.to_string()))?;
            let buffers = examiner.upload(&scene)?;
            let rendered = examiner.render(pipeline, &scene, &buffers, draft.size)?;
            if !rendered.traces || rendered.shown.is_empty() || !is_inside(&scene, draft.size) {
                return Ok(None);
            }
            let view = scene.camera.view(UVec2::from_array(draft.size));
            Standard::trace(&scene, &view).judge(&rendered).map(Some)
        }));
        outcome.unwrap_or_else(|panic| {
            let said = panic.downcast_ref::<String>().map(String::as_str);
            let said = said.or_else(|| panic.downcast_ref::<&str>().copied());
            let said = said.unwrap_or("it does not say why");
            Err(Fault::Panic(format!("the program gave up: {said}")))
        })
    }

    /// Takes back what is odd, halves first and then one by one, as long as the case still fails
    /// likewise.
    fn minimised(
        &mut self,
        number: u64,
        case: &Case,
        pipeline: usize,
        fault: Fault,
    ) -> SceneFailure {
        let (mut case, mut fault) = (case.clone(), fault);
        let mut part = case.oddities.len();
        while part > 0 {
            let mut start = 0;
            while start < case.oddities.len() {
                let mut plainer = case.clone();
                let end = (start + part).min(plainer.oddities.len());
                plainer.oddities.drain(start..end);
                match self.examine(&plainer, pipeline) {
                    Err(still) if still.is_like(&fault) => (case, fault) = (plainer, still),
                    _ => start += part,
                }
            }
            part /= 2;
        }
        let about = format!(
            "scene {number} of seed {}: {}",
            self.stress.seed,
            case.said().join("; ")
        );
        let written = case
            .scene(self.folder)
            .map_or_else(|_| case.draft(), |(_, draft)| draft);
        let ron = written.ron(&about);
        let names = ron.contains(SPLINTERS);
        SceneFailure {
            number,
            pipeline: self.stress.pipelines[pipeline].name.clone(),
            what: fault.said().to_owned(),
            oddities: case.said(),
            mesh: names.then(|| (SPLINTERS.to_owned(), SPLINTERS_OBJ.to_owned())),
            size: written.size,
            ron,
        }
    }
}

impl Distance {
    fn add(&mut self, other: &Self) {
        let sum = self.mean_px * self.pixels as f64 + other.mean_px * other.pixels as f64;
        self.pixels += other.pixels;
        self.far += other.far;
        self.mean_px = sum / self.pixels.max(1) as f64;
    }
}

/// The names of what can be odd about a scene.
pub fn oddity_names() -> Vec<&'static str> {
    oddities::names().collect()
}

/// One scene of a file, held to the same.
#[derive(Debug, Clone)]
pub struct SceneCheck {
    /// The scene.
    pub scene: Scene,
    /// The pipelines.
    pub pipelines: Vec<Pipeline>,
    /// Width and height of the pictures, pixels.
    pub size: [u32; 2],
}

impl SceneCheck {
    /// What is wrong with the frames of each pipeline, by its name.
    pub fn run(&self, project: &Project, gpu: &Gpu) -> BTreeMap<String, String> {
        let mut examiner = Examiner::new(project, gpu, &self.pipelines);
        let mut wrong = BTreeMap::new();
        let view = self.scene.camera.view(UVec2::from_array(self.size));
        for (index, pipeline) in self.pipelines.iter().enumerate() {
            let outcome = examiner
                .upload(&self.scene)
                .and_then(|buffers| examiner.render(index, &self.scene, &buffers, self.size))
                .and_then(|rendered| {
                    let held = rendered.traces && !rendered.shown.is_empty();
                    match held && is_inside(&self.scene, self.size) {
                        true => Standard::trace(&self.scene, &view)
                            .judge(&rendered)
                            .map(drop),
                        false => Ok(()),
                    }
                });
            if let Err(fault) = outcome {
                wrong.insert(pipeline.name.clone(), fault.said().to_owned());
            }
        }
        wrong
    }
}
