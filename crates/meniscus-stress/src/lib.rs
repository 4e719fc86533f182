//! Runs module functions on the CPU in several number systems and hunts their worst inputs.
//!
//! [`Program`] takes naga's IR, the very module that a GPU runs, and evaluates its functions and
//! entry points, 64 lanes at a time, in any [`Scalar`]: `f32` (as a GPU computes), `f64`,
//! [`DoubleDouble`], [`Interval`], [`Stochastic`], [`Dual`]. [`Function::trace`] names the line of
//! WGSL at which `f32` and `f64` part. [`Subject::hunt`] looks for the worst inputs of a function
//! and splits their errors into rounding, method and conditioning.
//!
//! ```
//! use meniscus_stress::{Lanes, Program, Resources, Settings};
//!
//! let module = naga::front::wgsl::parse_str("fn twice(x: f32) -> f32 { return 2.0 * x; }")?;
//! let mut validator = naga::valid::Validator::new(
//!     naga::valid::ValidationFlags::all(),
//!     naga::valid::Capabilities::all(),
//! );
//! let info = validator.validate(&module)?;
//! let program = Program::new(&module, &info, Settings::default())?;
//! let twice = program.function("twice")?;
//! let x = Lanes::<f64>::scalars(&[1.0, 2.5]);
//! let y = twice.call(&[x], 2, &Resources::new())?;
//! assert_eq!(y.floats(0), Some(&[2.0, 5.0][..]));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod code;
mod compile;
mod entry;
mod error;
mod function;
mod machine;
pub mod modules;
pub mod number;
mod op;
mod registers;
mod resources;
mod shape;
mod stress;
mod texel;
mod trace;
pub mod ulp;

pub use code::Site;
pub use compile::{Program, Settings};
pub use entry::{Entry, Feed, Pixels, Varying};
pub use error::{Trap, Unsupported};
pub use function::{Function, Outcome};
pub use number::{DoubleDouble, Dual, Elementary, Interval, Scalar, Shadow, Stochastic, Whole};
pub use resources::{Buffer, DepthTest, Resources, Sampler, Texture, Wrap};
pub use shape::{Column, Kind, Lanes, Shape};
pub use stress::{
    Case, Domain, Effort, Elsewhere, Exhausted, Findings, Input, NEARBY, Picture, Place, Range,
    Relation, Spread, Subject, Truth, Verdict, WORST_KEPT,
};
pub use texel::stored_texel;
pub use trace::{Parting, Trace};
