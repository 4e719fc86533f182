//! The Python that the independent check of the figures needs.

use crate::command;

/// Whether `python3` is there, with numpy.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Python {
    WithNumpy,
    WithoutNumpy,
    Missing,
}

impl Python {
    pub(crate) fn find() -> Self {
        if command::succeeds("python3", &["-c", "import numpy"]) {
            Self::WithNumpy
        } else if command::succeeds("python3", &["-c", ""]) {
            Self::WithoutNumpy
        } else {
            Self::Missing
        }
    }

    /// What is lacking, and what would mend it; nothing where all is there.
    pub(crate) fn lacks(self) -> Option<&'static str> {
        match self {
            Self::WithNumpy => None,
            Self::WithoutNumpy => {
                Some("python3 has no numpy (`python3 -m pip install numpy`, or python3-numpy)")
            }
            Self::Missing => Some("there is no python3 (it needs numpy as well)"),
        }
    }
}
