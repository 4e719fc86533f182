//! What can go wrong with the numbers and files handed to this crate.

use std::fmt;
use std::path::PathBuf;

/// Why a measurement, a results file or a picture could not be made.
#[derive(Debug)]
pub enum MeasureError {
    /// A slice has another length than the frame has pixels.
    Length {
        /// Which slice, in words.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length it should have.
        expected: usize,
    },
    /// A number is outside of what the measurement can use.
    Value {
        /// Which number, in words.
        what: String,
        /// What is wrong with it and what would serve.
        problem: String,
    },
    /// A file could not be read or written.
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The content of a results file or picture is not what it should be.
    Format {
        /// The file or the thing, in words.
        what: String,
        /// What is wrong, with line and column where there is one.
        problem: String,
    },
}

impl MeasureError {
    pub(crate) fn value(what: impl Into<String>, problem: impl Into<String>) -> Self {
        Self::Value {
            what: what.into(),
            problem: problem.into(),
        }
    }

    pub(crate) fn format(what: impl Into<String>, problem: impl fmt::Display) -> Self {
        Self::Format {
            what: what.into(),
            problem: problem.to_string(),
        }
    }

    pub(crate) fn check_length(
        what: &'static str,
        found: usize,
        expected: usize,
    ) -> Result<(), Self> {
        if found == expected {
            Ok(())
        } else {
            Err(Self::Length {
                what,
                found,
                expected,
            })
        }
    }
}

impl fmt::Display for MeasureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length {
                what,
                found,
                expected,
            } => write!(f, "{what}: {found} values where {expected} are needed"),
            Self::Value { what, problem } => write!(f, "{what}: {problem}"),
            Self::File { path, source } => write!(f, "{}: {source}", path.display()),
            Self::Format { what, problem } => write!(f, "{what}: {problem}"),
        }
    }
}

impl std::error::Error for MeasureError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::File { source, .. } => Some(source),
            _ => None,
        }
    }
}
