//! Experiments by name: which pipelines run, what is swept, and what others have published of it.

use std::sync::Arc;

use meniscus_source::ron::{Entries, Spanned, from_source};
use meniscus_source::{Report, SourceFile};
use serde::Deserialize;

/// An experiment, as its file says.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Preset {
    /// One line about it.
    pub about: String,
    /// The scene's name.
    pub scene: String,
    /// Settings of the scene.
    #[serde(default)]
    pub set: Entries<String>,
    /// The pipelines' names.
    pub pipelines: Vec<Spanned<String>>,
    /// What is swept.
    #[serde(default)]
    pub sweep: Vec<PresetAxis>,
    /// What others found.
    #[serde(default)]
    pub published: Option<Published>,
}

/// A swept setting of a preset.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PresetAxis {
    /// The setting.
    pub key: Spanned<String>,
    /// Its values, as on the command line.
    pub values: Vec<String>,
}

/// Frame rates that somebody published of the same experiment.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Published {
    /// Who, where and when.
    pub source: String,
    /// The pipeline that their times are relative to.
    pub relative_to: String,
    /// What they found.
    pub figures: Vec<Figures>,
}

/// Published frame rates at one point.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Figures {
    /// The swept settings that must have these values.
    pub at: Entries<String>,
    /// Frames per second by pipeline.
    pub frames_per_second: Entries<f64>,
}

impl Preset {
    /// Reads a preset.
    ///
    /// # Errors
    /// Where the file is wrong.
    pub fn read(file: &Arc<SourceFile>) -> Result<Self, Report> {
        let preset: Self = from_source(file)?;
        preset.check()
    }

    fn check(self) -> Result<Self, Report> {
        let mut report = Report::default();
        for figures in self
            .published
            .iter()
            .flat_map(|published| &published.figures)
        {
            for (name, rate) in figures.frames_per_second.iter() {
                if !(rate.is_finite() && *rate > 0.0) {
                    let wrong = meniscus_source::Diagnostic::error(format!(
                        "{rate} frames per second of `{}` is no rate",
                        name.value
                    ));
                    report.add(match &name.place {
                        Some(place) => wrong.at(place, "a positive number is wanted"),
                        None => wrong,
                    });
                }
            }
        }
        report.into_result(self)
    }
}

impl Published {
    /// The figures at a point of the sweep.
    pub fn at(&self, swept: &[(String, String)]) -> Option<&Figures> {
        self.figures.iter().find(|figures| {
            figures
                .at
                .iter()
                .all(|(key, value)| swept.iter().any(|(k, v)| *k == key.value && v == value))
        })
    }
}

impl Figures {
    /// Time of a frame of a pipeline as a multiple of that of another one.
    pub fn relative(&self, pipeline: &str, to: &str) -> Option<f64> {
        Some(self.frames_per_second.get(to)? / self.frames_per_second.get(pipeline)?)
    }
}
