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
//! vectors, or `is` with the components of something fixed. `near` names a place that some of
//! the inputs are drawn close to: a product and quotient of other arguments, host values and
//! `sine(a, b)` of two unit vectors. `against` names an independent truth. Truth values need no range.

use std::sync::Arc;

use meniscus_shader::Library;
use meniscus_source::{Diagnostic, Place, Report, SourceFile};

use super::host::Host;
use crate::{Domain, Function, Kind, Range, Relation, Shape};

/// A function or structure of which a header declares the domain.
#[derive(Debug, Clone)]
pub struct Declared {
    /// The module's path.
    pub module: String,
    /// The name of the function or structure.
    pub name: String,
    /// The name of an independent truth.
    pub against: Option<String>,
    entries: Vec<Entry>,
    place: Place,
}

#[derive(Debug, Clone)]
struct Entry {
    path: String,
    range: Written,
    near: Option<Vec<Factor>>,
    place: Place,
}

#[derive(Debug, Clone)]
enum Written {
    Numbers { least: f64, most: f64, scale: Scale },
    Unit,
    Fixed(Vec<f64>),
}

#[derive(Debug, Clone, Copy)]
enum Scale {
    Bits,
    Linear,
    Log,
    From(f64),
}

/// A part of a product; `inverse` for a divisor.
#[derive(Debug, Clone)]
struct Factor {
    of: Operand,
    inverse: bool,
}

