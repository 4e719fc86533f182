//! What is known of a scene, camera and moment, as far as plans depend on it.

use std::collections::BTreeSet;
use std::fmt;

use meniscus_shader::{Library, Name};
use meniscus_source::ron::Spanned;
use meniscus_source::{Diagnostic, Report};

use crate::cull;

/// Facts that `when` rules may refer to, with what they mean. Those of what is seen are careful:
/// they hold unless it is certain that they do not.
pub const KNOWN: &[(&str, &str)] = &[
    ("waves", "the water's slopes are not all zero"),
    (
        "displaced",
        "rays meet the waves themselves, not the rest plane",
    ),
    (
        "many_waves",
        "the water has more waves than its uniform block holds",
    ),
    ("camera_submerged", "the eye is under the water"),
    ("water_visible", "some pixel may show water"),
    ("dry_visible", "some pixel cannot show water"),
    (
        "near_visible",
        "something on the camera's side of the water may be seen",
    ),
    (
        "far_visible",
        "something on the other side of the water may be seen",
    ),
    (
        "fine_edges",
        "the eye is far enough from the water for edges behind it to be drawn within a tenth of a pixel",
    ),
];

/// Facts that hold where nothing is said.
const GENERAL: &[&str] = &[
    "water_visible",
    "dry_visible",
    "near_visible",
    "far_visible",
    "fine_edges",
];

/// Facts without which a plan would do no more, and nothing else.
const UNKNOWN: &[&str] = &[
    "waves",
    "water_visible",
    "dry_visible",
    "near_visible",
    "far_visible",
];

/// The facts that hold: a plan's key.
///
/// A copy of a few bits. By default everything may be seen, through flat water, from above it.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Facts(u32);

impl Default for Facts {
    fn default() -> Self {
        Self(bits(GENERAL))
    }
}

impl fmt::Debug for Facts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_set().entries(self.held()).finish()
    }
}

/// The bit of a fact; 0 of an unknown one.
const fn bit(name: &str) -> u32 {
    let mut index = 0;
    while index < KNOWN.len() {
        if equal(KNOWN[index].0.as_bytes(), name.as_bytes()) {
            return 1 << index;
        }
        index += 1;
    }
    0
}

const fn equal(a: &[u8], b: &[u8]) -> bool {
    if a.len() != b.len() {
        return false;
    }
    let mut index = 0;
    while index < a.len() {
        if a[index] != b[index] {
            return false;
        }
        index += 1;
    }
    true
}

const fn bits(names: &[&str]) -> u32 {
    let (mut all, mut index) = (0, 0);
    while index < names.len() {
        all |= bit(names[index]);
        index += 1;
    }
    all
}

impl Facts {
    /// The default with some facts said to hold or, with `not ` before them, not to hold. Unknown
    /// ones say nothing.
    pub fn new<'a>(said: impl IntoIterator<Item = &'a str>) -> Self {
        said.into_iter()
            .fold(Self::default(), |facts, said| match negated(said) {
                Some(name) => facts.with(name, false),
                None => facts.with(said.trim(), true),
            })
    }

    /// The same with a fact that holds or does not. An unknown one changes nothing.
    #[must_use]
    pub const fn with(self, name: &str, holds: bool) -> Self {
        match holds {
            true => Self(self.0 | bit(name)),
            false => Self(self.0 & !bit(name)),
        }
    }

    /// Whether a fact holds; an unknown one does not.
    pub const fn has(self, name: &str) -> bool {
        self.0 & bit(name) != 0
    }

    /// The same where only that is known which a picture cannot do without: all that may be seen is
    /// taken to be seen, and the water to have waves.
    #[must_use]
    pub const fn unpruned(self) -> Self {
        Self(self.0 | bits(UNKNOWN))
    }

    /// Every combination of facts on which shaders depend; with everything in view.
    pub fn all() -> Vec<Self> {
        let mut all = Vec::new();
        let many = &["waves", "displaced", "many_waves"];
        for water in [&[][..], &["waves"], &["waves", "displaced"], many] {
            for camera in [&[][..], &["camera_submerged"]] {
                all.push(Self::new(water.iter().chain(camera).copied()));
            }
        }
        all
    }

    /// The names of those that hold, in the order of [`KNOWN`].
    pub fn held(self) -> impl Iterator<Item = &'static str> {
        let names = KNOWN.iter().map(|(name, _)| *name);
        names.filter(move |name| self.has(name))
    }

    /// The names.
    pub fn names(&self) -> BTreeSet<String> {
        self.held().map(str::to_owned).collect()
    }

    /// Whether a rule holds: facts joined by `and`, each with or without `not` before it; such
    /// groups joined by `or`, of which one has to hold.
    ///
    /// # Errors
    /// When the rule names an unknown fact.
    pub fn hold(&self, rule: &Spanned<String>) -> Result<bool, Report> {
        let mut any = false;
        for group in rule.value.split(" or ") {
            let mut all = true;
            for part in group.split(" and ") {
                let (wanted, name) = match negated(part) {
                    Some(name) => (false, name),
                    None => (true, part.trim()),
                };
                if bit(name) == 0 {
                    return Err(unknown(rule, name).into());
                }
                all &= self.has(name) == wanted;
            }
            any |= all;
        }
        Ok(any)
    }
}

