//! Entry points: written from a skeleton's signatures and what the pass writes.
//!
//! A drawing skeleton has `fn vertex(attributes…) -> V`, V having a member `clip: vec4f`, and
//! `fn fragment(v: V, …) -> S`; a screen skeleton has `fn screen(pixel: vec2f) -> S`. Both may have
//! `fn keep(s: S) -> bool`, `fn also(s: S)` for what they do besides, and for each output NAME
//! `fn write_NAME(s: S) -> T`. Only the outputs that a pass writes are called, so that what the
//! others read is pruned. A compute skeleton has `fn compute(thread: vec3u)` and writes what it
//! declares.

mod draw;
mod screen;

use std::fmt::Write as _;

use meniscus_source::{Diagnostic, Report};

use crate::compose::{Recipe, Stage};
use crate::library::Module;
use crate::outline::{Field, Item, ItemKind};
use crate::shader::{Attribute, Entry};
pub(crate) use draw::Drawing;

/// The output that says which points the others show.
const SHOWN: &str = "shown";

/// The written entry points.
pub(crate) struct Written {
    pub text: String,
    pub entry: Entry,
    pub attributes: Vec<Attribute>,
    pub outputs: Vec<String>,
    /// What writes them again, without what turns out to be read by nothing; for drawing skeletons.
    pub drawing: Option<Drawing>,
}

pub(crate) fn write(skeleton: &Module, recipe: &Recipe) -> Result<Written, Report> {
    let kind = skeleton
        .header
        .skeleton
        .as_ref()
        .map_or("", |k| k.text.as_str());
    match (kind, recipe.stage) {
        ("draw", Stage::Render) => draw::write(skeleton, recipe),
        ("screen", Stage::Render) => screen::render(skeleton, recipe),
        ("screen", Stage::Compute | Stage::List) => screen::compute(skeleton, recipe),
        ("compute", _) => compute(skeleton, recipe),
        ("draw", _) => Err(wrong(
            skeleton,
            "a drawing skeleton runs in no compute shader",
        )),
        _ => Err(wrong(
            skeleton,
            "a skeleton is `draw`, `screen` or `compute`",
        )),
    }
}

fn wrong(skeleton: &Module, what: &str) -> Report {
    let mut diagnostic = Diagnostic::error(format!("`{}`: {what}", skeleton.path));
    if let Some(kind) = &skeleton.header.skeleton {
        diagnostic = diagnostic.at(&kind.place, "");
    }
    diagnostic.into()
}

struct Signature<'m> {
    parameters: &'m [Field],
    result: &'m str,
    item: &'m Item,
}

fn function<'m>(skeleton: &'m Module, name: &str) -> Result<Signature<'m>, Report> {
    match skeleton.item(name) {
        Some(
            item @ Item {
                kind: ItemKind::Function { parameters, result },
                ..
            },
        ) => Ok(Signature {
            parameters,
            result,
            item,
        }),
        _ => {
            let report = wrong(skeleton, &format!("it has no function `{name}`"));
            let missing = report.0.into_iter().map(|d| match signature_of(name) {
                Some(signature) => d.with_help(format!("declare `{signature}`")),
                None => d,
            });
            Err(Report(missing.collect()))
        }
    }
}

/// How the function of a stage is declared.
fn signature_of(name: &str) -> Option<&'static str> {
    match name {
        "vertex" => Some("fn vertex(position: vec3f) -> Varying"),
        "fragment" => Some("fn fragment(v: Varying) -> State"),
        "screen" => Some("fn screen(pixel: vec2f) -> State"),
        "compute" => Some("fn compute(thread: vec3u)"),
        _ => None,
    }
}

/// A mistake in a function of the skeleton.
fn wrong_function(skeleton: &Module, signature: &Signature, what: String) -> Report {
    Diagnostic::error(format!("`{}`: {what}", skeleton.path))
        .at(&skeleton.place(signature.item.name_range.clone()), "")
        .into()
}

/// Checks that the function of a stage returns something, which `keep` and the outputs take.
fn check_state(skeleton: &Module, stage: &Signature, recipe: &Recipe) -> Result<(), Report> {
    let name = &stage.item.name;
    if stage.result.is_empty() {
        return Err(wrong_function(
            skeleton,
            stage,
            format!(
                "`{name}` must return what the outputs are made of: a value or a struct, which each `write_NAME` takes"
            ),
        ));
    }
    let mut report = Report::default();
    let outputs = recipe
        .outputs
        .iter()
        .map(|output| format!("write_{}", output.name.value));
    for function_name in outputs.chain(["keep".to_owned()]) {
        let Ok(signature) = function(skeleton, &function_name) else {
            continue;
        };
        if !matches!(signature.parameters, [state] if state.ty == stage.result) {
            report.extend(wrong_function(
                skeleton,
                &signature,
                format!(
                    "`{function_name}` takes what `{name}` returns: a `{}`",
                    stage.result
                ),
            ));
        }
        let wanted = if function_name == "keep" {
            signature.result == "bool"
        } else {
            !signature.result.is_empty()
        };
        if !wanted {
            let what = if function_name == "keep" {
                "a `bool`"
            } else {
                "what is written"
            };
            report.extend(wrong_function(
                skeleton,
                &signature,
                format!("`{function_name}` must return {what}"),
            ));
        }
    }
    report.into_result(())
}

