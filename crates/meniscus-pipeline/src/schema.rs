//! What pipeline files may hold, for editors and other programs.

/// JSON Schema (2020-12) of the data of pipeline files. A RON struct is an object, a map an object, a
/// tuple an array; `Name(…)` of a choice is an object with the one key `Name`, and a plain name a
/// string.
pub const SCHEMA: &str = include_str!("schema.json");

#[cfg(test)]
mod tests {
    use meniscus_source::parts_of;
    use serde::Deserialize;
    use serde_json::Value;

    use super::SCHEMA;
    use crate::file::{
        BufferFile, ComputeFile, Dispatch, DrawFile, File, OutputFile, Over, PipelineFile,
        RepeatFile, Runs, ScreenFile, ShortcutFile, Step, TextureFile, VariantFile,
    };
    use crate::plan::{Format, Geometry, Size};

    /// A type's name, and those of its fields or variants.
    fn parts<T: for<'de> Deserialize<'de>>() -> (String, Vec<&'static str>) {
        let (name, parts) = parts_of::<T>().expect("a struct or a choice");
        (name.to_owned(), parts.to_vec())
    }

    fn schema() -> Value {
        serde_json::from_str(SCHEMA).expect("JSON")
    }

    fn sorted<'a>(names: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
        let mut names: Vec<&str> = names.into_iter().collect();
        names.sort_unstable();
        names
    }

    /// What the schema lets a choice be.
    fn choices(schema: &Value) -> Vec<&str> {
        let plain = schema["enum"].as_array().into_iter().flatten();
        let mut found: Vec<&str> = plain.filter_map(Value::as_str).collect();
        found.extend(
            schema["properties"]
                .as_object()
                .into_iter()
                .flat_map(|p| p.keys())
                .map(String::as_str),
        );
        for one in schema["oneOf"].as_array().into_iter().flatten() {
            found.extend(choices(one));
        }
        found
    }

    #[test]
    fn every_field_of_every_struct_is_in_the_schema_and_no_other() {
        let schema = schema();
        for (name, fields) in [
            parts::<PipelineFile>(),
            parts::<VariantFile>(),
            parts::<TextureFile>(),
            parts::<BufferFile>(),
            parts::<OutputFile>(),
            parts::<DrawFile>(),
            parts::<ScreenFile>(),
            parts::<ComputeFile>(),
            parts::<RepeatFile>(),
            parts::<ShortcutFile>(),
        ] {
            let declared = &schema["$defs"][&name];
            let properties = declared["properties"].as_object().expect("properties");
            let known = sorted(properties.keys().map(String::as_str));
            assert_eq!(known, sorted(fields), "{name}");
            assert_eq!(declared["additionalProperties"], false, "{name}");
            for required in declared["required"].as_array().expect("a list") {
                assert!(properties.contains_key(required.as_str().expect("a name")));
            }
        }
    }

    #[test]
    fn every_choice_is_in_the_schema_and_no_other() {
        let schema = schema();
        for (name, variants) in [
            parts::<Step>(),
            parts::<Over>(),
            parts::<Runs>(),
            parts::<Dispatch>(),
            parts::<Format>(),
            parts::<Size>(),
            parts::<Geometry>(),
        ] {
            assert_eq!(
                sorted(choices(&schema["$defs"][&name])),
                sorted(variants),
                "{name}"
            );
        }
        let (_, files) = parts::<File>();
        assert_eq!(sorted(choices(&schema)), sorted(files));
    }

    #[test]
    fn a_required_field_cannot_be_left_out_and_another_can() {
        use meniscus_source::{SourceFile, ron::from_source};
        let read = |text: String| from_source::<File>(&SourceFile::new("p.ron", text)).is_ok();
        let schema = schema();
        for (kind, fields) in [
            (
                "Pipeline",
                [
                    ("about", "\"\""),
                    ("textures", "{}"),
                    ("sequence", "[]"),
                    ("output", "(colour: \"f\")"),
                ]
                .as_slice(),
            ),
            ("Variant", &[("of", "\"a\""), ("about", "\"\"")]),
        ] {
            let required = schema["$defs"][kind]["required"]
                .as_array()
                .expect("a list");
            let names = required.iter().filter_map(Value::as_str);
            assert_eq!(sorted(names), sorted(fields.iter().map(|(name, _)| *name)));
            let without = |left_out: &str| {
                let kept = fields.iter().filter(|(name, _)| *name != left_out);
                let kept: Vec<String> = kept
                    .map(|(name, value)| format!("{name}: {value}"))
                    .collect();
                format!("{kind}({})", kept.join(", "))
            };
            assert!(read(without("nothing")), "{kind}");
            for (name, _) in fields {
                assert!(!read(without(name)), "{kind} without {name}");
            }
        }
    }

    #[test]
    fn what_the_schema_refers_to_is_there() {
        fn references<'v>(value: &'v Value, found: &mut Vec<&'v str>) {
            match value {
                Value::Object(map) => {
                    found.extend(map.get("$ref").and_then(Value::as_str));
                    map.values().for_each(|inner| references(inner, found));
                }
                Value::Array(list) => list.iter().for_each(|inner| references(inner, found)),
                _ => {}
            }
        }
        let schema = schema();
        let mut found = Vec::new();
        references(&schema, &mut found);
        assert!(!found.is_empty());
        for reference in found {
            let pointer = reference.trim_start_matches('#');
            assert!(schema.pointer(pointer).is_some(), "{reference}");
        }
    }
}
