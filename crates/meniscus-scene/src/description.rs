//! What a scene file says, as it is written.

use std::fmt;
use std::sync::Arc;

use meniscus_source::ron::{Entries, Spanned, from_source};
use meniscus_source::{Report, SourceFile};
use serde::Deserialize;
use serde::de::{Deserializer, Visitor};

pub(crate) type Number = Spanned<f64>;
pub(crate) type Pair = (Number, Number);
pub(crate) type Triple = (Number, Number, Number);

fn number(value: f64) -> Number {
    Spanned::unplaced(value)
}

fn triple(x: f64, y: f64, z: f64) -> Triple {
    (number(x), number(y), number(z))
}

/// A scene file.
#[derive(Debug, Clone, Deserialize)]
#[serde(rename = "Scene", deny_unknown_fields)]
pub(crate) struct SceneFile {
    pub about: String,
    pub camera: CameraFile,
    #[serde(default)]
    pub sun: SunFile,
    #[serde(default)]
    pub sky: SkyFile,
    #[serde(default)]
    pub water: WaterFile,
    #[serde(default)]
    pub pool: BudgetFile,
    #[serde(default)]
    pub materials: Entries<MaterialFile>,
    pub objects: Vec<Spanned<ObjectFile>>,
}

/// A scene given as a difference to another one.
#[derive(Debug, Clone, Deserialize)]
#[serde(rename = "Variant", deny_unknown_fields)]
pub(crate) struct VariantFile {
    pub of: Spanned<String>,
    pub about: String,
    #[serde(default)]
    pub set: Entries<Spanned<Plain>>,
}

/// A number or a word, as text.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Plain(pub String);

impl<'de> Deserialize<'de> for Plain {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct PlainVisitor;
        impl Visitor<'_> for PlainVisitor {
            type Value = Plain;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number or a text such as \"16k\" or \"flat\"")
            }
            fn visit_i64<E>(self, value: i64) -> Result<Plain, E> {
                Ok(Plain(value.to_string()))
            }
            fn visit_u64<E>(self, value: u64) -> Result<Plain, E> {
                Ok(Plain(value.to_string()))
            }
            fn visit_f64<E>(self, value: f64) -> Result<Plain, E> {
                Ok(Plain(value.to_string()))
            }
            fn visit_str<E>(self, text: &str) -> Result<Plain, E> {
                Ok(Plain(text.to_owned()))
            }
        }
        deserializer.deserialize_any(PlainVisitor)
    }
}

/// What a file that can be loaded by name holds.
#[derive(Debug, Clone)]
pub(crate) enum Document {
    Scene(Box<SceneFile>),
    Variant(VariantFile),
}

impl Document {
    /// Reads a file; the first word outside comments says which of both it is.
    pub fn read(file: &Arc<SourceFile>) -> Result<Self, Report> {
        if first_word(&file.text) == "Variant" {
            from_source(file).map(Self::Variant)
        } else {
            from_source(file).map(|scene| Self::Scene(Box::new(scene)))
        }
    }

    /// The line that the file says about itself.
    pub fn about(&self) -> &str {
        match self {
            Self::Scene(scene) => &scene.about,
            Self::Variant(variant) => &variant.about,
        }
    }
}

fn first_word(mut text: &str) -> &str {
    loop {
        text = text.trim_start();
        let rest = if text.starts_with("//") {
            text.split_once('\n')
        } else if text.starts_with("/*") {
            text.split_once("*/")
        } else {
            break;
        };
        text = rest.map_or("", |(_, rest)| rest);
    }
    let end = text
        .find(|c: char| !c.is_alphanumeric())
        .unwrap_or(text.len());
    &text[..end]
}

/// Lengths in metres, angles in degrees.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CameraFile {
    pub position: Pair,
    /// Above the water's level.
    pub height: Number,
    pub target: Triple,
    #[serde(default = "CameraFile::field_of_view")]
    pub field_of_view: Number,
    #[serde(default = "CameraFile::near")]
    pub near: Number,
}

