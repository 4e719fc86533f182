//! The directory that an ablation leaves behind.

use std::path::Path;

use meniscus_measure::heat::{LogScale, error_map};
use meniscus_measure::{
    FigurePoint, MeasureError, NpyData, Table, npy_bytes, time_error_figure, write_atomically,
    write_png,
};

use crate::ablation::Outcome;
use crate::picture::srgb;
use crate::report::report;

/// A pipeline's name as a part of a file's name.
fn file_name(pipeline: &str) -> String {
    let allowed = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.' | '=' | ',');
    pipeline
        .chars()
        .map(|c| if allowed(c) { c } else { '-' })
        .collect()
}

/// Writes pictures, error maps, the figure of time against error, tables, `report.html`, and what a stranger's
/// tracer needs to check them: `results.json`, `scene.json`, `truth.npy` (rows, columns, and x, y,
/// z in metres and the object id), `water.npy`, and per pipeline `NAME.png`, `NAME.error.png` and
/// `NAME.shown.npy`, `/` in names being written as `-`.
///
/// # Errors
/// When a file cannot be written.
pub fn write_directory(folder: &Path, outcome: &Outcome) -> Result<(), MeasureError> {
    std::fs::create_dir_all(folder).map_err(|source| MeasureError::File {
        path: folder.to_owned(),
        source,
    })?;
    let results = &outcome.results;
    let [width, height] = results.size;
    let shape = [height as usize, width as usize, 4];
    let scale = LogScale::PIXELS;
    for (row, figures) in outcome.rows.iter().zip(&results.rows) {
        let name = file_name(&figures.pipeline);
        let path = |ending: &str| folder.join(format!("{name}{ending}"));
        write_png(&path(".png"), results.size, &srgb(&row.colours))?;
        let map = error_map(&row.judgement.verdicts, &scale);
        write_png(&path(".error.png"), results.size, &map)?;
        let shown = npy_bytes(&shape, NpyData::F32(row.shown.as_flattened()))?;
        write_atomically(&path(".shown.npy"), &shown)?;
    }
    write_png(
        &folder.join("truth.png"),
        results.size,
        &srgb(&outcome.truth.colour),
    )?;
    let points = outcome.truth.point.iter().zip(&outcome.truth.object);
    let truth: Vec<f64> = points
        .flat_map(|(p, id)| [p[0], p[1], p[2], f64::from(*id)])
        .collect();
    write_atomically(
        &folder.join("truth.npy"),
        &npy_bytes(&shape, NpyData::F64(&truth))?,
    )?;
    for (name, mask) in [
        ("water.npy", &outcome.truth.water_first),
        ("undefined.npy", &outcome.truth.undefined),
        ("total.npy", &outcome.truth.total),
    ] {
        let bytes = npy_bytes(&shape[..2], NpyData::Bool(mask))?;
        write_atomically(&folder.join(name), &bytes)?;
    }
    let scene = serde_json::to_vec(&outcome.scene.export(&outcome.view)).map_err(|error| {
        MeasureError::Value {
            what: "scene.json".into(),
            problem: error.to_string(),
        }
    })?;
    write_atomically(&folder.join("scene.json"), &scene)?;
    write_atomically(&folder.join("results.json"), results.to_json()?.as_bytes())?;
    let table = Table::of(results);
    write_atomically(&folder.join("results.md"), table.markdown().as_bytes())?;
    write_atomically(&folder.join("results.csv"), table.csv()?.as_bytes())?;
    write_atomically(&folder.join("report.html"), report(outcome)?.as_bytes())?;
    if let Some(figure) = figure(outcome)? {
        write_atomically(&folder.join("time-error.svg"), figure.as_bytes())?;
    }
    Ok(())
}

/// Time against error, of the rows that have an error.
pub(crate) fn figure(outcome: &Outcome) -> Result<Option<String>, MeasureError> {
    let results = &outcome.results;
    let points: Vec<FigurePoint> = results
        .rows
        .iter()
        .filter_map(|row| {
            Some(FigurePoint {
                label: row.pipeline.clone(),
                ms: row.frame_ms.median,
                spread_ms: [row.frame_ms.low, row.frame_ms.high],
                error: row.error.as_ref()?.position_px.mean,
            })
        })
        .collect();
    if points.is_empty() {
        return Ok(None);
    }
    let [width, height] = results.size;
    let title = format!("{}, {width}×{height}", results.scene);
    time_error_figure(&title, "mean position error, pixels", &points).map(Some)
}
