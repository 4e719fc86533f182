//! RON with places: every value that may later turn out wrong remembers where it was written.

use std::cell::RefCell;
use std::collections::HashSet;
use std::fmt;
use std::ops::{Deref, Range};
use std::sync::Arc;

use ron::extensions::Extensions;
use ron::value::RawValue;
use serde::de::{Deserialize, DeserializeOwned, Deserializer, Error as _, MapAccess, Visitor};

use crate::{Diagnostic, Place, Report, SourceFile};

/// A value and the place where it was written.
///
/// Values that were not written in a file have no place.
#[derive(Debug, Clone, PartialEq)]
pub struct Spanned<T> {
    /// The value.
    pub value: T,
    /// Where it stands.
    pub place: Option<Place>,
}

impl<T> Spanned<T> {
    /// A value that no file holds.
    pub fn unplaced(value: T) -> Self {
        Self { value, place: None }
    }
}

impl<T> Deref for Spanned<T> {
    type Target = T;
    fn deref(&self) -> &T {
        &self.value
    }
}

/// What is being read, for the places of [`Spanned`] values.
struct Reading {
    file: Arc<SourceFile>,
    /// The address of the text that ron was given; values borrow from it.
    base: usize,
    /// The first fault met inside a spanned value, which is more exact than what ron reports.
    fault: Option<Fault>,
}

/// What is wrong, where in the file, and what is there to be meant instead.
struct Fault {
    range: Range<usize>,
    message: String,
    found: String,
    known: Vec<&'static str>,
}

impl Fault {
    fn of(range: Range<usize>, error: &ron::Error) -> Self {
        let (found, known) = match error {
            ron::Error::NoSuchStructField {
                expected, found, ..
            }
            | ron::Error::NoSuchEnumVariant {
                expected, found, ..
            } => (found.clone(), expected.to_vec()),
            _ => (String::new(), Vec::new()),
        };
        Self {
            range,
            message: describe(error),
            found,
            known,
        }
    }
}

thread_local! {
    static READING: RefCell<Option<Reading>> = const { RefCell::new(None) };
}

fn options() -> ron::Options {
    ron::Options::default()
        .with_default_extension(Extensions::IMPLICIT_SOME | Extensions::UNWRAP_VARIANT_NEWTYPES)
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Spanned<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let raw: &'de RawValue = Deserialize::deserialize(deserializer)?;
        let text = raw.get_ron();
        let (file, start) = READING
            .with_borrow(|reading| {
                let reading = reading.as_ref()?;
                let start = (text.as_ptr() as usize).checked_sub(reading.base)?;
                (start + text.len() <= reading.file.text.len())
                    .then(|| (reading.file.clone(), start))
            })
            .ok_or_else(|| {
                D::Error::custom("a spanned value can only be read from a source file")
            })?;
        let value = options().from_str::<T>(text).map_err(|error| {
            let at = range_of(text, &error.span);
            READING.with_borrow_mut(|reading| {
                if let Some(reading) = reading {
                    reading.fault.get_or_insert_with(|| {
                        Fault::of(start + at.start..start + at.end, &error.code)
                    });
                }
            });
            D::Error::custom(describe(&error.code))
        })?;
        Ok(Self {
            value,
            place: Some(Place::new(&file, start..start + text.len())),
        })
    }
}

/// A map in the order it was written, with places of its keys; a repeated key is an error.
#[derive(Debug, Clone, PartialEq)]
pub struct Entries<V>(pub Vec<(Spanned<String>, V)>);

impl<V> Default for Entries<V> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<V> Entries<V> {
    /// The value of a key.
    pub fn get(&self, key: &str) -> Option<&V> {
        self.0.iter().find(|(k, _)| k.value == key).map(|(_, v)| v)
    }

    /// Keys and values in order.
    pub fn iter(&self) -> impl Iterator<Item = (&Spanned<String>, &V)> {
        self.0.iter().map(|(k, v)| (k, v))
    }
}

impl<'de, V: Deserialize<'de>> Deserialize<'de> for Entries<V> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct InOrder<V>(std::marker::PhantomData<V>);
        impl<'de, V: Deserialize<'de>> Visitor<'de> for InOrder<V> {
            type Value = Entries<V>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a map { \"name\": value, … }")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut entries = Entries::<V>::default();
                let mut known = HashSet::new();
                while let Some((key, value)) = map.next_entry::<Spanned<String>, V>()? {
                    if !known.insert(key.value.clone()) {
                        return Err(fault(&key, format!("`{}` stands here twice", key.value)));
                    }
                    entries.0.push((key, value));
                }
                Ok(entries)
            }
        }
        deserializer.deserialize_map(InOrder(std::marker::PhantomData))
    }
}

