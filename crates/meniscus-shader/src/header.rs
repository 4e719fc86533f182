//! The leading comment of a module: words for people, and the lines that the composer reads.
//!
//! ```text
//! // One sentence of purpose.
//! // …
//! // provides: intersect
//! // needs: geometry/ray, screen/seen
//! // slots: step: intersect, reproject
//! // requires: reproject = screen/plain
//! // number taps: 1 to 8 px, step 1
//! // number tilt: 0 to 2 rad, live
//! // domain: …
//! // identity when not waves: within 0.1 px
//! // appears: on its vertical
//! ```

mod lines;

use std::ops::Range;
use std::sync::Arc;

use lines::{Line, leading_lines, list, number, one, part, sentence, within_px};
use meniscus_source::{Diagnostic, Place, Report, SourceFile};

/// What a module says of itself.
#[derive(Debug, Clone, Default)]
pub struct Header {
    /// The first sentence: what it is for.
    pub purpose: String,
    /// The slot it fills.
    pub provides: Option<Name>,
    /// Modules whose declarations it uses.
    pub needs: Vec<Name>,
    /// The slots it calls.
    pub slots: Vec<SlotUse>,
    /// Fillings of other slots without which it is not valid.
    pub requires: Vec<Requirement>,
    /// Its numbers.
    pub numbers: Vec<Number>,
    /// The input ranges in which its functions promise their accuracy.
    pub domain: Vec<String>,
    /// For a skeleton: the kind of pass it is the body of.
    pub skeleton: Option<Name>,
    /// For a skeleton: the outputs it can write.
    pub outputs: Vec<Name>,
    /// For a drawing skeleton: varyings that belong to the triangle's first vertex.
    pub flat: Vec<Name>,
    /// For a compute skeleton: threads of a workgroup.
    pub workgroup: Vec<u32>,
    /// For a slot: fillings that facts choose where a pipeline does not.
    pub when: Vec<When>,
    /// When it changes nothing: a pass whose fillings all say so shows what it was given to look at.
    pub identity: Option<Identity>,
    /// Where the points that it moves appear; for a drawing skeleton also `as SLOT says`.
    pub appears: Option<Name>,
}

/// A name and where it stands.
#[derive(Debug, Clone, PartialEq)]
pub struct Name {
    /// The name.
    pub text: String,
    /// Where.
    pub place: Place,
}

/// A slot that a module calls: by its own name, or by a name of the module's.
#[derive(Debug, Clone, PartialEq)]
pub struct SlotUse {
    /// The name that the module calls it by.
    pub name: Name,
    /// The slot whose signature it has.
    pub slot: Name,
}

/// `requires: SLOT = MODULE`
#[derive(Debug, Clone, PartialEq)]
pub struct Requirement {
    /// The slot.
    pub slot: Name,
    /// The module that must fill it.
    pub module: Name,
}

/// A number that a pipeline may set.
#[derive(Debug, Clone, PartialEq)]
pub struct Number {
    /// The `override`'s name.
    pub name: Name,
    /// Smallest value.
    pub least: f64,
    /// Largest value.
    pub most: f64,
    /// Distance of neighbouring values in an editor; 0 for none.
    pub step: f64,
    /// Unit, empty for none.
    pub unit: String,
    /// Whether it may change while a plan runs, without a new pipeline.
    pub live: bool,
}

/// `when FACT and FACT: MODULE`
#[derive(Debug, Clone, PartialEq)]
pub struct When {
    /// Facts that must hold.
    pub facts: Vec<Name>,
    /// The module that fills the slot then.
    pub module: Name,
}

/// `identity when RULE: exactly` or `identity when RULE: within NUMBER px`
#[derive(Debug, Clone, PartialEq)]
pub struct Identity {
    /// The rule on facts.
    pub rule: Name,
    /// By how much of a pixel, at most, what is shown moves all the same.
    pub within_px: f64,
}

