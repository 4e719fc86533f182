//! What a shader reads and writes, held against what the pipeline and the host offer.

mod formats;
mod targets;

use std::collections::BTreeSet;

use meniscus_shader::{Binding, BindingKind, LIVE_NUMBERS, Sample, Shader};
use meniscus_source::{Diagnostic, Place};
use naga::{TypeInner, VectorSize};

use crate::host::{self, Members, ValueType};
use crate::pipeline::{Pass, Pipeline};
use crate::plan::{Format, Texture};
pub(crate) use targets::{check_target, check_targets};

/// The suffix of the name of a texture that holds what is shown in another.
pub const SHOWN: &str = " (shown)";
/// How a variable asks for it: `shown_of_seen_colour`.
pub(crate) const SHOWN_OF: &str = "shown_of_";

/// A message about a pass, at its name.
pub(crate) fn about(pass: &Pass, message: String) -> Diagnostic {
    let diagnostic = Diagnostic::error(message);
    match &pass.name.place {
        Some(place) => diagnostic.at(place, "in this pass"),
        None => diagnostic,
    }
}

/// Where a shader's variable is declared.
pub(crate) type Declared<'d> = &'d dyn Fn(&str) -> Option<Place>;

/// A message about a resource that a pass reads: where the pass is, and where it is declared.
fn about_resource(
    pass: &Pass,
    binding: &Binding,
    declared: Declared,
    message: String,
) -> Diagnostic {
    let diagnostic = about(pass, message);
    match declared(&binding.variable) {
        Some(place) => diagnostic.see(&place, "declared here"),
        None => diagnostic,
    }
}

/// Checks one resource; `textures` holds the pipeline's and those made for what is shown.
pub(crate) fn check_binding(
    pass: &Pass,
    binding: &Binding,
    shader: &Shader,
    pipeline: &Pipeline,
    texture: Option<&Texture>,
    declared: Declared,
) -> Option<Diagnostic> {
    let name = &binding.resource;
    let wrong = |message: String| Some(about_resource(pass, binding, declared, message));
    match binding.kind {
        BindingKind::Uniform(ty) => match host::BLOCKS.iter().find(|(block, _)| block == name) {
            Some((block, members)) => check_members(&shader.module, ty, block, members)
                .and_then(|what| wrong(format!("`{name}`: {what}"))),
            None => unknown(
                pass,
                binding,
                declared,
                "uniform block",
                host::BLOCKS.iter().map(|(b, _)| *b),
            ),
        },
        // The composer makes it, and the host fills it.
        BindingKind::Storage { .. } if name == LIVE_NUMBERS => None,
        BindingKind::Storage { ty, read_only } => {
            if pipeline.buffers.contains_key(name) {
                return (binding.in_vertex && !read_only)
                    .then(|| wrong(format!("`{name}` is written, which no vertex shader may")))
                    .flatten();
            }
            let Some((_, members)) = host::ARRAYS.iter().find(|(array, _)| array == name) else {
                let own = pipeline.buffers.keys().map(String::as_str);
                return unknown(
                    pass,
                    binding,
                    declared,
                    "buffer",
                    own.chain(host::ARRAYS.iter().map(|(a, _)| *a)),
                );
            };
            if !read_only {
                return wrong(format!("`{name}` is the scene's and only to be read"))
                    .map(|d| d.with_help("declare it as `var<storage, read>`"));
            }
            let element = match shader.module.types[ty].inner {
                TypeInner::Array { base, .. } => base,
                _ => return wrong(format!("`{name}` is an array")),
            };
            check_members(&shader.module, element, name, members)
                .and_then(|what| wrong(format!("`{name}`: {what}")))
        }
        BindingKind::Sampler => (!host::SAMPLERS.contains(&name.as_str()))
            .then(|| {
                unknown(
                    pass,
                    binding,
                    declared,
                    "sampler",
                    host::SAMPLERS.iter().copied(),
                )
            })
            .flatten(),
        BindingKind::StorageTexture {
            format: written,
            dimension,
            ..
        } => {
            let Some(texture) = texture else {
                return unknown(
                    pass,
                    binding,
                    declared,
                    "texture",
                    pipeline.textures.keys().map(String::as_str),
                );
            };
            if dimension != naga::ImageDimension::D2 {
                return wrong(format!("`{name}` is a two-dimensional texture"));
            }
            if texture.format.storage_format() != Some(written) {
                let name_of = texture.format.storage_name();
                return wrong(format!(
                    "`{name}` has the format {:?}, and {written:?} is written to it",
                    texture.format
                ))
                .map(|d| match name_of {
                    Some(format) => d.with_help(format!(
                        "declare it as `texture_storage_2d<{format}, write>`"
                    )),
                    None => d.with_help("give the texture another format"),
                });
            }
            None
        }
        BindingKind::Texture {
            sample,
            filtered,
            dimension,
        } => {
            let Some(texture) = texture else {
                return unknown(
                    pass,
                    binding,
                    declared,
                    "texture",
                    pipeline.textures.keys().map(String::as_str),
                );
            };
            let format = texture.format;
            if dimension != naga::ImageDimension::D2 {
                return wrong(format!("`{name}` is a two-dimensional texture"));
            }
            if format.sample() != sample {
                return wrong(format!(
                    "`{name}` has the format {format:?}, which `{}` cannot read",
                    binding.variable
                ))
                .map(|d| d.with_help(format!("declare it as `{}`", declaration(format))));
            }
            if filtered && !format.filterable() {
                return wrong(format!(
                    "`{name}` has the format {format:?}, which no sampler can filter"
                ))
                .map(|d| d.with_help("use textureLoad, or Rgba16Float"));
            }
            None
        }
    }
}

