//! WGSL modules, slots, composition and validation, without a GPU.
//!
//! A *module* is a WGSL file with a few pure functions; a *slot* a named signature with a default
//! body; a *skeleton* the body of a kind of pass, which calls slots. A [`Composer`] turns a
//! [`Recipe`] (a skeleton and what fills its slots) into a [`Shader`]: one text, validated by
//! naga, with the bindings assigned. See this crate's README for the module format.

mod alone;
mod check;
mod compose;
mod contract;
mod demand;
mod entry;
mod explain;
mod export;
mod filling;
mod header;
mod instance;
mod ir;
mod lexer;
mod library;
mod names;
mod numbers;
mod outline;
mod predeclared;
mod purity;
mod shader;
mod signature;
mod template;
mod text;
mod used;

pub use alone::Alone;
pub use compose::{Composer, Output, Recipe, Stage};
pub use export::{Exported, Language};
pub use filling::Filling;
pub use header::{Header, Identity, Name, Number, Requirement, SlotUse, When};
pub use library::{Library, Module, Role};
pub use numbers::LIVE_NUMBERS;
pub use shader::{Attribute, Binding, BindingKind, Entry, LiveNumber, Sample, Shader};
