//! Which passes of a pipeline run, as far as facts alone decide.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use meniscus_shader::Library;
use meniscus_source::{Diagnostic, Report};

use crate::facts::Facts;
use crate::file::Over;
use crate::pipeline::{Pass, PassOver, Pipeline};
use crate::plan::{Geometry, Pruning};
use crate::rules::{Dropped, Rule};
use crate::shortcut::{Taken, decimal};

/// What is decided of a pipeline's passes, before anything is composed.
#[derive(Debug, Default)]
pub(crate) struct Choice<'p> {
    /// Passes in order; those of shortcuts that are not taken are not among them.
    pub passes: Vec<(Cow<'p, Pass>, Option<Dropped>)>,
    /// Shortcuts that are taken, by the passes that they stand for.
    pub replaced: BTreeMap<&'p str, &'p str>,
    /// Why others are not.
    pub not_taken: BTreeMap<String, String>,
    /// By how many pixels what is shown may move, with all of them taken.
    pub within_px: f64,
}

/// Decides on passes. `barred`: shortcuts that cannot be taken, and why.
///
/// # Errors
/// When a rule names an unknown fact, or a pass is like one that is not there.
pub(crate) fn choose<'p>(
    pipeline: &'p Pipeline,
    library: &Library,
    facts: &Facts,
    pruning: Pruning,
    barred: &BTreeMap<String, String>,
) -> Result<Choice<'p>, Report> {
    let mut report = Report::default();
    let mut choice = Choice::default();
    let mut taken = BTreeSet::new();
    let mut stands_for: BTreeMap<&str, Dropped> = BTreeMap::new();
    for (name, shortcut) in &pipeline.shortcuts {
        let verdict = match (pruning, barred.get(name)) {
            (Pruning::None, _) => Taken::No("nothing is left out".into()),
            (_, Some(why)) => Taken::No(why.clone()),
            _ => shortcut.taken(pipeline, library, facts)?,
        };
        match verdict {
            Taken::No(why) => drop(choice.not_taken.insert(name.clone(), why)),
            Taken::Yes { within_px, .. } if pruning == Pruning::Exact && within_px > 0.0 => {
                let why = format!("it holds within {within_px} px, and no bit may change");
                choice.not_taken.insert(name.clone(), why);
            }
            Taken::Yes { within_px, because } => {
                taken.insert(name.as_str());
                // One may move what the other has moved already.
                choice.within_px = decimal(choice.within_px + within_px);
                for pass in &shortcut.instead_of {
                    let because = format!("{because}; `{name}` runs instead");
                    let mut dropped = Dropped::exactly(&pass.value, Rule::Shortcut, because);
                    dropped.within_px = within_px;
                    stands_for.insert(&pass.value, dropped);
                    choice.replaced.insert(&pass.value, name);
                }
            }
        }
    }
    for pass in &pipeline.passes {
        if pass.shortcut.as_deref().is_some_and(|s| !taken.contains(s)) {
            continue;
        }
        let name = pass.name.value.as_str();
        let when = pass.when.as_ref().map(|rule| (rule, facts.hold(rule)));
        let dropped = match when {
            Some((_, Err(unknown))) => {
                report.extend(unknown);
                continue;
            }
            Some((rule, Ok(false))) => {
                let because = format!("`{}` does not hold", rule.value);
                Some(Dropped::exactly(name, Rule::When, because))
            }
            _ if pruning == Pruning::None => None,
            _ => stands_for
                .get(name)
                .cloned()
                .or_else(|| unseen(pass, facts)),
        };
        match pipeline.resolved(pass, library) {
            Ok(pass) => choice.passes.push((pass, dropped)),
            Err(unknown) => report.add(unknown),
        }
    }
    report.into_result(choice)
}

/// Why nothing that a pass draws is seen; none where something may be.
fn unseen(pass: &Pass, facts: &Facts) -> Option<Dropped> {
    let name = &pass.name.value;
    let (near, far) = (facts.has("near_visible"), facts.has("far_visible"));
    let side = |because: &str| Some(Dropped::exactly(name, Rule::UnseenSide, because));
    match &pass.over {
        PassOver::Draw(Geometry::NearSide) if !near => side("not near_visible"),
        PassOver::Draw(Geometry::FarSide) if !far => side("not far_visible"),
        PassOver::Draw(Geometry::All) if !near && !far => {
            side("not near_visible and not far_visible")
        }
        PassOver::Screen(Over::Water, _) if !facts.has("water_visible") => {
            Some(Dropped::exactly(name, Rule::NoWater, "not water_visible"))
        }
        PassOver::Screen(Over::Dry, _) if !facts.has("dry_visible") => {
            Some(Dropped::exactly(name, Rule::AllWater, "not dry_visible"))
        }
        _ => None,
    }
}

impl Pipeline {
    /// A pass with what it takes over from those that it is like: the fillings, numbers and
    /// connections of the first; of the next, fillings that its skeleton asks for and which are open.
    ///
    /// # Errors
    /// When there is no such pass.
    pub(crate) fn resolved<'p>(
        &'p self,
        pass: &'p Pass,
        library: &Library,
    ) -> Result<Cow<'p, Pass>, Diagnostic> {
        if pass.like.is_empty() {
            return Ok(Cow::Borrowed(pass));
        }
        let mut resolved = pass.clone();
        for like in &pass.like {
            let other = self.passes.iter().find(|p| p.name.value == like.value);
            let Some(other) = other.filter(|other| other.like.is_empty()) else {
                let wrong = format!("there is no pass `{}` to be like", like.value);
                let wrong = Diagnostic::error(wrong);
                return Err(match &like.place {
                    Some(place) => wrong.at(place, "unknown, or like another itself"),
                    None => wrong,
                });
            };
            let first = like == &pass.like[0];
            let called = |slot: &str| {
                let skeleton = library.get(&pass.skeleton.value);
                skeleton.is_some_and(|s| s.header.slots.iter().any(|used| used.name.text == slot))
            };
            for (slot, filling) in other.slots.iter().filter(|(s, _)| first || called(s)) {
                let slots = &mut resolved.slots;
                slots.entry(slot.clone()).or_insert_with(|| filling.clone());
            }
            // Numbers and connections belong to a skeleton, which is that of the first.
            if first {
                for (name, number) in &other.numbers {
                    let numbers = &mut resolved.numbers;
                    numbers
                        .entry(name.clone())
                        .or_insert_with(|| number.clone());
                }
                for (variable, resource) in &other.reads {
                    let reads = &mut resolved.reads;
                    reads
                        .entry(variable.clone())
                        .or_insert_with(|| resource.clone());
                }
            }
        }
        Ok(Cow::Owned(resolved))
    }
}
