//! Entry points: written from a skeleton's signatures and what the pass writes.
//!
//! A drawing skeleton has `fn vertex(attributes…) -> V`, V having a member `clip: vec4f`, and
//! `fn fragment(v: V, …) -> S`; a screen skeleton has `fn screen(pixel: vec2f) -> S`. Both may have
//! `fn keep(s: S) -> bool`, `fn also(s: S)` for what they do besides, and for each output NAME `fn write_NAME(s: S) -> T`. Only the outputs
//! that a pass writes are called, so that what the others read is pruned. A compute skeleton has
//! `fn compute(thread: vec3u)` and writes what it declares.

use std::fmt::Write as _;

use meniscus_source::{Diagnostic, Report};

use crate::compose::{Recipe, Stage};
use crate::library::Module;
use crate::outline::{Field, Item, ItemKind};
use crate::shader::{Attribute, Entry};

/// The output that says which points the others show.
const SHOWN: &str = "shown";

/// The written entry points.
pub(crate) struct Written {
    pub text: String,
    pub entry: Entry,
    pub attributes: Vec<Attribute>,
    pub outputs: Vec<String>,
}

/// Threads of a workgroup of a screen pass that runs as a compute shader.
const SCREEN_WORKGROUP: [u32; 3] = [8, 8, 1];
/// Threads of a workgroup that runs over a list.
const LIST_WORKGROUP: [u32; 3] = [64, 1, 1];

