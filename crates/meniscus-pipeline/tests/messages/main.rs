//! Mistakes in pipeline files: the place, the words and the way to mend each.

mod changes;
#[path = "../common/mod.rs"]
mod common;
mod passes;
mod texts;

use common::plan;

pub(crate) fn told(name: &str, text: &str, place: &str, words: &str, hint: &str) {
    let report = plan(text).map(|_| ()).unwrap_err().to_string();
    for wanted in [place, words, hint] {
        assert!(
            report.contains(wanted),
            "{name}: no `{wanted}` in\n{report}"
        );
    }
    assert!(
        !report.contains("File`"),
        "{name}: a name of the program's own in\n{report}"
    );
    insta::assert_snapshot!(name, report);
}

/// Keeps a whole text, in one folder for all parts of this test.
pub(crate) fn keep(name: &str, text: &str) {
    insta::assert_snapshot!(name, text);
}
