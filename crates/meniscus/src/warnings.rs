//! What rows were warned of when their times were taken, said once.

use meniscus_measure::{Results, Row};
use serde_json::Value;

fn warnings_of(row: &Row) -> impl Iterator<Item = &str> {
    let told = row.more.get("warnings").and_then(Value::as_array);
    told.into_iter().flatten().filter_map(Value::as_str)
}

/// The warnings of all rows, those that differ in their numbers alone as one: the first of its kind,
/// and the pipelines that it concerns.
pub fn gathered_warnings(results: &Results) -> Vec<String> {
    let mut kinds: Vec<(String, &str, Vec<&str>)> = Vec::new();
    for row in &results.rows {
        for warning in warnings_of(row) {
            let kind = warning.replace(|c: char| c.is_ascii_digit() || c == '.', "");
            match kinds.iter_mut().find(|known| known.0 == kind) {
                Some(known) => known.2.push(&row.pipeline),
                None => kinds.push((kind, warning, vec![&row.pipeline])),
            }
        }
    }
    let say = |(_, warning, names): (String, &str, Vec<&str>)| match names.as_slice() {
        [name, others @ ..] if !others.is_empty() => {
            let others = others.join(", ");
            format!("{name}: {warning}. The same of {others}")
        }
        names => format!("{}: {warning}", names.join(", ")),
    };
    kinds.into_iter().map(say).collect()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn row(pipeline: &str, warnings: &[&str]) -> Value {
        let none = json!(null);
        json!({
            "pipeline": pipeline, "timer": "gpu", "passes": [], "error": none, "warnings": warnings,
            "frame_ms": { "median": 1.0, "low": 1.0, "high": 1.0, "min": 1.0, "samples": [1.0] },
            "counters": { "triangles": none, "vertex_invocations": none,
                "fragment_invocations": none, "draws": none },
        })
    }

    #[test]
    fn warnings_that_differ_in_numbers_are_one_and_no_pipeline_is_lost() {
        let text = json!({
            "provenance": {}, "scene": "s", "settings": {}, "size": [1, 1], "truth": "flat",
            "water_pixels": 0, "undefined_pixels": 0,
            "rows": [
                row("one", &["only 5 frames", "spread by 30.5 %"]),
                row("two", &["only 5 frames"]),
                row("three", &["spread by 7 %"]),
                row("four", &[]),
            ],
        });
        let results = Results::from_json("test", &text.to_string()).unwrap();
        let said = gathered_warnings(&results);
        assert_eq!(said.len(), 2, "{said:?}");
        assert!(said[0].starts_with("one: only 5 frames") && said[0].ends_with("of two"));
        assert!(said[1].starts_with("one: spread by 30.5 %") && said[1].ends_with("of three"));
    }
}
