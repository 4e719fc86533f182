//! What can be written on the command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use meniscus::Sources;
use meniscus::gpu::{Gpu, GpuError, cache_folder};
use meniscus::pipeline::Pipeline;
use meniscus::scene::{Scene, Setting, WaterGeometry};
use meniscus::source::{Diagnostic, Report};

use super::Failure;

/// Under which the help shows the directories.
const SOURCES: &str = "Directories (each may be given more than once)";

/// The scene where none is named.
const SCENE: &str = "pool";

/// Shader pipelines put together by configuration, and refraction that is both fast and right.
#[derive(Debug, Parser)]
#[command(name = "meniscus", version, max_term_width = 100)]
pub(crate) struct Arguments {
    /// WGSL modules that add to the built-in ones, or replace those of the same path.
    #[arg(
        long = "modules",
        id = "modules_folders",
        global = true,
        value_name = "DIR",
        help_heading = SOURCES
    )]
    modules: Vec<PathBuf>,
    /// Pipelines in RON, likewise.
    #[arg(
        long = "pipelines",
        id = "pipelines_folders",
        global = true,
        value_name = "DIR",
        help_heading = SOURCES
    )]
    pipelines: Vec<PathBuf>,
    /// Scenes in RON, likewise.
    #[arg(
        long = "scenes",
        id = "scenes_folders",
        global = true,
        value_name = "DIR",
        help_heading = SOURCES
    )]
    scenes: Vec<PathBuf>,
    #[command(subcommand)]
    pub command: Command,
}

impl Arguments {
    pub fn sources(&self) -> Sources {
        let mut scenes = self.scenes.clone();
        if let Command::Stress(stress) = &self.command {
            // There the word stands for a number of scenes, too.
            scenes.retain(|folder| stress.random.number(folder).is_none());
        }
        Sources {
            modules: self.modules.clone(),
            pipelines: self.pipelines.clone(),
            scenes,
        }
    }
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// List modules, slots, pipelines and scenes, each with its purpose.
    List(super::list::List),
    /// Compose and validate every shader of every pipeline, and every module, without a GPU.
    Check(super::check::Check),
    /// Print what a pass is composed to: WGSL, SPIR-V, HLSL, MSL or GLSL.
    Compose(super::compose::Compose),
    /// Say in words how a pipeline differs from another.
    Diff(super::diff::Diff),
    /// Say what of a pipeline a scene needs: what is kept and what is left out, by which fact and rule.
    Explain(Box<super::explain::Explain>),
    /// Render with all that can be left out left out, and with nothing, and compare.
    ///
    /// Every output has to hold the same bits; where a module says that leaving something out moves
    /// what is shown by a part of a pixel, what is shown has to stay within that. Cameras, waves and
    /// times are drawn at random. Ends with 1 where something differs, and tells how to see it again.
    Prove(Box<super::prove::Prove>),
    /// Draw a pipeline: its passes, what fills their slots, and what lies between them.
    Graph(super::graph::Graph),
    /// Write what something new begins as.
    New(super::new_module::New),
    /// Render one pipeline to a PNG, or at several moments to as many.
    Render(super::render::Render),
    /// Run a pipeline pass by pass, compute and screen passes on the CPU.
    ///
    /// The shaders that a GPU runs are evaluated on all cores; draws take a GPU.
    Run(Box<super::run::Run>),
    /// Render pipelines beside each other and beside ray-traced truth: time and error in one table.
    Ablate(Box<Ablate>),
    /// Join the results of parts of a sweep.
    Merge(super::sweep::Merge),
    /// Measure how far a picture is from another: PNG (sRGB) or EXR (linear).
    ///
    /// Ends with 0 when the measure is within the limit or none is given, with 1 beyond it, and with
    /// 2 when the pictures cannot be compared.
    #[command(after_help = super::compare::measures())]
    Compare(super::compare::Compare),
    /// Run one function of a module on given numbers, on the CPU or a GPU.
    Eval(Eval),
    /// Hunt the inputs on which modules are worst, on the CPU and the GPU, and tell how exact they are.
    ///
    /// Functions are tried where their headers say that their inputs lie (`// domain: …`): with
    /// random inputs, with special ones, and by an adversary that goes from bad inputs to worse.
    /// Errors are in units in the last place of 32-bit floats.
    Stress(Stress),
    /// Print the JSON Schema of pipeline files or scene files, for editors and other programs.
    Schema(super::schema::Schema),
    /// List the graphics adapters of this machine.
    Adapters,
}

