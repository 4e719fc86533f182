//! naga's messages, at the places and in the words of what was written.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use meniscus_source::{Diagnostic, Report};

use crate::lexer::Kind;
use crate::library::{Library, Module};
use crate::text::Written;

/// An error and what caused it, in one line.
pub(crate) fn chain_of(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut source = error.source();
    while let Some(cause) = source {
        text.push_str(": ");
        text.push_str(&cause.to_string());
        source = cause.source();
    }
    text
}

/// A message of naga, at the places and in the words of what was written.
pub(crate) fn explain(
    written: &Written,
    library: &Library,
    message: &str,
    labels: Vec<(Option<Range<usize>>, String)>,
    notes: &[String],
) -> Report {
    let say = |text: &str| plain(&restore(text, &written.originals));
    let message = message.replace("found \"\"", "found the end");
    let mut diagnostic = Diagnostic::error(say(&message));
    let mut unplaced = Vec::new();
    let mut first = None;
    let mut labels = labels;
    // The narrowest place says most; of what surrounds it naga names no more than the kind.
    labels.sort_by_key(|(range, _)| range.as_ref().map_or(usize::MAX, |r| r.len()));
    for (range, words) in labels {
        let Some(range) = range else { continue };
        let words = if words.starts_with("naga::") {
            String::new()
        } else {
            words
        };
        if words.is_empty() && first.is_some() {
            continue;
        }
        match written.source.origin(range.clone()) {
            Some(place) if first.is_none() => {
                first = Some(place.clone());
                diagnostic = diagnostic.at(&place, say(&words));
            }
            Some(place) => diagnostic = diagnostic.see(&place, say(&words)),
            None => unplaced.push(written.source.text.get(range).unwrap_or("").to_owned()),
        }
    }
    if first.is_none() {
        // Only what is written for a skeleton has no place of its own.
        if let Some(skeleton) = &written.skeleton {
            diagnostic = diagnostic.at(skeleton, "in the entry points written for this skeleton");
        }
        for text in &unplaced {
            diagnostic = diagnostic.with_help(format!("it shows at `{}`", one_line(&say(text))));
        }
    }
    if message.contains("found the end") {
        diagnostic = diagnostic.with_help("a bracket that is opened before is never closed");
    }
    for note in notes {
        diagnostic = diagnostic.with_help(say(note));
    }
    if let Some(place) = &first {
        let word = place.text().to_owned();
        let owners: Vec<_> = library
            .modules()
            .filter(|m| m.role() == crate::Role::Shared && m.item(&word).is_some())
            .filter(|m| m.file != place.file)
            .map(|m| format!("`{}`", m.path))
            .collect();
        if message.contains("no definition in scope") {
            let user = library.modules().find(|m| m.file == place.file);
            diagnostic = match user {
                _ if !owners.is_empty() => diagnostic.with_help(format!(
                    "{} declares `{word}`: add it to `// needs: …` in {}",
                    owners.join(" or "),
                    place.file.name
                )),
                _ if library.slot(&word).is_some() => diagnostic.with_help(format!(
                    "`{word}` is a slot: add it to `// slots: …` in {}",
                    place.file.name
                )),
                Some(user) => match meniscus_source::did_you_mean(&word, visible(library, user)) {
                    Some(near) => diagnostic.with_help(format!("did you mean `{near}`?")),
                    None => diagnostic.with_help(format!(
                        "declare `{word}` here or in a module that this one needs"
                    )),
                },
                None => diagnostic,
            };
        }
        let asked = written
            .modules
            .iter()
            .filter(|(path, _)| library.get(path).is_some_and(|m| m.file == place.file))
            .find_map(|(_, asked)| asked.as_ref());
        if let Some(asked) = asked {
            diagnostic = diagnostic.see(asked, "the module is used here");
        }
    }
    diagnostic.into()
}

/// Puts the names that were written in the place of those of the composed text.
fn restore(text: &str, originals: &BTreeMap<String, String>) -> String {
    let mut restored = String::new();
    let mut at = 0;
    for token in crate::lexer::tokens(text) {
        if token.kind != Kind::Word {
            continue;
        }
        if let Some(original) = originals.get(&text[token.range.clone()]) {
            restored.push_str(&text[at..token.range.start]);
            restored.push_str(original);
            at = token.range.end;
        }
    }
    restored.push_str(&text[at..]);
    restored
}

/// Names that a module may use: its own, those of what it needs, and those of the slots it calls.
fn visible<'l>(library: &'l Library, module: &'l Module) -> BTreeSet<&'l str> {
    let closure = library.closure(module);
    let items = closure
        .iter()
        .flat_map(|m| m.outline.items.iter().map(|item| item.name.as_str()));
    let locals = module
        .outline
        .items
        .iter()
        .flat_map(|item| module.outline.locals(&module.file.text, item));
    let slots = module
        .header
        .slots
        .iter()
        .map(|used| used.name.text.as_str());
    items.chain(locals).chain(slots).collect()
}

/// A text on one line, cut where it becomes long.
fn one_line(text: &str) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    match line.char_indices().nth(80) {
        Some((end, _)) => format!("{} …", &line[..end]),
        None => line,
    }
}

/// Without naga's handles: `Expression [12] is invalid` becomes `Expression is invalid`.
fn plain(text: &str) -> String {
    let mut kept = String::with_capacity(text.len());
    let text = text
        .replace(" Some([", " [")
        .replace("]) ", "] ")
        .replace("])", "]");
    let mut rest = text.as_str();
    while let Some(start) = rest.find(" [") {
        let digits = rest[start + 2..]
            .find(|c: char| !c.is_ascii_digit())
            .unwrap_or(0);
        let handle = digits > 0 && rest[start + 2 + digits..].starts_with(']');
        let end = if handle {
            start + 2 + digits + 1
        } else {
            start + 2
        };
        kept.push_str(&rest[..if handle { start } else { end }]);
        rest = &rest[end..];
    }
    kept.push_str(rest);
    kept
}

#[cfg(test)]
mod tests {
    use super::plain;

    #[test]
    fn handles_are_left_out_and_the_rest_stays() {
        assert_eq!(
            plain("Function [3] 'f': Expression [12] is bad"),
            "Function 'f': Expression is bad"
        );
        assert_eq!(
            plain("expression Some([1]) is not Some([2])"),
            "expression is not"
        );
        assert_eq!(
            plain("a [b] array<f32, 3> [1 [12"),
            "a [b] array<f32, 3> [1 [12"
        );
    }
}
