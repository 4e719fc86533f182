//! What is said to hold of a scene, where commands need no scene.

use clap::Args;
use meniscus::pipeline::{Facts, KNOWN_FACTS};
use meniscus::source::{Diagnostic, Report};

#[derive(Debug, Args)]
pub(crate) struct Moment {
    /// What holds of the scene: `waves`, `displaced`, `camera_submerged`, joined by commas.
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
            if !KNOWN_FACTS.iter().any(|(known, _)| known == fact) {
                let known = KNOWN_FACTS.iter().map(|(known, _)| *known);
                let unknown = Diagnostic::error(format!("`--facts {fact}`: there is no such fact"));
                report.add(unknown.with_suggestion(fact, known));
            }
        }
        report.into_result(Facts::new(self.facts.iter().map(String::as_str)))
    }
}
