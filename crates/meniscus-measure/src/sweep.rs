//! Results of one ablation at many points: the settings that were swept, and every combination.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::{MeasureError, Results, Table};

/// The key of [`Results::more`] under which a point says which one it is.
const POINT: &str = "sweep";

/// Which point of a sweep results are of.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SweepPoint {
    /// Its place in the sweep, from 0.
    pub index: usize,
    /// How many points the whole sweep has.
    pub of: usize,
    /// The swept settings and their values here, in the order they were given.
    pub swept: Map<String, Value>,
    /// What results depend on, hashed: equal hashes promise equal results, times aside.
    pub hash: String,
}

/// The results file of a sweep: `{"points": […]}`, each point being [`Results`] with a key `sweep`
/// beside those of the contract.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Sweep {
    /// What is known so far, by rising index.
    points: Vec<Results>,
}

impl SweepPoint {
    /// The point that results say they are of.
    pub fn of(results: &Results) -> Option<Self> {
        let said = results.more.get(POINT)?;
        serde_json::from_value(said.clone()).ok()
    }

    /// The settings in words: `key=value, key=value`.
    pub fn label(&self) -> String {
        let words = self.swept.iter().map(|(key, value)| match value {
            Value::String(text) => format!("{key}={text}"),
            other => format!("{key}={other}"),
        });
        words.collect::<Vec<_>>().join(", ")
    }
}

impl Sweep {
    /// The points that are known, by rising index.
    pub fn points(&self) -> &[Results] {
        &self.points
    }

    /// Those of them, with what they say of themselves.
    pub fn places(&self) -> impl Iterator<Item = (SweepPoint, &Results)> {
        let known = self.points.iter();
        known.filter_map(|results| Some((SweepPoint::of(results)?, results)))
    }

    /// Whether the results of a point are known.
    pub fn holds(&self, hash: &str) -> bool {
        self.places().any(|(point, _)| point.hash == hash)
    }

    /// Puts in the results of a point, in place of those that are there for its index.
    ///
    /// # Errors
    /// [`MeasureError::Value`] when the point cannot be written.
    pub fn put(&mut self, point: &SweepPoint, mut results: Results) -> Result<(), MeasureError> {
        let said = serde_json::to_value(point)
            .map_err(|error| MeasureError::value("a point of a sweep", error.to_string()))?;
        results.more.insert(POINT.to_owned(), said);
        let index_of = |results: &Results| SweepPoint::of(results).map(|known| known.index);
        self.points
            .retain(|known| index_of(known) != Some(point.index));
        self.points.push(results);
        self.points.sort_by_key(index_of);
        Ok(())
    }

    /// Sweeps of the same settings as one. A point that several know is taken from the first.
    ///
    /// # Errors
    /// [`MeasureError::Value`] when two are of different sweeps: other settings, values or numbers of
    /// points.
    pub fn merge(sweeps: impl IntoIterator<Item = (String, Self)>) -> Result<Self, MeasureError> {
        let mut merged = Self::default();
        let mut first: BTreeMap<usize, (String, SweepPoint)> = BTreeMap::new();
        for (name, sweep) in sweeps {
            for (point, results) in sweep.places() {
                let other = first.values().find(|(_, known)| {
                    known.of != point.of
                        || (known.index == point.index) != (known.swept == point.swept)
                });
                if let Some((file, known)) = other {
                    let problem = format!(
                        "point {} of {} is {}, but in {file} point {} of {} is {}: merge parts of \
                         one sweep",
                        point.index + 1,
                        point.of,
                        point.label(),
                        known.index + 1,
                        known.of,
                        known.label()
                    );
                    return Err(MeasureError::value(name, problem));
                }
                if let Entry::Vacant(place) = first.entry(point.index) {
                    merged.put(&point, results.clone())?;
                    place.insert((name.clone(), point));
                }
            }
        }
        Ok(merged)
    }

    /// How many points are known, and how many there are in all.
    pub fn progress(&self) -> (usize, usize) {
        let all = self.places().map(|(point, _)| point.of).max().unwrap_or(0);
        (self.points.len(), all)
    }

    /// The sweep as JSON, indented, ending in a line feed.
    ///
    /// # Errors
    /// [`MeasureError::Value`] when a number is not finite.
    pub fn to_json(&self) -> Result<String, MeasureError> {
        let mut text = serde_json::to_string_pretty(self)
            .map_err(|error| MeasureError::value("results of a sweep", error.to_string()))?;
        text.push('\n');
        Ok(text)
    }

    /// Reads a sweep; `name` says in errors where `text` comes from.
    ///
    /// # Errors
    /// [`MeasureError::Format`] with line and column when the text is not the results of a sweep.
    pub fn from_json(name: &str, text: &str) -> Result<Self, MeasureError> {
        let sweep: Self = serde_json::from_str(text).map_err(|error| {
            let place = format!("{name}:{}:{}", error.line(), error.column());
            MeasureError::format(place, format!("not the results of a sweep: {error}"))
        })?;
        let lost = sweep
            .points
            .iter()
            .position(|results| SweepPoint::of(results).is_none());
        match lost {
            Some(index) => Err(MeasureError::format(
                name,
                format!("entry {index} of `points` does not say in `{POINT}` which one it is"),
            )),
            None => Ok(sweep),
        }
    }

    /// Every figure of every row of every point, each line led by the swept settings.
    ///
    /// # Errors
    /// As [`Table::csv`].
    pub fn csv(&self) -> Result<String, MeasureError> {
        let leading: Vec<Vec<(String, String)>> = self
            .places()
            .map(|(point, _)| {
                let text = |value: &Value| match value {
                    Value::String(text) => text.clone(),
                    other => other.to_string(),
                };
                let pairs = point.swept.iter();
                pairs
                    .map(|(key, value)| (key.clone(), text(value)))
                    .collect()
            })
            .collect();
        Table::csv_of_many(leading.iter().map(Vec::as_slice).zip(&self.points))
    }
}

#[cfg(test)]
#[path = "sweep_tests.rs"]
mod tests;
