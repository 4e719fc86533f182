//! How two pipelines differ, in words.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Display;

use meniscus_shader::Filling;
use meniscus_source::ron::Spanned;

use crate::pipeline::{Pass, Pipeline};
use crate::shortcut::Shortcut;

/// How `b` differs from `a`: a sentence a line, in the order of passes, then resources; none when
/// they do the same. Names and descriptions of the pipelines do not count.
pub fn diff(a: &Pipeline, b: &Pipeline) -> Vec<String> {
    let mut said = Vec::new();
    let find = |pipeline: &'_ Pipeline, name: &str| {
        pipeline.passes.iter().position(|p| p.name.value == name)
    };
    for pass in &a.passes {
        if find(b, &pass.name.value).is_none() {
            said.push(format!("the pass `{}` is left out", pass.name.value));
        }
    }
    for (at, pass) in b.passes.iter().enumerate() {
        match find(a, &pass.name.value) {
            Some(old) => passes(&a.passes[old], pass, &mut said),
            None => {
                let place = match at.checked_sub(1).map(|before| &b.passes[before].name.value) {
                    Some(before) => format!("behind `{before}`"),
                    None => "at the start".into(),
                };
                said.push(format!(
                    "the pass `{}` is added {place}, with `{}`",
                    pass.name.value, pass.skeleton.value
                ));
            }
        }
    }
    let order = |one: &Pipeline, other: &Pipeline| -> Vec<String> {
        let names = one.passes.iter().map(|p| p.name.value.clone());
        names.filter(|name| find(other, name).is_some()).collect()
    };
    let (old, new) = (order(a, b), order(b, a));
    if old != new {
        said.push(format!(
            "the passes run in the order {}, not {}",
            new.join(", "),
            old.join(", ")
        ));
    }
    entries(
        "the texture",
        &plain(&a.textures),
        &plain(&b.textures),
        &mut said,
    );
    entries(
        "the buffer",
        &plain(&a.buffers),
        &plain(&b.buffers),
        &mut said,
    );
    entries("the list of", &named(&a.lists), &named(&b.lists), &mut said);
    entries("the shortcut", &shortcuts(a), &shortcuts(b), &mut said);
    if a.output.value != b.output.value {
        said.push(format!(
            "`{}` comes out, not `{}`",
            b.output.value, a.output.value
        ));
    }
    said
}

fn plain<T: Display>(map: &BTreeMap<String, Spanned<T>>) -> BTreeMap<String, String> {
    map.iter()
        .map(|(name, value)| (name.clone(), value.value.to_string()))
        .collect()
}

/// Names that a map leads to, marked as such.
fn named(map: &BTreeMap<String, Spanned<String>>) -> BTreeMap<String, String> {
    map.iter()
        .map(|(key, value)| (key.clone(), format!("`{}`", value.value)))
        .collect()
}

/// What differs between two maps, called by `what` and the key.
fn entries(
    what: &str,
    a: &BTreeMap<String, String>,
    b: &BTreeMap<String, String>,
    said: &mut Vec<String>,
) {
    for key in a.keys().chain(b.keys()).collect::<BTreeSet<_>>() {
        match (a.get(key), b.get(key)) {
            (Some(old), Some(new)) if old != new => {
                said.push(format!("{what} `{key}` is {new}, not {old}"))
            }
            (Some(_), None) => said.push(format!("{what} `{key}` is gone")),
            (None, Some(new)) => said.push(format!("{what} `{key}` is {new}, and was not there")),
            _ => {}
        }
    }
}