/// Changes to pipelines.
#[derive(Debug, Clone, Args)]
pub(crate) struct Changes {
    /// Change a pipeline: PASS.SLOT=MODULE or PASS.SLOT.NUMBER=VALUE; may be given more than once.
    #[arg(long = "with", value_name = "KEY=VALUE")]
    pub with: Vec<String>,
}

/// The scene and how it is looked at.
#[derive(Debug, Clone, Args)]
pub(crate) struct Look {
    /// The scene, by name or file; the pool if none is given.
    #[arg(long, value_name = "NAME")]
    pub scene: Option<String>,
    /// Width and height in pixels.
    #[arg(long, value_name = "WxH", default_value = "640x360", value_parser = size)]
    pub size: [u32; 2],
    /// Change the scene, for example water.rms_slope=0.05; may be given more than once. `meniscus
    /// list settings` tells all keys.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// The graphics adapter, by a part of its name (see `meniscus adapters`); the best one if none
    /// is given.
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
}

#[derive(Debug, Clone, Args)]
pub(crate) struct Ablate {
    /// Pipelines by name or file, `refraction/*` for many; all under `refraction/` if none is given.
    pub pipelines: Vec<String>,
    #[command(flatten)]
    pub look: Look,
    #[command(flatten)]
    pub changes: Changes,
    #[command(flatten)]
    pub skipping: super::explain::Skipping,
    /// The water that rays meet, in pipelines and truth: its rest plane with the waves' normals
    /// (`flat`) or the waves (`displaced`); the scene's own if not given. With
    /// `--set water.geometry=…` it is the truth's alone.
    #[arg(long, value_enum, value_name = "GEOMETRY")]
    pub truth: Option<Geometry>,
    /// Run each pipeline with each of these fillings; given more than once, with every combination.
    #[arg(long = "try", value_name = "PASS.SLOT=A,B")]
    pub attempts: Vec<String>,
    /// The pipeline that times are relative to; by default the one that says so of itself.
    #[arg(long, value_name = "PIPELINE")]
    pub baseline: Option<String>,
    /// How many frames of each pipeline are timed, in turn with the others'.
    #[arg(long, value_name = "NUMBER", default_value_t = 15, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub rounds: u32,
    /// Time more frames than that, until the 95 % confidence interval of every ratio to the baseline
    /// is narrower than this share of the ratio, such as 0.02.
    #[arg(long, value_name = "RATIO", value_parser = share)]
    pub until: Option<f64>,
    /// When `--until` gives up.
    #[arg(long, value_name = "NUMBER", default_value_t = 60, value_parser = clap::value_parser!(u64).range(1..=86_400), requires = "until")]
    pub limit_seconds: u64,
    /// Also run this pipeline with each of its filled slots put back to the default: what each
    /// filling brings and costs.
    #[arg(long, value_name = "PIPELINE")]
    pub leave_one_out: Option<String>,
    #[command(flatten)]
    pub sweeping: super::sweep::Sweeping,
    /// Write one HTML file with the table, the plane of time and error, pictures to compare, times of
    /// passes and provenance; of a sweep, with curves and the tables of all points.
    #[arg(long, value_name = "FILE.html")]
    pub report: Option<PathBuf>,
    /// Write the results as JSON; crates/meniscus-measure/README.md tells the keys.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write the table as Markdown.
    #[arg(long, value_name = "FILE")]
    pub markdown: Option<PathBuf>,
    /// Write the table as CSV.
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Write pictures, error maps, the figure of time against error, a report, and the data to check
    /// them.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// What modules read from their surroundings.
#[derive(Debug, Args)]
pub(crate) struct Surroundings {
    /// Set what modules read: water.refractive_index=1.5, water.camera_side=-1 (the eye under
    /// water), waves[0].amplitude=0.1, view_target.eye=0,-4,1.7; may be given more than once. By
    /// default water of index 1.333 at height 0 with three waves, a camera 1.7 m above it that looks
    /// down, a sun, and small textures.
    #[arg(long = "set", value_name = "NAME=NUMBER,…")]
    pub set: Vec<String>,
}

#[derive(Debug, Args)]
pub(crate) struct Eval {
    /// The function: FOLDER/MODULE:FUNCTION.
    #[arg(value_name = "MODULE:FUNCTION")]
    pub function: String,
    /// Its arguments, a number for each component; true and false for truth values.
    #[arg(allow_negative_numbers = true, value_name = "NUMBER")]
    pub arguments: Vec<String>,
    /// Read arguments from a file instead, a line for each call; the first line names the columns
    /// (`incident.x`). Results are written as CSV.
    #[arg(long, value_name = "FILE", conflicts_with = "arguments")]
    pub csv: Option<PathBuf>,
    /// The number system.
    #[arg(long, value_enum, default_value = "f32")]
    pub scalar: Numbers,
    #[command(flatten)]
    pub computer: super::eval::Computer,
    #[command(flatten)]
    pub surroundings: Surroundings,
}

/// Number systems.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Numbers {
    /// 32-bit floats, as a GPU computes.
    F32,
    /// 64-bit floats.
    F64,
    /// Pairs of 64-bit floats: 31 digits.
    Dd,
    /// Bounds between which the result lies.
    Interval,
    /// 64-bit floats, and how a relative change of the arguments changes the result.
    Dual,
}

