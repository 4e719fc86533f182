//! Numbers of a scene that can be set from outside, with their ranges: one table for the help,
//! for what a file says and for what the command line says.

use std::sync::Arc;

use meniscus_source::ron::Spanned;
use meniscus_source::{Diagnostic, Place, Report, SourceFile};

use crate::description::{Count, GeometryFile, Number, SceneFile};

/// A number of a scene that can be set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Key {
    /// Its name: the path of fields in a scene file.
    pub name: &'static str,
    /// One line, with the unit.
    pub meaning: &'static str,
    /// What it may be.
    pub values: Values,
}

/// What a setting may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Values {
    /// A number from `least` to `most`, both included.
    Number {
        /// The smallest value.
        least: f64,
        /// The largest value.
        most: f64,
    },
    /// A number of things, which may be written with `k` or `M` behind it.
    Count {
        /// The smallest value.
        least: f64,
        /// The largest value.
        most: f64,
    },
    /// One of some words.
    Choice(&'static [&'static str]),
}

impl std::fmt::Display for Values {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number { least, most } => write!(f, "{least} to {most}"),
            Self::Count { least, most } => write!(f, "{least} to {most}, or like 16k, 1M"),
            Self::Choice(words) => f.write_str(&words.join(" or ")),
        }
    }
}

/// A key and the value it is to have.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// The key; it may not exist.
    pub key: Spanned<String>,
    /// The value as written.
    pub value: Spanned<String>,
}

impl Setting {
    /// A setting that was written nowhere.
    pub fn new(key: impl Into<String>, value: impl Into<String>) -> Self {
        Self {
            key: Spanned::unplaced(key.into()),
            value: Spanned::unplaced(value.into()),
        }
    }

    /// Reads `KEY=VALUE`; `source` is what messages call the text's origin, such as `--set`.
    ///
    /// # Errors
    /// When there is no `=` or no key.
    pub fn parse(source: &str, text: &str) -> Result<Self, Diagnostic> {
        let file = SourceFile::new(source, text);
        let spanned = |range: std::ops::Range<usize>| Spanned {
            value: text[range.clone()].trim().to_owned(),
            place: Some(Place::new(&file, range)),
        };
        match text.find('=') {
            Some(at) if !text[..at].trim().is_empty() => Ok(Self {
                key: spanned(0..at),
                value: spanned(at + 1..text.len()),
            }),
            _ => Err(Diagnostic::error("a setting is written KEY=VALUE")
                .at(&Place::new(&file, 0..text.len()), "")
                .with_help("for example water.rms_slope=0.05")),
        }
    }
}

/// Where a key's value stands in a scene file.
enum Field {
    Number(fn(&mut SceneFile) -> &mut Number),
    Count(fn(&mut SceneFile) -> &mut Option<Spanned<Count>>),
    Geometry(fn(&mut SceneFile) -> &mut Spanned<GeometryFile>),
}

const fn numbers(least: f64, most: f64) -> Values {
    Values::Number { least, most }
}

const fn key(
    name: &'static str,
    meaning: &'static str,
    values: Values,
    field: Field,
) -> (Key, Field) {
    (
        Key {
            name,
            meaning,
            values,
        },
        field,
    )
}

const GEOMETRIES: &[&str] = &["flat", "displaced"];

static KEYS: [(Key, Field); 16] = [
    key(
        "camera.position.x",
        "where the eye stands, metres",
        numbers(-1e5, 1e5),
        Field::Number(|s| &mut s.camera.position.0),
    ),
    key(
        "camera.position.y",
        "where the eye stands, metres",
        numbers(-1e5, 1e5),
        Field::Number(|s| &mut s.camera.position.1),
    ),
    key(
        "camera.height",
        "the eye above the water's level, metres",
        numbers(-1e5, 1e5),
        Field::Number(|s| &mut s.camera.height),
    ),
    key(
        "camera.target.x",
        "the point looked at, metres",
        numbers(-1e5, 1e5),
        Field::Number(|s| &mut s.camera.target.0),
    ),
    key(
        "camera.target.y",
        "the point looked at, metres",
        numbers(-1e5, 1e5),
        Field::Number(|s| &mut s.camera.target.1),
    ),
    key(
        "camera.target.z",
        "the point looked at, metres",
        numbers(-1e5, 1e5),
        Field::Number(|s| &mut s.camera.target.2),
    ),
    key(
        "camera.field_of_view",
        "from bottom to top, degrees",
        numbers(1.0, 170.0),
        Field::Number(|s| &mut s.camera.field_of_view),
    ),
    key(
        "camera.near",
        "distance of the near plane, metres",
        numbers(1e-5, 100.0),
        Field::Number(|s| &mut s.camera.near),
    ),
    key(
        "sun.azimuth",
        "where it stands, degrees counter-clockwise from +x",
        numbers(-360.0, 360.0),
        Field::Number(|s| &mut s.sun.azimuth),
    ),
    key(
        "sun.elevation",
        "how high it stands, degrees",
        numbers(-90.0, 90.0),
        Field::Number(|s| &mut s.sun.elevation),
    ),
    key(
        "water.level",
        "z of the rest plane, metres",
        numbers(-1e4, 1e4),
        Field::Number(|s| &mut s.water.level),
    ),
    key(
        "water.refractive_index",
        "of the water relative to the air",
        numbers(0.4, 2.5),
        Field::Number(|s| &mut s.water.refractive_index),
    ),
    key(
        "water.rms_slope",
        "the waves' √⟨|∇h|²⟩; 0 is flat",
        numbers(0.0, 4.0),
        Field::Number(|s| &mut s.water.rms_slope),
    ),
    key(
        "water.time",
        "seconds",
        numbers(-1e6, 1e6),
        Field::Number(|s| &mut s.water.time),
    ),
    key(
        "water.geometry",
        "whether rays meet the rest plane or the waves",
        Values::Choice(GEOMETRIES),
        Field::Geometry(|s| &mut s.water.geometry),
    ),
    key(
        "pool.triangles",
        "about how many triangles the scene is to have",
        Values::Count {
            least: 12.0,
            most: 16e6,
        },
        Field::Count(|s| &mut s.pool.triangles),
    ),
];

