//! Pipelines against each other on the plane of time and error: who is beaten by whom, and whether
//! some of them ("ours") beat each of the others ("rivals") by as much as is claimed.
//!
//! Times are compared round by round: the median of the ratios of frames that ran in the same
//! round. Errors are means of the position error in pixels.

use serde::{Deserialize, Serialize};

use crate::results::{Relative, Results, Row, finite};
use crate::table::{digits, percent};
use crate::timing::{Timing, relative_time};
use crate::{MeasureError, median};

/// By how much a rival is to be beaten: it has to be either as fast and far more wrong, or as right
/// and far slower.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Claim {
    /// An error of at most this share of the rival's …
    pub error_share: f64,
    /// … in at most this multiple of its time;
    pub times: f64,
    /// or an error of at most so many pixels more than the rival's …
    pub error_px: f64,
    /// … in at most this share of its time.
    pub time_share: f64,
}

impl Default for Claim {
    /// A tenth of the error in 1.25 times the time, or an error within 0.05 px in a fifth of it.
    fn default() -> Self {
        Self {
            error_share: 0.1,
            times: 1.25,
            error_px: 0.05,
            time_share: 0.2,
        }
    }
}

impl Claim {
    /// How far a pair of pipelines is from the claim: it holds up to 1; 1.3 misses it by 30 % in
    /// time or in error, whichever is worse, on the nearer of its two ways.
    fn needs(&self, times: f64, ours_px: f64, rival_px: f64) -> f64 {
        let share = match ours_px == 0.0 {
            true => 0.0,
            false => ours_px / rival_px,
        };
        let by_error = (share / self.error_share).max(times / self.times);
        let by_time = ((ours_px - rival_px) / self.error_px).max(times / self.time_share);
        by_error.min(by_time)
    }

    /// The claim in words.
    pub fn words(&self) -> String {
        format!(
            "against each rival one of ours has at most {} of its error in at most {} times its \
             time, or an error within {} px of its in at most {} of its time",
            self.error_share, self.times, self.error_px, self.time_share
        )
    }
}

/// One rival, and the one of ours that comes nearest to what is claimed, or goes furthest beyond.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Contest {
    /// The rival.
    pub rival: String,
    /// Whether the claim holds against it.
    pub holds: bool,
    /// Whether that is so at both ends of the confidence interval of the times, too.
    pub certain: bool,
    /// The one of ours.
    pub ours: String,
    /// Its time as a multiple of the rival's.
    pub times: Relative,
    /// Its mean position error, pixels.
    #[serde(serialize_with = "finite")]
    pub ours_px: f64,
    /// The rival's, pixels.
    #[serde(serialize_with = "finite")]
    pub rival_px: f64,
    /// The share of its pixels that show a wrong object, beside which its error is to be read: what
    /// is missing altogether may lie on the ray of what is seen instead, 0 px away.
    #[serde(serialize_with = "finite")]
    pub ours_wrong: f64,
    /// The rival's.
    #[serde(serialize_with = "finite")]
    pub rival_wrong: f64,
    /// How much of what is claimed is missing: up to 1 nothing; 1.3: 30 % too slow or too wrong.
    #[serde(serialize_with = "finite")]
    pub needs: f64,
    /// Those of ours that the rival dominates: it is as fast and as right, and better in one.
    pub dominates: Vec<String>,
}

fn error_px(row: &Row) -> Option<f64> {
    Some(row.error.as_ref()?.position_px.mean)
}

fn wrong_object(row: &Row) -> f64 {
    row.error.as_ref().map_or(0.0, |error| error.wrong_object)
}

/// Median of the ratios of two rows' frames; none where they did not run the same rounds.
fn times(row: &Row, other: &Row) -> Option<f64> {
    let (a, b) = (&row.frame_ms.samples, &other.frame_ms.samples);
    let ratios: Vec<f64> = a.iter().zip(b).map(|(a, b)| a / b).collect();
    median(&ratios).filter(|_| a.len() == b.len())
}

/// Whether a row is as fast and as right as another, and better in one of the two.
fn dominates(row: &Row, other: &Row) -> bool {
    let (Some(error), Some(beaten)) = (error_px(row), error_px(other)) else {
        return false;
    };
    times(row, other).is_some_and(|t| t <= 1.0 && error <= beaten && (t < 1.0 || error < beaten))
}

