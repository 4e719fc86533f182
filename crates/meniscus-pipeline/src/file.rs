//! Pipeline files as they are written.

use std::collections::BTreeMap;
use std::fmt;

use meniscus_shader::Filling;
use meniscus_source::ron::{Entries, Spanned, fault};
use serde::Deserialize;
use serde::de::{Deserializer, MapAccess, SeqAccess, Visitor, value::MapAccessDeserializer};

use crate::plan::{Format, Geometry, Size};

/// What a file holds.
#[derive(Debug, Deserialize)]
pub(crate) enum File {
    Pipeline(PipelineFile),
    Variant(VariantFile),
}

#[derive(Debug, Deserialize)]
#[serde(rename = "Pipeline", deny_unknown_fields)]
pub(crate) struct PipelineFile {
    pub about: String,
    #[serde(default)]
    pub baseline: bool,
    pub textures: Entries<TextureFile>,
    #[serde(default)]
    pub buffers: Entries<BufferFile>,
    #[serde(default)]
    pub lists: Entries<Spanned<String>>,
    pub sequence: Vec<Step>,
    pub output: OutputFile,
}

#[derive(Debug, Deserialize)]
#[serde(rename = "Variant", deny_unknown_fields)]
pub(crate) struct VariantFile {
    pub of: Spanned<String>,
    pub about: String,
    #[serde(default)]
    pub set: Entries<Spanned<Value>>,
    /// Passes that are left out.
    #[serde(default)]
    pub remove: Vec<Spanned<String>>,
    /// Steps that come right behind a pass.
    #[serde(default)]
    pub insert_after: Entries<Vec<Step>>,
    /// Textures and buffers that are added, or that replace those of their names.
    #[serde(default)]
    pub textures: Entries<TextureFile>,
    #[serde(default)]
    pub buffers: Entries<BufferFile>,
    #[serde(default)]
    pub output: Option<OutputFile>,
}

#[derive(Debug, Deserialize)]
#[serde(rename = "texture", deny_unknown_fields)]
pub(crate) struct TextureFile {
    pub format: Format,
    pub size: Size,
}

#[derive(Debug, Deserialize)]
#[serde(rename = "buffer", deny_unknown_fields)]
pub(crate) struct BufferFile {
    #[serde(default)]
    pub bytes: u32,
    #[serde(default)]
    pub bytes_per_pixel: u32,
    #[serde(default)]
    pub indirect: bool,
    #[serde(default)]
    pub zeroed: bool,
}

#[derive(Debug, Deserialize)]
#[serde(rename = "output", deny_unknown_fields)]
pub(crate) struct OutputFile {
    pub colour: Spanned<String>,
}

/// A pass, or passes in a row.
#[derive(Debug, Clone, Deserialize)]
pub(crate) enum Step {
    Draw(DrawFile),
    Screen(ScreenFile),
    Compute(ComputeFile),
    Repeat(RepeatFile),
    Shortcut(ShortcutFile),
}

#[derive(Debug, Clone, Deserialize)]
#[serde(rename = "Draw", deny_unknown_fields)]
pub(crate) struct DrawFile {
    pub name: Spanned<String>,
    /// Passes whose skeleton, geometry and fillings it takes over where it says nothing itself.
    #[serde(default)]
    pub like: Vec<Spanned<String>>,
    #[serde(default)]
    pub skeleton: Option<Spanned<String>>,
    #[serde(default)]
    pub geometry: Option<Geometry>,
    #[serde(default)]
    pub when: Option<Spanned<String>>,
    #[serde(default)]
    pub slots: Entries<Spanned<Value>>,
    #[serde(default)]
    pub reads: Entries<Spanned<String>>,
    pub writes: Entries<Spanned<String>>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(rename = "Screen", deny_unknown_fields)]
pub(crate) struct ScreenFile {
    pub name: Spanned<String>,
    pub skeleton: Spanned<String>,
    #[serde(default)]
    pub over: Over,
    #[serde(default)]
    pub runs: Runs,
    #[serde(default)]
    pub when: Option<Spanned<String>>,
    #[serde(default)]
    pub slots: Entries<Spanned<Value>>,
    #[serde(default)]
    pub reads: Entries<Spanned<String>>,
    pub writes: Entries<Spanned<String>>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(rename = "Compute", deny_unknown_fields)]
pub(crate) struct ComputeFile {
    pub name: Spanned<String>,
    pub skeleton: Spanned<String>,
    pub dispatch: Dispatch,
    #[serde(default)]
    pub when: Option<Spanned<String>>,
    #[serde(default)]
    pub slots: Entries<Spanned<Value>>,
    #[serde(default)]
    pub reads: Entries<Spanned<String>>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(rename = "Repeat", deny_unknown_fields)]
pub(crate) struct RepeatFile {
    pub times: Spanned<u32>,
    pub sequence: Vec<Step>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(rename = "Shortcut", deny_unknown_fields)]
pub(crate) struct ShortcutFile {
    pub name: Spanned<String>,
    /// The passes that it stands for.
    pub instead_of: Vec<Spanned<String>>,
    /// Slots (PASS.SLOT) whose fillings have to say that they are the identity.
    #[serde(default)]
    pub identity: Vec<Spanned<String>>,
    /// Slots (PASS.SLOT) with the modules that have to fill them.
    #[serde(default)]
    pub filled: Entries<Spanned<String>>,
    pub sequence: Vec<Step>,
}