/// The fact that is said not to hold.
fn negated(said: &str) -> Option<&str> {
    said.trim().strip_prefix("not ").map(str::trim)
}

fn unknown(rule: &Spanned<String>, name: &str) -> Diagnostic {
    let mut unknown = Diagnostic::error(format!("there is no fact `{name}`"));
    if let Some(place) = &rule.place {
        unknown = unknown.at(place, "unknown fact");
    }
    unknown.with_suggestion(name, KNOWN.iter().map(|(known, _)| *known))
}

/// Whether the `when` lines of a library's slots, and the `identity` lines of its modules, name known
/// facts, and whether the `appears` lines say something known.
pub fn check_facts(library: &Library) -> Report {
    let mut report = Report::default();
    for module in library.modules() {
        for fact in module.header.when.iter().flat_map(|when| &when.facts) {
            if bit(&fact.text) == 0 {
                let unknown = Diagnostic::error(format!("there is no fact `{}`", fact.text));
                report.add(
                    unknown
                        .at(&fact.place, "unknown fact: this line never holds")
                        .with_suggestion(&fact.text, KNOWN.iter().map(|(known, _)| *known)),
                );
            }
        }
        if let Some(identity) = &module.header.identity
            && let Err(unknown) = Facts::default().hold(&rule_of(&identity.rule))
        {
            report.extend(unknown);
        }
        if let Some(said) = &module.header.appears
            && let Err(wrong) = cull::check(library, said)
        {
            report.add(wrong);
        }
    }
    report
}

/// A rule that stands in a module's header.
pub(crate) fn rule_of(name: &Name) -> Spanned<String> {
    Spanned {
        value: name.text.clone(),
        place: Some(name.place.clone()),
    }
}

#[cfg(test)]
mod tests {
    use meniscus_source::SourceFile;

    use super::*;

    #[test]
    fn rules_hold_exactly_when_all_parts_of_a_group_do() {
        let facts = Facts::new(["waves", "nonsense", "not near_visible"]);
        let hold = |rule: &str| facts.hold(&Spanned::unplaced(rule.to_owned()));
        for (rule, holds) in [
            ("waves", true),
            ("waves and not displaced", true),
            ("not waves", false),
            ("waves and displaced", false),
            ("near_visible", false),
            ("far_visible", true),
            ("waves and displaced or far_visible", true),
            ("displaced or near_visible and waves", false),
        ] {
            assert_eq!(hold(rule), Ok(holds), "{rule}");
        }
        for wrong in ["wafes", "waves or wafes", "not wafes and displaced"] {
            let said = hold(wrong).unwrap_err().to_string();
            assert!(said.contains("did you mean `waves`?"), "{said}");
        }
    }

    #[test]
    fn every_fact_has_a_bit_of_its_own() {
        let all = KNOWN.iter().map(|(name, _)| bit(name));
        assert_eq!(all.fold(0, |sum, bit| sum | bit).count_ones(), 9);
        for names in [GENERAL, UNKNOWN] {
            assert_eq!(bits(names).count_ones() as usize, names.len());
        }
    }

    #[test]
    fn what_is_not_pruned_keeps_what_pictures_depend_on() {
        for facts in Facts::all() {
            let hidden = facts.with("water_visible", false).with("waves", false);
            assert_eq!(hidden.unpruned(), facts.with("waves", true), "{facts:?}");
        }
    }

    #[test]
    fn a_slot_that_asks_for_an_unknown_fact_is_told_where() {
        let read = |when: &str| {
            let text = format!(
                "// Light.\n//\n// when {when}: a/b\n\nfn light() -> f32 {{\n    return 1.0;\n}}\n"
            );
            let file = SourceFile::new("slots/light.wgsl", text);
            let (library, _) = Library::new([("slots/light", file)]);
            check_facts(&library)
        };
        assert_eq!(read("waves and displaced"), Report::default());
        for (wrong, place) in [
            ("waves and displased", "light.wgsl:3:19"),
            ("wafes", "light.wgsl:3:9"),
        ] {
            let said = read(wrong).to_string();
            assert!(
                said.contains(place) && said.contains("did you mean"),
                "{said}"
            );
        }
        assert!(!read("not waves").is_ok());
    }

    #[test]
    fn a_module_that_is_the_identity_under_an_unknown_fact_is_told_where() {
        let text = "// A.\n//\n// provides: light\n// identity when not wafes: exactly\n\nfn light() -> f32 {\n    return 1.0;\n}\n";
        let slot = "// Light.\n\nfn light() -> f32 {\n    return 0.0;\n}\n";
        let file = |name: &str, text: &str| SourceFile::new(name, text.to_owned());
        let (library, _) = Library::new([
            ("slots/light", file("slots/light.wgsl", slot)),
            ("a/lamp", file("a/lamp.wgsl", text)),
        ]);
        let said = check_facts(&library).to_string();
        assert!(
            said.contains("lamp.wgsl:4:") && said.contains("did you mean `waves`?"),
            "{said}"
        );
    }
}
