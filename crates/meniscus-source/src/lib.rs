//! Source files, places in them, and messages that point there.
//!
//! Whatever a user can write (RON, WGSL, meshes) is read through this crate, so that every error
//! names file, line and column in what they wrote, says what is wrong, and how to mend it.

mod diagnostic;
mod file;
mod names;
mod parts;
pub mod ron;
mod tree;

pub use diagnostic::{Diagnostic, Label, Report, Severity};
pub use file::{MAX_SOURCE_BYTES, Place, SourceFile};
pub use names::did_you_mean;
pub use parts::parts_of;
pub use tree::read_tree;
