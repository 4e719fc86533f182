//! Runs a plan on wgpu: resources, caches, timing, read-back.
//!
//! [`Gpu`] is an opened adapter, [`SceneBuffers`] a scene's triangles on it, [`PipelineCache`] the
//! compiled shaders that plans share, and [`Frame`] a plan with all that it needs. A frame is made
//! once and rendered often; between frames only what has changed is written.
//!
//! Adapters draw straight edges, and flat water bends them. The far side of the water is therefore
//! cut at the rest plane and divided on the CPU, for each camera and picture size once, until no
//! edge is off by more than [`BOW_PX`]; [`SceneBuffers::far_side`] tells what that took.
//!
//! A frame does no more than its plan and its scene ask for: textures that are never needed at once
//! share memory, and passes over the water touch the pixels that may show it ([`Skipping`]).
//! [`Frame::render`] runs every pass, which is what is timed; [`Frame::refresh`] runs those alone of
//! which an input has changed since the last frame, and none where nothing has.
//!
//! Objects that move have triangles in buffers of their own, and a tree for rays of their own under a
//! common top: a frame that is brought to another moment writes theirs alone ([`Frame::moved`]), and
//! only passes that draw or read them count as changed.
//!
//! Nothing here panics on what a plan, shader or scene holds: every creation and submission stands
//! inside error scopes, and [`GpuError`] says what was being done.

mod adapter;
mod bindings;
mod bodies;
mod bvh;
mod compute;
mod counters;
mod distance_field;
mod driver_cache;
mod error;
mod fitting;
mod footprint;
mod formats;
mod frame;
mod geometry;
mod given;
mod guard;
mod host_buffers;
mod host_scene;
mod host_uses;
mod host_values;
mod inspect;
mod kept_pipelines;
mod layout;
mod live;
mod moving;
mod parts;
mod pipelines;
mod queries;
mod readback;
mod record;
mod refresh;
mod region;
mod resources;
mod reuse;
mod runs;
mod scene_arrays;
mod scene_buffers;
mod sharing;
mod sight;
mod steps;
mod subdivide;
mod tiles;
mod timing;
mod tracing;
mod uses;
mod wide_bvh;

pub use adapter::{AdapterFacts, Gpu, adapters};
pub use compute::{Compute, run_compute};
pub use counters::{Counters, PassCounters};
pub use distance_field::voxels_asked as field_voxels;
pub use error::GpuError;
pub use footprint::Footprint;
pub use frame::Frame;
pub use given::{Given, GivenTexels};
pub use guard::{GUARD_MAX, GuardFacts, guard, largest_tilt};
pub use host_values::HostValues;
pub use inspect::TextureWords;
pub use kept_pipelines::cache_folder;
pub use moving::Moved;
pub use parts::Skipping;
pub use pipelines::PipelineCache;
pub use readback::Pixels;
pub use refresh::Refreshed;
pub use scene_buffers::{FarSide, Preprocessing, SceneBuffers};
pub use subdivide::BOW_PX;
pub use timing::{FrameTiming, PassTiming, Timer};