impl CameraFile {
    fn field_of_view() -> Number {
        number(50.0)
    }

    fn near() -> Number {
        number(0.05)
    }
}

/// Azimuth counter-clockwise from +x, elevation above the horizon.
#[derive(Debug, Clone, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct SunFile {
    pub azimuth: Number,
    pub elevation: Number,
    pub colour: Triple,
    pub ambient: Triple,
}

impl Default for SunFile {
    fn default() -> Self {
        Self {
            azimuth: number(-60.0),
            elevation: number(45.0),
            colour: triple(0.9, 0.82, 0.68),
            ambient: triple(0.28, 0.33, 0.4),
        }
    }
}

#[derive(Debug, Clone, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct SkyFile {
    pub horizon: Triple,
    pub zenith: Triple,
    pub deep: Triple,
}

impl Default for SkyFile {
    fn default() -> Self {
        Self {
            horizon: triple(0.72, 0.82, 0.9),
            zenith: triple(0.16, 0.36, 0.68),
            deep: triple(0.01, 0.06, 0.09),
        }
    }
}

#[derive(Debug, Clone, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct WaterFile {
    pub level: Number,
    pub refractive_index: Number,
    pub rms_slope: Number,
    pub time: Number,
    pub geometry: Spanned<GeometryFile>,
    pub waves: Vec<Spanned<WaveFile>>,
}

impl Default for WaterFile {
    fn default() -> Self {
        Self {
            level: number(0.0),
            refractive_index: number(1.333),
            rms_slope: number(0.0),
            time: number(0.0),
            geometry: Spanned::unplaced(GeometryFile::Displaced),
            waves: Vec::new(),
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub(crate) enum GeometryFile {
    Flat,
    Displaced,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct WaveFile {
    /// Where the wave goes, degrees counter-clockwise from +x.
    pub direction: Number,
    /// Metres.
    pub wavelength: Number,
    /// Amplitude relative to the other waves'.
    #[serde(default = "WaveFile::weight")]
    pub weight: Number,
    /// Degrees.
    #[serde(default = "WaveFile::phase")]
    pub phase: Number,
    /// Radians per second; that of deep water if it isn't given.
    pub angular_frequency: Option<Number>,
}

impl WaveFile {
    fn weight() -> Number {
        number(1.0)
    }

    fn phase() -> Number {
        number(0.0)
    }
}

/// How many triangles the generators are to make.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct BudgetFile {
    pub triangles: Option<Spanned<Count>>,
}

/// A number that may be written with a suffix: 16000, "16k", "1M".
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Count(pub f64);

impl Count {
    /// Reads a number with or without a suffix.
    pub fn parse(text: &str) -> Option<Self> {
        let text = text.trim();
        let (digits, factor) = match text.chars().last()? {
            'k' | 'K' => (&text[..text.len() - 1], 1e3),
            'm' | 'M' => (&text[..text.len() - 1], 1e6),
            _ => (text, 1.0),
        };
        digits.parse::<f64>().ok().map(|value| Self(value * factor))
    }
}

impl<'de> Deserialize<'de> for Count {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct CountVisitor;
        impl Visitor<'_> for CountVisitor {
            type Value = Count;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a count such as 16000, \"16k\" or \"1M\"")
            }
            fn visit_i64<E>(self, value: i64) -> Result<Count, E> {
                Ok(Count(value as f64))
            }
            fn visit_u64<E>(self, value: u64) -> Result<Count, E> {
                Ok(Count(value as f64))
            }
            fn visit_f64<E>(self, value: f64) -> Result<Count, E> {
                Ok(Count(value))
            }
            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Count, E> {
                Count::parse(text).ok_or_else(|| {
                    E::custom(format!(
                        "`{text}` is no count; write 16000, \"16k\" or \"1M\""
                    ))
                })
            }
        }
        deserializer.deserialize_any(CountVisitor)
    }
}

