//! Why a pass does not run on the CPU.

use meniscus_stress::Trap;

/// Why a pass does not run on the CPU.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CpuError {
    /// The pass draws triangles.
    #[error(
        "pass `{pass}` draws triangles, which takes a GPU; compute and screen passes run on the CPU"
    )]
    Draw {
        /// The pass.
        pass: String,
    },
    /// The pass tests or writes depth while it covers the screen.
    #[error("pass `{pass}` writes depth, which takes a GPU")]
    Depth {
        /// The pass.
        pass: String,
    },
    /// Something that the pass reads or writes is not in the store.
    #[error("pass `{pass}` uses `{resource}`, {problem}")]
    Resource {
        /// The pass.
        pass: String,
        /// The texture, buffer or block.
        resource: String,
        /// What is wrong with it.
        problem: String,
    },
    /// The shader cannot be evaluated.
    #[error("pass `{pass}`: {trap}")]
    Shader {
        /// The pass.
        pass: String,
        /// What happened.
        trap: Trap,
    },
}
