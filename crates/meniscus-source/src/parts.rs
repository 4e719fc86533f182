//! What a type that is read from files is made of, for tests that hold schemas against it.

use serde::Deserialize;
use serde::de::{Deserializer, Error as _, Visitor, value::Error};

/// A type's name as serde knows it, and those of its fields or variants; none of a type that is
/// neither a struct nor a choice.
pub fn parts_of<T: for<'de> Deserialize<'de>>() -> Option<(&'static str, &'static [&'static str])> {
    let mut found = None;
    // Nothing is ever read: the type is refused once it has said what it is.
    let _ = T::deserialize(Asking(&mut found));
    found
}

/// Asks a type what it is made of, and reads nothing.
struct Asking<'a>(&'a mut Option<(&'static str, &'static [&'static str])>);

impl<'de> Deserializer<'de> for Asking<'_> {
    type Error = Error;

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        fields: &'static [&'static str],
        _: V,
    ) -> Result<V::Value, Error> {
        *self.0 = Some((name, fields));
        Err(Error::custom("asked"))
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        name: &'static str,
        variants: &'static [&'static str],
        _: V,
    ) -> Result<V::Value, Error> {
        *self.0 = Some((name, variants));
        Err(Error::custom("asked"))
    }

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Error> {
        Err(Error::custom("neither a struct nor a choice"))
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 u8 u16 u32 u64 f32 f64 char str string bytes byte_buf option unit
        unit_struct newtype_struct seq tuple tuple_struct map identifier ignored_any
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Deserialize)]
    #[serde(rename = "Point")]
    #[allow(dead_code, reason = "asked for its shape alone")]
    struct Named {
        x: f32,
        #[serde(rename = "above")]
        y: f32,
    }

    #[derive(Deserialize)]
    #[allow(dead_code, reason = "asked for its shape alone")]
    enum Choice {
        One,
        Other(f32),
    }

    #[test]
    fn a_type_says_what_files_call_its_parts() {
        assert_eq!(parts_of::<Named>(), Some(("Point", &["x", "above"][..])));
        assert_eq!(
            parts_of::<Choice>(),
            Some(("Choice", &["One", "Other"][..]))
        );
        assert_eq!(parts_of::<Vec<f32>>(), None);
    }
}
