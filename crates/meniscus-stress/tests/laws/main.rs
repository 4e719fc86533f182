//! Laws that the shader modules obey, evaluated on the CPU from the very WGSL that a GPU runs.

mod crossing;
mod flat_water;
mod lab;
mod optics;
