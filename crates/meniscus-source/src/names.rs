//! Suggestions for misspelt names.

/// The candidate nearest to `name`, if it is near enough to be meant.
///
/// Ties fall to the candidate that comes first in order, so the answer is deterministic.
pub fn did_you_mean<'a>(
    name: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    let leaf = |path: &'a str| path.rsplit('/').next().unwrap_or(path);
    let mut best: Option<(f64, &str)> = None;
    for candidate in candidates {
        let whole = strsim::damerau_levenshtein(name, candidate) as f64
            / name.chars().count().max(candidate.chars().count()).max(1) as f64;
        // A right name in the wrong folder is as good as a small slip.
        let moved = if !name.is_empty() && leaf(candidate) == name.rsplit('/').next().unwrap_or("")
        {
            0.1
        } else {
            1.0
        };
        let distance = whole.min(moved);
        let nearer = best.is_none_or(|(least, known)| {
            distance < least || (distance == least && candidate < known)
        });
        if distance <= 0.4 && nearer {
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
    }
}
