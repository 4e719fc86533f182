//! Results as a table: for the terminal, as Markdown, as CSV.

use comfy_table::{CellAlignment, LineStyle, presets};

use crate::results::{BorderErrors, Results, Row, Timer};
use crate::{MeasureError, Summary};

/// One column: how people read it, and how programs do.
struct Column {
    heading: &'static str,
    show: fn(&Row) -> String,
}

/// The table that an ablation prints, one row per pipeline.
///
/// Terminal and Markdown show what decides between pipelines, rounded; CSV holds every figure
/// unrounded under the names of the results file.
pub struct Table<'a> {
    results: &'a Results,
}

/// What stands where there is no figure.
const NONE: &str = "–";

const COLUMNS: &[Column] = &[
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
        heading: "border px",
        show: |r| match r.error.as_ref().and_then(|e| e.border.as_ref()) {
            Some(b) => digits(b.position_px.mean),
            None => NONE.into(),
        },
    },
];

impl<'a> Table<'a> {
    /// The table of `results`.
    pub fn of(results: &'a Results) -> Self {
        Self { results }
    }

    /// Aligned columns for a terminal, ending in a line feed.
    pub fn terminal(&self) -> String {
        let mut table = comfy_table::Table::new();
        table.load_style(presets::UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none()));
        table.set_header(COLUMNS.iter().map(|c| c.heading));
        table.add_rows(self.cells());
        for column in table.column_iter_mut().skip(1) {
            column.set_cell_alignment(CellAlignment::Right);
        }
        format!("{}\n{}\n", table.trim_fmt(), self.notes())
    }

    /// A Markdown table with what it was measured on beneath, ending in a line feed.
    pub fn markdown(&self) -> String {
        let line = |cells: Vec<String>| {
            let cells: Vec<String> = cells.iter().map(|c| c.replace('|', "\\|")).collect();
            format!("| {} |\n", cells.join(" | "))
        };
        let mut text = line(COLUMNS.iter().map(|c| c.heading.to_owned()).collect());
        text.push_str("|---|");
        text.push_str(&"---:|".repeat(COLUMNS.len() - 1));
        text.push('\n');
        for cells in self.cells() {
            text.push_str(&line(cells));
        }
        text.push('\n');
        text.push_str(&self.notes());
        text.push('\n');
        text
    }

    /// Every figure of every row, a header line first; an empty field where there is none.
    ///
    /// # Errors
    /// [`MeasureError::Format`] when the text cannot be made.
    pub fn csv(&self) -> Result<String, MeasureError> {
        csv_text(self.results.rows.iter().map(csv_fields))
    }

    /// The same figures of several runs beneath each other, each line led by what its run was made
    /// with: names and values, the same names in every run.
    ///
    /// # Errors
    /// As [`Table::csv`].
    pub fn csv_of_many<'r>(
        runs: impl IntoIterator<Item = (&'r [(String, String)], &'r Results)>,
    ) -> Result<String, MeasureError> {
        let lines = runs.into_iter().flat_map(|(leading, results)| {
            let line = |row| leading.iter().cloned().chain(csv_fields(row)).collect();
            results.rows.iter().map(line)
        });
        csv_text(lines)
    }

    /// What stands above the columns for people.
    pub fn headings(&self) -> Vec<&'static str> {
        COLUMNS.iter().map(|column| column.heading).collect()
    }

    /// The columns for people, rounded, a line for each row of the results.
    pub fn cells(&self) -> Vec<Vec<String>> {
        self.results
            .rows
            .iter()
            .map(|row| COLUMNS.iter().map(|c| (c.show)(row)).collect())
            .collect()
    }

    /// What was measured on, and what the figures mean, in one line.
    pub fn notes(&self) -> String {
        let r = self.results;
        let mut notes = format!(
            "{}, {}×{}, {} truth; {} water pixels, {} of them undefined and left out.",
            r.scene,
            r.size[0],
            r.size[1],
            match r.truth {
                crate::TruthGeometry::Flat => "flat",
                crate::TruthGeometry::Displaced => "displaced",
            },
            r.water_pixels,
            r.undefined_pixels
        );
        if let Some(relative) = r.rows.iter().find_map(|row| row.relative.as_ref()) {
            notes.push_str(&format!(
                " Relative: median ratio to {} and its 95 % interval.",
                relative.to
            ));
        }
        if r.rows.iter().any(|row| row.timer == Timer::Wall) {
            notes.push_str(" Times marked with w are wall time, not the device's.");
        }
        notes
    }
}

/// Picks one of the two summaries.
type Part = fn(&BorderErrors) -> &Summary;

/// Lines of names and values as CSV, under the names of the first.
fn csv_text(lines: impl Iterator<Item = Vec<(String, String)>>) -> Result<String, MeasureError> {
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

fn csv_fields(row: &Row) -> Vec<(String, String)> {
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
    let whole = row.error.as_ref().map(|e| BorderErrors {
        position_px: e.position_px,
        position_m: e.position_m,
        within_half_px: e.within_half_px,
        wrong_object: e.wrong_object,
        rmse: e.rmse,
        psnr: e.psnr,
    });
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
    }
    fields
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

/// Three significant digits, never in powers of ten unless tiny.
fn digits(x: f64) -> String {
    let size = x.abs();
    if size == 0.0 {
        "0".into()
    } else if size < 1e-4 {
        format!("{x:.0e}")
    } else {
        let whole = size.log10().floor() as i32;
        format!("{x:.*}", (2 - whole).clamp(0, 5) as usize)
    }
}

/// A share in percent. What is not all or nothing never looks like it: 99.999 % is not 100 %.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    for decimals in 2..=6 {
        let text = format!("{percent:.decimals$}");
        let shown: f64 = text.parse().unwrap_or(percent);
        if (shown != 100.0 || share == 1.0) && (shown != 0.0 || share == 0.0) {
            return format!("{text} %");
        }
    }
    format!("{percent} %")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::{Relative, tests::example};

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
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let names: Vec<String> = reader
            .headers()
            .unwrap()
            .iter()
            .map(str::to_owned)
            .collect();
        let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
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
    fn nearly_all_is_not_shown_as_all() {
        assert_eq!(percent(1.0), "100.00 %");
        assert_eq!(percent(0.0), "0.00 %");
        assert_eq!(percent(0.999_99), "99.999 %");
        assert_eq!(percent(0.000_01), "0.001 %");
        assert_eq!(percent(0.5), "50.00 %");
    }

    #[test]
    fn three_digits_are_kept_at_every_size() {
        let shown = [1234.5, 12.345, 1.2345, 0.123_45, 0.001_234_5, 0.0, 1e-7].map(digits);
        assert_eq!(
            shown,
            ["1234", "12.3", "1.23", "0.123", "0.00123", "0", "1e-7"]
        );
    }
}
