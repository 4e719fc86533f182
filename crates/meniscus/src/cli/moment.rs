//! What is said to hold of a scene, where commands need no scene.

use clap::Args;
use meniscus::pipeline::{Facts, KNOWN_FACTS};
use meniscus::source::{Diagnostic, Report};

#[derive(Debug, Args)]
pub(crate) struct Moment {
    /// What holds of the scene: `waves`, `displaced`, `camera_submerged`, joined by commas; or, with
    /// `not ` before it, does not: `not water_visible`, `not near_visible`, `not far_visible`.
    #[arg(
        long,
        value_name = "FACT,FACT",
        value_delimiter = ',',
        default_value = "waves,displaced"
    )]
    facts: Vec<String>,
}

impl Moment {
    /// The facts.
    ///
    /// # Errors
    /// When one is unknown.
    pub fn facts(&self) -> Result<Facts, Report> {
        let mut report = Report::default();
        // `--facts ''` says that nothing holds.
        for fact in self.facts.iter().filter(|fact| !fact.is_empty()) {
            let name = fact.strip_prefix("not ").unwrap_or(fact);
            if !KNOWN_FACTS.iter().any(|(known, _)| *known == name) {
                let known = KNOWN_FACTS.iter().map(|(known, _)| *known);
                let unknown = Diagnostic::error(format!("`--facts {fact}`: there is no such fact"));
                report.add(unknown.with_suggestion(name, known));
            }
        }
        report.into_result(Facts::new(self.facts.iter().map(String::as_str)))
    }
}
