//! Modules that are wrong by themselves.

use crate::common::{composer, library, plain, recipe};
use crate::{header, module, recipe_fault, told};
use meniscus_source::Severity;

#[test]
fn headers_that_are_wrong() {
    header(
        "needs_a_filling",
        "a",
        "// A.\n// needs: optics/bent\n",
        "a.wgsl:2:11",
        "cannot be needed",
        "call the slot instead",
    );
    header(
        "binding_by_hand",
        "a",
        "// A.\n\n@group(0) @binding(3) var t: texture_2d<f32>;\n",
        "a.wgsl:3:2",
        "writes a binding by hand",
        "the composer assigns them",
    );
    header(
        "impure_derivative",
        "a",
        "// A.\n\nfn f(x: f32) -> f32 {\n    return dpdx(x);\n}\n",
        "a.wgsl:4:12",
        "is not pure",
        "pass the footprint as an argument",
    );
    header(
        "impure_sample",
        "a",
        "// A.\n\nvar t: texture_2d<f32>;\nvar s: sampler;\n\nfn f(x: vec2f) -> vec4f {\n    return textureSample(t, s, x);\n}\n",
        "a.wgsl:7:12",
        "implicit level of detail",
        "use textureSampleLevel",
    );
    header(
        "impure_discard",
        "a",
        "// A.\n\nfn f() {\n    discard;\n}\n",
        "a.wgsl:4:5",
        "it discards fragments",
        "`keep`",
    );
    header(
        "impure_storage",
        "a",
        "// A.\n\nvar<storage, read_write> out: array<u32>;\n",
        "a.wgsl:3:26",
        "`out` can be written",
        "only a skeleton writes",
    );
    header(
        "stray_text",
        "a",
        "// A.\n\nfnn f() {}\n",
        "a.wgsl:3:1",
        "is no declaration",
        "did you mean `fn`?",
    );
    header(
        "number_without_range",
        "a",
        "// A.\n// number bend: some\n\noverride bend: f32 = 1.0;\n",
        "a.wgsl:2:17",
        "declared wrongly",
        "number taps: 1 to 8",
    );
    header(
        "slot_called_as_itself",
        "a",
        "// A.\n//\n// provides: shift\n// slots: shift\n\nfn shift(x: f32) -> f32 {\n    return shift(x);\n}\n",
        "a.wgsl:4:11",
        "both declares `shift` and calls the slot",
        "`slots: inner: shift`",
    );
    header(
        "no_slot_name",
        "slots/a b",
        "// A.\n\nfn a() {}\n",
        "slots/a b.wgsl:1:1",
        "is no slot",
        "",
    );
}

#[test]
fn modules_that_are_wrong_wgsl() {
    let filling = |body: &str| {
        format!(
            "// A.\n//\n// provides: deflect\n// needs: geometry/ray\n\nfn deflect(ray: Ray) -> Ray {{\n{body}\n}}\n"
        )
    };
    module(
        "syntax_error",
        "a",
        &filling("    let x = 1.0 +;\n    return ray;"),
        "a.wgsl:7:18",
        "expected expression",
        "",
    );
    module(
        "type_error",
        "a",
        &filling("    let x: f32 = ray.origin;\n    return ray;"),
        "a.wgsl:7:9",
        "the type of `x` is expected to be",
        "",
    );
    module(
        "wrong_return",
        "a",
        &filling("    return ray.origin;"),
        "a.wgsl:7:12",
        "deflect",
        "",
    );
    module(
        "unknown_name",
        "a",
        &filling("    return bend(ray);"),
        "a.wgsl:7:12",
        "no definition in scope for identifier: `bend`",
        "",
    );
    module(
        "misspelt_name",
        "a",
        &filling("    let there = ray;\n    return thre;"),
        "a.wgsl:8:12",
        "no definition in scope",
        "did you mean `there`?",
    );
    module(
        "uncalled_slot",
        "a",
        &filling("    let x = shift(1.0);\n    return ray;"),
        "a.wgsl:7:13",
        "no definition in scope",
        "add it to `// slots: …` in a.wgsl",
    );
    module(
        "missing_brace",
        "a",
        "// A.\n\nfn f() {\n    if true {\n}\n",
        "a.wgsl:5:2",
        "expected",
        "",
    );
    module(
        "swizzle_error",
        "a",
        &filling("    let x = ray.colour;\n    return ray;"),
        "a.wgsl:7:17",
        "invalid field accessor `colour`",
        "",
    );
    let unneeded = "// A.\n//\n// provides: shift\n\nfn shift(x: f32) -> f32 {\n    return Ray(vec3f(x), vec3f(x)).origin.x;\n}\n";
    module(
        "missing_needs",
        "a",
        unneeded,
        "a.wgsl:6:12",
        "`Ray`",
        "`geometry/ray` declares `Ray`: add it to `// needs: …` in a.wgsl",
    );
    // The composed shader has the ray, and the module is told of all the same.
    let shifted = recipe(&[
        ("intersect", plain("geometry/plane")),
        ("shift", plain("a")),
    ]);
    recipe_fault(
        "missing_needs_hidden",
        &[("a", unneeded)],
        &shifted,
        "a.wgsl:6:12",
        "uses `Ray` without saying so",
        "add `geometry/ray` to `// needs: …` in a.wgsl",
    );
    module(
        "unused_needs",
        "a",
        "// A.\n// needs: geometry/ray\n\nfn f() {}\n",
        "a.wgsl:2:11",
        "uses nothing of it",
        "leave it out",
    );
    // What a needed module needs comes with it, but is better needed itself.
    let through =
        "// B.\n// needs: geometry/ray\n\nfn b(ray: Ray) -> f32 {\n    return ray.origin.x;\n}\n";
    let (composer, _) = library(&[
        ("b", through),
        (
            "a",
            "// A.\n// needs: b\n\nfn f(ray: Ray) -> f32 {\n    return ray.origin.y;\n}\n",
        ),
        (
            "c",
            "// C.\n// needs: b\n\nfn f(ray: Ray) -> f32 {\n    return b(ray);\n}\n",
        ),
    ]);
    told(
        "needs_by_way_of_another",
        &composer.check_module("a"),
        "a.wgsl:2:11",
        "uses nothing of it",
        "need `geometry/ray` instead, which it uses by way of it",
    );
    assert_eq!(composer.check_module("c").to_string(), "");
}

