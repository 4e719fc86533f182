//! What can go wrong, and where.

use crate::code::Site;

/// WGSL that the evaluator cannot run.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{construct} cannot run on the CPU (in `{}`)", site.function)]
pub struct Unsupported {
    /// The construct, in words.
    pub construct: String,
    /// Where it stands.
    pub site: Site,
}

/// Why a run stopped or did not start.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Trap {
    /// There is no such function or entry point.
    #[error("there is no function `{name}`; there are: {}", known.join(", "))]
    NoFunction {
        /// What was asked for.
        name: String,
        /// What there is.
        known: Vec<String>,
    },
    /// The module has no such `override`.
    #[error("there is no `override {name}`; there are: {}", known.join(", "))]
    NoOverride {
        /// What was set.
        name: String,
        /// What there is.
        known: Vec<String>,
    },
    /// WGSL that cannot run.
    #[error(transparent)]
    Unsupported(#[from] Unsupported),
    /// A loop went round too often.
    #[error("a loop in `{}` goes round more than {cap} times; bound it", site.function)]
    EndlessLoop {
        /// The loop.
        site: Site,
        /// The cap.
        cap: u32,
    },
    /// The number of arguments is not what the function takes.
    #[error("`{function}` takes {expected} arguments, not {given}")]
    ArgumentCount {
        /// Name of the function.
        function: String,
        /// Arguments it takes.
        expected: usize,
        /// Arguments given.
        given: usize,
    },
    /// An argument does not have the shape that the function takes.
    #[error("argument `{argument}` of `{function}` is {expected}; the columns given do not match")]
    ArgumentShape {
        /// Name of the function.
        function: String,
        /// Name of the argument.
        argument: String,
        /// Its type in WGSL.
        expected: String,
    },
    /// A resource that the function reads or writes is not there.
    #[error("`{name}` is used, but no {kind} is connected to it")]
    NoResource {
        /// Name of the variable in WGSL.
        name: String,
        /// What belongs there.
        kind: &'static str,
    },
    /// A buffer is smaller than the type of its variable.
    #[error("the buffer for `{name}` has {bytes} bytes; its type needs at least {least}")]
    ShortBuffer {
        /// Name of the variable in WGSL.
        name: String,
        /// Its size.
        bytes: usize,
        /// What the type needs.
        least: usize,
    },
    /// Another device than the evaluator could not call the function.
    #[error("{0}")]
    Device(String),
    /// An entry point is run in a way that is not its own.
    #[error("`{name}` is not a {wanted} entry point")]
    WrongStage {
        /// Name of the entry point.
        name: String,
        /// What was wanted.
        wanted: &'static str,
    },
    /// An input of an entry point that nothing provides.
    #[error("`{entry}` reads {input}, which this run does not provide")]
    NoInput {
        /// Name of the entry point.
        entry: String,
        /// The input.
        input: String,
    },
}
