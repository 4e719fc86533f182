//! Whether there is room for what is to be written, asked before the work begins.

use std::path::{Path, PathBuf};

use meniscus::source::{Diagnostic, Report};

/// Refuses files and a directory that cannot be written. Missing directories of files are fine:
/// they are made when there is something to write.
pub(crate) fn check<'a>(
    files: impl IntoIterator<Item = &'a PathBuf>,
    directory: Option<&PathBuf>,
) -> Result<(), Report> {
    let mut report = Report::default();
    for file in files {
        if file.is_dir() {
            let message = format!("cannot write `{}`: it is a directory", file.display());
            report.add(Diagnostic::error(message).with_help("name a file in it"));
        } else {
            let parent = file.parent().unwrap_or(Path::new(""));
            report.extend(room(file, parent).err().unwrap_or_default());
        }
    }
    if let Some(directory) = directory {
        report.extend(room(directory, directory).err().unwrap_or_default());
    }
    report.into_result(())
}

/// Whether a file can be made in a directory, or where the directory will be.
fn room(wanted: &Path, directory: &Path) -> Result<(), Report> {
    let there = directory
        .ancestors()
        .map(|part| match part.as_os_str().is_empty() {
            true => Path::new("."),
            false => part,
        })
        .find(|part| part.exists());
    let there = there.unwrap_or(Path::new("."));
    match tempfile::tempfile_in(there) {
        Ok(_) => Ok(()),
        Err(error) => {
            let reason = match there.is_dir() {
                true => format!("no file can be made in `{}`: {error}", there.display()),
                false => format!("`{}` is no directory", there.display()),
            };
            let message = format!("cannot write `{}`: {reason}", wanted.display());
            Err(Diagnostic::error(message)
                .with_help("name a place that exists, or that can be made, and may be written to")
                .into())
        }
    }
}
