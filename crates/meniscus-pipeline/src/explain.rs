//! What is kept of a pipeline and what is dropped, by which fact and rule, and what that saves.

use std::collections::BTreeMap;

use meniscus_shader::Composer;
use meniscus_source::Report;
use serde::Serialize;

use crate::explain_clusters::{ClustersSaid, Drawing};
use crate::explain_memory::guarded_texel;
use crate::explain_parts::{Said, facts_said};
use crate::outlook::Outlook;
use crate::pipeline::Pipeline;
use crate::plan::{Format, Plan, Pruning};

/// Why a plan is what it is. [`std::fmt::Display`] writes it for people.
#[derive(Debug, Clone, Serialize)]
pub struct Explanation {
    /// The pipeline's name.
    pub pipeline: String,
    /// What it is.
    pub about: String,
    /// Width and height of the frame, pixels.
    pub size: [u32; 2],
    /// By how many pixels what is shown may move, at most: see [`Plan::within_px`].
    pub within_px: f64,
    /// What is known.
    pub facts: Vec<FactSaid>,
    /// The passes in the order they would run; those of shortcuts only where they are taken.
    pub passes: Vec<PassSaid>,
    /// Shorter ways.
    pub shortcuts: Vec<ShortcutSaid>,
    /// Modules that fill slots of passes.
    pub modules: Vec<ModuleSaid>,
    /// Textures and buffers.
    pub resources: Vec<ResourceSaid>,
    /// Objects by their side of the water.
    pub objects: Vec<ObjectsSaid>,
    /// What remains, and what there would be if nothing were left out.
    pub total: [Total; 2],
    /// Width and height of textures with a guard band, pixels; unknown before
    /// [`Explanation::with_memory`].
    pub guarded: Option<[u32; 2]>,
    /// Bytes that a frame allocates for textures and buffers: less than the total's where some are
    /// never needed at once, and share memory. Unknown likewise.
    pub allocated_bytes: Option<u64>,
    /// Bytes for each pixel of the textures with a guard band that remain, and that there would be.
    #[serde(skip)]
    pub(crate) guarded_texels: [u64; 2],
    /// Passes that draw triangles.
    #[serde(skip)]
    pub(crate) drawings: Vec<Drawing>,
}

/// What a fact says of a scene.
#[derive(Debug, Clone, Serialize)]
pub struct FactSaid {
    /// Its name.
    pub name: &'static str,
    /// Whether it holds.
    pub holds: bool,
    /// What it means.
    pub says: &'static str,
    /// Numbers behind it; empty for none.
    pub numbers: String,
}

/// What becomes of a pass.
#[derive(Debug, Clone, Serialize)]
pub struct PassSaid {
    /// Its name.
    pub name: String,
    /// Whether it runs.
    pub kept: bool,
    /// What it runs over.
    pub over: String,
    /// Its skeleton.
    pub skeleton: String,
    /// Slots and what fills them, by path.
    pub slots: BTreeMap<String, String>,
    /// Why it does not run.
    pub dropped: Option<DroppedSaid>,
    /// What it does, or would do.
    pub work: Work,
    /// For a draw that runs, what of it is out of view: see [`Explanation::with_clusters`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clusters: Option<ClustersSaid>,
}

/// By which rule something is left out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DroppedSaid {
    /// The rule's name.
    pub rule: &'static str,
    /// What the rule says.
    pub says: &'static str,
    /// The facts, or whatever the rule refers to.
    pub because: String,
    /// What it promises: `choice`, `exact`, or `within`.
    pub promise: &'static str,
    /// By how much of a pixel what is shown may move.
    pub within_px: f64,
}

/// Bounds on what a pass does in a frame.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Work {
    /// Draws.
    pub draws: u64,
    /// Dispatches.
    pub dispatches: u64,
    /// Triangles of the scene, before any is divided.
    pub triangles: u64,
    /// Pixels that it covers; none where a list decides, or the triangles.
    pub pixels: Option<u64>,
}