#[derive(Debug, Args)]
pub(crate) struct Stress {
    /// The module, or one function of it; all that declare a domain if none is given. With --scenes
    /// or --scene a pipeline, `refraction/*` for many.
    #[arg(value_name = "MODULE[:FUNCTION]")]
    pub target: Option<String>,
    /// Go on searching for this long per function.
    #[arg(long, value_name = "NUMBER", default_value_t = 0, value_parser = clap::value_parser!(u64).range(..=86_400))]
    pub seconds: u64,
    /// How many random inputs are tried per function; a sixteenth as many special ones and steps of
    /// the adversary.
    #[arg(long, value_name = "NUMBER", default_value_t = 1 << 20, value_parser = clap::value_parser!(u32).range(16..=1 << 28))]
    pub samples: u32,
    /// Equal seeds find equal things.
    #[arg(long, value_name = "NUMBER", default_value_t = 1)]
    pub seed: u64,
    /// Write what is found as JSON.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write the table as Markdown.
    #[arg(long, value_name = "FILE")]
    pub markdown: Option<PathBuf>,
    /// Keep the worst inputs, a file for each function: for regression tests.
    #[arg(long, value_name = "DIR")]
    pub worst: Option<PathBuf>,
    #[command(flatten)]
    pub computers: super::stress::Computers,
    #[command(flatten)]
    pub surroundings: Surroundings,
    #[command(flatten)]
    pub random: super::stress_scenes::RandomScenes,
    #[command(flatten)]
    pub stability: super::stability::Stability,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Geometry {
    Flat,
    Displaced,
}

impl From<Geometry> for WaterGeometry {
    fn from(geometry: Geometry) -> Self {
        match geometry {
            Geometry::Flat => Self::Flat,
            Geometry::Displaced => Self::Displaced,
        }
    }
}

/// The latest moment, seconds: beyond it waves' phases lose their digits.
const LATEST_MOMENT: f64 = 1e6;

/// Refuses what is no moment of a scene.
pub(crate) fn check_moments(times: &[f64]) -> Result<(), Diagnostic> {
    let allowed = -LATEST_MOMENT..=LATEST_MOMENT;
    match times.iter().find(|time| !allowed.contains(time)) {
        Some(wrong) => Err(Diagnostic::error(format!("`--times {wrong}` is no moment"))
            .with_help(format!("give numbers of seconds up to {LATEST_MOMENT}"))),
        None => Ok(()),
    }
}

fn share(text: &str) -> Result<f64, String> {
    let number = text.trim().parse::<f64>().ok();
    let allowed = number.filter(|number| (1e-4..=1.0).contains(number));
    allowed.ok_or_else(|| format!("`{text}` is no share from 0.0001 to 1, such as 0.02"))
}

/// Beyond so many pixels along a side even bytes are hard to count; adapters make far fewer.
const LARGEST_SIDE: u32 = 1_000_000;

pub(crate) fn size(text: &str) -> Result<[u32; 2], String> {
    let wrong = || format!("`{text}` is no size; write WIDTHxHEIGHT in pixels, such as 640x360");
    let (width, height) = text.split_once(['x', '×']).ok_or_else(wrong)?;
    let number = |text: &str| text.trim().parse::<u32>().map_err(|_| wrong());
    let size = [number(width)?, number(height)?];
    if size.contains(&0) {
        return Err(format!(
            "a picture of {text} has no pixels; width and height begin at 1"
        ));
    }
    if size.iter().any(|side| *side > LARGEST_SIDE) {
        return Err(format!(
            "a picture of {text} is larger than any adapter makes; width and height end at {LARGEST_SIDE}"
        ));
    }
    Ok(size)
}

impl Look {
    /// The settings of the scene.
    pub fn settings(&self) -> Result<Vec<Setting>, Report> {
        let mut report = Report::default();
        let mut settings = Vec::new();
        for text in &self.set {
            match Setting::parse("--set", text) {
                Ok(setting) => settings.push(setting),
                Err(wrong) => report.add(wrong),
            }
        }
        report.into_result(settings)
    }

