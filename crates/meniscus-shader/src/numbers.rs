//! Numbers that a pipeline may set: `override`s; constants, which sizes of arrays can be made of; and
//! live ones, which change while a plan runs.

use std::collections::BTreeMap;
use std::ops::Range;

use meniscus_source::ron::Spanned;
use meniscus_source::{Diagnostic, Report};

use crate::header::Number;
use crate::lexer::Kind;
use crate::library::{Module, Role};
use crate::outline::{Item, ItemKind};

/// The variable that holds a shader's live numbers, a read-only storage buffer: no uniform block,
/// since a fourth of those in one shader crashes a driver.
pub const LIVE_NUMBERS: &str = "live_numbers";
/// Its type.
pub(crate) const LIVE_TYPE: &str = "LiveNumbers";

impl Module {
    /// The numbers that a pipeline may set.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = &Item> {
        let settable = |item: &&Item| match item.kind {
            ItemKind::Override { .. } => true,
            ItemKind::Constant { .. } => self.header.number(&item.name).is_some(),
            _ => false,
        };
        self.outline.items.iter().filter(settable)
    }

    /// What the header says of a live number; none for others.
    pub(crate) fn live(&self, item: &Item) -> Option<&Number> {
        let number = self.header.number(&item.name)?;
        (number.live && matches!(item.kind, ItemKind::Override { .. })).then_some(number)
    }

    /// Where a declaration's value stands, and the value if it is a plain number.
    pub(crate) fn value(&self, item: &Item) -> Option<(Range<usize>, Option<f64>)> {
        let text = &self.file.text;
        let tokens = &self.outline.tokens[item.tokens.clone()];
        let equals = tokens.iter().position(|t| t.kind == Kind::Mark('='))?;
        let value = tokens.get(equals + 1..tokens.len().checked_sub(1)?)?;
        let range = value.first()?.range.start..value.last()?.range.end;
        let (sign, digits) = match value {
            [digits] => (1.0, digits),
            [minus, digits] if minus.kind == Kind::Mark('-') => (-1.0, digits),
            _ => return Some((range, None)),
        };
        let digits = &text[digits.range.clone()];
        let number = digits.trim_end_matches(['f', 'h', 'u', 'i']).parse::<f64>();
        let number = number.ok().filter(|n| n.is_finite());
        Some((range, number.map(|n| sign * n)))
    }

    /// Checks what the header says of numbers against the declarations.
    pub(crate) fn check_declared_numbers(&self, report: &mut Report) {
        for number in &self.header.numbers {
            let name = &number.name.text;
            let Some(item) = self.numbers().find(|item| item.name == *name) else {
                let declared = self.numbers().map(|item| item.name.as_str());
                report.add(
                    Diagnostic::error(format!("`{}` declares no `override {name}`", self.path))
                        .at(&number.name.place, "a range for a number that is not there")
                        .with_suggestion(name, declared),
                );
                continue;
            };
            let wrong = match (&item.kind, number.live) {
                (ItemKind::Constant { .. }, true) => Some((
                    "is a constant, which cannot change while a plan runs",
                    "declare it with `override`, or leave `live` out",
                )),
                (ItemKind::Constant { .. }, _) if self.role() != Role::Filling => Some((
                    "is a constant, and only those of fillings can be set",
                    "declare it with `override`",
                )),
                (ItemKind::Constant { ty }, _) if ty.is_empty() => {
                    Some(("has no type", "write the type: `const NAME: i32 = …;`"))
                }
                (ItemKind::Override { .. }, true) => self.wrong_live(item),
                _ => None,
            };
            if let Some((what, help)) = wrong {
                report.add(
                    Diagnostic::error(format!("`{name}` of `{}` {what}", self.path))
                        .at(&self.place(item.name_range.clone()), "declared here")
                        .see(&number.name.place, "a number that can be set")
                        .with_help(help),
                );
            }
        }
    }

    /// What is wrong with the declaration of a live number, and how to mend it.
    fn wrong_live(&self, item: &Item) -> Option<(&'static str, &'static str)> {
        let ItemKind::Override { ty } = &item.kind else {
            return None;
        };
        if !matches!(ty.as_str(), "f32" | "i32" | "u32") {
            return Some((
                "is live, so it needs a type that a buffer can hold",
                "write `override NAME: f32 = …;`, or i32 or u32",
            ));
        }
        if self.value(item).and_then(|(_, value)| value).is_none() {
            return Some((
                "is live, so its default must be a plain number",
                "write for example `= 0.25;`",
            ));
        }
        let hidden = |other: &Item| {
            let mut locals = self.outline.locals(&self.file.text, other);
            locals.any(|local| local == item.name)
        };
        self.functions().any(hidden).then_some((
            "is live, and a local variable or a parameter has the same name",
            "rename one of them",
        ))
    }
}

