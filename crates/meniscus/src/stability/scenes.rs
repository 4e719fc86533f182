//! What random scenes have shown, and which extremes they reached.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use meniscus_measure::MeasureError;
use serde_json::{Map, Value};

use super::{missing, number, table, words};

/// An extreme that scenes are to reach: a kind of oddity, and the values that count, by size.
struct Extreme {
    said: &'static str,
    kinds: &'static [&'static str],
    values: [f64; 2],
}

const fn extreme(
    said: &'static str,
    kinds: &'static [&'static str],
    low: f64,
    high: f64,
) -> Extreme {
    Extreme {
        said,
        kinds,
        values: [low, high],
    }
}

const EYE: &[&str] = &["eye above the rest plane, m", "eye above the waves, m"];
const SMALL: &[&str] = &[
    "a speck of, m",
    "a blade this thin, m",
    "nothing but a ball of radius, m",
    "nothing but a floor this deep, m",
    "a basin this deep, m",
];
const LARGE: &[&str] = &[
    "a thing as far away as, m",
    "huge triangles, m",
    "everything this far from the origin, m",
    "nothing but a ball of radius, m",
    "nothing but a floor this deep, m",
    "a basin this deep, m",
];
const WITHIN: &[&str] = &[
    "a thing that ends in the water's plane, off by m",
    "a sheet in the water's plane, off by m",
];
const SIDE: &[&str] = &[
    "picture 1 pixel wide, of height",
    "picture 1 pixel high, of width",
];

static EXTREMES: &[Extreme] = &[
    extreme("the camera on the surface", EYE, 0.0, 0.0),
    extreme("the camera within 1e-7 m of it", EYE, 1e-300, 1e-7),
    extreme(
        "the camera in an object or a wall",
        &[
            "eye in the ball, m from its middle",
            "eye on the wall, m from it",
        ],
        0.0,
        1.0,
    ),
    extreme("objects at 1e-4 m", SMALL, 1e-4, 1e-4),
    extreme("objects at 1e5 m", LARGE, 1e5, 1e5),
    extreme(
        "things within 1e-7 m of the water's plane",
        WITHIN,
        0.0,
        1e-7,
    ),
    extreme(
        "rays that graze the water",
        &["gaze level, off by"],
        0.0,
        1.0,
    ),
    extreme("degenerate triangles", &["degenerate triangles"], 0.0, 0.0),
    extreme(
        "amplitude 0",
        &["rms slope", "no waves at all", "one wave without weight"],
        0.0,
        0.0,
    ),
    extreme(
        "tiny amplitudes: slopes up to 1e-4",
        &["rms slope"],
        1e-300,
        1e-4,
    ),
    extreme(
        "past overturning: slopes from 1 on",
        &["rms slope"],
        1.0,
        f64::INFINITY,
    ),
    extreme("refractive index 1", &["refractive index"], 1.0, 1.0),
    extreme(
        "refractive index 1 − 1e-7",
        &["refractive index"],
        1.0 - 1e-7,
        1.0 - 1e-7,
    ),
    extreme(
        "refractive index 1 + 1e-7",
        &["refractive index"],
        1.0 + 1e-7,
        1.0 + 1e-7,
    ),
    extreme("refractive index 0.4", &["refractive index"], 0.4, 0.4),
    extreme("refractive index 2.5", &["refractive index"], 2.5, 2.5),
    extreme("field of view 1°", &["field of view, degrees"], 1.0, 1.0),
    extreme(
        "field of view 170°",
        &["field of view, degrees"],
        170.0,
        170.0,
    ),
    extreme("far/near of 1e7", &["far / near = 1e7"], 0.0, 1.0),
    extreme("odd sizes", &["picture of odd size"], 0.0, 1e9),
    extreme("one pixel wide or high", SIDE, 2.0, 1e9),
    extreme("1 × 1 pixel", SIDE, 1.0, 1.0),
];

impl Extreme {
    /// In how many scenes an oddity of these kinds had such a value.
    fn times(&self, oddities: &Map<String, Value>) -> f64 {
        let [low, high] = self.values;
        let rounding = 1e-12 * low;
        let counts = oddities.iter().filter(|(said, _)| {
            let (kind, value) = split(said);
            let size = value.parse::<f64>().map_or(f64::NAN, f64::abs);
            self.kinds.contains(&kind) && low - rounding <= size && size <= high + rounding
        });
        counts.filter_map(|(_, times)| times.as_f64()).sum()
    }
}