/// Whether a shortcut is taken.
#[derive(Debug, Clone, Serialize)]
pub struct ShortcutSaid {
    /// Its name.
    pub name: String,
    /// Whether it is taken.
    pub taken: bool,
    /// Why, or why not.
    pub because: String,
    /// The passes it stands for.
    pub instead_of: Vec<String>,
    /// Its own passes.
    pub passes: Vec<String>,
}

/// What becomes of a module.
#[derive(Debug, Clone, Serialize)]
pub struct ModuleSaid {
    /// Its path.
    pub path: String,
    /// Whether a pass that runs is filled with it.
    pub kept: bool,
    /// The passes that are filled with it, those that do not run included.
    pub passes: Vec<String>,
}

/// What becomes of a texture or buffer.
#[derive(Debug, Clone, Serialize)]
pub struct ResourceSaid {
    /// Its name.
    pub name: String,
    /// Whether it is made.
    pub kept: bool,
    /// What it is.
    pub what: String,
    /// Its size in memory; without a guard band, which depends on the water's slopes, before
    /// [`Explanation::with_memory`].
    pub bytes: u64,
    /// Bytes of a texel, for textures with a guard band; else 0.
    #[serde(skip)]
    pub(crate) guarded_texel: u64,
    /// Why it is not made.
    pub dropped: Option<DroppedSaid>,
}

/// Objects on one side of the water.
#[derive(Debug, Clone, Serialize)]
pub struct ObjectsSaid {
    /// Which.
    pub side: &'static str,
    /// How many.
    pub objects: u64,
    /// Their triangles.
    pub triangles: u64,
    /// The passes that draw them.
    pub drawn_by: Vec<String>,
    /// The passes that would draw them if nothing were left out, and do not.
    pub not_by: Vec<String>,
}

/// What a plan comes to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Total {
    /// Passes.
    pub passes: u64,
    /// Draws.
    pub draws: u64,
    /// Dispatches.
    pub dispatches: u64,
    /// Triangles of the scene, once for each draw.
    pub triangles: u64,
    /// Bytes of textures and buffers, without guard bands before [`Explanation::with_memory`]; each
    /// counts, whether or not it shares memory with others.
    pub bytes: u64,
}

impl Format {
    /// Bytes of a texel.
    pub fn bytes(self) -> u64 {
        match self {
            Self::R32Float | Self::R32Uint | Self::Rgba8Unorm | Self::Depth32Float => 4,
            Self::Rg32Float | Self::Rgba16Float => 8,
            Self::Rgba32Float | Self::Rgba32Uint => 16,
        }
    }
}

impl Explanation {
    /// Explains the plan of a pipeline for what a camera sees.
    ///
    /// # Errors
    /// As [`Plan::pruned`].
    pub fn new(
        pipeline: &Pipeline,
        composer: &Composer,
        outlook: &Outlook,
        pruning: Pruning,
    ) -> Result<Self, Report> {
        let facts = outlook.facts;
        let (plan, decisions) = Plan::decided(pipeline, composer, &facts, pruning, false)?;
        let whole = Plan::pruned(pipeline, composer, &facts, Pruning::None, false)?;
        let said = Said {
            pipeline,
            composer,
            outlook,
            plan: &plan,
            whole: &whole,
            decisions: &decisions,
        };
        Ok(Self {
            pipeline: pipeline.name.clone(),
            about: pipeline.about.clone(),
            size: outlook.size.to_array(),
            within_px: plan.within_px,
            facts: facts_said(&facts, outlook),
            passes: said.passes(),
            shortcuts: said.shortcuts(),
            modules: said.modules(),
            resources: said.resources(),
            objects: said.objects(),
            total: [said.total(&plan), said.total(&whole)],
            guarded: None,
            allocated_bytes: None,
            guarded_texels: [guarded_texel(&plan), guarded_texel(&whole)],
            drawings: plan.passes.iter().filter_map(Drawing::of).collect(),
        })
    }
}
