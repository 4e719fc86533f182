use super::*;

const CONTRACT: &str = r#"{
    "provenance": {"adapter": "software", "commit": "0123abc"},
    "scene": "pool",
    "settings": {"water.rms_slope": 0.05},
    "size": [640, 360],
    "truth": "displaced",
    "water_pixels": 1000,
    "undefined_pixels": 3,
    "rows": [{
        "pipeline": "refraction/broad",
        "timer": "gpu",
        "frame_ms": {"median": 2.0, "low": 1.5, "high": 3.0, "min": 1.0, "samples": [1.0, 2.0, 3.0]},
        "passes": [{"name": "near", "ms": 0.5}],
        "counters": {"triangles": 16000, "vertex_invocations": 48000, "fragment_invocations": 230400, "draws": 4},
        "error": {
            "position_px": {"mean": 1.0, "median": 0.5, "p95": 2.0, "p99": 3.0},
            "position_m": {"mean": 0.1, "median": 0.05, "p95": 0.2, "p99": 0.3},
            "within_half_px": 0.5, "wrong_object": 0.01, "rmse": 0.1, "psnr": 20.0,
            "border": {
                "position_px": {"mean": 1.0, "median": 0.5, "p95": 2.0, "p99": 3.0},
                "position_m": {"mean": 0.1, "median": 0.05, "p95": 0.2, "p99": 0.3},
                "within_half_px": 0.5, "wrong_object": 0.01, "rmse": 0.1, "psnr": 20.0
            }
        }
    }]
}"#;

/// Results with every key of the contract.
pub(crate) fn example() -> Results {
    Results::from_json("contract.json", CONTRACT).unwrap()
}

#[test]
fn what_is_written_has_the_keys_of_the_contract_and_no_others() {
    let written: Value = serde_json::from_str(&example().to_json().unwrap()).unwrap();
    let contract: Value = serde_json::from_str(CONTRACT).unwrap();
    assert_eq!(written, contract);
}

#[test]
fn results_survive_being_written_and_read() {
    let mut results = example();
    results.rows[0].relative = Some(Relative {
        to: "refraction/none".into(),
        median: 1.25,
        low: 1.2,
        high: 1.3,
        of_minima: 1.1,
    });
    results.rows[0].error.as_mut().unwrap().border = None;
    results.rows[0].counters.vertex_invocations = None;
    let text = results.to_json().unwrap();
    assert_eq!(Results::from_json("again", &text).unwrap(), results);
}

#[test]
fn keys_of_a_later_version_are_kept() {
    let mut later: Value = serde_json::from_str(CONTRACT).unwrap();
    later["weather"] = Value::from("fine");
    later["rows"][0]["residual"] = Value::from(0.25);
    later["rows"][0]["counters"]["rays_traced"] = Value::from(12);
    let read = Results::from_json("later", &later.to_string()).unwrap();
    let written: Value = serde_json::from_str(&read.to_json().unwrap()).unwrap();
    assert_eq!(written, later);
}

#[test]
fn no_number_turns_into_null_silently() {
    type Spoil = fn(&mut Row, f64);
    let spoilers: [Spoil; 8] = [
        |r, x| r.frame_ms.median = x,
        |r, x| r.frame_ms.samples[1] = x,
        |r, x| r.passes[0].ms = x,
        |r, x| r.error.as_mut().unwrap().position_px.p99 = x,
        |r, x| r.error.as_mut().unwrap().position_m.mean = x,
        |r, x| r.error.as_mut().unwrap().psnr = x,
        |r, x| r.error.as_mut().unwrap().wrong_object = x,
        |r, x| r.error.as_mut().unwrap().border.as_mut().unwrap().rmse = x,
    ];
    for spoil in spoilers {
        for broken in [f64::NAN, f64::INFINITY] {
            let mut results = example();
            spoil(&mut results.rows[0], broken);
            let said = results.to_json().unwrap_err().to_string();
            assert!(said.contains("refraction/broad"), "{said}");
        }
    }
}

#[test]
fn a_broken_file_is_told_with_its_place() {
    let said = Results::from_json("out.json", "{\n  \"scene\": 7}").unwrap_err();
    assert!(said.to_string().starts_with("out.json:2:"), "{said}");
    let missing = CONTRACT.replace("\"timer\": \"gpu\",", "");
    let said = Results::from_json("out.json", &missing)
        .unwrap_err()
        .to_string();
    assert!(said.contains("timer"), "{said}");
}
