//! Every figure as CSV, under the names of the results file.

use serde_json::Value;

use crate::results::{Row, Timer};
use crate::{BorderErrors, Errors, MeasureError, Summary};

/// Counters that a row may hold beside those of the contract.
const COUNTERS: [&str; 6] = [
    "dispatches",
    "compute_invocations",
    "texture_bytes",
    "buffer_bytes",
    "scene_bytes",
    "uploaded_bytes",
];

/// Picks one of the two summaries.
type Part = fn(&BorderErrors) -> &Summary;

/// Lines of names and values as CSV, under the names of the first.
pub(super) fn text(
    lines: impl Iterator<Item = Vec<(String, String)>>,
) -> Result<String, MeasureError> {
    let failed = |e: &dyn std::fmt::Display| MeasureError::format("CSV table", e);
    let mut writer = csv::Writer::from_writer(Vec::new());
    for (index, fields) in lines.enumerate() {
        if index == 0 {
            let names = fields.iter().map(|(name, _)| name);
            writer.write_record(names).map_err(|e| failed(&e))?;
        }
        let values = fields.iter().map(|(_, value)| value);
        writer.write_record(values).map_err(|e| failed(&e))?;
    }
    let bytes = writer.into_inner().map_err(|e| failed(&e))?;
    String::from_utf8(bytes).map_err(|e| failed(&e))
}

pub(super) fn fields(row: &Row) -> Vec<(String, String)> {
    let text = |x: Option<f64>| x.map_or(String::new(), |x| x.to_string());
    let count = |x: Option<u64>| x.map_or(String::new(), |x| x.to_string());
    let relative = row.relative.as_ref();
    let mut fields: Vec<(String, String)> = vec![
        ("pipeline".into(), row.pipeline.clone()),
        (
            "timer".into(),
            match row.timer {
                Timer::Gpu => "gpu".into(),
                Timer::Wall => "wall".into(),
            },
        ),
    ];
    let mut add = |name: &str, value: String| fields.push((name.to_owned(), value));
    add("frame_ms_median", row.frame_ms.median.to_string());
    add("frame_ms_low", row.frame_ms.low.to_string());
    add("frame_ms_high", row.frame_ms.high.to_string());
    add("frame_ms_min", row.frame_ms.min.to_string());
    add("frames", row.frame_ms.samples.len().to_string());
    add(
        "relative_to",
        relative.map_or(String::new(), |r| r.to.clone()),
    );
    add("relative_median", text(relative.map(|r| r.median)));
    add("relative_low", text(relative.map(|r| r.low)));
    add("relative_high", text(relative.map(|r| r.high)));
    add("relative_of_minima", text(relative.map(|r| r.of_minima)));
    add("triangles", count(row.counters.triangles));
    add("vertex_invocations", count(row.counters.vertex_invocations));
    add(
        "fragment_invocations",
        count(row.counters.fragment_invocations),
    );
    add("draws", count(row.counters.draws));
    for name in COUNTERS {
        let counted = row.counters.more.get(name).and_then(Value::as_u64);
        add(name, count(counted));
    }
    let preprocessing = row.more.get("preprocessing_ms").and_then(Value::as_f64);
    add("preprocessing_ms", text(preprocessing));
    let whole = row.error.as_ref().map(Errors::whole);
    let border = row.error.as_ref().and_then(|e| e.border.clone());
    for (prefix, errors) in [("", whole), ("border_", border)] {
        let summary = |part: Part, figure: fn(&Summary) -> f64| {
            text(errors.as_ref().map(|e| figure(part(e))))
        };
        let parts: [(&str, Part); 2] = [
            ("position_px", |e| &e.position_px),
            ("position_m", |e| &e.position_m),
        ];
        for (name, part) in parts {
            add(&format!("{prefix}{name}_mean"), summary(part, |s| s.mean));
            add(
                &format!("{prefix}{name}_median"),
                summary(part, |s| s.median),
            );
            add(&format!("{prefix}{name}_p95"), summary(part, |s| s.p95));
            add(&format!("{prefix}{name}_p99"), summary(part, |s| s.p99));
        }
        let single = |figure: fn(&BorderErrors) -> f64| text(errors.as_ref().map(figure));
        add(
            &format!("{prefix}within_half_px"),
            single(|e| e.within_half_px),
        );
        add(&format!("{prefix}wrong_object"), single(|e| e.wrong_object));
        add(&format!("{prefix}rmse"), single(|e| e.rmse));
        add(&format!("{prefix}psnr"), single(|e| e.psnr));
        let flip = errors.as_ref().and_then(|e| e.flip);
        add(&format!("{prefix}flip"), text(flip));
    }
    fields
}
