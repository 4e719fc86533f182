//! What is known of a scene, camera and moment.

use std::collections::BTreeSet;

use meniscus_shader::Library;
use meniscus_source::ron::Spanned;
use meniscus_source::{Diagnostic, Report};

/// Facts that `when` rules may refer to, with what they mean.
pub const KNOWN: &[(&str, &str)] = &[
    ("waves", "the water's slopes are not all zero"),
    (
        "displaced",
        "rays meet the waves themselves, not the rest plane",
    ),
    ("camera_submerged", "the eye is under the water"),
];

/// Whether the `when` lines of a library's slots name known facts.
pub fn check_facts(library: &Library) -> Report {
    let mut report = Report::default();
    for module in library.modules() {
        for fact in module.header.when.iter().flat_map(|when| &when.facts) {
            if !KNOWN.iter().any(|(known, _)| *known == fact.text) {
                let unknown = Diagnostic::error(format!("there is no fact `{}`", fact.text));
                report.add(
                    unknown
                        .at(&fact.place, "unknown fact: this line never holds")
                        .with_suggestion(&fact.text, KNOWN.iter().map(|(known, _)| *known)),
                );
            }
        }
    }
    report
}

/// The facts that hold.
#[derive(Debug, Clone, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Facts(BTreeSet<&'static str>);

impl Facts {
    /// Those of the named facts that are known ones.
    pub fn new<'a>(names: impl IntoIterator<Item = &'a str>) -> Self {
        let names: BTreeSet<&str> = names.into_iter().collect();
        Self(
            KNOWN
                .iter()
                .map(|(name, _)| *name)
                .filter(|name| names.contains(name))
                .collect(),
        )
    }

    /// Every combination of facts that a scene can have.
    pub fn all() -> Vec<Self> {
        let mut all = Vec::new();
        for water in [&[][..], &["waves"], &["waves", "displaced"]] {
            for camera in [&[][..], &["camera_submerged"]] {
                all.push(Self::new(water.iter().chain(camera).copied()));
            }
        }
        all
    }

    /// The names.
    pub fn names(&self) -> BTreeSet<String> {
        self.0.iter().map(|name| (*name).to_owned()).collect()
    }

    /// Whether a rule holds: facts joined by `and`, each with or without `not` before it.
    ///
    /// # Errors
    /// When the rule names an unknown fact.
    pub fn hold(&self, rule: &Spanned<String>) -> Result<bool, Report> {
        let mut all = true;
        for part in rule.value.split(" and ") {
            let part = part.trim();
            let (wanted, name) = match part.strip_prefix("not ") {
                Some(name) => (false, name.trim()),
                None => (true, part),
            };
            if !KNOWN.iter().any(|(known, _)| *known == name) {
                let mut unknown = Diagnostic::error(format!("there is no fact `{name}`"));
                if let Some(place) = &rule.place {
                    unknown = unknown.at(place, "unknown fact");
                }
                return Err(unknown
                    .with_suggestion(name, KNOWN.iter().map(|(known, _)| *known))
                    .into());
            }
            all &= self.0.contains(name) == wanted;
        }
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use meniscus_source::SourceFile;

    use super::*;

    #[test]
    fn rules_hold_exactly_when_all_their_parts_do() {
        let facts = Facts::new(["waves", "nonsense"]);
        let hold = |rule: &str| facts.hold(&Spanned::unplaced(rule.to_owned()));
        assert_eq!(hold("waves"), Ok(true));
        assert_eq!(hold("waves and not displaced"), Ok(true));
        assert_eq!(hold("not waves"), Ok(false));
        assert_eq!(hold("waves and displaced"), Ok(false));
        assert!(
            hold("wafes")
                .unwrap_err()
                .to_string()
                .contains("did you mean `waves`?")
        );
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
}