fn declaration(format: Format) -> &'static str {
    match format.sample() {
        Sample::Depth => "texture_depth_2d",
        Sample::Uint => "texture_2d<u32>",
        _ => "texture_2d<f32>",
    }
}

fn unknown<'a>(
    pass: &Pass,
    binding: &Binding,
    declared: Declared,
    kind: &str,
    known: impl IntoIterator<Item = &'a str>,
) -> Option<Diagnostic> {
    let name = &binding.resource;
    let message = format!(
        "`{}` reads `{name}`, and there is no such {kind}",
        pass.name.value
    );
    Some(about_resource(pass, binding, declared, message).with_suggestion(name, known))
}

/// What is wrong with a struct of a block or array, whose members the host is to write.
fn check_members(
    module: &naga::Module,
    ty: naga::Handle<naga::Type>,
    resource: &str,
    members: Members,
) -> Option<String> {
    let TypeInner::Struct {
        members: declared, ..
    } = &module.types[ty].inner
    else {
        return Some("it must be a struct".into());
    };
    for member in declared {
        let name = member.name.as_deref().unwrap_or_default();
        let found = module.types[member.ty].inner.clone();
        if let Some((elements, length)) = host::block_array(resource, name) {
            match found {
                TypeInner::Array {
                    base,
                    size: naga::ArraySize::Constant(declared),
                    ..
                } if declared.get() as usize == length => {
                    match check_members(module, base, name, elements) {
                        Some(what) => return Some(format!("`{name}`: {what}")),
                        None => continue,
                    }
                }
                _ => {
                    return Some(format!(
                        "the member `{name}` is an array of {length} structs"
                    ));
                }
            }
        }
        match members.iter().find(|(known, _)| *known == name) {
            None => {
                let names: Vec<_> = members
                    .iter()
                    .map(|(known, _)| format!("`{known}`"))
                    .collect();
                return Some(format!(
                    "the host has no member `{name}`; it has {}",
                    names.join(", ")
                ));
            }
            Some((_, wanted)) if value_type(&found) != Some(*wanted) => {
                return Some(format!(
                    "the member `{name}` has the type {}",
                    wgsl_name(*wanted)
                ));
            }
            Some(_) => {}
        }
    }
    None
}

fn value_type(inner: &TypeInner) -> Option<ValueType> {
    match inner {
        TypeInner::Scalar(scalar) if *scalar == naga::Scalar::F32 => Some(ValueType::F32),
        TypeInner::Scalar(scalar) if *scalar == naga::Scalar::U32 => Some(ValueType::U32),
        TypeInner::Vector { size, scalar } if *scalar == naga::Scalar::F32 => Some(match size {
            VectorSize::Bi => ValueType::Vec2,
            VectorSize::Tri => ValueType::Vec3,
            VectorSize::Quad => ValueType::Vec4,
        }),
        _ => None,
    }
}

fn wgsl_name(ty: ValueType) -> &'static str {
    match ty {
        ValueType::F32 => "f32",
        ValueType::U32 => "u32",
        ValueType::Vec2 => "vec2f",
        ValueType::Vec3 => "vec3f",
        ValueType::Vec4 => "vec4f",
    }
}

/// Checks vertex attributes against what the host has.
pub(crate) fn check_attributes(pass: &Pass, shader: &Shader) -> Vec<Diagnostic> {
    let Some(vertex) = shader
        .module
        .entry_points
        .iter()
        .find(|e| e.stage == naga::ShaderStage::Vertex)
    else {
        return Vec::new();
    };
    let mut wrong = Vec::new();
    for attribute in &shader.attributes {
        let argument = vertex.function.arguments.iter().find(|a| {
            matches!(a.binding, Some(naga::Binding::Location { location, .. }) if location == attribute.location)
        });
        let Some(argument) = argument else { continue };
        match host::ATTRIBUTES
            .iter()
            .find(|(name, _)| *name == attribute.name)
        {
            None => wrong.push(
                about(
                    pass,
                    format!(
                        "`{}` wants the vertex attribute `{}`, which no mesh has",
                        pass.skeleton.value, attribute.name
                    ),
                )
                .with_suggestion(
                    &attribute.name,
                    host::ATTRIBUTES.iter().map(|(name, _)| *name),
                ),
            ),
            Some((_, ty)) if value_type(&shader.module.types[argument.ty].inner) != Some(*ty) => {
                wrong.push(about(
                    pass,
                    format!(
                        "the vertex attribute `{}` is a {}",
                        attribute.name,
                        wgsl_name(*ty)
                    ),
                ))
            }
            Some(_) => {}
        }
    }
    wrong
}

/// The names of all textures that a shader reads.
pub(crate) fn read_textures(shader: &Shader) -> BTreeSet<&str> {
    shader
        .bindings
        .iter()
        .filter(|b| matches!(b.kind, BindingKind::Texture { .. }))
        .map(|b| b.resource.as_str())
        .collect()
}