/// Every key there is.
pub fn keys() -> impl Iterator<Item = &'static Key> {
    KEYS.iter().map(|(key, _)| key)
}

/// Puts settings in place of what the file says; later ones win.
pub(crate) fn apply(scene: &mut SceneFile, settings: &[Setting]) -> Report {
    let mut report = Report::default();
    for setting in settings {
        if let Err(diagnostic) = apply_one(scene, setting) {
            report.add(diagnostic);
        }
    }
    report
}

fn apply_one(scene: &mut SceneFile, setting: &Setting) -> Result<(), Diagnostic> {
    let name = setting.key.value.as_str();
    let Some((key, field)) = KEYS.iter().find(|(key, _)| key.name == name) else {
        let unknown = located(
            Diagnostic::error(format!("unknown setting `{name}`")),
            &setting.key.place,
        );
        let all: Vec<&str> = keys().map(|key| key.name).collect();
        let near = unknown.with_suggestion(name, all.iter().copied());
        return Err(near.with_help(format!("the settings are {}", all.join(", "))));
    };
    let text = setting.value.value.as_str();
    let refused = |what: &str| {
        located(
            Diagnostic::error(format!("`{name}` must be {what}, not `{text}`")),
            &setting.value.place,
        )
        .with_help(format!("{name}: {} ({})", key.meaning, key.values))
    };
    let place = setting.value.place.clone();
    match field {
        Field::Number(field) => {
            let value = text.parse::<f64>().map_err(|_| refused("a number"))?;
            *field(scene) = Spanned { value, place };
        }
        Field::Count(field) => {
            let value = Count::parse(text).ok_or_else(|| refused("a count"))?;
            *field(scene) = Some(Spanned { value, place });
        }
        Field::Geometry(field) => {
            let value = match text.to_ascii_lowercase().as_str() {
                "flat" => GeometryFile::Flat,
                "displaced" => GeometryFile::Displaced,
                _ => return Err(refused("flat or displaced")),
            };
            *field(scene) = Spanned { value, place };
        }
    }
    Ok(())
}

/// Checks every key's value, wherever it was written.
pub(crate) fn check(scene: &mut SceneFile) -> Report {
    let mut report = Report::default();
    for (key, field) in &KEYS {
        let (value, place) = match field {
            Field::Number(field) => {
                let number = field(scene);
                (number.value, number.place.clone())
            }
            Field::Count(field) => match field(scene) {
                Some(count) => (count.value.0, count.place.clone()),
                None => continue,
            },
            Field::Geometry(_) => continue,
        };
        let (Values::Number { least, most } | Values::Count { least, most }) = key.values else {
            continue;
        };
        if let Err(diagnostic) = within(key.name, &Spanned { value, place }, least, most) {
            report.add(diagnostic.with_help(key.meaning));
        }
    }
    report
}

/// Whether a number is one, and in its range.
pub(crate) fn within(
    name: &str,
    number: &Number,
    least: f64,
    most: f64,
) -> Result<f64, Diagnostic> {
    let value = number.value;
    if value >= least && value <= most {
        return Ok(value);
    }
    let what = if value.is_finite() {
        "out of range"
    } else {
        "not a finite number"
    };
    let message = format!("`{name}` is {value}, which is {what}");
    Err(located(Diagnostic::error(message), &number.place)
        .with_help(format!("`{name}` goes from {least} to {most}")))
}

/// Adds a place if there is one.
pub(crate) fn located(diagnostic: Diagnostic, place: &Option<Place>) -> Diagnostic {
    match place {
        Some(place) => diagnostic.at(place, ""),
        None => diagnostic,
    }
}

/// A place that covers a whole file's name only, for messages that have no better one.
pub(crate) fn start_of(file: &Arc<SourceFile>) -> Place {
    Place::new(file, 0..0)
}
