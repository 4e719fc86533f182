//! GLSL, which has no flat values of a chosen corner and no loads from depth textures: both are
//! expressed otherwise, for this language alone.

use naga::back::glsl;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Binding, Module, Sampling, ShaderStage, TypeInner};

use super::Exported;
use crate::lexer::Kind;
use crate::outline::{ItemKind, Outline};
use crate::shader::Shader;

/// The version of GLSL, and that of GLSL ES.
const VERSION: u16 = 450;
const VERSION_ES: u16 = 310;

/// What is said in the texts of shaders with flat values.
const PROVOKING: &str = "// Flat values are those of a triangle's first vertex: \
    glProvokingVertex(GL_FIRST_VERTEX_CONVENTION);\n\
    // where that is missing, as in ES, let the indices of each triangle end with that vertex.\n";

/// The shader with its depth textures as textures of floats, of which `textureLoad` and the others
/// give the first component; none where it has no depth textures.
pub(super) fn prepared(shader: &Shader) -> Result<Option<(Module, ModuleInfo)>, String> {
    let Some(text) = without_depth(&shader.text) else {
        return Ok(None);
    };
    let reason = |error: &dyn std::error::Error| format!("its depth textures: {error}");
    let mut module = naga::front::wgsl::parse_str(&text).map_err(|error| reason(&error))?;
    naga::compact::compact(&mut module, naga::compact::KeepUnused::No);
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .map_err(|error| reason(error.as_inner()))?;
    Ok(Some((module, info)))
}

/// A text with depth textures read as textures of floats; none where there is none.
fn without_depth(text: &str) -> Option<String> {
    const DEPTH: &str = "texture_depth_2d";
    let outline = Outline::of(text);
    let is_depth = |kind: &ItemKind| matches!(kind, ItemKind::Variable { ty, .. } if ty == DEPTH);
    let depth: Vec<&str> = outline
        .items
        .iter()
        .filter(|item| is_depth(&item.kind))
        .map(|item| item.name.as_str())
        .collect();
    if depth.is_empty() {
        return None;
    }
    let word = |at: usize| outline.tokens.get(at).map(|t| &text[t.range.clone()]);
    // Where something is put in the place of a range, in order.
    let mut changes: Vec<(std::ops::Range<usize>, &str)> = Vec::new();
    for (at, token) in outline.tokens.iter().enumerate() {
        if word(at) == Some(DEPTH) {
            changes.push((token.range.clone(), "texture_2d<f32>"));
        }
        let reads = matches!(
            word(at),
            Some("textureLoad" | "textureSample" | "textureSampleLevel")
        );
        let of_depth = || word(at + 2).is_some_and(|name| depth.contains(&name));
        if reads && word(at + 1) == Some("(") && of_depth() {
            let mut open = 0;
            let end = outline.tokens[at + 1..].iter().find(|t| {
                match t.kind {
                    Kind::Mark('(') => open += 1,
                    Kind::Mark(')') => open -= 1,
                    _ => {}
                }
                open == 0
            })?;
            changes.push((end.range.end..end.range.end, ".x"));
        }
    }
    changes.sort_by_key(|(range, _)| range.start);
    let mut changed = String::with_capacity(text.len() + 8 * changes.len());
    let mut at = 0;
    for (range, new) in changes {
        changed.push_str(&text[at..range.start]);
        changed.push_str(new);
        at = range.end;
    }
    changed.push_str(&text[at..]);
    Some(changed)
}

/// The texts of all stages.
pub(super) fn write(
    mut module: Module,
    info: ModuleInfo,
    es: bool,
) -> Result<Vec<Exported>, String> {
    let flat = loosen(&mut module);
    let mut binding_map = glsl::BindingMap::new();
    for (_, variable) in module.global_variables.iter() {
        if let Some(place) = variable.binding {
            let number = u8::try_from(place.binding)
                .map_err(|_| "it has more than 256 resources".to_owned())?;
            binding_map.insert(place, number);
        }
    }
    let version = match es {
        true => glsl::Version::Embedded {
            version: VERSION_ES,
            is_webgl: false,
        },
        false => glsl::Version::Desktop(VERSION),
    };
    let options = glsl::Options {
        version,
        binding_map,
        ..Default::default()
    };
    let mut parts = Vec::new();
    for entry in &module.entry_points {
        let stage = glsl::PipelineOptions {
            shader_stage: entry.stage,
            entry_point: entry.name.clone(),
            multiview: None,
        };
        let mut text = String::new();
        let policies = naga::proc::BoundsCheckPolicies::default();
        glsl::Writer::new(&mut text, &module, &info, &options, &stage, policies)
            .and_then(|mut writer| writer.write())
            .map_err(|error| error.to_string())?;
        if flat && entry.stage == ShaderStage::Vertex {
            // The version must come first.
            let first = text.find('\n').map_or(text.len(), |end| end + 1);
            text.insert_str(first, PROVOKING);
        }
        parts.push(Exported {
            stage: Some(match entry.stage {
                ShaderStage::Vertex => "vert",
                ShaderStage::Fragment => "frag",
                _ => "comp",
            }),
            bytes: text.into_bytes(),
        });
    }
    Ok(parts)
}

/// Leaves open which corner flat values come from, and tells whether there are any.
fn loosen(module: &mut Module) -> bool {
    let loose = |binding: &mut Option<Binding>| match binding {
        Some(Binding::Location { sampling, .. }) if *sampling == Some(Sampling::First) => {
            *sampling = Some(Sampling::Either);
            true
        }
        _ => false,
    };
    let mut found = false;
    let handles: Vec<_> = module.types.iter().map(|(handle, _)| handle).collect();
    for handle in handles {
        let mut ty = module.types[handle].clone();
        if let TypeInner::Struct { members, .. } = &mut ty.inner {
            let changed = members
                .iter_mut()
                .filter_map(|member| loose(&mut member.binding).then_some(()));
            if changed.count() > 0 {
                found = true;
                module.types.replace(handle, ty);
            }
        }
    }
    for entry in &mut module.entry_points {
        for argument in &mut entry.function.arguments {
            found |= loose(&mut argument.binding);
        }
        if let Some(result) = &mut entry.function.result {
            found |= loose(&mut result.binding);
        }
    }
    found
}
