//! WGSL modules, slots, composition and validation, without a GPU.

mod shader;

pub use shader::{Attribute, Binding, BindingKind, Entry, Sample, Shader};
