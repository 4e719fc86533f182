//! The truth: a scene ray traced in f64 on the CPU.
//!
//! Every figure that the project prints about errors is measured against what this crate says, so
//! it takes its data from [`meniscus_scene`] and its formulas from nowhere else in the project.
//!
//! * [`trace`] answers for every pixel of a view, [`Tracer`] for some of them, or for one with the
//!   whole path of its ray.
//! * [`apparent_pixel`] and [`mirrored_pixel`] say where a point of the world appears in the
//!   picture, which makes a distance between two points a distance in pixels.
//!
//! A ray is followed from the eye through at most [`MAX_EVENTS`] meetings with the water. At each
//! it is refracted exactly, or reflected where refraction is impossible (total reflection). No
//! light is weighted by Fresnel's equations and none is absorbed.

mod apparent;
mod bvh;
mod path;
mod refraction;
mod shading;
mod surface;
mod triangle;
mod truth;

pub use apparent::{apparent_pixel, mirrored_pixel};
pub use path::{Event, Hit, MAX_EVENTS, Path, Tracer};
pub use surface::Medium;
pub use truth::{Sample, Truth, trace};