/// For each row the names of those that dominate it. Rows without an error dominate nothing, and
/// are dominated by nothing.
pub fn dominated_by(results: &Results) -> Vec<Vec<String>> {
    let rows = &results.rows;
    let beaters = |row: &Row| {
        let found = rows.iter().filter(|other| dominates(other, row));
        found.map(|other| other.pipeline.clone()).collect()
    };
    rows.iter().map(beaters).collect()
}

/// The claim against each rival, in the order of the rows; rivals without an error are left out.
///
/// # Errors
/// [`MeasureError::Length`] when rows did not run the same number of rounds, and
/// [`MeasureError::Value`] when a time is no time.
pub fn contests(
    results: &Results,
    ours: &[String],
    rivals: &[String],
    claim: &Claim,
) -> Result<Vec<Contest>, MeasureError> {
    let rows = |names: &'_ [String]| -> Vec<&Row> {
        let named = |row: &&Row| names.contains(&row.pipeline) && row.error.is_some();
        results.rows.iter().filter(named).collect()
    };
    let ours = rows(ours);
    let mut found = Vec::new();
    for rival in rows(rivals) {
        let theirs = Timing::new(rival.frame_ms.samples.clone())?;
        let rival_px = error_px(rival).unwrap_or_default();
        let mut best: Option<Contest> = None;
        for row in &ours {
            let own = Timing::new(row.frame_ms.samples.clone())?;
            let times = relative_time(&own, &theirs, &rival.pipeline)?;
            let ours_px = error_px(row).unwrap_or_default();
            let needs = |times: f64| claim.needs(times, ours_px, rival_px);
            let holds = needs(times.median) <= 1.0;
            let same = |times: f64| (needs(times) <= 1.0) == holds;
            let contest = Contest {
                rival: rival.pipeline.clone(),
                holds,
                certain: same(times.low) && same(times.high),
                ours: row.pipeline.clone(),
                ours_px,
                rival_px,
                ours_wrong: wrong_object(row),
                rival_wrong: wrong_object(rival),
                needs: needs(times.median),
                dominates: Vec::new(),
                times,
            };
            if best.as_ref().is_none_or(|b| contest.needs < b.needs) {
                best = Some(contest);
            }
        }
        if let Some(mut contest) = best {
            let beaten = ours.iter().filter(|row| dominates(rival, row));
            contest.dominates = beaten.map(|row| row.pipeline.clone()).collect();
            found.push(contest);
        }
    }
    Ok(found)
}

impl Contest {
    /// Headings of [`Contest::cells`].
    pub const HEADINGS: [&str; 9] = [
        "rival",
        "claim",
        "by",
        "times its time",
        "px mean",
        "its px mean",
        "wrong",
        "its wrong",
        "dominates",
    ];

