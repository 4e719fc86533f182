//! The truth: a scene ray traced in f64 on the CPU.
