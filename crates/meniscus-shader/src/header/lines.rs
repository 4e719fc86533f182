//! The lines of a leading comment, and the words that are read from them.

use std::sync::Arc;

use meniscus_source::{Diagnostic, Place, SourceFile};

use super::{Name, Number};

/// The text of a comment line, without its marks, and where it begins in the file.
pub(super) struct Line<'a> {
    pub text: &'a str,
    pub start: usize,
}

/// The first sentence, if it has come to its end: at a full stop before a capital letter or a name
/// in code. One at the end of a line may be that of an abbreviation, but then a sentence is cut short.
pub(super) fn sentence(text: &str) -> Option<&str> {
    let opens = |rest: &str| {
        let mut next = rest.chars();
        match next.next() {
            None => true,
            Some(' ') => next.next().is_some_and(|c| c.is_uppercase() || c == '`'),
            Some(_) => false,
        }
    };
    let mut stops = text.match_indices('.').map(|(at, _)| at + 1);
    stops.find(|at| opens(&text[*at..])).map(|at| &text[..at])
}

/// The `//` lines at the top of a text, up to the first line that is none: what follows a blank
/// line belongs to a declaration.
pub(super) fn leading_lines(text: &str) -> impl Iterator<Item = Line<'_>> {
    let mut at = 0;
    text.split_inclusive('\n')
        .map(move |line| {
            let start = at;
            at += line.len();
            (line.trim_end(), start)
        })
        .skip_while(|(line, _)| line.trim().is_empty())
        .map_while(|(line, start)| {
            let comment = line.trim_start().strip_prefix("//")?;
            Some(Line {
                text: comment,
                start: start + (line.len() - comment.len()),
            })
        })
}

pub(super) fn part(file: &Arc<SourceFile>, text: &str, start: usize) -> Name {
    let trimmed = text.trim();
    let start = start + (text.len() - text.trim_start().len());
    Name {
        text: trimmed.to_owned(),
        place: Place::new(file, start..start + trimmed.len()),
    }
}

pub(super) fn list(file: &Arc<SourceFile>, text: &str, start: usize) -> Vec<Name> {
    let mut at = start;
    let mut names = Vec::new();
    for piece in text.split(',') {
        if !piece.trim().is_empty() {
            names.push(part(file, piece, at));
        }
        at += piece.len() + 1;
    }
    names
}

pub(super) fn one(file: &Arc<SourceFile>, text: &str, start: usize) -> Result<Name, Diagnostic> {
    let name = part(file, text, start);
    if name.text.is_empty() {
        return Err(
            Diagnostic::error("nothing follows the colon").at(&name.place, "a name is missing")
        );
    }
    Ok(name)
}

/// `exactly` or `within NUMBER px`, the number from 0 to 1.
pub(super) fn within_px(said: &Name) -> Result<f64, Diagnostic> {
    if said.text == "exactly" {
        return Ok(0.0);
    }
    let number = said
        .text
        .strip_prefix("within ")
        .and_then(|rest| rest.trim().strip_suffix("px"))
        .and_then(|number| number.trim().parse::<f64>().ok())
        .filter(|px| (0.0..=1.0).contains(px));
    number.ok_or_else(|| {
        Diagnostic::error("an identity holds exactly, or within 0 to 1 pixels")
            .at(&said.place, "not such a bound")
            .with_help("write `identity when RULE: within 0.1 px`")
    })
}

/// `LEAST to MOST [UNIT][, step STEP][, live]`
pub(super) fn number(name: Name, said: &Name) -> Result<Number, Diagnostic> {
    let wrong = |what: &str| {
        Diagnostic::error(format!("the number `{}` is declared wrongly: {what}", name.text))
            .at(&said.place, "")
            .with_help("write `number NAME: LEAST to MOST UNIT, step STEP`, for example `number taps: 1 to 8, step 1`; `, live` at the end lets it change while a plan runs")
    };
    let (said_of_it, live) = match said.text.strip_suffix(", live") {
        Some(before) => (before, true),
        None => (said.text.as_str(), false),
    };
    let (range, step) = match said_of_it.split_once(", step ") {
        Some((range, step)) => (range, step.trim()),
        None => (said_of_it, "0"),
    };
    let mut words = range.split_whitespace();
    let mut value = || {
        words
            .next()
            .and_then(|w| w.parse::<f64>().ok())
            .filter(|v| v.is_finite())
    };
    let least = value().ok_or_else(|| wrong("no least value"))?;
    let mut words = range.split_whitespace().skip(1);
    if words.next() != Some("to") {
        return Err(wrong("no `to` between least and most"));
    }
    let most = words
        .next()
        .and_then(|w| w.parse::<f64>().ok())
        .filter(|v| v.is_finite() && *v >= least)
        .ok_or_else(|| wrong("no most value, or one under the least"))?;
    let unit = words.collect::<Vec<_>>().join(" ");
    let step = step.parse().map_err(|_| wrong("the step is no number"))?;
    Ok(Number {
        name,
        least,
        most,
        step,
        unit,
        live,
    })
}
