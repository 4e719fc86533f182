//! Entry points of drawing skeletons: a vertex and a fragment stage, and what passes between them.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use meniscus_source::{Diagnostic, Report};

use super::{
    Signature, Written, check_state, finish, function, outputs, render_entry, wrong, wrong_function,
};
use crate::compose::Recipe;
use crate::demand::{Demand, Demands};
use crate::library::Module;
use crate::outline::{Field, Item, ItemKind};
use crate::shader::Attribute;

/// The member that says where a vertex lies on the screen.
const CLIP: &str = "clip";
/// How the parameters of the vertex entry point begin.
const IN: &str = "in_";

/// The entry points of a drawing skeleton, to be written with or without some of what passes
/// through them.
#[derive(Debug)]
pub(crate) struct Drawing {
    /// The parameters of the skeleton's `vertex`.
    attributes: Vec<Field>,
    /// The struct that it returns, and its members; flat ones belong to a triangle's first vertex.
    varying: String,
    members: Vec<(Field, bool)>,
    /// Declarations, the builtin parameter, the result and the end of the fragment entry point, and
    /// what `fragment` is given besides.
    declared: String,
    front: &'static str,
    result: &'static str,
    end: String,
    extra: String,
    /// Attributes that the skeleton does not mention.
    unmentioned: BTreeSet<String>,
}

/// Vertex attributes and varyings that nothing reads.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Unread {
    attributes: BTreeSet<String>,
    varyings: BTreeSet<String>,
}

impl Unread {
    /// Attributes as `vertex.NAME`, varyings as `fragment.NAME`.
    pub fn names(&self) -> Vec<String> {
        let attributes = self.attributes.iter().map(|name| format!("vertex.{name}"));
        let varyings = self.varyings.iter().map(|name| format!("fragment.{name}"));
        attributes.chain(varyings).collect()
    }
}

impl Drawing {
    /// The text of the entry points, and the attributes that they take.
    pub fn write(&self, unread: &Unread) -> (String, Vec<Attribute>) {
        let (mut attributes, mut parameters, mut values) = (Vec::new(), Vec::new(), Vec::new());
        for Field { name, ty } in &self.attributes {
            if unread.attributes.contains(name) {
                values.push(format!("{ty}()"));
                continue;
            }
            let location = attributes.len() as u32;
            parameters.push(format!("@location({location}) {IN}{name}: {ty}"));
            values.push(format!("{IN}{name}"));
            attributes.push(Attribute {
                name: name.clone(),
                location,
            });
        }
        let (mut declared, mut given, mut taken) = (String::new(), Vec::new(), Vec::new());
        let mut location = 0;
        for (Field { name, ty }, flat) in &self.members {
            if unread.varyings.contains(name) {
                taken.push(format!("{ty}()"));
                continue;
            }
            given.push(format!("v.{name}"));
            taken.push(format!("v.{name}"));
            if name == CLIP {
                let _ = writeln!(declared, "    @builtin(position) {name}: {ty},");
                continue;
            }
            let flat = if *flat {
                " @interpolate(flat, first)"
            } else {
                ""
            };
            let _ = writeln!(declared, "    @location({location}){flat} {name}: {ty},");
            location += 1;
        }
        let Self {
            varying,
            declared: targets,
            front,
            result,
            end,
            extra,
            ..
        } = self;
        let text = format!(
            "struct PassVarying {{\n{declared}}}\n\n{targets}\
             @vertex\nfn vertex_main({}) -> PassVarying {{\n    let v = vertex({});\n    return PassVarying({});\n}}\n\n\
             @fragment\nfn fragment_main(v: PassVarying{front}){result} {{\n    let pixel = v.clip.xy;\n    \
             let state = fragment({varying}({}){extra});\n{end}}}\n",
            parameters.join(", "),
            values.join(", "),
            given.join(", "),
            taken.join(", "),
        );
        (text, attributes)
    }

    /// What nothing reads of what the entry points, as first written, take and hand on.
    pub fn unread(&self, module: &naga::Module) -> Unread {
        let mut unread = self.unmentioned();
        let mut demands = Demands::of(module);
        let entry = |stage| module.entry_points.iter().find(|e| e.stage == stage);
        let stages = entry(naga::ShaderStage::Vertex).zip(entry(naga::ShaderStage::Fragment));
        let Some((vertex, fragment)) = stages else {
            return unread;
        };
        // In the fragment's text nothing is kept for the result, so all of it is wanted.
        let wanted = demands.arguments(&fragment.function, &Demand::All);
        let varying = wanted.first().cloned().unwrap_or_default();
        let numbered = || (0..).zip(&self.members);
        let read = |(index, (member, _)): &(u32, &(Field, bool))| {
            member.name == CLIP || varying.member(*index) != Demand::Nothing
        };
        let given = Demand::members(numbered().filter(&read).map(|(index, _)| index));
        let left_out = numbered().filter(|member| !read(member));
        unread.varyings = left_out.map(|(_, (m, _))| m.name.clone()).collect();
        let wanted = demands.arguments(&vertex.function, &given);
        for (argument, demand) in vertex.function.arguments.iter().zip(wanted.iter()) {
            let name = argument.name.as_deref().and_then(|n| n.strip_prefix(IN));
            if let Some(name) = name.filter(|_| *demand == Demand::Nothing) {
                unread.attributes.insert(name.to_owned());
            }
        }
        unread
    }

    /// What the skeleton takes and leaves aside.
    pub fn unmentioned(&self) -> Unread {
        Unread {
            attributes: self.unmentioned.clone(),
            varyings: BTreeSet::new(),
        }
    }
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

pub(super) fn write(skeleton: &Module, recipe: &Recipe) -> Result<Written, Report> {
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
    if !members.iter().any(|m| m.name == CLIP && m.ty == "vec4f") {
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
    let flat = |member: &Field| {
        let integer =
            matches!(member.ty.as_str(), "u32" | "i32") || member.ty.ends_with(['u', 'i']);
        integer || skeleton.header.flat.iter().any(|f| f.text == member.name)
    };
    let outputs = outputs(skeleton, recipe)?;
    let (declared, result, end) = finish(skeleton, recipe, &outputs);
    let extra = builtin_arguments(skeleton, &fragment, 1)?;
    let unmentioned = vertex.parameters.iter();
    let drawing = Drawing {
        attributes: vertex.parameters.to_vec(),
        varying: vertex.result.to_owned(),
        members: members.iter().map(|m| (m.clone(), flat(m))).collect(),
        declared,
        front: match extra.contains(", front") {
            true => ", @builtin(front_facing) front: bool",
            false => "",
        },
        result,
        end,
        extra,
        unmentioned: unmentioned
            .filter(|parameter| !uses(skeleton, vertex.item, &parameter.name))
            .map(|parameter| parameter.name.clone())
            .collect(),
    };
    let (text, attributes) = drawing.write(&drawing.unmentioned());
    Ok(Written {
        text,
        entry: render_entry(),
        attributes,
        outputs: outputs.into_iter().map(|(name, _)| name).collect(),
        drawing: Some(drawing),
    })
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
