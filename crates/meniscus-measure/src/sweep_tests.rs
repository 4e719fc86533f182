use serde_json::json;

use super::*;

/// Results that tell each other apart by the scene's name.
fn results(scene: &str) -> Results {
    let text = json!({
        "provenance": {}, "scene": scene, "settings": {}, "size": [1, 1], "truth": "flat",
        "water_pixels": 0, "undefined_pixels": 0, "rows": [{
            "pipeline": "p", "timer": "gpu", "passes": [], "error": null,
            "frame_ms": { "median": 1.0, "low": 1.0, "high": 1.0, "min": 1.0, "samples": [1.0] },
            "counters": { "triangles": null, "vertex_invocations": null,
                "fragment_invocations": null, "draws": null },
        }],
    });
    Results::from_json("test", &text.to_string()).unwrap()
}

fn point(index: usize, of: usize, value: &str) -> SweepPoint {
    let swept = [("key".to_owned(), json!(value))].into_iter().collect();
    let hash = format!("hash of {value}");
    SweepPoint {
        index,
        of,
        swept,
        hash,
    }
}

/// Points of a sweep over `a`, `b`, `c`.
fn part(indices: &[usize]) -> Sweep {
    let mut sweep = Sweep::default();
    for index in indices {
        let value = ["a", "b", "c"][*index];
        sweep.put(&point(*index, 3, value), results(value)).unwrap();
    }
    sweep
}

#[test]
fn parts_merge_to_the_whole_in_any_order() {
    let whole = part(&[0, 1, 2]);
    for parts in [
        [&[2usize, 0][..], &[1]],
        [&[1], &[0, 2]],
        [&[0, 1, 2], &[1]],
    ] {
        let named = parts.map(|indices| (format!("{indices:?}"), part(indices)));
        assert_eq!(Sweep::merge(named).unwrap(), whole);
    }
}

#[test]
fn a_file_is_read_as_it_was_written() {
    let sweep = part(&[1, 2]);
    let text = sweep.to_json().unwrap();
    assert_eq!(Sweep::from_json("test", &text).unwrap(), sweep);
    assert_eq!(sweep.progress(), (2, 3));
    assert!(sweep.holds("hash of b") && !sweep.holds("hash of a"));
}

#[test]
fn parts_of_different_sweeps_do_not_merge() {
    for stranger in [point(0, 3, "z"), point(1, 3, "a"), point(2, 4, "c")] {
        let mut other = Sweep::default();
        other.put(&stranger, results("z")).unwrap();
        let parts = [("one".to_owned(), part(&[0])), ("two".to_owned(), other)];
        let said = Sweep::merge(parts).unwrap_err().to_string();
        assert!(said.contains("one") && said.contains("two"), "{said}");
    }
}

#[test]
fn a_point_measured_anew_replaces_the_old_one() {
    let mut sweep = part(&[0, 1]);
    let again = SweepPoint {
        hash: "new".into(),
        ..point(1, 3, "b")
    };
    sweep.put(&again, results("newer")).unwrap();
    assert_eq!(sweep.points().len(), 2);
    assert!(sweep.holds("new") && !sweep.holds("hash of b"));
}

#[test]
fn what_is_no_sweep_is_refused_with_its_place() {
    let said = Sweep::from_json("f.json", "{\n\"points\": 3}").unwrap_err();
    assert!(said.to_string().contains("f.json:2:"), "{said}");
    let plain = format!("{{\"points\": [{}]}}", results("s").to_json().unwrap());
    assert!(Sweep::from_json("f.json", &plain).is_err());
}

#[test]
fn the_csv_has_the_swept_keys_as_columns() {
    let csv = part(&[0, 2]).csv().unwrap();
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines.len(), 3);
    assert!(lines[0].starts_with("key,pipeline,"), "{csv}");
    assert!(lines[2].starts_with("c,p,"), "{csv}");
}
