//! What can go wrong on the way to a picture.

use std::fmt;

/// Why a GPU could not do what was asked.
///
/// Every message says what was being done, what is wrong, and where possible how to mend it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum GpuError {
    /// No adapter, none of the wanted name, or none that can render floating point.
    NoAdapter {
        /// The part of a name that was asked for.
        wanted: Option<String>,
        /// The adapters that are there, each described in one line.
        found: Vec<String>,
    },
    /// The picture or a buffer exceeds a limit of the adapter, or is empty.
    Size(String),
    /// The plan asks for something that does not fit together.
    Plan(String),
    /// The scene holds something that cannot be uploaded.
    Scene(String),
    /// A creation or submission failed.
    Failed {
        /// What was being done.
        doing: String,
        /// What the graphics library says.
        message: String,
    },
    /// The device is gone, or does not come to an end.
    Lost(String),
}

impl fmt::Display for GpuError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoAdapter { wanted, found } => no_adapter(f, wanted.as_deref(), found),
            Self::Size(message) | Self::Plan(message) | Self::Scene(message) => {
                f.write_str(message)
            }
            Self::Failed { doing, message } => write!(f, "{doing}: {}", message.trim()),
            Self::Lost(message) => write!(f, "the device was lost: {message}"),
        }
    }
}

impl std::error::Error for GpuError {}

fn no_adapter(f: &mut fmt::Formatter<'_>, wanted: Option<&str>, found: &[String]) -> fmt::Result {
    match wanted {
        Some(name) => writeln!(f, "no graphics adapter's name contains `{name}`")?,
        None if found.is_empty() => writeln!(f, "there is no graphics adapter")?,
        None => writeln!(
            f,
            "no graphics adapter can render to textures of floating point"
        )?,
    }
    if found.is_empty() {
        return write!(
            f,
            "help: install a GPU driver, or a software adapter; on Debian and Ubuntu: \
             sudo apt-get install mesa-vulkan-drivers libvulkan1"
        );
    }
    write!(f, "there is:")?;
    for adapter in found {
        write!(f, "\n  {adapter}")?;
    }
    write!(
        f,
        "\nhelp: name a part of one of these to use it; a software adapter comes, on Debian and Ubuntu, with: \
         sudo apt-get install mesa-vulkan-drivers libvulkan1"
    )
}