/// A value as WGSL writes it for a type.
pub(crate) fn literal(ty: &str, value: f64) -> String {
    match ty {
        "bool" => (value != 0.0).to_string(),
        "i32" | "u32" => format!("{value:.0}"),
        _ => format!("{value:?}"),
    }
}

/// The values that a number of a type can have.
fn range_of_type(ty: &str) -> (f64, f64) {
    match ty {
        "bool" => (0.0, 1.0),
        "i32" => (f64::from(i32::MIN), f64::from(i32::MAX)),
        "u32" => (0.0, f64::from(u32::MAX)),
        _ => (f64::from(f32::MIN), f64::from(f32::MAX)),
    }
}

/// What a number's value is held against.
pub(crate) struct Bounds<'n> {
    pub name: &'n str,
    pub module: &'n str,
    pub ty: &'n str,
    pub least: f64,
    pub most: f64,
    pub unit: &'n str,
}

impl<'n> Bounds<'n> {
    pub fn of(module: &'n Module, item: &'n Item) -> Self {
        let ty = match &item.kind {
            ItemKind::Override { ty } | ItemKind::Constant { ty } => ty.as_str(),
            _ => "",
        };
        let (low, high) = range_of_type(ty);
        let number = module.header.number(&item.name);
        Self {
            name: &item.name,
            module: &module.path,
            ty,
            least: number.map_or(low, |n| n.least.max(low)),
            most: number.map_or(high, |n| n.most.min(high)),
            unit: number.map_or("", |n| &n.unit),
        }
    }

    /// What is wrong with a value, and what to say at its place.
    pub fn check(&self, value: f64) -> Result<(), (String, String)> {
        let Self {
            name,
            module,
            least,
            most,
            ..
        } = self;
        if !(*least..=*most).contains(&value) {
            let space = if self.unit.is_empty() { "" } else { " " };
            let unit = self.unit;
            return Err((
                format!("`{name}` of `{module}` goes from {least} to {most}{space}{unit}"),
                format!("{value} is outside"),
            ));
        }
        if matches!(self.ty, "i32" | "u32") && value.fract() != 0.0 {
            return Err((
                format!("`{name}` of `{module}` is a whole number"),
                format!("{value} is none"),
            ));
        }
        Ok(())
    }
}

/// Numbers must be declared by their module, lie in its range, and fit their type.
pub(crate) fn check_numbers(module: &Module, numbers: &BTreeMap<String, Spanned<f64>>) -> Report {
    let mut report = Report::default();
    for (name, value) in numbers {
        let mut wrong = |diagnostic: Diagnostic, words: &str| {
            report.add(match &value.place {
                Some(place) => diagnostic.at(place, words),
                None => diagnostic,
            });
        };
        let mut slots = module.header.slots.iter();
        if slots.any(|slot| slot.name.text == *name) {
            let message = format!("the slot `{name}` wants a module");
            wrong(Diagnostic::error(message), "a number");
            continue;
        }
        let Some(item) = module.numbers().find(|item| item.name == *name) else {
            let known = module.numbers().map(|item| item.name.as_str());
            let unknown = Diagnostic::error(format!("`{}` has no number `{name}`", module.path))
                .with_suggestion(name, known);
            wrong(unknown, "unknown number");
            continue;
        };
        if let Err((message, words)) = Bounds::of(module, item).check(value.value) {
            wrong(Diagnostic::error(message), &words);
        }
    }
    report
}
