//! What composed texts and shaders hold, and what things are called there.

#[path = "../common/mod.rs"]
mod common;
mod fillings;
mod names;
mod texts;

use common::{number, plain, written};
use meniscus_shader::Filling;

pub(crate) fn with(
    path: &str,
    slots: &[(&str, Filling)],
    numbers: &[(&str, f64)],
    reads: &[(&str, &str)],
) -> Filling {
    let mut filling = plain(path);
    filling.slots = slots
        .iter()
        .map(|(name, inner)| ((*name).to_owned(), inner.clone()))
        .collect();
    filling.numbers = numbers
        .iter()
        .map(|(name, value)| ((*name).to_owned(), number(*value)))
        .collect();
    filling.reads = reads
        .iter()
        .map(|(name, resource)| ((*name).to_owned(), written(resource)))
        .collect();
    filling
}

/// A sum of two fillings of the slot that it fills itself.
pub(crate) const BOTH: (&str, &str) = (
    "geometry/both",
    "// Two in one.\n//\n// provides: intersect\n// needs: geometry/ray\n// slots: first: intersect, then: intersect\n\n\
     fn intersect(ray: Ray) -> f32 {\n    return first(ray) + then(ray);\n}\n",
);

/// A filling with a helper, a type and a resource of its own.
pub(crate) const SEEN: (&str, &str) = (
    "screen/seen",
    "// What is seen.\n//\n// provides: intersect\n// needs: geometry/ray\n// number scale: 0 to 9\n\n\
     // The scale.\noverride scale: f32 = 1.0;\n\nvar seen: texture_2d<f32>;\n\nstruct Texel {\n    scale: f32,\n    seen: vec4f,\n}\n\n\
     fn texel_at(ray: Ray) -> Texel {\n    let seen = textureLoad(seen, vec2i(ray.origin.xy), 0);\n    return Texel(scale, seen);\n}\n\n\
     fn unused(ray: Ray) -> f32 {\n    return 1.0;\n}\n\n\
     fn intersect(ray: Ray) -> f32 {\n    let texel = texel_at(ray);\n    return texel.seen.x * texel.scale;\n}\n",
);

/// Keeps a whole text, in one folder for all parts of this test.
pub(crate) fn keep(name: &str, text: &str) {
    insta::assert_snapshot!(name, text);
}
