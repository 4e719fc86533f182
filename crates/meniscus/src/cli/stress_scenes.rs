//! `meniscus stress --scenes N`

use std::path::{Path, PathBuf};

use clap::Args;
use meniscus::gpu::Gpu;
use meniscus::measure::write_atomically;
use meniscus::pipeline::Pipeline;
use meniscus::source::{Diagnostic, Report};
use meniscus::{Project, SceneCheck, SceneFailure, SceneStress, StressedScenes};

use super::arguments::{Stress, size};
use super::progress::Bar;
use super::say::say;
use super::{Failure, outputs};

/// What is run where nothing is named.
const ALL: &str = "refraction/*";
/// How many pipelines render each scene.
const EACH: usize = 2;

/// The most scenes of one run.
const MOST: u64 = 1 << 32;

/// Whole scenes instead of functions.
#[derive(Debug, Args)]
#[command(next_help_heading = "Whole scenes")]
pub(crate) struct RandomScenes {
    /// Render so many random scenes that are pushed to extremes, each with two of the pipelines by
    /// turns: no number that is none in any texture, equal frames from equal input, no objection of
    /// the driver, and the truth where the scene is in the modules' domains. What fails is made as
    /// plain as it can be and printed. (The name of a folder with scenes may also stand here.)
    // Of the same name and kind as the folders, since arguments that are valid everywhere are.
    #[arg(long = "scenes", id = "scenes_folders", value_name = "NUMBER")]
    scenes: Vec<PathBuf>,
    /// The first scene's number.
    #[arg(long, value_name = "NUMBER", default_value_t = 0)]
    first: u64,
    /// Hold the frames of this scene to the same instead, by name or file.
    #[arg(long, value_name = "NAME")]
    scene: Option<String>,
    /// Width and height in pixels.
    #[arg(long, value_name = "WxH", default_value = "24x16", value_parser = size)]
    size: [u32; 2],
}

impl RandomScenes {
    /// A number of scenes, where that is what is written.
    pub fn number<'a>(&self, written: &'a Path) -> Option<&'a str> {
        let text = written.to_str()?;
        let number = !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
        number.then_some(text)
    }

    /// Whether whole scenes are to be tried.
    pub fn is_asked(&self) -> bool {
        self.scene.is_some() || self.scenes.iter().any(|s| self.number(s).is_some())
    }

    fn count(&self) -> Result<u64, Report> {
        let mut numbers = self.scenes.iter().filter_map(|s| self.number(s));
        let written = numbers.next_back();
        let written = written.unwrap_or_default();
        let number = written.parse::<u64>().ok();
        number.filter(|n| (1..=MOST).contains(n)).ok_or_else(|| {
            let wrong = Diagnostic::error(format!("`--scenes {written}` scenes cannot be tried"));
            wrong
                .with_help(format!("give a number from 1 to {MOST}"))
                .into()
        })
    }
}

pub(crate) fn run(project: &Project, stress: &Stress) -> Result<(), Failure> {
    let patterns = [stress.target.clone().unwrap_or_else(|| ALL.to_owned())];
    let mut pipelines = Vec::new();
    for name in project.pipeline_names(&patterns)? {
        pipelines.push(project.pipeline(&name)?);
    }
    outputs::check(stress.json.iter(), stress.worst.as_ref())?;
    if let Some(name) = &stress.random.scene {
        return one(project, stress, name, pipelines);
    }
    let tried = SceneStress {
        pipelines,
        each: EACH,
        first: stress.random.first,
        scenes: stress.random.count()?,
        seed: stress.seed,
        size: stress.random.size,
    };
    let gpu = Gpu::open(None)?;
    let bar = Bar::new();
    let found = tried.run(project, &gpu, &|what, part| bar.tell(what, part));
    bar.finish();
    let found = found?;
    for (index, failure) in found.failures.iter().enumerate() {
        say(&told(failure))?;
        if let Some(folder) = &stress.worst {
            keep(folder, index, failure)?;
        }
    }
    say(&summary(&found))?;
    if let Some(path) = &stress.json {
        let text = serde_json::to_string_pretty(&found)
            .map_err(|error| Failure::Machine(format!("error: {error}")))?;
        write_atomically(path, text.as_bytes())?;
    }
    match found.failures.len() {
        0 => Ok(()),
        failures => Err(Failure::Beyond(format!("{failures} pictures fail"))),
    }
}

/// Holds one scene to what all are held to.
fn one(
    project: &Project,
    stress: &Stress,
    name: &str,
    pipelines: Vec<Pipeline>,
) -> Result<(), Failure> {
    let checked = SceneCheck {
        scene: project.scene(name, &[])?,
        pipelines,
        size: stress.random.size,
    };
    let gpu = Gpu::open(None)?;
    let wrong = checked.run(project, &gpu);
    for (pipeline, what) in &wrong {
        say(&format!("{pipeline}: {what}\n"))?;
    }
    let count = checked.pipelines.len();
    match wrong.len() {
        0 => say(&format!("{count} pictures, none fails\n")),
        failures => Err(Failure::Beyond(format!(
            "{failures} of {count} pictures fail"
        ))),
    }
}

fn told(failure: &SceneFailure) -> String {
    let SceneFailure {
        number,
        pipeline,
        what,
        ron,
        mesh,
        size: [width, height],
        ..
    } = failure;
    let mut text = format!("scene {number}, {pipeline}: {what}\n{ron}");
    if let Some((name, obj)) = mesh {
        text += &format!("// {name}:\n{obj}");
    }
    text + &format!(
        "to see it, write this to scene.ron and run\n  \
         meniscus stress {pipeline} --scene scene.ron --size {width}x{height}\n\n"
    )
}

/// Writes a scene that fails, with the meshes that it names.
fn keep(folder: &Path, index: usize, failure: &SceneFailure) -> Result<(), Failure> {
    let path = folder.join(format!("scene-{index}.ron"));
    write_atomically(&path, failure.ron.as_bytes())?;
    if let Some((name, text)) = &failure.mesh {
        write_atomically(&folder.join(name), text.as_bytes())?;
    }
    Ok(())
}

fn summary(found: &StressedScenes) -> String {
    let mut text = format!(
        "{} scenes, {} pictures: {} fail\n",
        found.scenes,
        found.pictures,
        found.failures.len()
    );
    let refused: u64 = found.refused.values().sum();
    text += &format!("refused in words: {refused}\n");
    for (why, times) in &found.refused {
        text += &format!("  {times} × {why}\n");
    }
    let distance = &found.distance;
    text + &format!(
        "held to the truth: {} pictures, {} pixels; {} of these more than half a pixel off, mean {:.4} pixels\n",
        found.judged, distance.pixels, distance.far, distance.mean_px
    )
}
