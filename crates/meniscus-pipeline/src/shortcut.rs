//! Shorter ways to the same picture, and when they may be taken.

use std::collections::BTreeMap;

use meniscus_shader::{Filling, Library};
use meniscus_source::ron::Spanned;
use meniscus_source::{Diagnostic, Report};

use crate::facts::{Facts, rule_of};
use crate::file::ShortcutFile;
use crate::pipeline::Pipeline;

/// Passes that run instead of others where certain fillings of those change nothing.
///
/// A filling changes nothing where its module's header says so (`identity when …: within … px`),
/// and the headers of all modules within it do.
#[derive(Debug, Clone, PartialEq)]
pub struct Shortcut {
    /// Its name.
    pub name: Spanned<String>,
    /// The passes that it stands for.
    pub instead_of: Vec<Spanned<String>>,
    /// Slots, as PASS.SLOT, of which the fillings have to change nothing.
    pub identity: Vec<Spanned<String>>,
    /// Slots with the modules that have to fill them.
    pub filled: Vec<(Spanned<String>, Spanned<String>)>,
}

/// Whether a shortcut is taken.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Taken {
    /// What is shown moves by no more than so many pixels; and the facts that make it so.
    Yes { within_px: f64, because: String },
    /// Why not.
    No(String),
}

impl Shortcut {
    pub(crate) fn new(file: ShortcutFile) -> (Self, Vec<crate::file::Step>) {
        let shortcut = Self {
            name: file.name,
            instead_of: file.instead_of,
            identity: file.identity,
            filled: file.filled.0,
        };
        (shortcut, file.sequence)
    }

    /// Whether it refers to a pass.
    pub(crate) fn refers_to(&self, pass: &str) -> bool {
        let slots = self.identity.iter().chain(self.filled.iter().map(|f| &f.0));
        self.instead_of.iter().any(|name| name.value == pass)
            || slots
                .filter_map(|slot| slot.value.split_once('.'))
                .any(|(name, _)| name == pass)
    }

    /// Whether what it refers to is there.
    pub(crate) fn check(&self, pipeline: &Pipeline, report: &mut Report) {
        if self.instead_of.is_empty() {
            let nothing = Diagnostic::error(format!("`{}` stands for no pass", self.name.value));
            report.add(placed(nothing, &self.name, "instead of nothing"));
        }
        let own = |name: &str| {
            let pass = pipeline.passes.iter().find(|p| p.name.value == name);
            pass.filter(|pass| pass.shortcut.is_none())
        };
        let names = || {
            let passes = pipeline.passes.iter().filter(|p| p.shortcut.is_none());
            passes.map(|pass| pass.name.value.as_str())
        };
        for name in &self.instead_of {
            if own(&name.value).is_none() {
                let unknown = Diagnostic::error(format!("there is no pass `{}`", name.value));
                report.add(
                    placed(unknown, name, "unknown pass").with_suggestion(&name.value, names()),
                );
            }
        }
        for slot in self.identity.iter().chain(self.filled.iter().map(|f| &f.0)) {
            let Some((name, rest)) = slot.value.split_once('.') else {
                let wrong = Diagnostic::error(format!("`{}` names no slot of a pass", slot.value));
                report.add(placed(wrong, slot, "").with_help("write PASS.SLOT"));
                continue;
            };
            match own(name) {
                None => {
                    let unknown = Diagnostic::error(format!("there is no pass `{name}`"));
                    report
                        .add(placed(unknown, slot, "unknown pass").with_suggestion(name, names()));
                }
                Some(pass) if find(&pass.slots, rest).is_none() => {
                    let unknown = Diagnostic::error(format!("nothing fills `{rest}` in `{name}`"));
                    let filled = pass.slots.keys().map(String::as_str);
                    report.add(placed(unknown, slot, "unfilled").with_suggestion(rest, filled));
                }
                Some(_) => {}
            }
        }
    }

    /// Whether it may be taken under facts.
    ///
    /// # Errors
    /// When a module's rule names an unknown fact.
    pub(crate) fn taken(
        &self,
        pipeline: &Pipeline,
        library: &Library,
        facts: &Facts,
    ) -> Result<Taken, Report> {
        let filling = |key: &Spanned<String>| {
            let (name, slot) = key.value.split_once('.')?;
            let pass = pipeline.passes.iter().find(|p| p.name.value == name)?;
            find(&pass.slots, slot)
        };
        for (key, module) in &self.filled {
            let found = filling(key).map_or("left open", |f| f.module.value.as_str());
            if found != module.value {
                let why = format!("`{}` is {found}, not {}", key.value, module.value);
                return Ok(Taken::No(why));
            }
        }
        let mut within_px = 0.0;
        let mut because: Vec<String> = Vec::new();
        for key in &self.identity {
            let Some(filling) = filling(key) else {
                return Ok(Taken::No(format!("`{}` is left open", key.value)));
            };
            let mut most: f64 = 0.0;
            if let Some(why) = changes(filling, library, facts, &mut most, &mut because)? {
                return Ok(Taken::No(format!(
                    "`{}` may change something: {why}",
                    key.value
                )));
            }
            within_px += most;
        }
        Ok(Taken::Yes {
            within_px: decimal(within_px),
            because: because.join(", "),
        })
    }
}

/// A sum of decimal fractions without the last bits that it has in binary.
pub(crate) fn decimal(sum: f64) -> f64 {
    (sum * 1e6).round() / 1e6
}

/// Why a filling may change something; none where it does not. `most`: the largest bound of the
/// modules within it. `because`: their rules.
fn changes(
    filling: &Filling,
    library: &Library,
    facts: &Facts,
    most: &mut f64,
    because: &mut Vec<String>,
) -> Result<Option<String>, Report> {
    let path = &filling.module.value;
    let said = library.get(path).and_then(|m| m.header.identity.as_ref());
    let Some(identity) = said else {
        return Ok(Some(format!("{path} does not say when it is the identity")));
    };
    let rule = rule_of(&identity.rule);
    if !facts.hold(&rule)? {
        return Ok(Some(format!(
            "{path} is the identity when {}",
            identity.rule.text
        )));
    }
    *most = most.max(identity.within_px);
    let parts = match rule.value.contains(" or ") {
        true => vec![rule.value.as_str()],
        false => rule.value.split(" and ").map(str::trim).collect(),
    };
    for fact in parts {
        if !because.iter().any(|known| known == fact) {
            because.push(fact.to_owned());
        }
    }
    for inner in filling.slots.values() {
        if let Some(why) = changes(inner, library, facts, most, because)? {
            return Ok(Some(why));
        }
    }
    Ok(None)
}

/// The filling at a path of slots.
fn find<'f>(slots: &'f BTreeMap<String, Filling>, path: &str) -> Option<&'f Filling> {
    match path.split_once('.') {
        None => slots.get(path),
        Some((first, rest)) => find(&slots.get(first)?.slots, rest),
    }
}

fn placed(diagnostic: Diagnostic, at: &Spanned<String>, words: &str) -> Diagnostic {
    match &at.place {
        Some(place) => diagnostic.at(place, words),
        None => diagnostic,
    }
}
