//! WGSL modules, slots, composition and validation, without a GPU.
