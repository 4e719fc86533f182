//! Messages with places, and how they are printed.

use std::sync::Arc;

use codespan_reporting::diagnostic as codespan;
use codespan_reporting::files::SimpleFiles;
use codespan_reporting::term;

use crate::{Place, SourceFile};

/// How much a message matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Works, but is likely not meant.
    Warning,
    /// Does not work.
    Error,
}

/// A place and what is to be said about it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Label {
    /// Where.
    pub place: Place,
    /// What is there; may be empty.
    pub message: String,
    /// Whether this is the place of the mistake; otherwise it helps to understand.
    pub primary: bool,
}

/// One message: what is wrong, where, and how to mend it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    /// How much it matters.
    pub severity: Severity,
    /// What is wrong.
    pub message: String,
    /// Where; the first primary label is the place of the mistake.
    pub labels: Vec<Label>,
    /// How to mend it.
    pub help: Vec<String>,
}

impl Diagnostic {
    /// An error without a place yet.
    pub fn error(message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Error,
            message: message.into(),
            labels: Vec::new(),
            help: Vec::new(),
        }
    }

    /// A warning without a place yet.
    pub fn warning(message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Warning,
            ..Self::error(message)
        }
    }

    /// Adds the place of the mistake.
    #[must_use]
    pub fn at(mut self, place: &Place, message: impl Into<String>) -> Self {
        self.labels.push(Label {
            place: place.clone(),
            message: message.into(),
            primary: true,
        });
        self
    }

    /// Adds a place that helps to understand.
    #[must_use]
    pub fn see(mut self, place: &Place, message: impl Into<String>) -> Self {
        self.labels.push(Label {
            place: place.clone(),
            message: message.into(),
            primary: false,
        });
        self
    }

    /// Adds a way to mend it.
    #[must_use]
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help.push(help.into());
        self
    }

    /// Adds "did you mean …" if there is a near name, else the names that exist.
    #[must_use]
    pub fn with_suggestion<'a>(
        self,
        name: &str,
        candidates: impl IntoIterator<Item = &'a str>,
    ) -> Self {
        let candidates: Vec<&str> = candidates.into_iter().collect();
        match crate::did_you_mean(name, candidates.iter().copied()) {
            Some(near) => self.with_help(format!("did you mean `{near}`?")),
            None if candidates.is_empty() => self,
            None => {
                let shown: Vec<String> = candidates
                    .iter()
                    .take(24)
                    .map(|c| format!("`{c}`"))
                    .collect();
                let more = if candidates.len() > 24 { ", …" } else { "" };
                self.with_help(format!("there is {}{more}", shown.join(", ")))
            }
        }
    }

    /// Renders the message with its source lines, without colour.
    pub fn render(&self) -> String {
        let mut files = SimpleFiles::new();
        let mut known: Vec<Arc<SourceFile>> = Vec::new();
        let labels = self
            .labels
            .iter()
            .map(|label| {
                let file = &label.place.file;
                let id = match known.iter().position(|k| k == file) {
                    Some(id) => id,
                    None => {
                        known.push(file.clone());
                        files.add(file.name.clone(), file.text.clone())
                    }
                };
                let style = if label.primary {
                    codespan::LabelStyle::Primary
                } else {
                    codespan::LabelStyle::Secondary
                };
                let end = label.place.range.end.min(file.text.len());
                let start = label.place.range.start.min(end);
                codespan::Label::new(style, id, start..end).with_message(label.message.clone())
            })
            .collect();
        let severity = match self.severity {
            Severity::Warning => codespan::Severity::Warning,
            Severity::Error => codespan::Severity::Error,
        };
        let message = codespan::Diagnostic::new(severity)
            .with_message(self.message.clone())
            .with_labels(labels)
            .with_notes(
                self.help
                    .iter()
                    .map(|help| format!("help: {help}"))
                    .collect(),
            );
        term::emit_into_string(&term::Config::default(), &files, &message)
            // Only a range outside its file could fail, and those are clamped above.
            .unwrap_or_else(|_| format!("error: {}\n", self.message))
    }
}

/// The most messages that are shown at once: nobody reads more, and each shows its lines.
const MAX_SHOWN: usize = 50;

/// Messages of one undertaking, all of them rather than the first.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Report(pub Vec<Diagnostic>);

impl Report {
    /// Whether nothing is wrong; warnings do not count.
    pub fn is_ok(&self) -> bool {
        self.0.iter().all(|d| d.severity < Severity::Error)
    }

    /// Adds a message unless the same one is there already.
    pub fn add(&mut self, diagnostic: Diagnostic) {
        if !self.0.contains(&diagnostic) {
            self.0.push(diagnostic);
        }
    }

    /// Adds another report's messages.
    pub fn extend(&mut self, other: Report) {
        for diagnostic in other.0 {
            self.add(diagnostic);
        }
    }

    /// `value`, or this report if something is wrong.
    ///
    /// # Errors
    /// When the report holds an error.
    pub fn into_result<T>(self, value: T) -> Result<T, Report> {
        if self.is_ok() { Ok(value) } else { Err(self) }
    }
}

impl From<Diagnostic> for Report {
    fn from(diagnostic: Diagnostic) -> Self {
        Self(vec![diagnostic])
    }
}

impl std::fmt::Display for Report {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (index, diagnostic) in self.0.iter().enumerate() {
            if index == MAX_SHOWN {
                return writeln!(f, "\n… and {} more", self.0.len() - MAX_SHOWN);
            }
            if index > 0 {
                writeln!(f)?;
            }
            writeln!(f, "{}", diagnostic.render().trim_end())?;
        }
        Ok(())
    }
}

impl std::error::Error for Report {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rendered_message_names_place_fault_and_remedy() {
        let file = SourceFile::new("pool.ron", "Scene(\n  watr: 1,\n)");
        let text = Diagnostic::error("unknown field `watr`")
            .at(&Place::new(&file, 9..13), "not a field of Scene")
            .with_suggestion("watr", ["water", "camera"])
            .render();
        assert!(text.contains("pool.ron:2:3"), "{text}");
        assert!(text.contains("not a field of Scene"), "{text}");
        assert!(text.contains("did you mean `water`?"), "{text}");
    }

    #[test]
    fn a_range_outside_the_file_is_clamped() {
        let file = SourceFile::new("a", "é");
        let text = Diagnostic::error("x")
            .at(&Place::new(&file, 7..900), "y")
            .render();
        assert!(text.contains("a:1:"), "{text}");
    }
}
