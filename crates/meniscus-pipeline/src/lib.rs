//! Pipelines declared in RON: variants, facts, plans, without a GPU.

pub mod host;
mod plan;

pub use plan::{
    Buffer, Format, Geometry, PassKind, Plan, PlannedPass, Size, Texture,
};
