//! Which of an ablation's pipelines are held against which others.

use meniscus_measure::{Claim, Contest, MeasureError, Results, aligned, contests, dominated_by};
use meniscus_source::Diagnostic;
use serde_json::{Value, json};

/// Some pipelines, and those that they are held against; by their rows' names.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Rivalry {
    /// Those that are to be better.
    pub ours: Vec<String>,
    /// Those that they are to be better than.
    pub rivals: Vec<String>,
}

/// Whether a pattern means a row: its name, the name of the pipeline without its changes, or
/// `FOLDER/*`.
fn means(pattern: &str, name: &str) -> bool {
    let plain = name.split(' ').next().unwrap_or(name);
    match pattern.strip_suffix('*') {
        Some(beginning) => plain.starts_with(beginning),
        None => pattern == name || pattern == plain,
    }
}

impl Rivalry {
    /// From patterns, over the names of all rows; `ours` empty: all that are no rivals. The baseline
    /// is on a side only where it is named.
    ///
    /// # Errors
    /// When a pattern means none of the rows, or a row is on both sides.
    pub fn of(
        ours: &[String],
        rivals: &[String],
        names: &[&str],
        baseline: Option<&str>,
    ) -> Result<Self, Diagnostic> {
        for pattern in ours.iter().chain(rivals) {
            if !names.iter().any(|name| means(pattern, name)) {
                let message = format!("`{pattern}` is none of the pipelines that run");
                return Err(
                    Diagnostic::error(message).with_suggestion(pattern, names.iter().copied())
                );
            }
        }
        let side = |patterns: &[String]| -> Vec<String> {
            let on = names.iter().filter(|name| {
                let mut meant = patterns.iter().filter(|pattern| means(pattern, name));
                // Stars leave the baseline out.
                meant.any(|pattern| Some(**name) != baseline || !pattern.ends_with('*'))
            });
            on.map(|name| (*name).to_owned()).collect()
        };
        let rivals = side(rivals);
        let others = || {
            let all = names.iter().filter(|name| Some(**name) != baseline);
            let all = all.filter(|name| !rivals.iter().any(|rival| rival == *name));
            all.map(|name| (*name).to_owned()).collect()
        };
        let ours = if ours.is_empty() {
            others()
        } else {
            side(ours)
        };
        if let Some(both) = ours.iter().find(|name| rivals.contains(name)) {
            return Err(Diagnostic::error(format!("`{both}` is on both sides"))
                .with_help("name it with --ours or with --against"));
        }
        Ok(Self { ours, rivals })
    }
}

/// Writes into the results who dominates whom, and how the claim stands against each rival.
///
/// # Errors
/// When a row's times are no times.
pub(crate) fn note(results: &mut Results, rivalry: Option<&Rivalry>) -> Result<(), MeasureError> {
    let beaten = dominated_by(results);
    for (row, by) in results.rows.iter_mut().zip(beaten) {
        row.more.insert("dominated_by".into(), json!(by));
    }
    if let Some(Rivalry { ours, rivals }) = rivalry {
        let found = contests(results, ours, rivals, &Claim::default())?;
        let found = serde_json::to_value(found).map_err(|error| MeasureError::Value {
            what: "contests".into(),
            problem: error.to_string(),
        })?;
        results.more.insert("contests".into(), found);
    }
    Ok(())
}

/// What the results say of rivals; empty where none were named.
pub fn contests_of(results: &Results) -> Vec<Contest> {
    let said = results.more.get("contests").and_then(Value::as_array);
    let read = |value: &Value| serde_json::from_value(value.clone()).ok();
    said.into_iter().flatten().filter_map(read).collect()
}

/// The same as text; nothing where no rivals were named.
pub fn contests_text(results: &Results) -> String {
    let contests = contests_of(results);
    if contests.is_empty() {
        return String::new();
    }
    let rows: Vec<Vec<String>> = contests.iter().map(Contest::cells).collect();
    format!(
        "\nClaim: {}; and no rival dominates one of ours.\n{}",
        Claim::default().words(),
        aligned(&Contest::HEADINGS, &rows)
    )
}

/// The same as Markdown.
pub fn contests_markdown(results: &Results) -> String {
    let contests = contests_of(results);
    if contests.is_empty() {
        return String::new();
    }
    let line = |cells: &[String]| {
        let cells: Vec<String> = cells.iter().map(|c| c.replace('|', "\\|")).collect();
        format!("| {} |\n", cells.join(" | "))
    };
    let mut text = format!(
        "\nClaim: {}; and no rival dominates one of ours.\n\n",
        Claim::default().words()
    );
    text.push_str(&line(&Contest::HEADINGS.map(str::to_owned)));
    text.push_str(&format!("|{}\n", "---|".repeat(Contest::HEADINGS.len())));
    for contest in contests {
        text.push_str(&line(&contest.cells()));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    const NAMES: [&str; 4] = ["a/none", "a/one", "a/two", "a/two pass.slot=b/x"];

    fn of(ours: &[&str], rivals: &[&str]) -> Result<Rivalry, Diagnostic> {
        let owned = |names: &[&str]| {
            names
                .iter()
                .map(|name| (*name).to_owned())
                .collect::<Vec<_>>()
        };
        Rivalry::of(&owned(ours), &owned(rivals), &NAMES, Some("a/none"))
    }

    #[test]
    fn all_that_are_no_rivals_are_ours_but_the_baseline() {
        let found = of(&[], &["a/one"]).unwrap();
        assert_eq!(found.rivals, ["a/one"]);
        assert_eq!(found.ours, ["a/two", "a/two pass.slot=b/x"]);
    }

    #[test]
    fn a_pipeline_s_name_means_it_with_all_its_changes() {
        let found = of(&["a/one"], &["a/two"]).unwrap();
        assert_eq!(found.rivals, ["a/two", "a/two pass.slot=b/x"]);
    }

    #[test]
    fn the_baseline_is_a_rival_where_it_is_named_alone() {
        assert_eq!(of(&["a/one"], &["a/none"]).unwrap().rivals, ["a/none"]);
        let found = of(&["a/one"], &["a/t*"]).unwrap();
        assert_eq!(found.rivals, ["a/two", "a/two pass.slot=b/x"]);
        assert!(
            of(&[], &["a/*"])
                .unwrap()
                .rivals
                .iter()
                .all(|name| name != "a/none")
        );
    }

    #[test]
    fn what_means_nothing_or_both_is_refused() {
        assert!(of(&[], &["a/three"]).is_err());
        assert!(of(&["a/one"], &["a/one"]).is_err());
    }
}
