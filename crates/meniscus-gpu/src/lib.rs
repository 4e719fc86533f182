//! Runs a plan on wgpu: resources, caches, timing, read-back.