#[test]
fn every_broken_module_is_told_of() {
    let broken = |slot: &str, ty: &str| {
        format!(
            "// B.\n//\n// provides: {slot}\n// needs: geometry/ray\n\nfn {slot}(ray: Ray) -> {ty} {{\n    return nonsense_{slot};\n}}\n"
        )
    };
    let (first, second) = (broken("deflect", "Ray"), broken("intersect", "f32"));
    let third = "// B.\n//\n// provides: shift\n\nfn shift(x: f32) -> f32 {\n    return nonsense_shift;\n}\n";
    let more = [("a", first.as_str()), ("b", second.as_str()), ("c", third)];
    let composer = composer(&more);
    let report = composer.check_library();
    let errors = report
        .0
        .iter()
        .filter(|d| d.severity == Severity::Error)
        .count();
    assert_eq!(errors, 3, "{report}");
    for (file, line) in [("a.wgsl", 7), ("b.wgsl", 7), ("c.wgsl", 6)] {
        assert!(
            report.to_string().contains(&format!("{file}:{line}:12")),
            "{report}"
        );
    }
    let composed = composer
        .compose(&recipe(&[
            ("deflect", plain("a")),
            ("intersect", plain("b")),
        ]))
        .unwrap_err()
        .to_string();
    assert!(
        composed.contains("a.wgsl:7:12") && composed.contains("b.wgsl:7:12"),
        "{composed}"
    );
    assert!(
        composed.contains("pipeline.ron:2:4"),
        "the pipeline's line: {composed}"
    );
}

#[test]
fn modules_that_do_not_say_what_they_are_made_for_are_warned_of() {
    let module = |domain: &str, argument: &str| {
        format!("// Halves.\n//{domain}\n\nfn half({argument}) -> f32 {{\n    return 0.5;\n}}\n")
    };
    let ranged = module("\n// domain: half(x -1 to 1)", "x: f32");
    let worded = module("\n// domain: everything finite", "x: f32");
    let (silent, still) = (module("", "x: f32"), module("", ""));
    let composer = composer(&[
        ("mine/ranged", ranged.as_str()),
        ("mine/silent", silent.as_str()),
        ("mine/still", still.as_str()),
        ("mine/worded", worded.as_str()),
    ]);
    let report = composer.check_library().to_string();
    let warned: Vec<&str> = report.lines().filter(|l| l.contains("`mine/")).collect();
    assert_eq!(warned.len(), 1, "{report}");
    assert!(
        warned[0].contains("`mine/silent` declares no domain"),
        "{report}"
    );
    assert!(report.contains("mine/silent.wgsl:4:4"), "{report}");
}