    /// The contest for people.
    pub fn cells(&self) -> Vec<String> {
        let holds = match self.holds {
            true => "holds".to_owned(),
            false => format!("misses by {:.0} %", 100.0 * (self.needs - 1.0)),
        };
        let doubt = if self.certain { "" } else { " (uncertain)" };
        let times = &self.times;
        let dominates = match self.dominates.is_empty() {
            true => "none of ours".to_owned(),
            false => self.dominates.join(", "),
        };
        vec![
            self.rival.clone(),
            format!("{holds}{doubt}"),
            self.ours.clone(),
            format!("{:.2} [{:.2}, {:.2}]", times.median, times.low, times.high),
            digits(self.ours_px),
            digits(self.rival_px),
            percent(self.ours_wrong),
            percent(self.rival_wrong),
            dominates,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::tests::example;

    /// Rows of a name, frame times and an error.
    fn results(rows: &[(&str, &[f64], f64)]) -> Results {
        let mut results = example();
        let pattern = results.rows.remove(0);
        for (name, samples, px) in rows {
            let mut row = pattern.clone();
            row.pipeline = (*name).to_owned();
            row.frame_ms = Timing::new(samples.to_vec()).unwrap().frame_ms();
            row.error.as_mut().unwrap().position_px.mean = *px;
            results.rows.push(row);
        }
        results
    }

    fn contest(ours: (f64, f64), rival: (f64, f64)) -> Contest {
        let (ours_ms, rival_ms) = ([ours.0; 12], [rival.0; 12]);
        let results = results(&[("ours", &ours_ms, ours.1), ("rival", &rival_ms, rival.1)]);
        let names = ["ours", "rival"].map(str::to_owned);
        let (ours, rivals) = names.split_at(1);
        let mut found = contests(&results, ours, rivals, &Claim::default()).unwrap();
        assert_eq!(found.len(), 1);
        found.remove(0)
    }

    #[test]
    fn a_tenth_of_the_error_at_about_its_time_is_enough() {
        assert!(contest((1.25, 0.1), (1.0, 1.0)).holds);
        assert!(!contest((1.26, 0.1), (1.0, 1.0)).holds);
        assert!(!contest((1.25, 0.11), (1.0, 1.0)).holds);
        // No error at all is a share of any, of none included.
        assert!(contest((1.0, 0.0), (1.0, 0.0)).holds);
    }

    #[test]
    fn its_error_in_a_fifth_of_its_time_is_enough() {
        assert!(contest((1.0, 0.049), (5.0, 0.0)).holds);
        assert!(!contest((1.0, 0.051), (5.0, 0.0)).holds);
        assert!(!contest((1.1, 0.0001), (5.0, 0.0)).holds);
    }

    #[test]
    fn what_is_missing_is_the_worse_of_time_and_error_on_the_nearer_way() {
        assert!((contest((2.5, 0.05), (1.0, 1.0)).needs - 2.0).abs() < 1e-12);
        assert!((contest((1.0, 0.4), (1.0, 1.0)).needs - 4.0).abs() < 1e-12);
        assert!((contest((1.5, 0.01), (5.0, 0.0)).needs - 1.5).abs() < 1e-12);
    }

    #[test]
    fn a_rival_that_is_faster_and_as_right_dominates() {
        assert_eq!(contest((2.0, 0.5), (1.0, 0.5)).dominates, ["ours"]);
        assert!(contest((2.0, 0.5), (1.0, 0.51)).dominates.is_empty());
        assert!(contest((1.0, 0.5), (1.0, 0.5)).dominates.is_empty());
    }

    #[test]
    fn nothing_dominates_itself_and_no_two_each_other() {
        let rows: [(&str, &[f64], f64); 4] = [
            ("a", &[1.0, 2.0, 1.5], 1.0),
            ("b", &[2.0, 1.0, 1.5], 0.5),
            ("c", &[3.0, 3.0, 3.0], 2.0),
            ("d", &[3.0, 3.0, 3.0], 2.0),
        ];
        let results = results(&rows);
        let found = dominated_by(&results);
        for (row, beaters) in results.rows.iter().zip(&found) {
            assert!(!beaters.contains(&row.pipeline));
        }
        assert!(found[1].is_empty());
        assert_eq!(found[2], found[3]);
        assert_eq!(found[2], ["a", "b"]);
    }

    #[test]
    fn noise_that_spans_the_limit_is_told() {
        let steady: &[f64] = &[1.0; 6];
        let noisy: &[f64] = &[0.9, 1.6, 0.9, 1.6, 1.2, 1.1];
        let results = results(&[("ours", noisy, 0.1), ("rival", steady, 1.0)]);
        let names = ["ours", "rival"].map(str::to_owned);
        let (ours, rivals) = names.split_at(1);
        let found = contests(&results, ours, rivals, &Claim::default()).unwrap();
        assert!(found[0].holds && !found[0].certain);
        assert!(found[0].cells()[1].contains("uncertain"));
    }

    #[test]
    fn a_row_without_an_error_takes_no_part() {
        let mut results = results(&[("ours", &[1.0], 0.1), ("rival", &[1.0], 1.0)]);
        results.rows[0].error = None;
        let names = ["ours", "rival"].map(str::to_owned);
        let (ours, rivals) = names.split_at(1);
        let found = contests(&results, ours, rivals, &Claim::default());
        assert_eq!(found.unwrap(), []);
        assert_eq!(dominated_by(&results), [Vec::<String>::new(), Vec::new()]);
    }
}
