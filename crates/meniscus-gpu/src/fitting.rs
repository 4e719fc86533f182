//! Whether the passes of a plan fit together.

use meniscus_pipeline::{PassKind, Plan, PlannedPass, Size};
use meniscus_shader::Entry;

use crate::uses::{reads, writes};
use crate::{GpuError, formats};

/// Whether a pass fits together: what no graphics library would tell in the pipeline's words.
///
/// # Errors
/// When stages, outputs, textures or sizes do not fit, or a texture is read while it is written.
pub(crate) fn check(plan: &Plan, pass: &PlannedPass) -> Result<(), GpuError> {
    let wrong = |message: String| Err(GpuError::Plan(format!("pass `{}` {message}", pass.name)));
    let renders = matches!(pass.kind, PassKind::Draw(_) | PassKind::Screen);
    if renders != matches!(pass.shader.entry, Entry::Render { .. }) {
        return wrong("has a shader of another stage than it runs in".to_owned());
    }
    if renders && pass.targets.len() != pass.shader.outputs.len() {
        let (outputs, targets) = (pass.shader.outputs.len(), pass.targets.len());
        return wrong(format!(
            "has {outputs} outputs and {targets} textures to write"
        ));
    }
    let written = writes(pass);
    if let Some(both) = reads(pass).find(|name| written.contains(name)) {
        return wrong(format!("reads the texture `{both}` while it writes it"));
    }
    if renders && written.is_empty() {
        return wrong("writes no texture, which a draw or screen pass has to".to_owned());
    }
    let mut first: Option<(&str, Size)> = None;
    for name in pass
        .targets
        .iter()
        .map(String::as_str)
        .chain(pass.depth.as_deref())
    {
        let Some(texture) = plan.textures.get(name) else {
            return wrong(format!("writes the texture `{name}`, which is not there"));
        };
        if formats::is_depth(texture.format) != (pass.depth.as_deref() == Some(name)) {
            return wrong(format!(
                "writes `{name}` as what it is not: depth goes to a depth format, and only depth"
            ));
        }
        match first {
            Some((first, size)) if size != texture.size => {
                return wrong(format!(
                    "writes `{first}` and `{name}`, which differ in size"
                ));
            }
            _ => first = Some((name, texture.size)),
        }
    }
    Ok(())
}

/// The formats of a pass's colour targets.
pub(crate) fn colour_formats(
    plan: &Plan,
    pass: &PlannedPass,
) -> Result<Vec<wgpu::TextureFormat>, GpuError> {
    // Storage textures' formats are in the shader.
    if !matches!(pass.kind, PassKind::Draw(_) | PassKind::Screen) {
        return Ok(Vec::new());
    }
    let format = |name: &String| {
        let texture = plan.textures.get(name).ok_or_else(|| {
            GpuError::Plan(format!(
                "pass `{}` writes the texture `{name}`, which is not there",
                pass.name
            ))
        })?;
        Ok(formats::to_wgpu(texture.format))
    };
    pass.targets.iter().map(format).collect()
}
