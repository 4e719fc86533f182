//! Where figures come from.

use meniscus_gpu::Gpu;
use meniscus_pipeline::Pruning;
use serde_json::{Map, Value, json};

/// Adapter, driver, version, commit and what was left out, as they stand in results.
pub(crate) fn provenance(gpu: &Gpu, pruning: Pruning) -> Map<String, Value> {
    let facts = gpu.facts();
    let entries = [
        ("adapter", facts.name.clone()),
        (
            "driver",
            format!("{} {}", facts.driver, facts.driver_info)
                .trim()
                .to_owned(),
        ),
        ("backend", facts.backend.clone()),
        ("device_type", facts.device_type.clone()),
        ("meniscus", env!("CARGO_PKG_VERSION").to_owned()),
        ("commit", crate::COMMIT.to_owned()),
        ("left_out", left_out(pruning).to_owned()),
    ];
    entries
        .into_iter()
        .map(|(key, value)| (key.to_owned(), json!(value)))
        .collect()
}

/// What may have been left out, in a word that does not change.
fn left_out(pruning: Pruning) -> &'static str {
    match pruning {
        Pruning::None => "nothing",
        Pruning::Exact => "exact",
        Pruning::Approximate => "within_px",
    }
}
