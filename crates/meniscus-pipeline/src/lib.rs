//! Pipelines declared in RON: variants, facts, plans, without a GPU.

mod checks;
mod choose;
mod composed;
mod cull;
mod diff;
mod explain;
mod explain_clusters;
mod explain_memory;
mod explain_parts;
mod explain_text;
mod facts;
mod file;
mod graph;
pub mod host;
mod interface;
mod outlook;
mod pipeline;
mod plan;
mod plan_cache;
mod planner;
mod rules;
mod schema;
mod shortcut;
mod steps;
mod sweep;
mod uses;
mod variant;

pub use cull::{Appears, Cull};
pub use diff::diff;
pub use explain::{
    DroppedSaid, Explanation, FactSaid, ModuleSaid, ObjectsSaid, PassSaid, ResourceSaid,
    ShortcutSaid, Total, Work,
};
pub use explain_clusters::ClustersSaid;
pub use explain_memory::Memory;
pub use facts::{Facts, KNOWN as KNOWN_FACTS, check_facts};
pub use file::{Dispatch, Over, Runs};
pub use interface::SHOWN;
pub use outlook::{Counted, Outlook, Rect, SceneBounds};
pub use pipeline::{Pass, PassOver, Pipeline, Pipelines};
pub use plan::{
    Buffer, Covers, Format, Geometry, PassKind, Plan, PlannedPass, Pruning, Size, Texture,
};
pub use plan_cache::PlanCache;
pub use rules::{Dropped, Promise, Rule};
pub use schema::SCHEMA;
pub use shortcut::Shortcut;