impl Header {
    /// Reads the leading comment. Mistakes in the machine-read lines are added to the report.
    pub fn read(file: &Arc<SourceFile>, report: &mut Report) -> (Self, Range<usize>) {
        let mut header = Self::default();
        let mut end = 0;
        let mut first = String::new();
        for line in leading_lines(&file.text) {
            end = line.start + line.text.len();
            if header.purpose.is_empty() {
                let text = line.text.trim();
                match text.is_empty() {
                    true => header.purpose = std::mem::take(&mut first),
                    false => {
                        let space = if first.is_empty() { "" } else { " " };
                        first = format!("{first}{space}{text}");
                        header.purpose = sentence(&first).unwrap_or_default().to_owned();
                    }
                }
            }
            if let Err(diagnostic) = header.read_line(file, &line) {
                report.add(diagnostic);
            }
        }
        if header.purpose.is_empty() {
            header.purpose = first;
        }
        (header, 0..end)
    }

    fn read_line(&mut self, file: &Arc<SourceFile>, line: &Line) -> Result<(), Diagnostic> {
        let Some((key, value)) = line.text.split_once(':') else {
            return Ok(());
        };
        let start = line.start + key.len() + 1;
        let names = || list(file, value, start);
        let first = || one(file, value, start);
        let (word, rest) = key.trim().split_once(' ').unwrap_or((key.trim(), ""));
        let rest_start = line.start + key.trim_end().len() - rest.len();
        match (word, rest.is_empty()) {
            ("provides", true) => self.provides = Some(first()?),
            ("skeleton", true) => self.skeleton = Some(first()?),
            ("needs", true) => self.needs.extend(names()),
            ("outputs", true) => self.outputs.extend(names()),
            ("flat", true) => self.flat.extend(names()),
            ("slots", true) => {
                self.slots.extend(
                    names()
                        .into_iter()
                        .map(|name| match name.text.split_once(':') {
                            Some((own, slot)) => SlotUse {
                                slot: part(file, slot, name.place.range.start + own.len() + 1),
                                name: part(file, own, name.place.range.start),
                            },
                            None => SlotUse {
                                slot: name.clone(),
                                name,
                            },
                        }),
                )
            }
            ("requires", true) => {
                for name in names() {
                    let (slot, module) = name.text.split_once('=').ok_or_else(|| {
                        Diagnostic::error("`requires` wants SLOT = MODULE")
                            .at(&name.place, "no `=` here")
                    })?;
                    let at = name.place.range.start;
                    self.requires.push(Requirement {
                        slot: part(file, slot, at),
                        module: part(file, module, at + slot.len() + 1),
                    });
                }
            }
            ("workgroup", true) => {
                for name in names() {
                    let threads = name.text.parse().ok().filter(|n| (1..=256).contains(n));
                    self.workgroup.push(threads.ok_or_else(|| {
                        Diagnostic::error("a workgroup has 1 to 256 threads along each axis")
                            .at(&name.place, "not such a number")
                    })?);
                }
            }
            ("appears", true) => self.appears = Some(first()?),
            ("domain", true) => self.domain.push(value.trim().to_owned()),
            ("number", false) => {
                let name = part(file, rest, rest_start);
                self.numbers.push(number(name, &one(file, value, start)?)?);
            }
            ("when", false) => {
                let mut facts = Vec::new();
                let mut at = rest_start;
                for fact in rest.split(" and ") {
                    facts.push(part(file, fact, at));
                    at += fact.len() + " and ".len();
                }
                self.when.push(When {
                    facts,
                    module: first()?,
                });
            }
            ("identity", false) => {
                let Some(rule) = rest.strip_prefix("when ") else {
                    return Ok(());
                };
                self.identity = Some(Identity {
                    rule: part(file, rule, rest_start + "when ".len()),
                    within_px: within_px(&first()?)?,
                });
            }
            // Anything else with a colon is prose.
            _ => {}
        }
        Ok(())
    }

