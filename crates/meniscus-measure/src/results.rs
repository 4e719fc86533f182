//! The results file of an ablation: a contract with whoever reads it.
//!
//! Keys and their nesting do not change; new keys may be added beside them. A reader ignores keys it
//! does not know, and this one keeps those it does not know ([`Results::more`], [`Row::more`]), so that
//! a file survives being read and written by an older program.
//!
//! Every number is finite. Writing a NaN or an infinity is an error, never a silent `null`. Where
//! `null` may stand, its meaning is documented at the field. Equal pictures have a `psnr` of
//! [`MAX_PSNR_DB`](crate::MAX_PSNR_DB).

use serde::{Deserialize, Serialize, Serializer};
use serde_json::{Map, Value};

use crate::{Errors, MeasureError};

/// What one ablation found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Results {
    /// Where the figures come from: adapter, driver, commit, hashes of the composed shaders, …
    pub provenance: Map<String, Value>,
    /// Name of the scene.
    pub scene: String,
    /// Settings of the scene and the pipelines that were set, by their full names.
    pub settings: Map<String, Value>,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The water's geometry in the truth.
    pub truth: TruthGeometry,
    /// Pixels whose true ray meets water first, the undefined ones included.
    pub water_pixels: u64,
    /// Water pixels without a physical answer; they are left out of every row's errors.
    pub undefined_pixels: u64,
    /// One row per pipeline.
    pub rows: Vec<Row>,
    /// Keys that this version does not know.
    #[serde(flatten)]
    pub more: Map<String, Value>,
}

/// The water's geometry that the true picture was traced with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TruthGeometry {
    /// A plane with the normals of the waves.
    Flat,
    /// The waves themselves.
    Displaced,
}

/// What was found of one pipeline.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The pipeline's name, with what was put in its place by a trial of fillings.
    pub pipeline: String,
    /// What measured the times.
    pub timer: Timer,
    /// Time of a frame in milliseconds.
    pub frame_ms: FrameMs,
    /// Frame time relative to the baseline of the same run; left out where there is no baseline.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relative: Option<Relative>,
    /// Median time of each pass in milliseconds, in the order they run.
    pub passes: Vec<PassMs>,
    /// What one frame draws.
    pub counters: Counters,
    /// The errors against the truth; `null` where no water is seen, so that there is none to judge.
    /// Where several moments ran, the mean of each figure over them ([`Errors::mean`]).
    pub error: Option<Errors>,
    /// Keys that this version does not know.
    #[serde(flatten)]
    pub more: Map<String, Value>,
}

/// What measured the times of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Timer {
    /// Timestamps of the device.
    Gpu,
    /// The clock of the host, from submission to completion.
    Wall,
}

/// The time of a frame, in milliseconds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FrameMs {
    /// Half of the frames take at most this.
    #[serde(serialize_with = "finite")]
    pub median: f64,
    /// 10th percentile: the low end of the spread.
    #[serde(serialize_with = "finite")]
    pub low: f64,
    /// 90th percentile: the high end of the spread.
    #[serde(serialize_with = "finite")]
    pub high: f64,
    /// The fastest frame.
    #[serde(serialize_with = "finite")]
    pub min: f64,
    /// Every frame, in the order of the rounds: the n-th sample of each row is from the same round.
    #[serde(serialize_with = "all_finite")]
    pub samples: Vec<f64>,
}

/// Frame time as a multiple of the baseline's, measured frame by frame in the same run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Relative {
    /// The baseline's name.
    pub to: String,
    /// Median of the ratios of the rounds.
    #[serde(serialize_with = "finite")]
    pub median: f64,
    /// Low end of the 95 % confidence interval of that median.
    #[serde(serialize_with = "finite")]
    pub low: f64,
    /// High end of the 95 % confidence interval of that median.
    #[serde(serialize_with = "finite")]
    pub high: f64,
    /// Ratio of the fastest frames: what a loaded machine disturbs least.
    #[serde(serialize_with = "finite")]
    pub of_minima: f64,
}

/// The time of one pass.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PassMs {
    /// The pass's name in the pipeline.
    pub name: String,
    /// Median over the frames, in milliseconds.
    #[serde(serialize_with = "finite")]
    pub ms: f64,
}

/// What one frame draws. `null` means that the adapter cannot count it.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Triangles handed to the rasteriser.
    pub triangles: Option<u64>,
    /// Invocations of vertex shaders.
    pub vertex_invocations: Option<u64>,
    /// Invocations of fragment shaders.
    pub fragment_invocations: Option<u64>,
    /// Draw calls.
    pub draws: Option<u64>,
    /// Counters of modules and later versions (rays traced, bytes allocated, …) by name.
    #[serde(flatten)]
    pub more: Map<String, Value>,
}

impl Results {
    /// The results as JSON, indented, ending in a line feed.
    ///
    /// # Errors
    /// [`MeasureError::Value`] when a number is NaN or infinite; it names the row.
    pub fn to_json(&self) -> Result<String, MeasureError> {
        for row in &self.rows {
            // The whole would fail as well, but could not say where.
            serde_json::to_value(row).map_err(|e| {
                MeasureError::value(format!("results of {}", row.pipeline), e.to_string())
            })?;
        }
        let mut text = serde_json::to_string_pretty(self)
            .map_err(|e| MeasureError::value("results", e.to_string()))?;
        text.push('\n');
        Ok(text)
    }

    /// Reads results; `name` says in errors where `text` comes from.
    ///
    /// # Errors
    /// [`MeasureError::Format`] with line and column when the text is not what the contract says.
    pub fn from_json(name: &str, text: &str) -> Result<Self, MeasureError> {
        serde_json::from_str(text).map_err(|e| {
            let place = format!("{name}:{}:{}", e.line(), e.column());
            MeasureError::format(place, format!("not the results of an ablation: {e}"))
        })
    }
}

/// Serialises a number that has to be finite, because JSON would turn any other into `null`.
pub(crate) fn finite<S: Serializer>(number: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    if number.is_finite() {
        serializer.serialize_f64(*number)
    } else {
        Err(serde::ser::Error::custom(format!(
            "a number is {number}, where only finite ones can be written"
        )))
    }
}

/// The same of a number that may be missing.
pub(crate) fn finite_or_none<S: Serializer>(
    number: &Option<f64>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    match number {
        Some(number) => finite(number, serializer),
        None => serializer.serialize_none(),
    }
}

fn all_finite<S: Serializer>(numbers: &[f64], serializer: S) -> Result<S::Ok, S::Error> {
    match numbers.iter().find(|n| !n.is_finite()) {
        None => numbers.serialize(serializer),
        Some(number) => finite(number, serializer),
    }
}

#[cfg(test)]
#[path = "results_tests.rs"]
pub(crate) mod tests;
