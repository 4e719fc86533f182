//! The columns of the tables.

use serde_json::Value;

use super::digits::{bytes, count, digits, percent};
use crate::Summary;
use crate::results::{Row, Timer};

/// One column: how people read it.
pub(super) struct Column {
    pub heading: &'static str,
    pub show: fn(&Row) -> String,
}

/// What stands where there is no figure.
const NONE: &str = "–";

/// Time and error.
pub(super) const COLUMNS: &[Column] = &[
    Column {
        heading: "pipeline",
        show: |r| r.pipeline.clone(),
    },
    Column {
        heading: "ms",
        show: |r| milliseconds(r, r.frame_ms.median),
    },
    Column {
        heading: "10–90 %",
        show: |r| format!("{}–{}", digits(r.frame_ms.low), digits(r.frame_ms.high)),
    },
    Column {
        heading: "fastest",
        show: |r| digits(r.frame_ms.min),
    },
    Column {
        heading: "relative",
        show: |r| match &r.relative {
            Some(x) => format!("{:.2} [{:.2}, {:.2}]", x.median, x.low, x.high),
            None => NONE.into(),
        },
    },
    Column {
        heading: "px mean",
        show: |r| position(r, |s| s.mean),
    },
    Column {
        heading: "px median",
        show: |r| position(r, |s| s.median),
    },
    Column {
        heading: "px p95",
        show: |r| position(r, |s| s.p95),
    },
    Column {
        heading: "px p99",
        show: |r| position(r, |s| s.p99),
    },
    Column {
        heading: "≤ ½ px",
        show: |r| figure(r, |e| percent(e.within_half_px)),
    },
    Column {
        heading: "wrong",
        show: |r| figure(r, |e| percent(e.wrong_object)),
    },
    Column {
        heading: "m mean",
        show: |r| figure(r, |e| digits(e.position_m.mean)),
    },
    Column {
        heading: "RMSE",
        show: |r| figure(r, |e| digits(e.rmse)),
    },
    Column {
        heading: "dB",
        show: |r| figure(r, |e| format!("{:.1}", e.psnr)),
    },
    Column {
        heading: "FLIP",
        show: |r| match r.error.as_ref().and_then(|e| e.flip) {
            Some(flip) => digits(flip),
            None => NONE.into(),
        },
    },
    Column {
        heading: "border px",
        show: |r| match r.error.as_ref().and_then(|e| e.border.as_ref()) {
            Some(b) => digits(b.position_px.mean),
            None => NONE.into(),
        },
    },
];

/// What a frame takes beside time.
pub(super) const COSTS: &[Column] = &[
    Column {
        heading: "pipeline",
        show: |r| r.pipeline.clone(),
    },
    Column {
        heading: "passes",
        show: |r| match r.counters.more.get("passes").and_then(Value::as_array) {
            Some(passes) => passes.len().to_string(),
            None => NONE.into(),
        },
    },
    Column {
        heading: "draws",
        show: |r| counted(r.counters.draws),
    },
    Column {
        heading: "dispatches",
        show: |r| counted(other(r, "dispatches")),
    },
    Column {
        heading: "triangles",
        show: |r| counted(r.counters.triangles),
    },
    Column {
        heading: "vertices",
        show: |r| counted(r.counters.vertex_invocations),
    },
    Column {
        heading: "fragments",
        show: |r| counted(r.counters.fragment_invocations),
    },
    Column {
        heading: "threads",
        show: |r| counted(other(r, "compute_invocations")),
    },
    Column {
        heading: "textures",
        show: |r| size(other(r, "texture_bytes")),
    },
    Column {
        heading: "buffers",
        show: |r| size(other(r, "buffer_bytes")),
    },
    Column {
        heading: "scene",
        show: |r| size(other(r, "scene_bytes")),
    },
    Column {
        heading: "upload/frame",
        show: |r| size(other(r, "uploaded_bytes")),
    },
    Column {
        heading: "update in ms",
        show: |r| match r.more.get("update").and_then(|u| u["ms"].as_f64()) {
            Some(ms) => digits(ms),
            None => NONE.into(),
        },
    },
    Column {
        heading: "prepared in ms",
        show: |r| match r.more.get("preprocessing_ms").and_then(Value::as_f64) {
            Some(ms) => digits(ms),
            None => NONE.into(),
        },
    },
];

/// What the columns of [`COSTS`] mean.
pub(super) const COSTS_NOTES: &str = "Of one frame. Vertices, fragments and threads: shader \
    invocations. Textures and buffers: the pipeline's own; scene: what it reads of the scene. \
    Upload: when water and objects have moved. Update: what following moving objects takes \
    on the CPU, uploads included. Prepared: before the first frame, for what it reads.";

fn other(row: &Row, counter: &str) -> Option<u64> {
    row.counters.more.get(counter).and_then(Value::as_u64)
}

fn counted(number: Option<u64>) -> String {
    number.map_or(NONE.into(), count)
}

fn size(number: Option<u64>) -> String {
    number.map_or(NONE.into(), |number| bytes(number as f64))
}

fn milliseconds(row: &Row, ms: f64) -> String {
    let mark = match row.timer {
        Timer::Gpu => "",
        Timer::Wall => " w",
    };
    format!("{}{mark}", digits(ms))
}

fn figure(row: &Row, show: impl Fn(&crate::Errors) -> String) -> String {
    row.error.as_ref().map_or(NONE.into(), show)
}

fn position(row: &Row, which: impl Fn(&Summary) -> f64) -> String {
    figure(row, |e| digits(which(&e.position_px)))
}
