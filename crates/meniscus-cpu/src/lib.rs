//! Runs the compute and screen passes of a plan on the CPU.
//!
//! A [`Store`] holds the textures and buffers between passes. [`run_pass`] runs one pass on it: the
//! shader that a GPU would run, evaluated in `f32` with 64 pixels side by side, on all cores. Draws
//! need a GPU. The host's blocks and arrays are asked for as bytes, in the layout that the shader
//! declares.
//!
//! Two runs on equal stores end with equal stores, but for the order of lists that threads append to.

mod coding;
mod error;
mod pass;
mod store;

pub use error::CpuError;
pub use pass::{Host, is_drawn, run_pass, uses, writes};
pub use store::{Store, Texels};