/// The outputs' functions with their result types, in the order of the recipe.
fn outputs(skeleton: &Module, recipe: &Recipe) -> Result<Vec<(String, String)>, Report> {
    let mut report = Report::default();
    let mut found = Vec::new();
    for output in &recipe.outputs {
        let name = &output.name.value;
        let known = skeleton.header.outputs.iter().find(|o| o.text == *name);
        match (known, function(skeleton, &format!("write_{name}"))) {
            (Some(_), Ok(signature)) => found.push((name.clone(), signature.result.to_owned())),
            (Some(declared), Err(_)) => report.add(
                Diagnostic::error(format!(
                    "`{}` has no function `write_{name}`",
                    skeleton.path
                ))
                .at(&declared.place, "an output that nothing makes")
                .with_help(format!("declare `fn write_{name}(…) -> vec4f`")),
            ),
            _ => {
                let mut unknown =
                    Diagnostic::error(format!("`{}` has no output `{name}`", skeleton.path));
                if let Some(place) = &output.name.place {
                    unknown = unknown.at(place, "unknown output");
                }
                let names = skeleton.header.outputs.iter().map(|o| o.text.as_str());
                report.add(unknown.with_suggestion(name, names));
            }
        }
    }
    report.into_result(found)
}

/// Statements that leave the entry point unless the state is kept.
///
/// What a skeleton does besides its outputs (`also`) is done once: not again by the pass that only
/// tells what another shows.
fn keep(skeleton: &Module, recipe: &Recipe, leave: &str) -> String {
    let mut statements = match skeleton.item("keep") {
        Some(_) => format!("    if !keep(state) {{ {leave}; }}\n"),
        None => String::new(),
    };
    let only_shown = recipe.outputs.iter().all(|o| o.name.value == SHOWN);
    if skeleton.item("also").is_some() && !only_shown {
        statements.push_str("    also(state);\n");
    }
    statements
}

/// The struct of a fragment shader's outputs, and the expression that makes one.
fn targets(outputs: &[(String, String)]) -> (String, String) {
    let mut members = String::new();
    let mut values = Vec::new();
    for (location, (name, ty)) in outputs.iter().enumerate() {
        let _ = writeln!(members, "    @location({location}) {name}: {ty},");
        values.push(format!("write_{name}(state)"));
    }
    (
        format!("struct PassOutputs {{\n{members}}}\n\n"),
        format!("PassOutputs({})", values.join(", ")),
    )
}

/// The end of a fragment entry point: its result type and last statements.
fn finish(
    skeleton: &Module,
    recipe: &Recipe,
    outputs: &[(String, String)],
) -> (String, &'static str, String) {
    let keep = keep(skeleton, recipe, "discard");
    if outputs.is_empty() {
        return (String::new(), "", keep);
    }
    let (declared, made) = targets(outputs);
    (
        declared,
        " -> PassOutputs",
        format!("{keep}    return {made};\n"),
    )
}

fn render_entry() -> Entry {
    Entry::Render {
        vertex: "vertex_main".into(),
        fragment: "fragment_main".into(),
    }
}

fn compute(skeleton: &Module, recipe: &Recipe) -> Result<Written, Report> {
    let signature = function(skeleton, "compute")?;
    outputs(skeleton, recipe)?;
    let threads = &skeleton.header.workgroup;
    let axis = |index: usize| threads.get(index).copied().unwrap_or(1);
    let workgroup = [axis(0), axis(1), axis(2)];
    if threads.is_empty() || workgroup.iter().product::<u32>() > 256 {
        return Err(wrong(
            skeleton,
            "it needs a line `// workgroup: X, Y, Z` with at most 256 threads in all",
        ));
    }
    let [x, y, z] = workgroup;
    let wanted = signature.parameters;
    if !matches!(wanted, [thread] if thread.ty == "vec3u") {
        return Err(wrong(
            skeleton,
            "`compute` takes `thread: vec3u`, its place among all threads",
        ));
    }
    Ok(Written {
        text: format!(
            "@compute @workgroup_size({x}, {y}, {z})\nfn compute_main(@builtin(global_invocation_id) thread: vec3u) {{\n    compute(thread);\n}}\n"
        ),
        entry: Entry::Compute {
            name: "compute_main".into(),
            workgroup,
        },
        attributes: Vec::new(),
        outputs: Vec::new(),
        drawing: None,
    })
}
