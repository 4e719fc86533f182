//! What headers say of the inputs that functions are made for.
//!
//! ```text
//! // domain: refracted(incident unit, normal unit, index 0.4 to 2.5 linear)
//! // domain: crossing(low 1e-3 to 1e3 log, apart 0 to 3e3 near low / water.root_high) against crossing
//! // domain: Ray(origin -1e4 to 1e4, direction unit)
//! ```
//!
//! A function has an entry for each argument, or for the members of one (`ray.origin`); a structure
//! has entries for its members, which hold wherever a function takes one. A range is `LEAST to MOST`
//! with every float equally likely (or `linear`: every number, or `log`: every decade, or
//! `from MAGNITUDE`: every decade on both sides of 0 from a magnitude on, and 0), `unit` for unit
//! vectors, `seen LEAST to MOST` for points that `view_target` sees at these depths, or `is` with
//! the components of something fixed. `near` names a place that some of
//! the inputs are drawn close to: a product and quotient of other arguments, host values and
//! `sine(a, b)` of two unit vectors. `against` names an independent truth. Truth values need no range.

use std::sync::Arc;

use meniscus_shader::Library;
use meniscus_source::{Diagnostic, Place, Report, SourceFile};

/// A function or structure of which a header declares the domain.
#[derive(Debug, Clone)]
pub struct Declared {
    /// The module's path.
    pub module: String,
    /// The name of the function or structure.
    pub name: String,
    /// The name of an independent truth.
    pub against: Option<String>,
    pub(super) entries: Vec<Entry>,
    pub(super) place: Place,
}

#[derive(Debug, Clone)]
pub(super) struct Entry {
    pub(super) path: String,
    pub(super) range: Written,
    pub(super) near: Option<Vec<Factor>>,
    pub(super) place: Place,
}

#[derive(Debug, Clone)]
pub(super) enum Written {
    Numbers {
        least: f64,
        most: f64,
        scale: Scale,
    },
    Unit,
    /// Points that `view_target` sees between two depths.
    Seen([f64; 2]),
    Fixed(Vec<f64>),
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Scale {
    Bits,
    Linear,
    Log,
    From(f64),
}

/// A part of a product; `inverse` for a divisor.
#[derive(Debug, Clone)]
pub(super) struct Factor {
    pub(super) of: Operand,
    pub(super) inverse: bool,
}

#[derive(Debug, Clone)]
pub(super) enum Operand {
    Number(f64),
    Value(String),
    Sine(String, String),
}

impl Declared {
    /// Whether it is of a function; domains of structures belong to whatever takes them.
    pub fn is_function(&self, library: &Library) -> bool {
        let module = library.get(&self.module);
        module.is_some_and(|m| m.file.text.contains(&format!("fn {}(", self.name)))
    }
}

/// The ranges of all entries, by path; what a page tells of a function.
impl std::fmt::Display for Declared {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.place.text())
    }
}

/// Everything that the headers of a library declare, and what is wrong with it. Lines without
/// brackets are for people.
pub fn declared(library: &Library) -> (Vec<Declared>, Report) {
    let mut found = Vec::new();
    let mut report = Report::default();
    for module in library.modules() {
        for line in module
            .header
            .domain
            .iter()
            .filter(|line| line.contains('('))
        {
            let start = module.file.text.find(line.as_str()).unwrap_or(0);
            let reader = Reader {
                file: &module.file,
                start,
                line,
            };
            match reader.declared(&module.path) {
                Ok(declared) => found.push(declared),
                Err(wrong) => report.add(wrong),
            }
        }
    }
    (found, report)
}

struct Reader<'a> {
    file: &'a Arc<SourceFile>,
    start: usize,
    line: &'a str,
}

