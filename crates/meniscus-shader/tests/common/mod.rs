//! A small library of modules, and recipes from it.
#![allow(dead_code, reason = "each test uses its part")]

use std::collections::BTreeMap;
use std::sync::Arc;

use meniscus_shader::{Composer, Filling, Library, Output, Recipe, Shader, Stage};
use meniscus_source::ron::Spanned;
use meniscus_source::{Place, Report, SourceFile};

/// Modules of a screen that looks along rays: enough for every seam of composition.
pub const BASE: &[(&str, &str)] = &[
    (
        "geometry/ray",
        "// A ray.\n\nstruct Ray {\n    origin: vec3f,\n    direction: vec3f,\n}\n",
    ),
    (
        "slots/deflect",
        "// How a ray goes on. By default straight.\n//\n// needs: geometry/ray\n\nfn deflect(ray: Ray) -> Ray {\n    return ray;\n}\n",
    ),
    (
        "slots/intersect",
        "// How far a ray goes. By default not at all.\n//\n// needs: geometry/ray\n\nfn intersect(ray: Ray) -> f32 {\n    return 0.0;\n}\n",
    ),
    (
        "slots/shift",
        "// A number to add. By default none.\n\nfn shift(x: f32) -> f32 {\n    return x;\n}\n",
    ),
    (
        "optics/bent",
        "// A ray that bends.\n//\n// provides: deflect\n// needs: geometry/ray\n// number bend: 0 to 2 rad, step 0.1\n\noverride bend: f32 = 0.5;\n\nfn deflect(ray: Ray) -> Ray {\n    return Ray(ray.origin, ray.direction * bend);\n}\n",
    ),
    (
        "geometry/plane",
        "// The plane z = 0.\n//\n// provides: intersect\n// needs: geometry/ray\n// slots: shift\n\nfn intersect(ray: Ray) -> f32 {\n    return shift(-ray.origin.z / ray.direction.z);\n}\n",
    ),
    (
        "geometry/taps",
        "// Several taps.\n//\n// provides: intersect\n// needs: geometry/ray\n// slots: tap: intersect\n// number taps: 1 to 8, step 1\n\noverride taps: i32 = 2;\n\nfn intersect(ray: Ray) -> f32 {\n    var sum = 0.0;\n    for (var i = 0; i < taps; i++) {\n        sum += tap(ray);\n    }\n    return sum;\n}\n",
    ),
    (
        "passes/look",
        "// Looks along rays.\n//\n// skeleton: screen\n// outputs: colour, distance\n// slots: deflect, intersect\n// needs: geometry/ray\n\nstruct Look {\n    ray: Ray,\n}\n\nfn screen(pixel: vec2f) -> Look {\n    return Look(deflect(Ray(vec3f(pixel, 1.0), vec3f(0.0, 0.0, -1.0))));\n}\n\nfn write_colour(look: Look) -> vec4f {\n    return vec4f(look.ray.direction, 1.0);\n}\n\nfn write_distance(look: Look) -> f32 {\n    return intersect(look.ray);\n}\n",
    ),
];

/// The base with other modules beside it or in the place of its own.
pub fn sources(more: &[(&str, &str)]) -> Vec<(String, Arc<SourceFile>)> {
    BASE.iter()
        .chain(more)
        .map(|(path, text)| {
            (
                (*path).to_owned(),
                SourceFile::new(format!("{path}.wgsl"), *text),
            )
        })
        .collect()
}

/// A composer over the base and more modules, and what is wrong with their headers.
pub fn library(more: &[(&str, &str)]) -> (Composer, Report) {
    let sources = sources(more);
    let (library, report) = Library::new(sources.iter().map(|(p, f)| (p.as_str(), f.clone())));
    (Composer::new(library), report)
}

/// A composer over modules without a fault in their headers.
pub fn composer(more: &[(&str, &str)]) -> Composer {
    let (composer, report) = library(more);
    assert!(report.0.is_empty(), "{report}");
    composer
}

/// A name that stands at the end of a pipeline's text.
pub fn written(text: &str) -> Spanned<String> {
    let file = SourceFile::new("pipeline.ron", format!("narrow:\n  \"{text}\""));
    let start = file.text.len() - 1 - text.len();
    Spanned {
        value: text.to_owned(),
        place: Some(Place::new(&file, start..start + text.len())),
    }
}

/// A number that stands in a pipeline's text.
pub fn number(value: f64) -> Spanned<f64> {
    let place = written(&value.to_string()).place;
    Spanned { value, place }
}

/// A filling without anything of its own.
pub fn plain(path: &str) -> Filling {
    Filling {
        slot_place: written(path).place,
        ..Filling::plain(written(path))
    }
}

/// The screen pass with fillings and both outputs.
pub fn recipe(slots: &[(&str, Filling)]) -> Recipe {
    Recipe {
        skeleton: written("passes/look"),
        slots: slots
            .iter()
            .map(|(slot, filling)| ((*slot).to_owned(), filling.clone()))
            .collect(),
        reads: BTreeMap::new(),
        outputs: ["colour", "distance"].map(output).to_vec(),
        facts: Default::default(),
        stage: Stage::Render,
    }
}

/// An output that is written.
pub fn output(name: &str) -> Output {
    Output {
        name: written(name),
        format: "rgba16float".into(),
    }
}

/// The shader of a recipe that is right.
pub fn compose(composer: &Composer, recipe: &Recipe) -> Arc<Shader> {
    composer
        .compose(recipe)
        .unwrap_or_else(|report| panic!("{report}"))
}

/// The text of one item of a composed shader, from its keyword to the next empty line.
pub fn item<'t>(shader: &'t Shader, start: &str) -> &'t str {
    let at = shader
        .text
        .find(start)
        .unwrap_or_else(|| panic!("no `{start}` in\n{}", shader.text));
    shader.text[at..].split("\n\n").next().unwrap_or_default()
}
