//! What each filling of a pipeline brings and costs: the same pipeline without it.

use meniscus_measure::Results;
use meniscus_pipeline::Pipeline;
use serde_json::{Value, json};

/// A pipeline of which one slot went back to its default.
#[derive(Debug, Clone)]
pub struct Without {
    /// The whole pipeline's name.
    pub of: String,
    /// The slot, as `PASS.SLOT`.
    pub slot: String,
    /// The module that filled it.
    pub filling: String,
    /// What is left.
    pub pipeline: Pipeline,
}

/// A pipeline with each of its filled slots put back to the default, in order of passes.
pub fn leave_one_out(pipeline: &Pipeline) -> Vec<Without> {
    let mut found = Vec::new();
    for (index, pass) in pipeline.passes.iter().enumerate() {
        for (slot, filling) in &pass.slots {
            let slot_of = format!("{}.{slot}", pass.name.value);
            let mut left = pipeline.clone();
            left.passes[index].slots.remove(slot);
            left.baseline = false;
            left.name = format!("{} without {slot_of}", pipeline.name);
            found.push(Without {
                of: pipeline.name.clone(),
                slot: slot_of,
                filling: filling.module.value.clone(),
                pipeline: left,
            });
        }
    }
    found
}

/// Headings of [`table`].
pub const HEADINGS: [&str; 7] = [
    "slot",
    "filling",
    "of",
    "adds ms",
    "times",
    "adds px mean",
    "adds RMSE",
];

/// Writes into the rows of pipelines without a filling what that filling brings: `leave_one_out`
/// with the slot, the filling, and the whole pipeline's median time and mean error less its own.
pub(crate) fn note(results: &mut Results, without: &[Without]) {
    for left in without {
        let Some(whole) = results.rows.iter().find(|row| row.pipeline == left.of) else {
            continue;
        };
        let (ms, px) = (whole.frame_ms.clone(), whole.error.clone());
        let name = &left.pipeline.name;
        let Some(row) = results.rows.iter_mut().find(|row| row.pipeline == *name) else {
            continue;
        };
        let mut ratios: Vec<f64> = Vec::new();
        for (with, without) in ms.samples.iter().zip(&row.frame_ms.samples) {
            ratios.push(with / without);
        }
        let mut note = json!({
            "of": left.of,
            "slot": left.slot,
            "filling": left.filling,
            "adds_ms": ms.median - row.frame_ms.median,
            "times": meniscus_measure::median(&ratios),
        });
        if let (Some(with), Some(without)) = (&px, &row.error) {
            note["adds_px_mean"] = json!(with.position_px.mean - without.position_px.mean);
            note["adds_rmse"] = json!(with.rmse - without.rmse);
        }
        row.more.insert("leave_one_out".into(), note);
    }
}

/// The rows that say what a filling brings, for people; none where nothing was left out.
pub fn table(results: &Results) -> Vec<Vec<String>> {
    let notes = results
        .rows
        .iter()
        .filter_map(|row| row.more.get("leave_one_out"));
    let text = |note: &Value, key: &str| note[key].as_str().unwrap_or_default().to_owned();
    let number = |note: &Value, key: &str, signed: bool| match note[key].as_f64() {
        Some(number) if signed => format!("{number:+.3}"),
        Some(number) => format!("{number:.2}"),
        None => "–".to_owned(),
    };
    let line = |note: &Value| {
        vec![
            text(note, "slot"),
            text(note, "filling"),
            text(note, "of"),
            number(note, "adds_ms", true),
            number(note, "times", false),
            number(note, "adds_px_mean", true),
            number(note, "adds_rmse", true),
        ]
    };
    notes.map(line).collect()
}
