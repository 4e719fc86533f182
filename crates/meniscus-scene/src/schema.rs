//! What scene files may hold, for editors and other programs.

/// JSON Schema (2020-12) of the data of scene files. A RON struct is an object, a map an object, a
/// tuple an array; `Name(…)` of a choice is an object with the one key `Name`, and a plain name a
/// string.
pub const SCHEMA: &str = include_str!("schema.json");

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use meniscus_source::{SourceFile, parts_of};
    use serde::Deserialize;
    use serde_json::Value;

    use super::SCHEMA;
    use crate::description::{
        BudgetFile, CameraFile, Document, GeometryFile, HeaveFile, MaterialFile, MotionFile,
        Normals, ObjectFile, SceneFile, Shape, SkyFile, SunFile, TilesFile, Up, VariantFile,
        WaterFile, WaveFile,
    };

    /// The names of a type's fields or variants.
    fn parts<T: for<'de> Deserialize<'de>>() -> BTreeSet<String> {
        let (_, names) = parts_of::<T>().expect("a struct or a choice");
        names.iter().map(|name| (*name).to_owned()).collect()
    }

    fn schema() -> Value {
        serde_json::from_str(SCHEMA).expect("JSON")
    }

    fn text(value: &Value) -> &str {
        value.as_str().expect("a string")
    }

    fn list(value: &Value) -> impl Iterator<Item = &Value> {
        value.as_array().into_iter().flatten()
    }

    fn resolved<'s>(schema: &'s Value, node: &'s Value) -> &'s Value {
        match node["$ref"].as_str() {
            Some(reference) => {
                let path = reference.trim_start_matches('#');
                schema.pointer(path).expect("what is referred to is there")
            }
            None => node,
        }
    }

    /// RON texts of a node: with all that it may have, one for each choice.
    fn honest(schema: &Value, node: &Value) -> Vec<String> {
        let node = resolved(schema, node);
        if let Some(choices) = node["enum"].as_array() {
            return choices.iter().map(|c| text(c).to_owned()).collect();
        }
        if !node["oneOf"].is_null() {
            let one = |choice: &Value| {
                let (name, inner) = choice["properties"].as_object()?.iter().next()?;
                let written = honest(schema, inner).into_iter();
                Some(written.map(|w| format!("{name}{w}")).collect::<Vec<_>>())
            };
            return list(&node["oneOf"]).filter_map(one).flatten().collect();
        }
        match &node["type"] {
            Value::String(kind) => match kind.as_str() {
                "number" => vec!["1.5".into(), "2".into()],
                "integer" => vec!["3".into()],
                "boolean" => vec!["false".into()],
                "string" => vec!["\"x\"".into()],
                "array" if !node["prefixItems"].is_null() => {
                    let items = list(&node["prefixItems"]).map(|i| honest(schema, i).remove(0));
                    vec![format!("({})", items.collect::<Vec<_>>().join(", "))]
                }
                "array" => vec![format!("[{}]", honest(schema, &node["items"]).join(", "))],
                "object" if !node["properties"].is_null() => vec![object(schema, node, |_| None)],
                _ => {
                    let values = honest(schema, &node["additionalProperties"]);
                    vec![format!("{{\"a\": {}}}", values[0])]
                }
            },
            Value::Array(_) => vec!["3".into(), "\"16k\"".into()],
            other => panic!("{other}"),
        }
    }

    /// A struct's text, some of its fields written otherwise (or, if empty, left out).
    fn object(schema: &Value, node: &Value, other: impl Fn(&str) -> Option<String>) -> String {
        let fields = node["properties"].as_object().expect("properties");
        let fields = fields.iter().filter_map(|(name, node)| {
            let honest = || honest(schema, node).remove(0);
            let value = other(name).unwrap_or_else(honest);
            (!value.is_empty()).then(|| format!("{name}: {value}"))
        });
        format!("({})", fields.collect::<Vec<_>>().join(", "))
    }

    /// Something that a node is not.
    fn wrong(schema: &Value, node: &Value) -> &'static str {
        let node = resolved(schema, node);
        match node["type"].as_str() {
            Some("number" | "integer" | "boolean") => "\"x\"",
            Some("string") => "7",
            _ => "true",
        }
    }

    fn reads<T: for<'de> Deserialize<'de>>(text: &str) -> Result<(), String> {
        let file = SourceFile::new("s.ron", text);
        meniscus_source::ron::from_source::<T>(&file)
            .map(drop)
            .map_err(|report| report.to_string())
    }

    /// Holds a struct against its node: the same fields, the same ones required, the same types.
    fn same<T: for<'de> Deserialize<'de>>(name: &str) {
        let schema = schema();
        let node = &schema["$defs"][name];
        let properties = node["properties"].as_object().expect("properties");
        assert_eq!(
            properties.keys().cloned().collect::<BTreeSet<_>>(),
            parts::<T>(),
            "{name}"
        );
        assert_eq!(node["additionalProperties"], false, "{name}");
        let all = object(&schema, node, |_| None);
        reads::<T>(&all).unwrap_or_else(|report| panic!("{name}: {all}\n{report}"));
        let required: Vec<&str> = list(&node["required"]).map(text).collect();
        for (field, inner) in properties {
            let instead = |value: &str| {
                let value = value.to_owned();
                object(&schema, node, move |f| (f == field).then(|| value.clone()))
            };
            let without = reads::<T>(&instead(""));
            let is_required = required.contains(&field.as_str());
            assert_eq!(without.is_err(), is_required, "{name} without {field}");
            for honest in honest(&schema, inner) {
                let text = instead(&honest);
                reads::<T>(&text).unwrap_or_else(|report| panic!("{text}\n{report}"));
            }
            let text = instead(wrong(&schema, inner));
            assert!(reads::<T>(&text).is_err(), "{text}");
        }
    }

    #[test]
    fn structs_have_the_fields_of_the_schema_with_their_types() {
        same::<SceneFile>("Scene");
        same::<VariantFile>("Variant");
        same::<CameraFile>("camera");
        same::<SunFile>("sun");
        same::<SkyFile>("sky");
        same::<WaterFile>("water");
        same::<WaveFile>("wave");
        same::<BudgetFile>("budget");
        same::<MaterialFile>("material");
        same::<TilesFile>("tiles");
        same::<ObjectFile>("object");
        same::<MotionFile>("motion");
        same::<HeaveFile>("heave");
    }

    #[test]
    fn choices_are_those_of_the_schema() {
        let schema = schema();
        let plain = |name: &str| -> BTreeSet<String> {
            let names = list(&schema["$defs"][name]["enum"]);
            names.map(|choice| text(choice).to_owned()).collect()
        };
        assert_eq!(plain("geometry"), parts::<GeometryFile>());
        assert_eq!(plain("up"), parts::<Up>());
        assert_eq!(plain("normals"), parts::<Normals>());
        let mut shapes = BTreeSet::new();
        for choice in list(&schema["$defs"]["shape"]["oneOf"]) {
            let properties = choice["properties"].as_object().expect("properties");
            let (name, node) = properties.iter().next().expect("a shape");
            shapes.insert(name.clone());
            let all = format!("{name}{}", object(&schema, node, |_| None));
            reads::<Shape>(&all).unwrap_or_else(|report| panic!("{all}\n{report}"));
            let required: Vec<&str> = list(&node["required"]).map(text).collect();
            for (field, inner) in node["properties"].as_object().expect("properties") {
                let instead = |value: &str| {
                    let other = |f: &str| (f == field).then(|| value.to_owned());
                    format!("{name}{}", object(&schema, node, other))
                };
                let is_required = required.contains(&field.as_str());
                assert_eq!(
                    reads::<Shape>(&instead("")).is_err(),
                    is_required,
                    "{name} {field}"
                );
                assert!(
                    reads::<Shape>(&instead(wrong(&schema, inner))).is_err(),
                    "{name} {field}"
                );
            }
            let more = all.replacen('(', "(colour: 1, ", 1);
            assert!(reads::<Shape>(&more).is_err(), "{more}");
        }
        assert_eq!(shapes, parts::<Shape>());
    }

    #[test]
    fn a_document_is_what_the_schema_begins_with() {
        let schema = schema();
        for choice in list(&schema["oneOf"]) {
            let properties = choice["properties"].as_object().expect("properties");
            let (name, node) = properties.iter().next().expect("a kind of file");
            let text = format!("{name}{}", honest(&schema, node).remove(0));
            Document::read(&SourceFile::new("s.ron", text.as_str()))
                .unwrap_or_else(|report| panic!("{text}\n{report}"));
        }
    }
}