/// What a screen pass covers.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
pub enum Over {
    /// Every pixel.
    #[default]
    All,
    /// Pixels that may show water; the skeleton's `keep` decides for each.
    Water,
    /// The other pixels: those that cannot show water.
    Dry,
    /// The pixels of a list in a buffer, with an indirect dispatch by another buffer.
    List {
        /// The buffer with a count and the pixels behind it.
        pixels: Spanned<String>,
        /// The buffer with the dispatch's arguments.
        arguments: Spanned<String>,
    },
}

/// Which stage a screen pass runs in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub enum Runs {
    /// A fragment shader over a full-screen triangle.
    #[default]
    Fragment,
    /// A compute shader, a thread a pixel.
    Compute,
}

/// How many workgroups a compute pass has.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub enum Dispatch {
    /// A thread for each pixel of a view.
    Pixels(Size),
    /// So many workgroups.
    Fixed(u32, u32, u32),
    /// As many workgroups as a buffer says.
    Indirect(Spanned<String>),
}

/// What may stand behind a name: a number, a filling, or connections of resources.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Value {
    Number(f64),
    /// A module alone: its place is the value's.
    Module(String),
    /// A module with what belongs to it.
    Filled(Spanned<String>, Entries<Spanned<Value>>),
    Reads(Entries<Spanned<String>>),
}

impl<'de> Deserialize<'de> for Value {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct AnyValue;
        impl<'de> Visitor<'de> for AnyValue {
            type Value = Value;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a module (\"path\" or (\"path\", { … })), a number, or { \"variable\": \"resource\" }")
            }
            fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
                Ok(Value::Number(f64::from(u8::from(value))))
            }
            fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
                Ok(Value::Number(value as f64))
            }
            fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
                Ok(Value::Number(value as f64))
            }
            fn visit_f64<E>(self, value: f64) -> Result<Value, E> {
                Ok(Value::Number(value))
            }
            fn visit_str<E>(self, value: &str) -> Result<Value, E> {
                Ok(Value::Module(value.to_owned()))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Value, A::Error> {
                let missing = |what: &str| {
                    serde::de::Error::custom(format!("{what} is missing in (\"module\", {{ … }})"))
                };
                let module = seq.next_element()?.ok_or_else(|| missing("the module"))?;
                let within = seq.next_element()?.ok_or_else(|| missing("the map"))?;
                if seq.next_element::<serde::de::IgnoredAny>()?.is_some() {
                    return Err(fault(
                        &module,
                        "a filling is (\"module\", { … }) and nothing more",
                    ));
                }
                Ok(Value::Filled(module, within))
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Value, A::Error> {
                Entries::deserialize(MapAccessDeserializer::new(map)).map(Value::Reads)
            }
        }
        deserializer.deserialize_any(AnyValue)
    }
}

/// The word under which a filling connects resources.
const READS: &str = "reads";

/// A filling from what was written for a slot.
///
/// # Errors
/// In words, to be shown at the value's place.
pub(crate) fn filling(
    slot: &Spanned<String>,
    value: &Spanned<Value>,
) -> Result<Filling, meniscus_source::Diagnostic> {
    let wrong = |at: &Spanned<Value>, what: String| {
        let diagnostic = meniscus_source::Diagnostic::error(what);
        match &at.place {
            Some(place) => diagnostic.at(place, ""),
            None => diagnostic,
        }
    };
    let mut made = match &value.value {
        Value::Module(path) => Filling::plain(Spanned {
            value: path.clone(),
            place: value.place.clone(),
        }),
        Value::Filled(module, within) => {
            let mut made = Filling::plain(module.clone());
            for (name, value) in within.iter() {
                match &value.value {
                    Value::Number(number) => {
                        let number = Spanned {
                            value: finite(*number).ok_or_else(|| {
                                wrong(value, format!("`{}` is no finite number", name.value))
                            })?,
                            place: value.place.clone(),
                        };
                        made.numbers.insert(name.value.clone(), number);
                    }
                    Value::Reads(reads) if name.value == READS => {
                        made.reads = connections(reads);
                    }
                    Value::Reads(_) => {
                        return Err(wrong(
                            value,
                            format!(
                                "`{}` wants a module or a number; only `reads` is a map",
                                name.value
                            ),
                        ));
                    }
                    _ => {
                        made.slots.insert(name.value.clone(), filling(name, value)?);
                    }
                }
            }
            made
        }
        _ => {
            return Err(wrong(
                value,
                format!("the slot `{}` wants a module", slot.value),
            ));
        }
    };
    made.slot_place = slot.place.clone();
    Ok(made)
}

pub(crate) fn finite(number: f64) -> Option<f64> {
    number.is_finite().then_some(number)
}

pub(crate) fn connections(reads: &Entries<Spanned<String>>) -> BTreeMap<String, Spanned<String>> {
    reads
        .iter()
        .map(|(k, v)| (k.value.clone(), v.clone()))
        .collect()
}
