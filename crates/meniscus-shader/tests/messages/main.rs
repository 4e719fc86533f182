//! One mistake of every kind: the place, the words and the way to mend it.

#[path = "../common/mod.rs"]
mod common;
mod modules;
mod recipes;
mod structure;

use common::{composer, library, number, plain};
use meniscus_shader::{Filling, Recipe};
use meniscus_source::Report;

/// Asserts that a report says what it must, and keeps its whole text.
pub(crate) fn told(name: &str, report: &Report, place: &str, words: &str, hint: &str) {
    let text = report.to_string();
    assert!(text.contains(place), "{name}: no `{place}` in\n{text}");
    assert!(text.contains(words), "{name}: no `{words}` in\n{text}");
    assert!(text.contains(hint), "{name}: no `{hint}` in\n{text}");
    for internal in ["shader.wgsl", "PassVarying", "<unnamed", "wgsl:1:0"] {
        assert!(!text.contains(internal), "{name}: `{internal}` in\n{text}");
    }
    insta::assert_snapshot!(name, text);
}

/// What is wrong with a module's header or outline.
pub(crate) fn header(name: &str, path: &str, text: &str, place: &str, words: &str, hint: &str) {
    let (_, report) = library(&[(path, text)]);
    told(name, &report, place, words, hint);
}

/// What is wrong with a module by itself.
pub(crate) fn module(name: &str, path: &str, text: &str, place: &str, words: &str, hint: &str) {
    let (composer, headers) = library(&[(path, text)]);
    assert!(headers.0.is_empty(), "{name}: {headers}");
    told(name, &composer.check_module(path), place, words, hint);
}

/// What is wrong with a recipe.
pub(crate) fn recipe_fault(
    name: &str,
    more: &[(&str, &str)],
    recipe: &Recipe,
    place: &str,
    words: &str,
    hint: &str,
) {
    let report = composer(more).compose(recipe).unwrap_err();
    told(name, &report, place, words, hint);
}

pub(crate) fn numbered(path: &str, name: &str, value: f64) -> Filling {
    let mut filling = plain(path);
    filling.numbers.insert(name.into(), number(value));
    filling
}
