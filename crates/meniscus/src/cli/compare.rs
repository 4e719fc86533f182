//! `meniscus compare`

use std::path::PathBuf;

use clap::Args;
use meniscus::measure::{Better, Image, METRICS, MeasureError, Metric, metric, write_png};

use super::Failure;
use super::say::say;

#[derive(Debug, Args)]
pub(crate) struct Compare {
    /// The picture that is right.
    pub reference: PathBuf,
    /// The picture that is judged.
    pub test: PathBuf,
    /// The measure, of those listed below.
    #[arg(long, value_name = "NAME", default_value = "flip")]
    pub metric: String,
    /// Write the error of each pixel as a picture in false colours.
    #[arg(long, value_name = "FILE.png")]
    pub map: Option<PathBuf>,
    /// The worst value that is good enough.
    #[arg(long, value_name = "VALUE", allow_negative_numbers = true)]
    pub limit: Option<f64>,
}

pub(crate) fn run(compare: &Compare) -> Result<(), Failure> {
    if let Some(limit) = compare.limit
        && !limit.is_finite()
    {
        return Err(Failure::Written(format!(
            "error: `--limit {limit}` is no limit; give a finite number"
        )));
    }
    let metric = metric(&compare.metric).map_err(wrong)?;
    let reference = Image::read(&compare.reference).map_err(wrong)?;
    let test = Image::read(&compare.test).map_err(wrong)?;
    let difference = metric.compare(&reference, &test).map_err(wrong)?;
    if let Some(path) = &compare.map {
        write_png(path, reference.size(), &difference.picture()).map_err(wrong)?;
    }
    say(&format!("{}\n", figure(metric, difference.value)))?;
    match compare.limit {
        Some(limit) if !metric.holds(difference.value, limit) => {
            let side = match metric.better {
                Better::Lower => "above",
                Better::Higher => "below",
            };
            Err(Failure::Beyond(format!(
                "{} is {side} the limit {limit}",
                figure(metric, difference.value)
            )))
        }
        _ => Ok(()),
    }
}

/// What is wrong with the files or the names, as something that was written: 1 is kept for pictures
/// that differ.
fn wrong(error: MeasureError) -> Failure {
    Failure::Written(format!("error: {error}"))
}

fn figure(metric: &Metric, value: f64) -> String {
    let unit = match metric.unit {
        "" => String::new(),
        unit => format!(" {unit}"),
    };
    format!("{} {value:.6}{unit}", metric.name)
}

/// The measures there are, for the help.
pub(crate) fn measures() -> String {
    let lines = METRICS.iter().map(|m| {
        let good = match m.better {
            Better::Lower => "small is good",
            Better::Higher => "large is good",
        };
        format!("  {:9} {}; {good}\n", m.name, m.about)
    });
    format!("Measures:\n{}", lines.collect::<String>())
}