/// Linear RGB albedo, and tiles over it.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct MaterialFile {
    pub colour: Triple,
    pub tiles: Option<TilesFile>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TilesFile {
    pub size: Number,
    pub line: Number,
    #[serde(default = "TilesFile::offset")]
    pub offset: Number,
    pub colour: Triple,
}

impl TilesFile {
    fn offset() -> Number {
        number(0.0)
    }
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ObjectFile {
    pub name: Spanned<String>,
    pub material: Spanned<String>,
    pub shape: Spanned<Shape>,
    #[serde(default = "ObjectFile::origin")]
    pub translate: Triple,
    /// Degrees about the x, then the y, then the z axis.
    #[serde(default = "ObjectFile::origin")]
    pub rotate: Triple,
    #[serde(default = "ObjectFile::unit")]
    pub scale: Triple,
    /// Longest side of a cell, metres, whatever the budget.
    pub edge: Option<Number>,
    /// How many times finer than the budget's edge the cells are.
    #[serde(default = "ObjectFile::one")]
    pub detail: Number,
    /// Whether an upright shape gets a row of vertices at the water's level.
    #[serde(default = "ObjectFile::yes")]
    pub waterline: bool,
    /// How it moves with the scene's time.
    pub motion: Option<MotionFile>,
}

/// A rigid motion, from where the object is placed on.
#[derive(Debug, Clone, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct MotionFile {
    /// Metres per second.
    pub velocity: Triple,
    /// About the object's own origin: the axis, as long as it turns in degrees per second.
    pub turn: Triple,
    /// Up and down.
    pub heave: Option<HeaveFile>,
}

impl Default for MotionFile {
    fn default() -> Self {
        Self {
            velocity: triple(0.0, 0.0, 0.0),
            turn: triple(0.0, 0.0, 0.0),
            heave: None,
        }
    }
}

/// amplitude · sin(2π t / period)
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct HeaveFile {
    /// Metres.
    pub amplitude: Number,
    /// Seconds.
    pub period: Number,
}

impl ObjectFile {
    fn origin() -> Triple {
        triple(0.0, 0.0, 0.0)
    }

    fn unit() -> Triple {
        triple(1.0, 1.0, 1.0)
    }

    fn one() -> Number {
        number(1.0)
    }

    fn yes() -> bool {
        true
    }
}

/// A generator with its numbers (metres, degrees), or a mesh file.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) enum Shape {
    /// About the origin.
    Box { size: Triple },
    /// About the origin.
    Sphere { radius: Number },
    /// Upright, about the origin.
    Cylinder { radius: Number, height: Number },
    /// About the z axis.
    Torus { radius: Number, tube: Number },
    /// About the origin, facing up.
    Plane { size: Pair },
    /// A basin seen from inside; z = 0 is where its water is.
    Pool {
        size: Pair,
        depth: Number,
        rise: Number,
    },
    /// A slab with a rectangular hole along z, about the origin.
    Frame {
        inner: Pair,
        outer: Pair,
        height: Number,
    },
    /// A lattice of upright and level bars in the x–z plane.
    Bars {
        size: Pair,
        count: (u32, u32),
        thickness: Number,
    },
    /// Thin rods at random places on z = 0.
    Reeds {
        count: u32,
        area: Pair,
        height: Number,
        radius: Number,
        lean: Number,
        seed: u64,
    },
    /// An OBJ, glTF or GLB file, relative to the scene file.
    Mesh {
        file: Spanned<String>,
        #[serde(default)]
        up: Up,
        #[serde(default)]
        normals: Normals,
    },
}

/// The file's axis that points up; it becomes z.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub(crate) enum Up {
    #[default]
    Y,
    Z,
}

/// Where shading normals come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub(crate) enum Normals {
    /// From the file; smooth where it has none.
    #[default]
    File,
    Smooth,
    Flat,
}