/// A kind of oddity and its value, of how both are said.
fn split(said: &str) -> (&str, &str) {
    said.rsplit_once(": ").unwrap_or((said, ""))
}

pub(super) fn told(page: &mut String, scenes: &Value) -> Result<(), MeasureError> {
    let (tried, pictures) = (number(scenes, "/scenes")?, number(scenes, "/pictures")?);
    let failures = scenes.get("failures").and_then(Value::as_array);
    let failures = failures.ok_or_else(|| missing("failures"))?.len();
    let refused = scenes.get("refused").and_then(Value::as_object);
    let refused = refused.ok_or_else(|| missing("refused"))?;
    let oddities = scenes.get("oddities").and_then(Value::as_object);
    let oddities = oddities.ok_or_else(|| missing("oddities"))?;
    let _ = writeln!(
        page,
        "\n## Extreme scenes\n\n\
         {tried} random scenes of seed {} were rendered by two pipelines each, by turns of {}: {pictures} \
         pictures, of which {failures} fail. A picture holds when no texture has a NaN or an infinity, a \
         second frame and a frame that leaves out what it can are equal to it bit for bit, no driver or \
         graphics library objects, nothing panics, and, where the scene lies in the modules' domains \
         and a pass traces the scene's triangles, it shows the points that a ray tracer in `f64` shows.\n",
        number(scenes, "/seed")?,
        number(scenes, "/pipelines")?,
    );
    let _ = writeln!(
        page,
        "{} pictures with {} pixels of water were held to that truth: {} pixels are more than half a \
         pixel off; the mean error is {:.4} pixels.\n",
        number(scenes, "/judged")?,
        number(scenes, "/distance/pixels")?,
        number(scenes, "/distance/far")?,
        number(scenes, "/distance/mean_px")?,
    );
    if refused.is_empty() {
        *page += "No scene was refused.\n\n";
    } else {
        *page += "Scenes that were refused in words, which is no failure:\n\n";
        for (why, times) in refused {
            let _ = writeln!(page, "- {times} × {why}");
        }
        *page += "\n";
    }
    reached(page, oddities);
    *page += "\nA scene is an ordinary pool that is made odd in up to six of these ways; of each, the \
              values lie at those listed in `crates/meniscus/src/scene_stress/oddities.rs` or between \
              them:\n\n";
    let mut kinds: BTreeMap<&str, (f64, BTreeSet<&str>)> = BTreeMap::new();
    for (said, times) in oddities {
        let (name, value) = split(said);
        let kind = kinds.entry(name).or_default();
        kind.0 += times.as_f64().unwrap_or(0.0);
        kind.1.insert(value);
    }
    for (name, (times, values)) in kinds {
        let _ = writeln!(page, "- {name}: {times} scenes, {} values", values.len());
    }
    Ok(())
}

/// How often each extreme was reached that is asked for.
fn reached(page: &mut String, oddities: &Map<String, Value>) {
    *page += "How often they reached what is asked of them at least:\n\n";
    let mut rows = vec![words(["extreme", "scenes"])];
    for extreme in EXTREMES {
        let times = extreme.times(oddities);
        rows.push(vec![extreme.said.to_owned(), format!("{times}")]);
    }
    *page += &table(&rows);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extremes_are_of_oddities_that_there_are() {
        let known = crate::oddity_names();
        for extreme in EXTREMES {
            for kind in extreme.kinds {
                assert!(known.iter().any(|name| name == kind), "{kind}");
            }
        }
    }

    #[test]
    fn values_count_by_size_and_kind() {
        let said = [
            ("rms slope: 1e-9", 3),
            ("rms slope: 4.0", 5),
            ("rms slope: 0.0", 7),
            ("waves: 1.0", 11),
            ("eye above the waves, m: -1e-7", 13),
        ];
        let said = said.map(|(name, times)| (name.to_owned(), Value::from(times)));
        let oddities: Map<String, Value> = said.into_iter().collect();
        let times = |said: &str| {
            let extreme = EXTREMES.iter().find(|e| e.said.starts_with(said));
            extreme.map(|e| e.times(&oddities))
        };
        assert_eq!(times("tiny"), Some(3.0));
        assert_eq!(times("past overturning"), Some(5.0));
        assert_eq!(times("amplitude 0"), Some(7.0));
        assert_eq!(times("the camera within"), Some(13.0));
        assert_eq!(times("the camera on"), Some(0.0));
    }
}
