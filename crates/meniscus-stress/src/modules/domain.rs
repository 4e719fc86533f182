//! From what headers declare to the domain of a function: ranges for single numbers, places that
//! some of them are drawn close to.

use meniscus_source::{Diagnostic, Report};

use super::declared::{Declared, Entry, Factor, Operand, Scale, Written};
use super::host::Host;
use crate::{Domain, Function, Kind, Range, Relation, Shape};

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
            self.collect(name, shape, None, (all, host), &mut collected)?;
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
        (all, host): (&'a [Declared], &Host),
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
            return into.add(path, shape, entry, prefix, host);
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
                    self.collect(&format!("{path}.{member}"), shape, outer, (all, host), into)?;
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
        host: &Host,
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
                Written::Seen(depths) if float && leaves.len() == 3 => {
                    count = if index == 0 { leaves.len() } else { 0 };
                    let Some(picture) = host.picture("view_target", *depths) else {
                        return Err(wrong("the host says nothing of `view_target`"));
                    };
                    Range::Seen(picture)
                }
                Written::Seen(_) => return Err(wrong("only points can be seen")),
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
