//! Results as a table: for the terminal, as Markdown, as CSV.

mod columns;
mod csv;
mod digits;

use comfy_table::{CellAlignment, LineStyle, presets};

use crate::MeasureError;
use crate::results::{Results, Timer};
use columns::{COLUMNS, COSTS, COSTS_NOTES, Column};
pub(crate) use digits::{digits, percent};

/// The table that an ablation prints, one row per pipeline.
///
/// Terminal and Markdown show what decides between pipelines, rounded; CSV holds every figure
/// unrounded under the names of the results file.
pub struct Table<'a> {
    results: &'a Results,
    columns: &'static [Column],
    /// What the columns mean, where that is not told with what was measured on.
    notes: Option<&'static str>,
}

impl<'a> Table<'a> {
    /// Time and error.
    pub fn of(results: &'a Results) -> Self {
        Self {
            results,
            columns: COLUMNS,
            notes: None,
        }
    }

    /// What a frame takes beside time: passes, invocations, memory, uploads, preparation.
    pub fn of_costs(results: &'a Results) -> Self {
        Self {
            results,
            columns: COSTS,
            notes: Some(COSTS_NOTES),
        }
    }

    /// Aligned columns for a terminal, ending in a line feed.
    pub fn terminal(&self) -> String {
        format!(
            "{}{}\n",
            aligned(&self.headings(), &self.cells()),
            self.notes()
        )
    }

    /// A Markdown table with what it was measured on beneath, ending in a line feed.
    pub fn markdown(&self) -> String {
        let line = |cells: Vec<String>| {
            let cells: Vec<String> = cells.iter().map(|c| c.replace('|', "\\|")).collect();
            format!("| {} |\n", cells.join(" | "))
        };
        let mut text = line(self.columns.iter().map(|c| c.heading.to_owned()).collect());
        text.push_str("|---|");
        text.push_str(&"---:|".repeat(self.columns.len() - 1));
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
        csv::text(self.results.rows.iter().map(csv::fields))
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
            let line = |row| leading.iter().cloned().chain(csv::fields(row)).collect();
            results.rows.iter().map(line)
        });
        csv::text(lines)
    }

    /// What stands above the columns for people.
    pub fn headings(&self) -> Vec<&'static str> {
        self.columns.iter().map(|column| column.heading).collect()
    }

    /// The columns for people, rounded, a line for each row of the results.
    pub fn cells(&self) -> Vec<Vec<String>> {
        self.results
            .rows
            .iter()
            .map(|row| self.columns.iter().map(|c| (c.show)(row)).collect())
            .collect()
    }

    /// What was measured on, and what the figures mean, in one line.
    pub fn notes(&self) -> String {
        if let Some(notes) = self.notes {
            return notes.to_owned();
        }
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

/// Rows under headings for a terminal, the first column to the left and the others to the right,
/// ending in a line feed.
pub fn aligned(headings: &[&str], rows: &[Vec<String>]) -> String {
    let mut table = comfy_table::Table::new();
    table.load_style(presets::UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none()));
    table.set_header(headings);
    table.add_rows(rows);
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    format!("{}\n", table.trim_fmt())
}

#[cfg(test)]
mod tests;
