use super::*;
use crate::results::{Relative, tests::example};
use serde_json::json;

fn two_rows() -> Results {
    let mut results = example();
    let mut second = results.rows[0].clone();
    second.pipeline = "a|b, \"c\"".into();
    second.timer = Timer::Wall;
    second.error = None;
    second.relative = Some(Relative {
        to: "refraction/none".into(),
        median: 1.25,
        low: 1.2,
        high: 1.3,
        of_minima: 1.1,
    });
    results.rows.push(second);
    results
}

#[test]
fn the_terminal_table_is_as_wide_everywhere_and_explains_its_marks() {
    let text = Table::of(&two_rows()).terminal();
    let lines: Vec<&str> = text.lines().collect();
    // Three rules, the heading and two rows; the notes follow.
    let table = &lines[..lines.len() - 1];
    assert_eq!(table.len(), 6);
    let widest = table.iter().map(|l| l.trim_end().chars().count()).max();
    let rule = Some(table[0].chars().count());
    assert!(widest == rule, "{text}");
    assert!(lines.iter().any(|l| l.contains("1.25 [1.20, 1.30]")));
    assert!(lines.iter().any(|l| l.contains("refraction/broad")));
    assert!(text.contains("wall time") && text.contains("refraction/none"));
}

#[test]
fn a_pipe_in_a_name_breaks_no_markdown_row() {
    let results = two_rows();
    let text = Table::of(&results).markdown();
    let bars = |line: &str| line.replace("\\|", "").matches('|').count();
    let rows: Vec<&str> = text.lines().take_while(|l| l.starts_with('|')).collect();
    assert_eq!(rows.len(), 4);
    assert!(rows.iter().all(|row| bars(row) == COLUMNS.len() + 1));
}

#[test]
fn csv_holds_the_figures_unrounded_and_empty_fields_where_there_is_none() {
    let mut results = two_rows();
    results.rows[0].frame_ms.median = 1.0 / 3.0;
    let text = Table::of(&results).csv().unwrap();
    let mut reader = ::csv::Reader::from_reader(text.as_bytes());
    let names: Vec<String> = reader
        .headers()
        .unwrap()
        .iter()
        .map(str::to_owned)
        .collect();
    let rows: Vec<::csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let field = |row: usize, name: &str| {
        let column = names.iter().position(|n| n == name).unwrap();
        rows[row][column].to_owned()
    };
    assert_eq!(field(0, "frame_ms_median").parse(), Ok(1.0 / 3.0));
    assert_eq!(field(0, "border_position_px_p99").parse(), Ok(3.0));
    assert_eq!(field(0, "relative_median"), "");
    assert_eq!(field(1, "pipeline"), "a|b, \"c\"");
    assert_eq!(field(1, "position_px_mean"), "");
    let distinct: std::collections::BTreeSet<&String> = names.iter().collect();
    assert_eq!(distinct.len(), names.len());
}

#[test]
fn costs_show_what_is_known_and_leave_out_nothing() {
    let mut results = two_rows();
    let more = &mut results.rows[0].counters.more;
    more.insert("passes".into(), json!([{ "name": "a" }, { "name": "b" }]));
    more.insert("texture_bytes".into(), json!(3 << 20));
    results.rows[0]
        .more
        .insert("preprocessing_ms".into(), json!(12.5));
    let update = json!({ "objects": 2, "bytes": 960, "ms": 0.75, "tree_ms": 0.5 });
    results.rows[0].more.insert("update".into(), update);
    let table = Table::of_costs(&results);
    let cells = table.cells();
    let cell = |row: usize, heading: &str| {
        let column = table.headings().iter().position(|h| *h == heading);
        cells[row][column.unwrap()].as_str()
    };
    assert_eq!(cell(0, "passes"), "2");
    assert_eq!(cell(0, "textures"), "3.00 MiB");
    assert_eq!(cell(0, "prepared in ms"), "12.5");
    assert_eq!(cell(0, "update in ms"), "0.750");
    assert_eq!(cell(1, "update in ms"), "–");
    assert_eq!(cell(1, "textures"), "–");
    assert_eq!(cell(1, "triangles"), "16\u{202f}000");
}
