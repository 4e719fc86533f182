//! Meshes, cameras and water, from files and by code, without a GPU.
//!
//! World space is right-handed with z up, in metres; the water's rest plane is a constant z.
//! Everything that both the pipelines and the truth need to agree on is data in this crate;
//! neither borrows the other's formulas.

mod camera;
mod model;

pub use camera::{Camera, View};
pub use model::{Material, Mesh, Object, Pattern, Scene, Sky, Sun, Triangle, Water, WaterGeometry, Wave};