    /// The scene's name.
    pub fn scene_name(&self) -> &str {
        self.scene.as_deref().unwrap_or(SCENE)
    }

    pub fn scene(&self, project: &meniscus::Project) -> Result<Scene, Failure> {
        Ok(project.scene(self.scene_name(), &self.settings()?)?)
    }

    /// Opens the adapter; what its driver compiles is kept for the next run.
    pub fn gpu(&self) -> Result<Gpu, GpuError> {
        Gpu::keeping(self.adapter.as_deref(), cache_folder().as_deref())
    }
}

/// Splits `KEY=VALUE`.
pub(crate) fn key_value<'a>(option: &str, text: &'a str) -> Result<(&'a str, &'a str), Diagnostic> {
    text.split_once('=')
        .filter(|(key, _)| !key.trim().is_empty())
        .ok_or_else(|| {
            Diagnostic::error(format!("`{option} {text}`: KEY=VALUE is wanted"))
                .with_help(format!("for example {option} PASS.SLOT=FOLDER/MODULE"))
        })
}

impl Changes {
    /// Applies `--with`. Where several pipelines run, one that has not the pass is left as it is,
    /// unless none has it.
    pub fn apply(&self, pipelines: &mut [Pipeline]) -> Result<(), Report> {
        for text in &self.with {
            let (key, value) = key_value("--with", text)?;
            let mut report = Report::default();
            let mut changed = false;
            for pipeline in pipelines.iter_mut() {
                let mut attempt = pipeline.clone();
                match attempt.set(key, value) {
                    Ok(()) => {
                        *pipeline = attempt;
                        changed = true;
                    }
                    Err(wrong) => report.extend(wrong),
                }
            }
            if !changed {
                return Err(report);
            }
        }
        Ok(())
    }
}