pub(crate) fn write(skeleton: &Module, recipe: &Recipe) -> Result<Written, Report> {
    let kind = skeleton
        .header
        .skeleton
        .as_ref()
        .map_or("", |k| k.text.as_str());
    match (kind, recipe.stage) {
        ("draw", Stage::Render) => draw(skeleton, recipe),
        ("screen", Stage::Render) => screen(skeleton, recipe),
        ("screen", Stage::Compute | Stage::List) => screen_compute(skeleton, recipe),
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
        _ => Err(wrong(skeleton, &format!("it has no function `{name}`"))),
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
            format!("`{name}` must return what the outputs are made of"),
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

/// The function of a screen skeleton, checked.
fn screen_function<'m>(skeleton: &'m Module, recipe: &Recipe) -> Result<Signature<'m>, Report> {
    let screen = function(skeleton, "screen")?;
    if !matches!(screen.parameters, [pixel] if pixel.ty == "vec2f") {
        return Err(wrong_function(
            skeleton,
            &screen,
            "`screen` takes `pixel: vec2f` (pixels, centres at half integers)".into(),
        ));
    }
    check_state(skeleton, &screen, recipe)?;
    Ok(screen)
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

/// Whether a function's body has a word.
fn uses(skeleton: &Module, function: &Item, word: &str) -> bool {
    let text = &skeleton.file.text;
    let body = text[function.range.clone()].find('{');
    let start = function.range.start + body.unwrap_or_default();
    let tokens = skeleton.outline.tokens.iter();
    let mut inside = tokens.filter(|t| t.range.start > start && t.range.end <= function.range.end);
    inside.any(|token| &text[token.range.clone()] == word)
}

/// Whether a type may pass from stage to stage.
fn is_io(ty: &str) -> bool {
    let vector = |size: char| {
        ["f", "u", "i"]
            .iter()
            .any(|scalar| ty == format!("vec{size}{scalar}"))
    };
    matches!(ty, "f32" | "u32" | "i32") || ['2', '3', '4'].into_iter().any(vector)
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

fn draw(skeleton: &Module, recipe: &Recipe) -> Result<Written, Report> {
    let vertex = function(skeleton, "vertex")?;
    let fragment = function(skeleton, "fragment")?;
    let members = match skeleton.item(vertex.result).map(|item| &item.kind) {
        Some(ItemKind::Struct(members)) => members,
        _ => {
            return Err(wrong(
                skeleton,
                "`vertex` must return a struct that the skeleton declares",
            ));
        }
    };
    if !members.iter().any(|m| m.name == "clip" && m.ty == "vec4f") {
        return Err(wrong(
            skeleton,
            &format!("`{}` needs a member `clip: vec4f`", vertex.result),
        ));
    }
    if let Some(member) = members.iter().find(|m| !is_io(&m.ty)) {
        return Err(wrong_function(
            skeleton,
            &vertex,
            format!(
                "`{}` of `{}` is a `{}`, which no vertex shader can hand on: only numbers and vectors can be",
                member.name, vertex.result, member.ty
            ),
        ));
    }
    if fragment
        .parameters
        .first()
        .is_none_or(|v| v.ty != vertex.result)
    {
        let what = format!(
            "`fragment` takes what `vertex` returns: a `{}`",
            vertex.result
        );
        return Err(wrong_function(skeleton, &fragment, what));
    }
    check_state(skeleton, &fragment, recipe)?;
    let (mut attributes, mut parameters, mut values) = (Vec::new(), Vec::new(), Vec::new());
    for parameter in vertex.parameters {
        let Field { name, ty, .. } = parameter;
        // What the skeleton takes and leaves aside is not fetched.
        if !uses(skeleton, vertex.item, name) {
            values.push(format!("{ty}()"));
            continue;
        }
        let location = attributes.len() as u32;
        parameters.push(format!("@location({location}) in_{name}: {ty}"));
        values.push(format!("in_{name}"));
        attributes.push(Attribute {
            name: name.clone(),
            location,
        });
    }
    let mut varying = String::new();
    let mut location = 0;
    for member in members {
        let attribute = if member.name == "clip" {
            "@builtin(position)".to_owned()
        } else {
            let integer = matches!(member.ty.as_str(), "u32" | "i32")
                || member.ty.ends_with('u')
                || member.ty.ends_with('i');
            let flat = integer || skeleton.header.flat.iter().any(|f| f.text == member.name);
            location += 1;
            format!(
                "@location({}){}",
                location - 1,
                if flat {
                    " @interpolate(flat, first)"
                } else {
                    ""
                }
            )
        };
        let _ = writeln!(varying, "    {attribute} {}: {},", member.name, member.ty);
    }
    let copies = |from: &str| {
        let values: Vec<String> = members
            .iter()
            .map(|m| format!("{from}.{}", m.name))
            .collect();
        values.join(", ")
    };
    let outputs = outputs(skeleton, recipe)?;
    let (declared, result, end) = finish(skeleton, recipe, &outputs);
    let extra = builtin_arguments(skeleton, &fragment, 1)?;
    let front = if extra.contains(", front") {
        ", @builtin(front_facing) front: bool"
    } else {
        ""
    };
    let ty = vertex.result;
    let text = format!(
        "struct PassVarying {{\n{varying}}}\n\n{declared}\
         @vertex\nfn vertex_main({}) -> PassVarying {{\n    let v = vertex({});\n    return PassVarying({});\n}}\n\n\
         @fragment\nfn fragment_main(v: PassVarying{front}){result} {{\n    let pixel = v.clip.xy;\n    \
         let state = fragment({ty}({}){extra});\n{end}}}\n",
        parameters.join(", "),
        values.join(", "),
        copies("v"),
        copies("v"),
    );
    Ok(Written {
        text,
        entry: render_entry(),
        attributes,
        outputs: outputs.into_iter().map(|(name, _)| name).collect(),
    })
}

fn render_entry() -> Entry {
    Entry::Render {
        vertex: "vertex_main".into(),
        fragment: "fragment_main".into(),
    }
}

/// The arguments after the first `given` of a fragment function: `pixel` and `front`, by name.
fn builtin_arguments(
    skeleton: &Module,
    signature: &Signature,
    given: usize,
) -> Result<String, Report> {
    let mut arguments = String::new();
    for parameter in signature.parameters.iter().skip(given) {
        match (parameter.name.as_str(), parameter.ty.as_str()) {
            ("pixel", "vec2f") | ("front", "bool") => {
                let _ = write!(arguments, ", {}", parameter.name);
            }
            _ => {
                return Err(Diagnostic::error(format!(
                    "`{}`: nothing is there to pass as `{}: {}`",
                    skeleton.path, parameter.name, parameter.ty
                ))
                .at(&skeleton.place(signature.item.name_range.clone()), "")
                .with_help("it may take `pixel: vec2f` (pixels, centres at half integers) and `front: bool`")
                .into());
            }
        }
    }
    Ok(arguments)
}

fn screen(skeleton: &Module, recipe: &Recipe) -> Result<Written, Report> {
    screen_function(skeleton, recipe)?;
    let outputs = outputs(skeleton, recipe)?;
    let (declared, result, end) = finish(skeleton, recipe, &outputs);
    let text = format!(
        "{declared}// One triangle that covers the screen.\n\
         @vertex\nfn vertex_main(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {{\n    \
         return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);\n}}\n\n\
         @fragment\nfn fragment_main(@builtin(position) position: vec4f){result} {{\n    \
         let state = screen(position.xy);\n{end}}}\n",
    );
    Ok(Written {
        text,
        entry: render_entry(),
        attributes: Vec::new(),
        outputs: outputs.into_iter().map(|(name, _)| name).collect(),
    })
}

fn screen_compute(skeleton: &Module, recipe: &Recipe) -> Result<Written, Report> {
    screen_function(skeleton, recipe)?;
    let outputs = outputs(skeleton, recipe)?;
    let mut text = String::new();
    let mut stores = String::new();
    for ((name, ty), output) in outputs.iter().zip(&recipe.outputs) {
        let _ = writeln!(
            text,
            "var target_{name}: texture_storage_2d<{}, write>;",
            output.format
        );
        let value = match ty.as_str() {
            "f32" => format!("vec4f(write_{name}(state))"),
            "u32" => format!("vec4u(write_{name}(state))"),
            _ => format!("write_{name}(state)"),
        };
        let _ = writeln!(
            stores,
            "    textureStore(target_{name}, vec2i(pixel), {value});"
        );
    }
    let list = recipe.stage == Stage::List;
    let workgroup = if list {
        LIST_WORKGROUP
    } else {
        SCREEN_WORKGROUP
    };
    let [x, y, _] = workgroup;
    let keep = keep(skeleton, recipe, "return");
    let size = match outputs.first() {
        Some((name, _)) => format!("vec2u(textureDimensions(target_{name}))"),
        None => return Err(wrong(skeleton, "a compute pass must write something")),
    };
    if list {
        // The number of workgroups along x is limited, so a long list is folded into rows.
        let _ = write!(
            text,
            "\n// Pixels as x + 65536 y, behind their count.\n\
             struct PassPixels {{ count: u32, pixels: array<u32> }}\nvar<storage, read> pass_pixels: PassPixels;\n\n\
             @compute @workgroup_size({x}, {y})\nfn compute_main(@builtin(global_invocation_id) thread: vec3u, @builtin(num_workgroups) groups: vec3u) {{\n    \
             let index = thread.x + thread.y * groups.x * {x}u;\n    if index >= min(pass_pixels.count, arrayLength(&pass_pixels.pixels)) {{ return; }}\n    \
             let packed = pass_pixels.pixels[index];\n    let pixel = vec2f(vec2u(packed & 0xffffu, packed >> 16u)) + 0.5;\n    \
             let state = screen(pixel);\n{keep}{stores}}}\n"
        );
    } else {
        let _ = write!(
            text,
            "\n@compute @workgroup_size({x}, {y})\nfn compute_main(@builtin(global_invocation_id) thread: vec3u) {{\n    \
             if any(thread.xy >= {size}) {{ return; }}\n    let pixel = vec2f(thread.xy) + 0.5;\n    \
             let state = screen(pixel);\n{keep}{stores}}}\n"
        );
    }
    Ok(Written {
        text,
        entry: Entry::Compute {
            name: "compute_main".into(),
            workgroup,
        },
        attributes: Vec::new(),
        outputs: outputs.into_iter().map(|(name, _)| name).collect(),
    })
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
    })
}
