//! Pipelines declared in RON: variants, facts, plans, without a GPU.

mod diff;
mod facts;
mod file;
mod graph;
pub mod host;
mod interface;
mod outlook;
mod pipeline;
mod plan;
mod planner;
mod schema;
mod variant;

pub use diff::diff;
pub use facts::{Facts, KNOWN as KNOWN_FACTS, check_facts};
pub use file::{Dispatch, Over, Runs};
pub use outlook::{Counted, FINE_EDGES_PX, Outlook, Rect, SceneBounds};
pub use pipeline::{Pass, PassOver, Pipeline, Pipelines};
pub use plan::{
    Buffer, Covers, Format, Geometry, PassKind, Plan, PlannedPass, Pruning, Size, Texture,
};
pub use schema::SCHEMA;
