//! Where figures come from.

use meniscus_gpu::Gpu;
use serde_json::{Map, Value, json};

/// Adapter, driver, version and commit, as they stand in results.
pub(crate) fn provenance(gpu: &Gpu) -> Map<String, Value> {
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
    ];
    entries
        .into_iter()
        .map(|(key, value)| (key.to_owned(), json!(value)))
        .collect()
}
