//! Meshes, cameras and water, from files and by code, without a GPU.
//!
//! World space is right-handed with z up, in metres; the water's rest plane is a constant z.
//! Everything that both the pipelines and the truth need to agree on is data in this crate;
//! neither borrows the other's formulas.

mod camera;
mod check;
mod clusters;
mod description;
mod export;
mod generate;
mod gltf_file;
mod library;
mod lower;
mod mesh;
mod mesh_file;
mod model;
mod motion;
mod polygon;
mod schema;
mod settings;
mod shapes;
mod soup;
mod water;

pub use camera::{Camera, View};
pub use clusters::{Cluster, Clusters, Side, WaterBand};
pub use export::{
    CameraExport, MaterialExport, MotionExport, ObjectExport, SceneExport, SkyExport, SunExport,
    TilesExport, WaterExport, WaveExport,
};
pub use library::{Library, SceneSource};
pub use mesh::Sides;
pub use model::{
    Material, Mesh, Object, Pattern, Scene, Sky, Sun, Triangle, Water, WaterGeometry, Wave,
};
pub use motion::{Body, Motion, Moving};
pub use schema::SCHEMA;
pub use settings::{Key, Setting, Values, keys};
