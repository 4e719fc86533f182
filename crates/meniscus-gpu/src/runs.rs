//! Ranges of indices, joined into few draws.

use std::ops::Range;

/// Ranges of indices in order, which do not overlap: a draw each.
pub(crate) type Runs = Vec<Range<u32>>;

/// The most draws that a pass's triangles are split into.
const MOST: usize = 64;

/// Joins ranges, which are in order and do not overlap, where nothing lies between them; and where
/// little does, if there would be too many otherwise.
pub(crate) fn joined(ranges: impl Iterator<Item = Range<u32>>) -> Runs {
    let apart = across(ranges.filter(|range| !range.is_empty()), 0);
    if apart.len() <= MOST {
        return apart;
    }
    let mut gaps: Vec<u32> = apart.windows(2).map(|w| w[1].start - w[0].end).collect();
    gaps.sort_unstable();
    // Of equal gaps all are closed, so that there may be fewer draws, but not more.
    across(apart.into_iter(), gaps[gaps.len() - MOST])
}

/// Joins those between which so many indices lie, or fewer.
fn across(ranges: impl Iterator<Item = Range<u32>>, gap: u32) -> Runs {
    let mut joined: Runs = Vec::new();
    for range in ranges {
        match joined.last_mut() {
            Some(last) if range.start - last.end <= gap => last.end = range.end,
            _ => joined.push(range),
        }
    }
    joined
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lies_together_is_one_draw_and_nothing_is_none() {
        let of = |ranges: &[Range<u32>]| joined(ranges.iter().cloned());
        assert_eq!(of(&[0..3, 3..9, 9..9, 12..15]), [0..9, 12..15]);
        assert!(of(&[]).is_empty() && of(&[6..6, 9..9]).is_empty());
    }

    #[test]
    fn there_are_never_too_many_draws_and_the_smallest_gaps_are_closed() {
        for count in [MOST, MOST + 1, 500] {
            // The gaps grow.
            let mut start = 0;
            let ranges: Vec<Range<u32>> = (0..count as u32)
                .map(|i| {
                    start += 10 + i;
                    start - 10..start - 7
                })
                .collect();
            let made = joined(ranges.iter().cloned());
            assert_eq!(made.len(), MOST);
            for range in &ranges {
                assert!(
                    made.iter()
                        .any(|m| m.start <= range.start && m.end >= range.end)
                );
            }
            assert_eq!(made.last(), ranges.last());
        }
        let even = joined((0..500).map(|i| 10 * i..10 * i + 3));
        assert!(even.len() == 1 && even[0] == (0..4993), "{even:?}");
    }
}
