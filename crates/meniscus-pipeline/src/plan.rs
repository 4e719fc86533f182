//! What is left of a pipeline for the facts of one scene: what a GPU is given to do.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

use meniscus_shader::Shader;
use serde::Deserialize;

use crate::cull::Appears;

/// A frame's passes in order, and what lies between them.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The pipeline's name, with the settings that differ from its file.
    pub pipeline: String,
    /// Textures by name.
    pub textures: BTreeMap<String, Texture>,
    /// Buffers by name.
    pub buffers: BTreeMap<String, Buffer>,
    /// Buffers that hold lists of pixels at the end of a frame (x + 65536 y, behind their count), by
    /// the name of what is counted.
    pub lists: BTreeMap<String, String>,
    /// Passes in order.
    pub passes: Vec<PlannedPass>,
    /// The texture that comes out.
    pub output: String,
    /// The texture with the world point (xyz) and object id (w, −1 for none) of which the colour
    /// is displayed; only in plans made for it.
    pub shown: Option<String>,
    /// By how many pixels of the frame what is shown may move because of what was left out, at most:
    /// what the shortcuts that are taken may move it, together. 0: no bit of any output changes.
    pub within_px: f64,
}

/// A texture between passes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Texture {
    /// Texel format.
    pub format: Format,
    /// How large it is.
    pub size: Size,
}

/// A buffer between passes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Buffer {
    /// Bytes that do not depend on the picture.
    pub bytes: u64,
    /// Bytes for each pixel of the frame.
    pub bytes_per_pixel: u64,
    /// Whether it serves as arguments of an indirect dispatch.
    pub indirect: bool,
    /// Whether it is zeroed at the start of every frame.
    pub zeroed: bool,
}

impl fmt::Display for Texture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = match self.size {
            Size::Frame => "as large as the frame",
            Size::Guarded => "with a guard band",
        };
        write!(f, "{:?}, {size}", self.format)
    }
}

impl fmt::Display for Buffer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut said = Vec::new();
        if self.bytes > 0 || self.bytes_per_pixel == 0 {
            said.push(format!("{} bytes", self.bytes));
        }
        if self.bytes_per_pixel > 0 {
            said.push(format!("{} bytes a pixel", self.bytes_per_pixel));
        }
        if self.indirect {
            said.push("arguments of a dispatch".into());
        }
        if self.zeroed {
            said.push("zeroed every frame".into());
        }
        f.write_str(&said.join(", "))
    }
}

/// Texel formats, with WebGPU's names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Deserialize)]
#[allow(missing_docs, reason = "WebGPU's names say all there is to say")]
pub enum Format {
    R32Float,
    Rg32Float,
    R32Uint,
    Rgba8Unorm,
    Rgba16Float,
    Rgba32Float,
    Rgba32Uint,
    Depth32Float,
}

/// How large a texture is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Deserialize)]
pub enum Size {
    /// As large as the frame.
    Frame,
    /// The frame with a guard band on every side, as wide as the water's slopes demand.
    Guarded,
}

/// What may be left out of a plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub enum Pruning {
    /// Nothing: the facts choose between passes, and all else runs.
    None,
    /// What changes no bit of any output.
    Exact,
    /// Also what moves nothing that is shown by more than a declared part of a pixel.
    #[default]
    Approximate,
}

/// The pixels that a pass may touch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub enum Covers {
    /// All of its targets.
    #[default]
    All,
    /// Those that may show water: see [`crate::Outlook::water`]. Others keep what they hold, and are
    /// cleared where nothing has been written yet.
    Water,
    /// The other ones.
    Dry,
}

/// One pass, ready to run.
#[derive(Debug, Clone)]
pub struct PlannedPass {
    /// Its name in the pipeline.
    pub name: String,
    /// What runs.
    pub kind: PassKind,
    /// The pixels that it is meant for; more do no harm.
    pub covers: Covers,
    /// The shader.
    pub shader: Arc<Shader>,
    /// Values of the shader's `override`s, by their names in the IR.
    pub numbers: BTreeMap<String, f64>,
    /// The textures written, in the order of the shader's outputs.
    pub targets: Vec<String>,
    /// The depth texture written and tested against; none for passes without depth.
    pub depth: Option<String>,
    /// The view that is drawn: `view_target` in the shader.
    pub view_target: Size,
    /// The view with which the textures that are read were drawn: `view_seen` in the shader.
    pub view_seen: Size,
    /// Where points appear that it draws; none where that is not known.
    pub appears: Option<Appears>,
}

/// What a pass runs over.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PassKind {
    /// Triangles of the scene.
    Draw(Geometry),
    /// Every pixel of the targets, in a fragment shader.
    Screen,
    /// Every pixel of the targets' size, in a compute shader that stores to its outputs.
    ScreenCompute,
    /// One thread for each pixel of a view, in a compute shader.
    Dispatch(Size),
    /// As many workgroups as a buffer says.
    DispatchIndirect(String),
    /// A fixed number of workgroups.
    DispatchFixed([u32; 3]),
}

/// Which triangles are drawn, relative to the camera's side of the water.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Deserialize)]
pub enum Geometry {
    /// On the camera's side, and those that cross the water.
    NearSide,
    /// On the other side, and those that cross the water.
    FarSide,
    /// All.
    All,
}