#[derive(Debug, Clone)]
enum Operand {
    Number(f64),
    Value(String),
    Sine(String, String),
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
            && !super::TRUTHS.contains(&truth.as_str())
        {
            let unknown = Diagnostic::error(format!("there is no truth `{truth}`"))
                .at(&self.place(after), "unknown truth");
            return Err(unknown.with_suggestion(truth, super::TRUTHS.iter().copied()));
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

/// Ranges of single numbers or unit vectors, by their paths.
struct Collected<'a> {
    leaves: Vec<(Kind, Range, usize)>,
    entries: Vec<(usize, &'a Entry, String)>,
    paths: Vec<String>,
}

impl Declared {
    /// The domain for a function of this name.
    ///
    /// # Errors
    /// Where an argument has no range, an entry is of no argument, or a range does not suit.
    pub fn domain(
        &self,
        all: &[Declared],
        function: &Function,
        host: &Host,
    ) -> Result<Domain, Report> {
        let mut collected = Collected {
            leaves: Vec::new(),
            entries: Vec::new(),
            paths: Vec::new(),
        };
        for (name, shape) in function.arguments() {
            self.collect(name, shape, None, all, &mut collected)?;
        }
        for entry in &self.entries {
            let known = collected
                .entries
                .iter()
                .any(|(_, e, _)| std::ptr::eq(*e, entry));
            if !known {
                let wrong = Diagnostic::error(format!(
                    "`{}` takes no `{}`, or it is said twice",
                    self.name, entry.path
                ));
                return Err(wrong.at(&entry.place, "not an argument").into());
            }
        }
        let mut domain = Domain::of_leaves(&collected.leaves).ok_or_else(|| {
            Diagnostic::error(format!(
                "the domain of `{}` does not suit its arguments",
                self.name
            ))
            .at(&self.place, "")
        })?;
        for (leaf, entry, prefix) in &collected.entries {
            let Some(near) = &entry.near else { continue };
            let place = place_of(near, prefix, &collected.paths, host).map_err(|name| {
                Diagnostic::error(format!("`{name}` is neither an argument nor a host value"))
                    .at(&entry.place, "named here")
            })?;
            let relation = Relation {
                leaf: *leaf,
                share: 0.375,
                place,
            };
            domain = domain.with(relation).ok_or_else(|| {
                Diagnostic::error("`near` is for single numbers").at(&entry.place, "not one")
            })?;
        }
        Ok(domain)
    }

    /// `prefix`: the path of the structure whose declaration speaks, none for the function's own.
    fn collect<'a>(
        &'a self,
        path: &str,
        shape: &Shape,
        outer: Option<(&'a Declared, &str)>,
        all: &'a [Declared],
        into: &mut Collected<'a>,
    ) -> Result<(), Report> {
        let own = self
            .entries
            .iter()
            .find(|e| e.path == path)
            .map(|e| (e, ""));
        let inherited = || {
            let (declared, prefix) = outer?;
            let member = path.strip_prefix(prefix)?.strip_prefix('.')?;
            let entry = declared.entries.iter().find(|e| e.path == member)?;
            Some((entry, prefix))
        };
        if let Some((entry, prefix)) = own.or_else(inherited) {
            return into.add(path, shape, entry, prefix);
        }
        match shape {
            Shape::Scalar(Kind::Bool) => {
                into.paths.push(path.to_owned());
                into.leaves.push((Kind::Bool, Range::Whole(0, 1), 1));
                Ok(())
            }
            Shape::Struct { name, members } => {
                let declared = all.iter().find(|d| d.name == *name);
                let outer = declared.map(|d| (d, path)).or(outer);
                for (member, shape) in members {
                    self.collect(&format!("{path}.{member}"), shape, outer, all, into)?;
                }
                Ok(())
            }
            _ => Err(Diagnostic::error(format!(
                "the domain of `{}` says nothing of `{path}`",
                self.name
            ))
            .at(&self.place, "a range is missing")
            .into()),
        }
    }
}

impl<'a> Collected<'a> {
    fn add(
        &mut self,
        path: &str,
        shape: &Shape,
        entry: &'a Entry,
        prefix: &str,
    ) -> Result<(), Report> {
        let wrong = |what: &str| -> Report {
            let message = format!("`{path}` is {shape}: {what}");
            Diagnostic::error(message)
                .at(&entry.place, "this range")
                .into()
        };
        self.entries
            .push((self.paths.len(), entry, prefix.to_owned()));
        let leaves = shape.leaves();
        for (index, (leaf, kind)) in leaves.iter().enumerate() {
            self.paths.push(format!("{path}{leaf}"));
            let float = *kind == Kind::Float;
            let mut count = 1;
            let range = match &entry.range {
                Written::Unit if float && matches!(shape, Shape::Vector { .. }) => {
                    count = if index == 0 { leaves.len() } else { 0 };
                    Range::Unit
                }
                Written::Unit => return Err(wrong("only vectors of `f32` can be unit vectors")),
                Written::Fixed(values) => match (values.len() == leaves.len(), float) {
                    (true, true) => Range::Linear(values[index] as f32, values[index] as f32),
                    (true, false) => Range::Whole(values[index] as i64, values[index] as i64),
                    _ => return Err(wrong("as many values are wanted as it has numbers")),
                },
                Written::Numbers { least, most, scale } => {
                    let (low, high) = (*least as f32, *most as f32);
                    match scale {
                        _ if !float => Range::Whole(*least as i64, *most as i64),
                        Scale::Bits => Range::Bits(low, high),
                        Scale::Linear => Range::Linear(low, high),
                        Scale::Log => Range::Log(low, high),
                        Scale::From(least) => Range::Coordinate(low, high, *least as f32),
                    }
                }
            };
            self.leaves.push((*kind, range, count));
        }
        Ok(())
    }
}

/// The place that a product stands for, or the name in it that nothing has.
fn place_of(
    factors: &[Factor],
    prefix: &str,
    paths: &[String],
    host: &Host,
) -> Result<Box<crate::Place>, String> {
    enum Part {
        Number(f64),
        Leaf(usize),
        Sine(usize, usize),
    }
    let index = |name: &str| {
        let full = match prefix {
            "" => name.to_owned(),
            prefix => format!("{prefix}.{name}"),
        };
        paths
            .iter()
            .position(|p| *p == full)
            .ok_or_else(|| name.to_owned())
    };
    let mut parts = Vec::new();
    for factor in factors {
        let part = match &factor.of {
            Operand::Number(number) => Part::Number(*number),
            Operand::Sine(a, b) => Part::Sine(index(&format!("{a}.x"))?, index(&format!("{b}.x"))?),
            Operand::Value(name) => match (index(name), host.number(name)) {
                (Ok(leaf), _) => Part::Leaf(leaf),
                (_, Some(number)) => Part::Number(number),
                (Err(name), None) => return Err(name),
            },
        };
        parts.push((part, factor.inverse));
    }
    Ok(Box::new(move |numbers: &[f64]| {
        let value = |part: &Part| match part {
            Part::Number(number) => *number,
            Part::Leaf(leaf) => numbers[*leaf],
            Part::Sine(a, b) => {
                let (a, b) = (&numbers[*a..a + 3], &numbers[*b..b + 3]);
                let cross = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
                (cross(1, 2).powi(2) + cross(2, 0).powi(2) + cross(0, 1).powi(2)).sqrt()
            }
        };
        parts
            .iter()
            .fold(1.0, |product, (part, inverse)| match inverse {
                true => product / value(part),
                false => product * value(part),
            })
    }))
}

/// The ranges of all entries, by path; what a page tells of a function.
impl std::fmt::Display for Declared {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.place.text())
    }
}
