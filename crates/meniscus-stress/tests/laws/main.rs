//! Laws that the shader modules obey, evaluated on the CPU from the very WGSL that a GPU runs.

mod crossing;
mod domains;
mod exceptions;
mod flat_water;
mod geometry;
mod lab;
mod marches;
mod optics;
mod screen;
mod shading;
mod sides;
mod truths;
mod water;
mod waves;
mod worst;