/// What shortcuts stand for, and when, by their names.
fn shortcuts(pipeline: &Pipeline) -> BTreeMap<String, String> {
    let listed = |names: &[Spanned<String>]| -> String {
        let names: Vec<String> = names.iter().map(|n| format!("`{}`", n.value)).collect();
        names.join(", ")
    };
    let said = |(name, shortcut): (&String, &Shortcut)| {
        let filled = shortcut.filled.iter();
        let filled: Vec<String> = filled
            .map(|(slot, module)| format!("`{}` is `{}`", slot.value, module.value))
            .collect();
        let mut said = format!("instead of {}", listed(&shortcut.instead_of));
        if !shortcut.identity.is_empty() {
            said.push_str(&format!(
                " where {} change nothing",
                listed(&shortcut.identity)
            ));
        }
        if !filled.is_empty() {
            said.push_str(&format!(" and {}", filled.join(" and ")));
        }
        (name.clone(), said)
    };
    pipeline.shortcuts.iter().map(said).collect()
}

fn passes(a: &Pass, b: &Pass, said: &mut Vec<String>) {
    let name = &b.name.value;
    let mut differs = |what: &str, old: String, new: String| {
        if old != new {
            said.push(format!("in `{name}`, {what} is {new}, not {old}"));
        }
    };
    differs(
        "the skeleton",
        format!("`{}`", a.skeleton.value),
        format!("`{}`", b.skeleton.value),
    );
    let rule = |pass: &Pass| {
        pass.when
            .as_ref()
            .map_or("always".to_owned(), |when| format!("`{}`", when.value))
    };
    differs("the condition", rule(a), rule(b));
    differs("what it runs over", over(a), over(b));
    let like = |pass: &Pass| match pass.like.is_empty() {
        true => "nothing".to_owned(),
        false => {
            let names: Vec<String> = pass.like.iter().map(|n| format!("`{}`", n.value)).collect();
            names.join(", ")
        }
    };
    differs("what it is like", like(a), like(b));
    let (mut old, mut new) = (BTreeMap::new(), BTreeMap::new());
    fillings("", &a.slots, &mut old);
    fillings("", &b.slots, &mut new);
    entries(&format!("in `{name}`,"), &old, &new, said);
    entries(
        &format!("in `{name}`, the number"),
        &plain(&a.numbers),
        &plain(&b.numbers),
        said,
    );
    entries(
        &format!("in `{name}`, what is read as"),
        &named(&a.reads),
        &named(&b.reads),
        said,
    );
    let writes = |pass: &Pass| -> BTreeMap<String, String> {
        pass.writes
            .iter()
            .map(|(output, texture)| (output.value.clone(), format!("`{}`", texture.value)))
            .collect()
    };
    entries(
        &format!("in `{name}`, the target of"),
        &writes(a),
        &writes(b),
        said,
    );
}

/// What a pass runs over, without the places where that was written.
fn over(pass: &Pass) -> String {
    use crate::file::{Dispatch, Over};
    use crate::pipeline::PassOver;
    match &pass.over {
        PassOver::Draw(geometry) => format!("{geometry:?}"),
        PassOver::Screen(Over::List { pixels, arguments }, _) => {
            format!("the list `{}` by `{}`", pixels.value, arguments.value)
        }
        PassOver::Screen(over, runs) => format!("{over:?} ({runs:?})"),
        PassOver::Compute(Dispatch::Indirect(arguments)) => {
            format!("as much as `{}` says", arguments.value)
        }
        PassOver::Compute(dispatch) => format!("{dispatch:?}"),
    }
}

/// Modules, numbers and connections of fillings, by their paths.
fn fillings(path: &str, slots: &BTreeMap<String, Filling>, found: &mut BTreeMap<String, String>) {
    for (slot, filling) in slots {
        let path = if path.is_empty() {
            slot.clone()
        } else {
            format!("{path}.{slot}")
        };
        found.insert(path.clone(), format!("`{}`", filling.module.value));
        for (name, number) in &filling.numbers {
            found.insert(format!("{path}.{name}"), number.value.to_string());
        }
        for (variable, resource) in &filling.reads {
            found.insert(
                format!("{path}.reads.{variable}"),
                format!("`{}`", resource.value),
            );
        }
        fillings(&path, &filling.slots, found);
    }
}
