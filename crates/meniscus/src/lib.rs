//! meniscus: shader pipelines put together by configuration, and refraction that is both fast and
//! right.
//!
//! A [`Project`] holds modules, pipelines and scenes, the built-in ones and those of directories.
//! [`Picture`] renders one pipeline, a [`Sequence`] one at several moments, an [`Ablation`] several beside
//! ray-traced truth. The parts are crates of their own and re-exported here.

mod ablation;
mod costs;
mod device_run;
mod facts;
mod judging;
mod lists;
mod marginal;
mod moments;
mod on_gpu;
mod output;
mod picture;
mod preset;
mod project;
mod prove;
mod provenance;
mod report;
mod rivalry;
mod rounds;
mod rows;
mod scene_stress;
mod sequence;
mod solvers;
mod stability;
mod subject;
mod sweep;
mod truth;
mod warnings;

pub use ablation::{Ablation, AblationError, Outcome, Progress, RowOutcome};
pub use device_run::{Device, PassDifference, PassError, Passes, bound, colours};
pub use facts::{facts_of, outlook_of};
pub use marginal::{Without, leave_one_out, table as marginal_table};
pub use moments::moments_text;
pub use on_gpu::FunctionsOnGpu;
pub use output::write_directory;
pub use picture::{Picture, PictureError};
pub use preset::{Figures, Preset, PresetAxis, Published};
pub use project::{Project, Sources};
pub use prove::{Case, Difference, Place, Proof, Proved};
pub use report::{Beside, report, sweep_report};
pub use rivalry::{Rivalry, contests_markdown, contests_of, contests_text};
pub use rounds::{Rounds, Until};
pub use scene_stress::{
    Distance, SceneCheck, SceneFailure, SceneStress, StressedScenes, oddity_names,
};
pub use sequence::{Sequence, Shot};
pub use solvers::{Solver, solvers};
pub use stability::{StabilityData, short, solvers_figures, stability_page};
pub use sweep::{Axis, Partition, fingerprint, points};
pub use warnings::gathered_warnings;

pub use meniscus_cpu as cpu;
pub use meniscus_gpu as gpu;
pub use meniscus_measure as measure;
pub use meniscus_pipeline as pipeline;
pub use meniscus_reference as reference;
pub use meniscus_scene as scene;
pub use meniscus_shader as shader;
pub use meniscus_source as source;
pub use meniscus_stress as stress;

/// The commit that this program was built from, or `unknown`.
pub const COMMIT: &str = env!("MENISCUS_COMMIT");
