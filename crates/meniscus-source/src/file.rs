//! A text a user wrote, and a range in it.

use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use crate::Diagnostic;

/// The largest text that is read: far above any honest module or pipeline, far below what would
/// exhaust a parser's stack or the machine's memory.
pub const MAX_SOURCE_BYTES: u64 = 1 << 20;

/// A named text.
#[derive(Debug, PartialEq, Eq)]
pub struct SourceFile {
    /// What messages call it: a path as the user gave it, or the path of a built-in file.
    pub name: String,
    /// The text, in UTF-8.
    pub text: String,
}

impl SourceFile {
    /// A text that is at hand already. A byte-order mark at its start is dropped.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Arc<Self> {
        let mut text = text.into();
        if text.starts_with('\u{feff}') {
            text.drain(..'\u{feff}'.len_utf8());
        }
        Arc::new(Self {
            name: name.into(),
            text,
        })
    }

    /// Reads a file of at most [`MAX_SOURCE_BYTES`].
    ///
    /// # Errors
    /// When it cannot be read, is too large or is not UTF-8; the message names the path.
    pub fn read(path: &Path) -> Result<Arc<Self>, Diagnostic> {
        let name = path.display().to_string();
        let size = std::fs::metadata(path)
            .map_err(|error| Diagnostic::error(format!("cannot read `{name}`: {error}")))?
            .len();
        if size > MAX_SOURCE_BYTES {
            return Err(Diagnostic::error(format!(
                "`{name}` has {size} bytes; at most {MAX_SOURCE_BYTES} are read"
            ))
            .with_help("split it into several files"));
        }
        let bytes = std::fs::read(path)
            .map_err(|error| Diagnostic::error(format!("cannot read `{name}`: {error}")))?;
        let text = String::from_utf8(bytes).map_err(|error| {
            Diagnostic::error(format!(
                "`{name}` is not UTF-8: the byte at offset {} begins no character",
                error.utf8_error().valid_up_to()
            ))
        })?;
        Ok(Self::new(name, text))
    }

    /// Line and column, both from 1, of a byte offset; columns count characters.
    pub fn line_column(&self, offset: usize) -> (usize, usize) {
        let mut end = offset.min(self.text.len());
        while !self.text.is_char_boundary(end) {
            end -= 1;
        }
        let before = &self.text[..end];
        let line = before.matches('\n').count() + 1;
        let column = before.chars().rev().take_while(|&c| c != '\n').count() + 1;
        (line, column)
    }

    /// The byte offset of a line and column, both from 1.
    pub fn offset(&self, line: usize, column: usize) -> usize {
        let start: usize = self
            .text
            .split_inclusive('\n')
            .take(line.saturating_sub(1))
            .map(str::len)
            .sum();
        let rest = &self.text[start..];
        start
            + rest
                .char_indices()
                .nth(column.saturating_sub(1))
                .map_or(rest.len(), |(at, _)| at)
    }
}

/// A range of bytes in a source file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub file: Arc<SourceFile>,
    /// The bytes meant.
    pub range: Range<usize>,
}

impl Place {
    /// A range in a file.
    pub fn new(file: &Arc<SourceFile>, range: Range<usize>) -> Self {
        Self {
            file: file.clone(),
            range,
        }
    }

    /// The text that stands there.
    pub fn text(&self) -> &str {
        self.file.text.get(self.range.clone()).unwrap_or("")
    }
}

impl std::fmt::Display for Place {
    /// `file:line:column`
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (line, column) = self.file.line_column(self.range.start);
        write!(f, "{}:{line}:{column}", self.file.name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offset_and_line_column_are_inverse() {
        let file = SourceFile::new("a", "ab\nçd\r\n\n€");
        for (at, _) in file.text.char_indices() {
            let (line, column) = file.line_column(at);
            assert_eq!(file.offset(line, column), at);
        }
        assert_eq!(file.line_column(4), (2, 1), "inside a character: its start");
        assert_eq!(file.offset(99, 99), file.text.len());
    }
}
