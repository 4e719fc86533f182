//! Shaders in other languages than WGSL, written by naga's back ends.

mod glsl;

use std::collections::BTreeMap;

use meniscus_source::Diagnostic;
use naga::back::{hlsl, msl, spv};
use naga::valid::ModuleInfo;

use crate::ir;
use crate::shader::{BindingKind, Shader};

/// What a shader can be written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Language {
    /// SPIR-V 1.3: one module with every stage; little-endian words.
    SpirV,
    /// HLSL for shader model 6.0: one text with every stage.
    Hlsl,
    /// Metal's language, version 2.4: one text with every stage.
    Msl,
    /// GLSL 4.50: a text for each stage.
    Glsl,
    /// GLSL ES 3.10: a text for each stage.
    GlslEs,
}

/// A shader, or one stage of it, in another language.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Exported {
    /// The stage that it holds, as file endings of GLSL have it (`vert`, `frag`, `comp`); none where
    /// it holds all.
    pub stage: Option<&'static str>,
    /// Text in UTF-8, or the words of SPIR-V.
    pub bytes: Vec<u8>,
}

/// The version of Metal's language.
const METAL: (u8, u8) = (2, 4);

impl Language {
    fn name(self) -> &'static str {
        match self {
            Self::SpirV => "SPIR-V 1.3",
            Self::Hlsl => "HLSL 6.0",
            Self::Msl => "MSL 2.4",
            Self::Glsl => "GLSL 4.50",
            Self::GlslEs => "GLSL ES 3.10",
        }
    }
}

impl Shader {
    /// The shader in another language, with the values of its numbers (by the names of the
    /// `override`s in the IR; defaults for the others). A resource keeps its number of binding in
    /// SPIR-V, HLSL and GLSL; in Metal, buffers, textures and samplers are counted for themselves,
    /// in the order of the bindings, and the sizes of arrays follow the buffers. In GLSL, what the
    /// host must know of flat values stands in the text.
    ///
    /// # Errors
    /// What the language cannot express, and numbers that are no values of their types.
    pub fn export(
        &self,
        language: Language,
        numbers: &BTreeMap<String, f64>,
    ) -> Result<Vec<Exported>, Diagnostic> {
        // Live numbers are in a buffer, whatever the language.
        let constants = self
            .constants(numbers)
            .map(|(name, value)| (name.to_owned(), value))
            .collect();
        let cannot = |what: String| {
            Diagnostic::error(format!(
                "{} cannot express this shader: {what}",
                language.name()
            ))
            .with_help("take another format; wgsl and spirv hold every shader")
        };
        ir::run_apart(|| {
            let es = match language {
                Language::Glsl => Some(false),
                Language::GlslEs => Some(true),
                _ => None,
            };
            let prepared = es.map(|_| glsl::prepared(self)).transpose();
            let prepared = prepared.map_err(cannot)?.flatten();
            let (module, info) = match &prepared {
                Some((module, info)) => (module, info),
                None => (&self.module, &self.info),
            };
            let (module, info) = naga::back::pipeline_constants::process_overrides(
                module, info, None, &constants,
            )
            .map_err(|error| Diagnostic::error(format!("the numbers do not suit: {error}")))?;
            match language {
                Language::SpirV => spirv(&module, &info),
                Language::Hlsl => hlsl(&module, &info),
                Language::Msl => self.msl(&module, &info),
                Language::Glsl | Language::GlslEs => {
                    glsl::write(module.into_owned(), info.into_owned(), es == Some(true))
                }
            }
            .map_err(|what| cannot(what).into())
        })
        .map_err(|report| {
            let first = report.0.into_iter().next();
            first.unwrap_or_else(|| cannot("naga gave no reason".into()))
        })
    }

    /// The slots of Metal's resources: buffers, textures and samplers are counted for themselves.
    fn metal_resources(&self) -> msl::EntryPointResources {
        let mut resources = msl::EntryPointResources::default();
        let [mut buffers, mut textures, mut samplers] = [0_u8; 3];
        // A slot beyond what Metal has stays without, which naga then refuses.
        let take = |counter: &mut u8| {
            let slot = *counter;
            *counter = counter.saturating_add(1);
            Some(slot)
        };
        for binding in &self.bindings {
            let mut target = msl::BindTarget::default();
            match binding.kind {
                BindingKind::Uniform(_) => target.buffer = take(&mut buffers),
                BindingKind::Storage { read_only, .. } => {
                    target.buffer = take(&mut buffers);
                    target.mutable = !read_only;
                }
                BindingKind::Texture { .. } => target.texture = take(&mut textures),
                BindingKind::StorageTexture { .. } => {
                    target.texture = take(&mut textures);
                    target.mutable = true;
                }
                BindingKind::Sampler => {
                    target.sampler = take(&mut samplers).map(msl::BindSamplerTarget::Resource);
                }
            }
            let place = naga::ResourceBinding {
                group: 0,
                binding: binding.index,
            };
            resources.resources.insert(place, target);
        }
        resources.sizes_buffer = Some(buffers);
        resources
    }

    fn msl(&self, module: &naga::Module, info: &ModuleInfo) -> Result<Vec<Exported>, String> {
        let resources = self.metal_resources();
        let options = msl::Options {
            lang_version: METAL,
            fake_missing_bindings: false,
            per_entry_point_map: module
                .entry_points
                .iter()
                .map(|entry| (entry.name.clone(), resources.clone()))
                .collect(),
            ..Default::default()
        };
        let (text, translation) =
            msl::write_string(module, info, &options, &msl::PipelineOptions::default())
                .map_err(|error| error.to_string())?;
        for name in translation.entry_point_names {
            name.map_err(|error| error.to_string())?;
        }
        Ok(whole(text.into_bytes()))
    }
}

fn whole(bytes: Vec<u8>) -> Vec<Exported> {
    vec![Exported { stage: None, bytes }]
}

fn spirv(module: &naga::Module, info: &ModuleInfo) -> Result<Vec<Exported>, String> {
    let options = spv::Options {
        lang_version: (1, 3),
        ..Default::default()
    };
    let words = spv::write_vec(module, info, &options, None).map_err(|error| error.to_string())?;
    Ok(whole(
        words.into_iter().flat_map(u32::to_le_bytes).collect(),
    ))
}

fn hlsl(module: &naga::Module, info: &ModuleInfo) -> Result<Vec<Exported>, String> {
    let options = hlsl::Options {
        shader_model: hlsl::ShaderModel::V6_0,
        ..Default::default()
    };
    let everything = hlsl::PipelineOptions::default();
    let mut text = String::new();
    let reflection = hlsl::Writer::new(&mut text, &options, &everything)
        .write(module, info, None)
        .map_err(|error| error.to_string())?;
    for name in reflection.entry_point_names {
        name.map_err(|error| error.to_string())?;
    }
    Ok(whole(text.into_bytes()))
}
