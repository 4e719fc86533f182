//! Shaders in other languages, what a new module begins as, and what is fetched of a mesh.

mod common;

use std::collections::BTreeMap;

use common::{compose, composer, output, plain, recipe, written};
use meniscus_shader::{Composer, Language, Library, Recipe, Shader};
use meniscus_source::SourceFile;

const LANGUAGES: [Language; 5] = [
    Language::SpirV,
    Language::Hlsl,
    Language::Msl,
    Language::Glsl,
    Language::GlslEs,
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
            Language::Glsl | Language::GlslEs => assert_eq!(stages, [Some("vert"), Some("frag")]),
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

/// A skeleton whose varyings pass through a struct before the outputs take them.
const SURFACE: (&str, &str) = (
    "passes/solid",
    "// Draws.\n//\n// skeleton: draw\n// outputs: colour, normal, object\n// flat: face\n\nstruct V {\n    clip: vec4f,\n    world: vec3f,\n    normal: vec3f,\n    face: vec3f,\n    object: u32,\n}\n\n\
    struct Point {\n    at: vec3f,\n    normal: vec3f,\n}\n\nstruct Solid {\n    point: Point,\n    face: vec3f,\n    object: u32,\n}\n\n\
    fn vertex(position: vec3f, normal: vec3f, geometric_normal: vec3f, object: u32) -> V {\n    return V(vec4f(position, 1.0), 2.0 * position, normal, geometric_normal, object);\n}\n\n\
    fn fragment(v: V) -> Solid {\n    let normal = normalize(v.normal);\n    return Solid(Point(v.world, normal), v.face, v.object);\n}\n\n\
    fn lit(point: Point) -> f32 {\n    return point.at.z;\n}\n\n\
    fn write_colour(s: Solid) -> vec4f {\n    return vec4f(lit(s.point));\n}\n\nfn write_normal(s: Solid) -> vec4f {\n    return vec4f(s.point.normal + s.face, 0.0);\n}\n\nfn write_object(s: Solid) -> u32 {\n    return s.object;\n}\n",
);

fn solid(text: &str, outputs: &[&str]) -> std::sync::Arc<Shader> {
    let recipe = Recipe {
        skeleton: written(SURFACE.0),
        outputs: outputs.iter().map(|name| output(name)).collect(),
        ..recipe(&[])
    };
    compose(&composer(&[(SURFACE.0, text)]), &recipe)
}

#[test]
fn what_only_other_outputs_read_is_neither_fetched_nor_handed_on() {
    let attributes = |shader: &Shader| -> Vec<String> {
        let attributes = shader.attributes.iter();
        attributes.map(|a| a.name.clone()).collect()
    };
    let handed_on = |shader: &Shader| {
        let varying = shader.text.split("struct PassVarying {").nth(1);
        let members = varying.and_then(|text| text.split('}').next());
        members.map_or(0, |members| members.matches("@location").count())
    };
    let whole = solid(SURFACE.1, &["colour", "normal", "object"]);
    assert_eq!(handed_on(&whole), 4);
    assert!(whole.unread.is_empty());
    for (output, wanted, varyings) in [
        ("colour", &["position"][..], 1),
        ("normal", &["position", "normal", "geometric_normal"], 2),
        ("object", &["position", "object"], 1),
    ] {
        let shader = solid(SURFACE.1, &[output]);
        assert_eq!(attributes(&shader), wanted, "{output}");
        assert_eq!(handed_on(&shader), varyings, "{output}");
        let left_out = |name: &str| !wanted.contains(&name);
        for name in ["normal", "geometric_normal", "object"] {
            let told = shader.unread.contains(&format!("vertex.{name}"));
            assert_eq!(told, left_out(name), "{output} {name}");
        }
    }
    // A decision reads its varying whatever is written.
    let choosing = SURFACE.1.replace(
        "fn lit",
        "fn keep(s: Solid) -> bool {\n    return s.object > 1u;\n}\n\nfn lit",
    );
    let shader = solid(&choosing, &["colour"]);
    assert_eq!(attributes(&shader), ["position", "object"]);
    // So does what goes through a variable, which is not looked into.
    let stored = SURFACE.1.replace(
        "    return vec4f(lit(s.point));",
        "    var copy = s;\n    return vec4f(lit(copy.point));",
    );
    assert_eq!(handed_on(&solid(&stored, &["colour"])), 4);
}

#[test]
fn glsl_has_flat_values_and_loads_from_depth() {
    let flat = solid(SURFACE.1, &["normal"]);
    let looking = "// Looks at depth.\n//\n// skeleton: screen\n// outputs: colour\n\nvar front: texture_depth_2d;\n\nfn screen(pixel: vec2f) -> f32 {\n    let at = vec2i(pixel);\n    return textureLoad(front, min(at, vec2i(textureDimensions(front)) - 1), 0) + 1.0;\n}\n\nfn write_colour(x: f32) -> vec4f {\n    return vec4f(x);\n}\n";
    let recipe = Recipe {
        skeleton: written("passes/depth"),
        outputs: vec![output("colour")],
        ..recipe(&[])
    };
    let depth = compose(&composer(&[("passes/depth", looking)]), &recipe);
    for (language, version) in [
        (Language::Glsl, "#version 450 core\n"),
        (Language::GlslEs, "#version 310 es\n"),
    ] {
        let text = String::from_utf8(exported(&flat, language, &BTreeMap::new())).unwrap();
        assert!(text.starts_with(version), "{text}");
        assert!(text.contains("flat out vec3"), "{text}");
        // What the host must do for it is said once.
        assert_eq!(text.matches("glProvokingVertex").count(), 1, "{text}");
        let text = String::from_utf8(exported(&depth, language, &BTreeMap::new())).unwrap();
        assert!(text.contains("texelFetch("), "{text}");
        assert!(!text.contains("Shadow"), "{text}");
        assert!(!text.contains("glProvokingVertex"), "{text}");
    }
}