impl Reader<'_> {
    /// The place of a part of the line.
    fn place(&self, part: &str) -> Place {
        let part = part.trim();
        let at = self.start + (part.as_ptr() as usize).saturating_sub(self.line.as_ptr() as usize);
        Place::new(self.file, at..at + part.len())
    }

    fn wrong(&self, part: &str, message: impl Into<String>) -> Diagnostic {
        Diagnostic::error(message)
            .at(&self.place(part), "in this domain")
            .with_help(
                "write `NAME(ARGUMENT LEAST to MOST, ARGUMENT unit)`, for example \
             `refracted(incident unit, normal unit, index 0.4 to 2.5)`",
            )
    }

    fn declared(&self, module: &str) -> Result<Declared, Diagnostic> {
        let (name, rest) = self.line.split_once('(').unwrap_or((self.line, ""));
        let Some((inside, after)) = rest.rsplit_once(')') else {
            return Err(self.wrong(self.line, "a bracket is not closed"));
        };
        let against = match after.trim().strip_prefix("against") {
            Some(truth) => Some(truth.trim().to_owned()),
            None if after.trim().is_empty() => None,
            None => return Err(self.wrong(after, "after the brackets only `against` may follow")),
        };
        if let Some(truth) = &against
            && super::truth_names().all(|known| known != truth)
        {
            let unknown = Diagnostic::error(format!("there is no truth `{truth}`"))
                .at(&self.place(after), "unknown truth");
            return Err(unknown.with_suggestion(truth, super::truth_names()));
        }
        let entries = split_outside_brackets(inside)
            .map(|entry| self.entry(entry))
            .collect::<Result<_, _>>()?;
        Ok(Declared {
            module: module.to_owned(),
            name: name.trim().to_owned(),
            against,
            entries,
            place: self.place(self.line),
        })
    }

    fn entry(&self, text: &str) -> Result<Entry, Diagnostic> {
        let (range, near) = match text.trim().split_once(" near ") {
            Some((range, near)) => (range, Some(self.product(near)?)),
            None => (text, None),
        };
        let words: Vec<&str> = range.split_whitespace().collect();
        let number = |word: &str| word.parse::<f64>().ok().filter(|x| x.is_finite());
        let bad = |what: &str| self.wrong(text, format!("`{}`: {what}", text.trim()));
        let (path, range) = match words.as_slice() {
            [path, "unit"] => (path, Written::Unit),
            [path, "seen", near, "to", far] => match (number(near), number(far)) {
                (Some(near), Some(far)) if 0.0 < near && near < far => {
                    (path, Written::Seen([near, far]))
                }
                _ => {
                    return Err(bad(
                        "`seen` wants two depths, of which the second is larger",
                    ));
                }
            },
            [path, "is", values @ ..] if !values.is_empty() => {
                let values: Option<Vec<f64>> = values.iter().map(|v| number(v)).collect();
                let values = values.ok_or_else(|| bad("a value is no finite number"))?;
                (path, Written::Fixed(values))
            }
            [path, least, "to", most, rest @ ..] => {
                let scale = match rest {
                    [] => Scale::Bits,
                    ["linear"] => Scale::Linear,
                    ["log"] => Scale::Log,
                    ["from", magnitude] => match number(magnitude).filter(|m| *m > 0.0) {
                        Some(magnitude) => Scale::From(magnitude),
                        None => return Err(bad("`from` wants a positive magnitude")),
                    },
                    _ => {
                        return Err(bad(
                            "only `linear`, `log`, `from` or `near` may follow a range",
                        ));
                    }
                };
                let (Some(least), Some(most)) = (number(least), number(most)) else {
                    return Err(bad("a bound is no finite number"));
                };
                if least > most {
                    return Err(bad("the bounds are out of order"));
                }
                if matches!(scale, Scale::Log) && least * most <= 0.0 {
                    return Err(bad("decades do not reach across 0"));
                }
                (path, Written::Numbers { least, most, scale })
            }
            _ => return Err(bad("no range")),
        };
        Ok(Entry {
            path: (*path).to_owned(),
            range,
            near,
            place: self.place(text),
        })
    }

    fn product(&self, text: &str) -> Result<Vec<Factor>, Diagnostic> {
        let mut factors = Vec::new();
        let mut inverse = false;
        if text.trim().ends_with(['*', '/']) {
            return Err(self.wrong(text, format!("`{}` lacks a factor", text.trim())));
        }
        for part in text.split_inclusive(['*', '/']) {
            let next = part.ends_with('/');
            let word = part.trim_end_matches(['*', '/']).trim();
            if word.is_empty() {
                return Err(self.wrong(text, format!("`{}` lacks a factor", text.trim())));
            }
            let sine = word.strip_prefix("sine(").and_then(|w| w.strip_suffix(')'));
            let of = match (
                word.parse::<f64>(),
                sine.and_then(|pair| pair.split_once(',')),
            ) {
                (Ok(number), _) => Operand::Number(number),
                (_, Some((a, b))) => Operand::Sine(a.trim().to_owned(), b.trim().to_owned()),
                _ => Operand::Value(word.to_owned()),
            };
            factors.push(Factor { of, inverse });
            inverse = next;
        }
        Ok(factors)
    }
}

/// Parts between commas that are not within brackets; none of an empty text.
fn split_outside_brackets(text: &str) -> impl Iterator<Item = &str> {
    let mut depth = 0i32;
    text.split(move |c| {
        depth += i32::from(c == '(') - i32::from(c == ')');
        c == ',' && depth == 0
    })
    .filter(|part| !part.trim().is_empty())
}