/// An error of a `Deserialize` implementation that is shown at the place of `value`.
pub fn fault<T, E: serde::de::Error>(value: &Spanned<T>, message: impl Into<String>) -> E {
    let message = message.into();
    if let Some(place) = &value.place {
        READING.with_borrow_mut(|reading| {
            if let Some(reading) = reading {
                reading.fault.get_or_insert_with(|| Fault {
                    range: place.range.clone(),
                    message: message.clone(),
                    found: String::new(),
                    known: Vec::new(),
                });
            }
        });
    }
    E::custom(message)
}

/// Reads a whole file. Unknown fields are errors where the type denies them
/// (`#[serde(deny_unknown_fields)]`, which every type that is read here should do).
///
/// # Errors
/// One message that points at the fault.
pub fn from_source<T: DeserializeOwned>(file: &Arc<SourceFile>) -> Result<T, Report> {
    let outer = READING.replace(Some(Reading {
        file: file.clone(),
        base: file.text.as_ptr() as usize,
        fault: None,
    }));
    let result = options().from_str::<T>(&file.text);
    let fault = READING.replace(outer).and_then(|reading| reading.fault);
    result.map_err(|error| {
        let fault =
            fault.unwrap_or_else(|| Fault::of(range_of(&file.text, &error.span), &error.code));
        Diagnostic::error(fault.message)
            .at(&Place::new(file, fault.range), "")
            .with_suggestion(&fault.found, fault.known)
            .into()
    })
}

fn range_of(text: &str, span: &ron::error::Span) -> Range<usize> {
    let file = SourceFile {
        name: String::new(),
        text: text.to_owned(),
    };
    let start = file.offset(span.start.line, span.start.col);
    let end = file.offset(span.end.line, span.end.col);
    start..end.max(start)
}

fn describe(error: &ron::Error) -> String {
    match error {
        ron::Error::Message(message) => message.clone(),
        ron::Error::NoSuchStructField { found, outer, .. } => match outer {
            Some(outer) => format!("`{outer}` has no field `{found}`"),
            None => format!("there is no field `{found}` here"),
        },
        ron::Error::NoSuchEnumVariant { found, outer, .. } => match outer {
            Some(outer) => format!("`{found}` is no {outer}"),
            None => format!("there is no `{found}` here"),
        },
        ron::Error::MissingStructField { field, outer } => match outer {
            Some(outer) => format!("`{outer}` lacks the field `{field}`"),
            None => format!("the field `{field}` is missing"),
        },
        ron::Error::ExpectedFloat => "a number is expected here".into(),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Inner {
        size: Spanned<f64>,
    }

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Outer {
        name: Spanned<String>,
        inner: Option<Spanned<Inner>>,
        #[serde(default)]
        map: Entries<Spanned<Inner>>,
    }

    fn read(text: &str) -> Result<Outer, Report> {
        from_source(&SourceFile::new("t.ron", text))
    }

    #[test]
    fn values_know_where_they_stand() {
        let outer = read("(\n name: \"a\", inner: (size: 2.5), map: {\"k\": (size: 1)})").unwrap();
        assert_eq!(outer.name.place.as_ref().unwrap().to_string(), "t.ron:2:8");
        let inner = outer.inner.unwrap();
        let place = inner.value.size.place.unwrap();
        assert_eq!(place.text(), "2.5");
        let (key, value) = &outer.map.0[0];
        assert_eq!(key.place.as_ref().unwrap().text(), "\"k\"");
        assert_eq!(value.size.place.as_ref().unwrap().text(), "1");
    }

    #[test]
    fn faults_are_placed_where_they_are() {
        for (text, place, words) in [
            ("(name: \"a\",\n inner: (sise: 2))", "t.ron:2:", "sise"),
            (
                "(name: \"a\",\n\n map: {\"k\": (size: 1), \"k\": (size: 1)})",
                "t.ron:3:24",
                "twice",
            ),
            (
                "(name: \"a\",\n inner: (size: true))",
                "t.ron:2:16",
                "number",
            ),
            ("(name: \"a\",\n inner (size: 1))", "t.ron:2:", ""),
            ("(nam: \"a\")", "t.ron:1:", "did you mean `name`?"),
            ("", "t.ron:1:1", ""),
        ] {
            let message = read(text).unwrap_err().to_string();
            assert!(message.contains(place), "{text}: {message}");
            assert!(message.contains(words), "{text}: {message}");
        }
    }
}
