//! Errors, statistics, tables and pictures: plain slices in, figures out.
//!
//! What is here knows nothing of GPUs, scenes or tracers. A caller hands over what was shown and what
//! is true, pixel by pixel ([`Comparison`]), and the frame times it took ([`Timing`]); it gets figures
//! ([`Errors`]), tables ([`Table`]), false colours ([`heat`]) and the results file ([`Results`]).
//!
//! Nothing is dropped: a NaN counts as the largest error there is, never as no error.

mod axes;
mod colour;
mod contest;
mod curves;
mod error;
mod errors;
mod files;
mod geometric;
pub mod heat;
mod image_metrics;
mod npy;
mod random;
mod results;
mod statistics;
mod sweep;
mod table;
mod time_error;
mod timing;
mod trend;

pub use colour::{
    ColourError, MAX_PSNR_DB, colour_error, linear_to_srgb, srgb_to_linear, to_srgb8,
};
pub use contest::{Claim, Contest, contests, dominated_by};
pub use curves::{Curve, curves_figure};
pub use error::MeasureError;
pub use errors::{BorderErrors, Errors};
pub use files::{png_bytes, write_atomically, write_png};
pub use geometric::{Comparison, Judgement, Picture, Seen, Verdict};
pub use image_metrics::{
    Better, Difference, Exposures, FlipOptions, Image, METRICS, Metric, Viewing, Yee, flip,
    flip_hdr, metric, psnr, rmse, ssim, yee,
};
pub use npy::{NpyData, npy_bytes};
pub use results::{Counters, FrameMs, PassMs, Relative, Results, Row, Timer, TruthGeometry};
pub use statistics::{Summary, median, quantile};
pub use sweep::{Sweep, SweepPoint};
pub use table::{Table, aligned};
pub use time_error::{FigurePoint, pareto_front, plane_figure, time_error_figure};
pub use timing::{Timing, TimingWarning, relative_time, timing_warnings};
