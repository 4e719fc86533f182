//! Suggestions for misspelt names.

/// How large a part of a name may differ.
const NEAR: f64 = 0.4;
/// Longer names are nobody's slip of the pen.
const LONGEST: usize = 128;

/// The candidate nearest to `name`, if it is near enough to be meant.
///
/// Ties fall to the candidate that comes first in order, so the answer is deterministic.
pub fn did_you_mean<'a>(
    name: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    let leaf = |path: &'a str| path.rsplit('/').next().unwrap_or(path);
    let mut best: Option<(f64, &str)> = None;
    let length = name.chars().count();
    for candidate in candidates {
        let other = candidate.chars().count();
        let right_leaf =
            !name.is_empty() && leaf(candidate) == name.rsplit('/').next().unwrap_or("");
        // The distance is at least the difference of the lengths; computing it takes their product.
        let hopeless = length.abs_diff(other) as f64 > NEAR * length.max(other) as f64;
        if length > LONGEST || (hopeless && !right_leaf) {
            continue;
        }
        let whole =
            strsim::damerau_levenshtein(name, candidate) as f64 / length.max(other).max(1) as f64;
        // A right name in the wrong folder is as good as a small slip.
        let moved = if right_leaf { 0.1 } else { 1.0 };
        let distance = whole.min(moved);
        let nearer = best.is_none_or(|(least, known)| {
            distance < least || (distance == least && candidate < known)
        });
        if distance <= NEAR && nearer {
            best = Some((distance, candidate));
        }
    }
    best.map(|(_, candidate)| candidate)
}

#[cfg(test)]
mod tests {
    use super::did_you_mean;

    #[test]
    fn slips_and_wrong_folders_are_understood_and_strangers_are_not() {
        let names = ["optics/refracted_ray", "geometry/tangent_plane", "deflect"];
        assert_eq!(did_you_mean("optics/refacted_ray", names), Some(names[0]));
        assert_eq!(did_you_mean("screen/tangent_plane", names), Some(names[1]));
        assert_eq!(did_you_mean("delfect", names), Some(names[2]));
        assert_eq!(did_you_mean("banana", names), None);
        assert_eq!(did_you_mean("", names), None);
        assert_eq!(did_you_mean(&"deflect".repeat(200_000), names), None);
    }
}