    /// The number of this name.
    pub fn number(&self, name: &str) -> Option<&Number> {
        self.numbers.iter().find(|number| number.name.text == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_identity_has_a_rule_and_a_bound() {
        let read = |said: &str| {
            let file = SourceFile::new("a.wgsl", format!("// A.\n//\n// identity {said}\n"));
            let mut report = Report::default();
            let (header, _) = Header::read(&file, &mut report);
            let identity = header.identity.map(|i| (i.rule.text, i.within_px));
            (identity, report.to_string())
        };
        let rule = |text: &str, px| Some((text.to_owned(), px));
        assert_eq!(
            read("when not waves: within 0.25 px").0,
            rule("not waves", 0.25)
        );
        assert_eq!(
            read("when not waves or x: exactly").0,
            rule("not waves or x", 0.0)
        );
        for wrong in [
            "nearly",
            "within px",
            "within 2 px",
            "within NaN px",
            "within -1 px",
        ] {
            let (identity, said) = read(&format!("when not waves: {wrong}"));
            assert!(identity.is_none() && said.contains("a.wgsl:3:"), "{said}");
        }
        // Words about identities are words.
        assert_eq!(read("of the cut: none"), (None, String::new()));
    }

    #[test]
    fn the_purpose_is_the_first_sentence() {
        for (comment, purpose) in [
            ("// One line.\n//\n// provides: x\n", "One line."),
            ("// Over two\n// lines. And more.\n", "Over two lines."),
            ("// Lies in 0.5 to 1. `x`: an input.\n", "Lies in 0.5 to 1."),
            ("// After eq. 3 of it. World space.\n", "After eq. 3 of it."),
            ("// No stop\n//\n// needs: a/b\n", "No stop"),
            ("// No stop", "No stop"),
            ("fn f() {}", ""),
        ] {
            assert_eq!(read(comment).0.purpose, purpose);
        }
    }

    fn read(text: &str) -> (Header, Report) {
        let mut report = Report::default();
        let (header, _) = Header::read(&SourceFile::new("m.wgsl", text), &mut report);
        (header, report)
    }

    #[test]
    fn machine_read_lines_are_understood_with_their_places() {
        let (header, report) = read(
            "// Keeps the best tap.\r\n// Prose: with a colon.\n//\n// provides: intersect\n// needs: a/b, c/d\n\
             // slots: step: intersect, reproject\n// requires: reproject = screen/plain\n\
             // number bound_px: 0 to 64 px, step 0.05\n// number r: 0 to 1\n// when waves and displaced: water/marched\nfn f() {}",
        );
        assert!(report.0.is_empty(), "{report}");
        assert_eq!(header.purpose, "Keeps the best tap.");
        assert_eq!(header.provides.unwrap().place.text(), "intersect");
        assert_eq!(header.needs[1].place.text(), "c/d");
        assert_eq!(header.slots[0].name.place.text(), "step");
        assert_eq!(header.slots[0].slot.place.text(), "intersect");
        assert_eq!(header.slots[1].name.text, "reproject");
        assert_eq!(header.requires[0].module.place.text(), "screen/plain");
        let number = &header.numbers[0];
        assert_eq!(
            (number.least, number.most, number.step, number.unit.as_str()),
            (0.0, 64.0, 0.05, "px")
        );
        assert_eq!(number.name.place.text(), "bound_px");
        assert_eq!(header.numbers[1].name.place.to_string(), "m.wgsl:9:11");
        assert_eq!(header.when[0].facts[1].place.text(), "displaced");
    }

    #[test]
    fn wrong_lines_are_reported_where_they_stand() {
        for (line, words) in [
            ("// provides:", "nothing follows"),
            ("// requires: reproject", "SLOT = MODULE"),
            ("// number taps: one to 3", "no least"),
            ("// number taps: 1 up 3", "no `to`"),
            ("// number taps: 4 to 3", "no most"),
            ("// number taps: 0 to 1e999", "no most"),
            ("// workgroup: 0", "1 to 256"),
        ] {
            let (_, report) = read(&format!("// P.\n{line}\n"));
            let text = report.to_string();
            assert!(
                text.contains(words) && text.contains("m.wgsl:2:"),
                "{line}: {text}"
            );
        }
    }
}
