//! Modules that do not go together, and skeletons that make no entry points.

use crate::common::{library, plain, recipe};
use crate::{recipe_fault, told};
use meniscus_shader::Stage;

#[test]
fn circles_and_names_declared_twice() {
    let b = ("b", "// B.\n// needs: a\n\nfn g() {}\n");
    let (composer, _) = library(&[("a", "// A.\n// needs: b\n\nfn f() {\n    g();\n}\n"), b]);
    told(
        "needs_in_a_circle",
        &composer.check_module("a"),
        "b.wgsl:2:11",
        "modules need each other: a → b → a",
        "a module of its own",
    );
    let helper = |slot: &str, of: &str| {
        format!(
            "// H.\n//\n// provides: {slot}\n// needs: geometry/ray\n\nfn help() -> f32 {{\n    return 1.0;\n}}\n\nfn {slot}(ray: Ray) -> {of} {{\n    let one = help();\n    return {};\n}}\n",
            if of == "Ray" { "ray" } else { "one" }
        )
    };
    let (first, second) = (helper("deflect", "Ray"), helper("intersect", "f32"));
    recipe_fault(
        "declared_twice",
        &[("a", &first), ("b", &second)],
        &recipe(&[("deflect", plain("a")), ("intersect", plain("b"))]),
        "wgsl:6:4",
        "both declare `help`",
        "move it into a module that both need",
    );
    let crossing = |slot: &str, other: &str| {
        format!(
            "// C.\n//\n// provides: {slot}\n// needs: geometry/ray\n// slots: {other}\n\nfn {slot}(ray: Ray) -> f32 {{\n    return {other}(ray);\n}}\n"
        )
    };
    let slot = (
        "slots/reach",
        "// R.\n//\n// needs: geometry/ray\n\nfn reach(ray: Ray) -> f32 {\n    return 1.0;\n}\n",
    );
    let (first, second) = (
        crossing("intersect", "reach"),
        crossing("reach", "intersect"),
    );
    recipe_fault(
        "fillings_in_a_circle",
        &[slot, ("a", &first), ("b", &second)],
        &recipe(&[("intersect", plain("a")), ("reach", plain("b"))]),
        "b.wgsl:5:11",
        "calls itself by way of others",
        "give one of them a filling of its own",
    );
    let (composer, _) = library(&[
        (
            "x",
            "// X.\n\nvar t: texture_2d<f32>;\n\nfn fx() -> vec2u {\n    return textureDimensions(t);\n}\n",
        ),
        (
            "y",
            "// Y.\n// needs: x\n\nvar t: texture_depth_2d;\n\nfn fy() -> vec2u {\n    return fx() + textureDimensions(t);\n}\n",
        ),
    ]);
    told(
        "resource_twice",
        &composer.check_module("y"),
        "y.wgsl:4:5",
        "differently declare the resource `t`",
        "the same type",
    );
}

#[test]
fn skeletons_that_do_not_make_entry_points() {
    let look = |body: &str| {
        (
            "passes/look",
            format!("// L.\n//\n// skeleton: screen\n// outputs: colour, distance\n\n{body}"),
        )
    };
    for (name, body, place, words) in [
        (
            "no_screen_function",
            "fn f() {}\n",
            "passes/look.wgsl:3:14",
            "it has no function `screen`",
        ),
        (
            "screen_takes_other",
            "fn screen(pixel: vec2u) -> f32 {\n    return 0.0;\n}\n",
            "passes/look.wgsl:6:4",
            "takes `pixel: vec2f`",
        ),
        (
            "screen_gives_nothing",
            "fn screen(pixel: vec2f) {\n}\n",
            "passes/look.wgsl:6:4",
            "must return",
        ),
        (
            "no_writing_function",
            "fn screen(pixel: vec2f) -> f32 {\n    return 0.0;\n}\n",
            "passes/look.wgsl:4:13",
            "no function `write_colour`",
        ),
        (
            "writing_takes_other",
            "fn screen(pixel: vec2f) -> f32 {\n    return 0.0;\n}\n\nfn write_colour(x: vec2f) -> vec4f {\n    return vec4f(x, x);\n}\n\nfn write_distance(x: f32) -> f32 {\n    return x;\n}\n",
            "passes/look.wgsl:10:4",
            "takes what `screen` returns",
        ),
    ] {
        let (path, text) = look(body);
        let report = library(&[(path, &text)])
            .0
            .compose(&recipe(&[]))
            .unwrap_err();
        told(name, &report, place, words, "");
    }
    let mut compute = recipe(&[]);
    compute.stage = Stage::Compute;
    compute.outputs[1].format = "rgba16uint".into();
    recipe_fault(
        "only_in_the_entry_point",
        &[],
        &compute,
        "passes/look.wgsl:3:14",
        "",
        "passes/look",
    );
}
