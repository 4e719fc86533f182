//! A shader's outputs, held against the textures that they are written to.

use std::collections::{BTreeMap, BTreeSet};

use meniscus_shader::{Entry, Shader};
use meniscus_source::Diagnostic;
use meniscus_source::ron::Spanned;
use naga::{ScalarKind, TypeInner};

use super::about;
use crate::pipeline::Pass;
use crate::plan::{Format, Texture};

/// Checks an output's type against its texture's format.
pub(crate) fn check_target(
    pass: &Pass,
    output: &str,
    location: u32,
    format: Format,
    shader: &Shader,
) -> Option<Diagnostic> {
    let fragment = shader
        .module
        .entry_points
        .iter()
        .find(|e| e.stage == naga::ShaderStage::Fragment)?;
    let result = fragment.function.result.as_ref()?;
    let TypeInner::Struct { members, .. } = &shader.module.types[result.ty].inner else {
        return None;
    };
    let member = members.iter().find(
        |m| matches!(m.binding, Some(naga::Binding::Location { location: l, .. }) if l == location),
    )?;
    let (channels, kind) = match &shader.module.types[member.ty].inner {
        TypeInner::Scalar(scalar) => (1, scalar.kind),
        TypeInner::Vector { size, scalar } => (*size as u8, scalar.kind),
        _ => return None,
    };
    let (wanted, wanted_unsigned) = format.channels();
    let wanted_kind = if wanted_unsigned {
        ScalarKind::Uint
    } else {
        ScalarKind::Float
    };
    (channels < wanted || kind != wanted_kind).then(|| {
        about(
            pass,
            format!("the output `{output}` does not fit the format {format:?} of its texture: that has {wanted} {}{}",
                if wanted_unsigned { "unsigned integer" } else { "floating-point number" },
                if wanted == 1 { "" } else { "s" }),
        )
    })
}

/// The most bytes of a sample that all colour targets of a pass may have together.
const MAX_TARGET_BYTES: u32 = 32;

/// Checks all targets of a pass together: each once, colours only, and not too large.
pub(crate) fn check_targets(
    pass: &Pass,
    outputs: &[(Spanned<String>, Spanned<String>)],
    textures: &BTreeMap<String, Texture>,
    shader: &Shader,
) -> Vec<Diagnostic> {
    let mut wrong = Vec::new();
    let mut seen = BTreeSet::new();
    let mut bytes = 0;
    for (output, texture) in outputs {
        let at = |message: String, words: &str| {
            let diagnostic = Diagnostic::error(message);
            match &texture.place {
                Some(place) => diagnostic.at(place, words),
                None => diagnostic,
            }
        };
        if !seen.insert(&texture.value) {
            wrong.push(at(
                format!("`{}` writes `{}` twice", pass.name.value, texture.value),
                "again here",
            ));
        }
        let Some(format) = textures.get(&texture.value).map(|t| t.format) else {
            continue;
        };
        if format == Format::Depth32Float {
            wrong.push(
                at(
                    format!(
                        "the output `{}` cannot be written to the depth texture `{}`",
                        output.value, texture.value
                    ),
                    "a depth texture",
                )
                .with_help("write `depth` to it, or give it another format"),
            );
        }
        bytes += format.target_bytes();
    }
    if matches!(shader.entry, Entry::Render { .. }) && bytes > MAX_TARGET_BYTES {
        wrong.push(
            about(
                pass,
                format!(
                    "`{}` writes {bytes} bytes a sample; {MAX_TARGET_BYTES} are allowed",
                    pass.name.value
                ),
            )
            .with_help("take smaller formats, or split the pass"),
        );
    }
    wrong
}
