//! Reading a folder of source files.

use std::path::Path;
use std::sync::Arc;

use crate::{Diagnostic, Report, SourceFile};

/// The most files that are read from one folder.
const MAX_FILES: usize = 20_000;
/// The deepest folder within it.
const MAX_DEPTH: usize = 16;

/// All files below a folder whose names end in `.ending`, with their paths relative to it, without
/// the ending, and with `/` between the parts; in the order of these paths. Links are not followed.
///
/// # Errors
/// When the folder or a file cannot be read, and when there are too many.
pub fn read_tree(folder: &Path, ending: &str) -> Result<Vec<(String, Arc<SourceFile>)>, Report> {
    let mut found = Vec::new();
    let mut report = Report::default();
    walk(folder, "", ending, 0, &mut found, &mut report);
    found.sort_by(|(a, _), (b, _)| a.cmp(b));
    report.into_result(found)
}

fn walk(
    folder: &Path,
    prefix: &str,
    ending: &str,
    depth: usize,
    found: &mut Vec<(String, Arc<SourceFile>)>,
    report: &mut Report,
) {
    let entries = match std::fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) => {
            report.add(Diagnostic::error(format!(
                "cannot read the folder `{}`: {error}",
                folder.display()
            )));
            return;
        }
    };
    for entry in entries.flatten() {
        let Ok(kind) = entry.file_type() else {
            continue;
        };
        let name = entry.file_name().to_string_lossy().into_owned();
        if found.len() >= MAX_FILES {
            report.add(Diagnostic::error(format!(
                "`{}` holds more than {MAX_FILES} files",
                folder.display()
            )));
            return;
        }
        if kind.is_dir() && depth < MAX_DEPTH {
            walk(
                &entry.path(),
                &format!("{prefix}{name}/"),
                ending,
                depth + 1,
                found,
                report,
            );
        } else if kind.is_file()
            && let Some(stem) = name.strip_suffix(ending).and_then(|n| n.strip_suffix('.'))
        {
            match SourceFile::read(&entry.path()) {
                Ok(file) => found.push((format!("{prefix}{stem}"), file)),
                Err(wrong) => report.add(wrong),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::read_tree;

    #[test]
    fn files_come_in_the_order_of_their_paths_and_missing_folders_are_told() {
        let here = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
        let files = read_tree(here, "rs").unwrap();
        let names: Vec<_> = files.iter().map(|(name, _)| name.as_str()).collect();
        assert!(
            names.contains(&"src/tree") && names.is_sorted(),
            "{names:?}"
        );
        let missing = read_tree(&here.join("nowhere"), "rs")
            .unwrap_err()
            .to_string();
        assert!(missing.contains("cannot read the folder"), "{missing}");
    }
}
