//! A composed text, and where each part of it was written.

use std::ops::Range;
use std::sync::Arc;

use meniscus_source::{Place, SourceFile};

/// A composed text, and where each part of it came from.
#[derive(Debug, Default)]
pub(crate) struct Source {
    pub text: String,
    segments: Vec<Segment>,
}

#[derive(Debug)]
struct Segment {
    /// Bytes of the composed text.
    range: Range<usize>,
    /// Where they stand in what the user wrote.
    place: Place,
    /// Whether each byte maps onto one; otherwise (a renamed word) the whole onto the whole.
    exact: bool,
}

impl Source {
    pub fn copy(&mut self, file: &Arc<SourceFile>, range: Range<usize>) {
        let start = self.text.len();
        self.text.push_str(&file.text[range.clone()]);
        self.segments.push(Segment {
            range: start..self.text.len(),
            place: Place::new(file, range),
            exact: true,
        });
    }

    pub fn rename(&mut self, file: &Arc<SourceFile>, range: Range<usize>, name: &str) {
        let start = self.text.len();
        self.text.push_str(name);
        self.segments.push(Segment {
            range: start..self.text.len(),
            place: Place::new(file, range),
            exact: false,
        });
    }

    /// Where a range of the composed text was written.
    pub fn origin(&self, range: Range<usize>) -> Option<Place> {
        let index = self
            .segments
            .partition_point(|s| s.range.end <= range.start);
        let Some(first) = self
            .segments
            .get(index)
            .filter(|s| s.range.start <= range.start)
        else {
            // Right behind a part, where something is missing, the part's end is meant.
            let before = self.segments.get(index.checked_sub(1)?)?;
            let gap = self.text.get(before.range.end..range.start)?;
            let end = before.place.range.end;
            return gap
                .trim()
                .is_empty()
                .then(|| Place::new(&before.place.file, end..end));
        };
        let start = match first.exact {
            true => first.place.range.start + (range.start - first.range.start),
            false => first.place.range.start,
        };
        // The end may lie in a later segment of the same file.
        let end = self.segments[index..]
            .iter()
            .take_while(|s| s.range.start < range.end && s.place.file == first.place.file)
            .last()
            .map_or(first.place.range.end, |last| match last.exact {
                true => last.place.range.start + (range.end.min(last.range.end) - last.range.start),
                false => last.place.range.end,
            });
        Some(Place::new(&first.place.file, start..end.max(start)))
    }
}
