//! Shaders in other languages, what a new module begins as, and what is fetched of a mesh.

mod common;

use std::collections::BTreeMap;

use common::{compose, composer, output, plain, recipe, written};
use meniscus_shader::{Composer, Language, Library, Recipe, Shader};
use meniscus_source::SourceFile;

const LANGUAGES: [Language; 4] = [
    Language::SpirV,
    Language::Hlsl,
    Language::Msl,
    Language::Glsl,
];

fn exported(shader: &Shader, language: Language, numbers: &BTreeMap<String, f64>) -> Vec<u8> {
    let parts = shader.export(language, numbers);
    let parts = parts.unwrap_or_else(|wrong| panic!("{}", wrong.render()));
    parts.into_iter().flat_map(|part| part.bytes).collect()
}

#[test]
fn numbers_stand_in_every_language() {
    let shader = compose(
        &composer(&[]),
        &recipe(&[("intersect", plain("geometry/taps"))]),
    );
    let name = &shader.overrides["intersect.taps"];
    for language in LANGUAGES {
        let taps = |taps: f64| exported(&shader, language, &BTreeMap::from([(name.clone(), taps)]));
        assert_ne!(taps(3.0), taps(5.0), "{language:?}");
        assert_eq!(taps(3.0), taps(3.0), "{language:?}");
        // 2 is the default.
        assert_eq!(taps(2.0), exported(&shader, language, &BTreeMap::new()));
        let beyond = shader.export(language, &BTreeMap::from([(name.clone(), f64::NAN)]));
        assert!(beyond.is_err(), "{language:?}");
    }
    let unknown = shader.export(Language::Msl, &BTreeMap::from([("tips".to_owned(), 1.0)]));
    assert!(unknown.unwrap_err().message.contains("tips"));
}

#[test]
fn glsl_comes_in_stages_and_the_others_whole() {
    let shader = compose(&composer(&[]), &recipe(&[]));
    for language in LANGUAGES {
        let parts = shader.export(language, &BTreeMap::new()).expect("a text");
        let stages: Vec<_> = parts.iter().map(|part| part.stage).collect();
        match language {
            Language::Glsl => assert_eq!(stages, [Some("vert"), Some("frag")]),
            _ => assert_eq!(stages, [None]),
        }
    }
}

const DRAW: (&str, &str) = (
    "passes/draw",
    "// Draws.\n//\n// skeleton: draw\n// outputs: colour\n\nstruct V {\n    clip: vec4f,\n    height: f32,\n}\n\n\
    fn vertex(normal: vec3f, position: vec3f, object: u32) -> V {\n    // No normal here.\n    return V(vec4f(position, 1.0), f32(object));\n}\n\n\
    fn fragment(v: V) -> f32 {\n    return v.height;\n}\n\nfn write_colour(x: f32) -> vec4f {\n    return vec4f(x);\n}\n",
);

#[test]
fn what_a_skeleton_leaves_aside_is_not_fetched() {
    let draw = |text: &str| {
        let recipe = Recipe {
            skeleton: written(DRAW.0),
            outputs: vec![output("colour")],
            ..recipe(&[])
        };
        compose(&composer(&[(DRAW.0, text)]), &recipe)
    };
    let names = |shader: &Shader| -> Vec<(String, u32)> {
        let attributes = shader.attributes.iter();
        attributes.map(|a| (a.name.clone(), a.location)).collect()
    };
    let wanted = |names: &[&str]| -> Vec<(String, u32)> {
        let numbered = names.iter().zip(0..);
        numbered
            .map(|(name, at)| ((*name).to_owned(), at))
            .collect()
    };
    assert_eq!(names(&draw(DRAW.1)), wanted(&["position", "object"]));
    let used = DRAW.1.replace("f32(object)", "normal.x * f32(object)");
    assert_eq!(
        names(&draw(&used)),
        wanted(&["normal", "position", "object"])
    );
}

#[test]
fn a_template_composes_in_its_slot() {
    let base = composer(&[]);
    for slot in ["deflect", "intersect", "shift"] {
        let text = base
            .library()
            .template("mine/new", slot)
            .unwrap_or_else(|report| panic!("{report}"));
        let composer = composer(&[("mine/new", &text)]);
        assert!(composer.check_module("mine/new").is_ok());
        let shader = compose(&composer, &recipe(&[(slot, plain("mine/new"))]));
        let before = compose(&base, &recipe(&[]));
        // It does what the slot does by default.
        assert_eq!(shader.bindings, before.bindings, "{slot}");
    }
}

#[test]
fn a_slot_whose_default_is_no_module_gives_no_template() {
    let broken =
        "// Odd. By default wrong.\n\nfn odd(x: f32) -> f32 {\n    return missing(x);\n}\n";
    let file = SourceFile::new("slots/odd.wgsl", broken);
    let (library, _) = Library::new([("slots/odd", file)]);
    let report = Composer::new(library).library().template("mine/new", "odd");
    assert!(report.unwrap_err().to_string().contains("missing"));
}
