//! One mistake of every kind: the place, the words and the way to mend it.

mod common;

use common::{compose, composer, library, number, output, plain, recipe, written};
use meniscus_shader::{Filling, Recipe, Stage};
use meniscus_source::{Report, Severity};

/// Asserts that a report says what it must, and keeps its whole text.
fn told(name: &str, report: &Report, place: &str, words: &str, hint: &str) {
    let text = report.to_string();
    assert!(text.contains(place), "{name}: no `{place}` in\n{text}");
    assert!(text.contains(words), "{name}: no `{words}` in\n{text}");
    assert!(text.contains(hint), "{name}: no `{hint}` in\n{text}");
    for internal in ["shader.wgsl", "PassVarying", "<unnamed", "wgsl:1:0"] {
        assert!(!text.contains(internal), "{name}: `{internal}` in\n{text}");
    }
    insta::assert_snapshot!(name, text);
}

/// What is wrong with a module's header or outline.
fn header(name: &str, path: &str, text: &str, place: &str, words: &str, hint: &str) {
    let (_, report) = library(&[(path, text)]);
    told(name, &report, place, words, hint);
}

/// What is wrong with a module by itself.
fn module(name: &str, path: &str, text: &str, place: &str, words: &str, hint: &str) {
    let (composer, headers) = library(&[(path, text)]);
    assert!(headers.0.is_empty(), "{name}: {headers}");
    told(name, &composer.check_module(path), place, words, hint);
}

/// What is wrong with a recipe.
fn recipe_fault(
    name: &str,
    more: &[(&str, &str)],
    recipe: &Recipe,
    place: &str,
    words: &str,
    hint: &str,
) {
    let report = composer(more).compose(recipe).unwrap_err();
    told(name, &report, place, words, hint);
}

fn numbered(path: &str, name: &str, value: f64) -> Filling {
    let mut filling = plain(path);
    filling.numbers.insert(name.into(), number(value));
    filling
}

#[test]
fn names_that_are_not_there() {
    recipe_fault(
        "unknown_module",
        &[],
        &recipe(&[("deflect", plain("optics/bnet"))]),
        "pipeline.ron:2:4",
        "there is no module `optics/bnet`",
        "did you mean `optics/bent`?",
    );
    recipe_fault(
        "unknown_slot",
        &[],
        &recipe(&[("delfect", plain("optics/bent"))]),
        "pipeline.ron:2:4",
        "there is no slot `delfect`",
        "did you mean `deflect`?",
    );
    let mut outputs = recipe(&[]);
    outputs.outputs.push(output("color"));
    recipe_fault(
        "unknown_output",
        &[],
        &outputs,
        "pipeline.ron:2:4",
        "has no output `color`",
        "did you mean `colour`?",
    );
    recipe_fault(
        "unknown_number",
        &[],
        &recipe(&[("deflect", numbered("optics/bent", "bned", 1.0))]),
        "pipeline.ron:2:4",
        "has no number `bned`",
        "did you mean `bend`?",
    );
    let mut skeleton = recipe(&[]);
    skeleton.skeleton = written("optics/bent");
    recipe_fault(
        "no_skeleton",
        &[],
        &skeleton,
        "pipeline.ron:2:4",
        "is no skeleton",
        "passes/look",
    );
    let mut reads = plain("optics/bent");
    reads.reads.insert("sen".into(), written("seen"));
    recipe_fault(
        "unknown_read",
        &[],
        &recipe(&[("deflect", reads)]),
        "pipeline.ron:2:4",
        "reads no `sen`",
        "",
    );
    header(
        "unknown_need",
        "a",
        "// A.\n// needs: geometry/rya\n",
        "a.wgsl:2:11",
        "no module `geometry/rya`",
        "did you mean `geometry/ray`?",
    );
    header(
        "unknown_provided_slot",
        "a",
        "// A.\n// provides: deflct\n",
        "a.wgsl:2:14",
        "no slot `deflct`",
        "did you mean `deflect`?",
    );
    header(
        "unknown_called_slot",
        "a",
        "// A.\n// slots: mine: shfit\n",
        "a.wgsl:2:17",
        "no slot `shfit`",
        "did you mean `shift`?",
    );
    header(
        "unknown_override",
        "a",
        "// A.\n// number benb: 0 to 1\n\noverride bend: f32 = 1.0;\n",
        "a.wgsl:2:11",
        "declares no `override benb`",
        "did you mean `bend`?",
    );
}

#[test]
fn fillings_that_do_not_fit() {
    recipe_fault(
        "wrong_slot",
        &[],
        &recipe(&[("intersect", plain("optics/bent"))]),
        "optics/bent.wgsl:3:14",
        "fills the slot `deflect`, not `intersect`",
        "asked for here",
    );
    recipe_fault(
        "fills_no_slot",
        &[],
        &recipe(&[("deflect", plain("geometry/ray"))]),
        "pipeline.ron:2:4",
        "`geometry/ray` fills no slot",
        "add the line `// provides: deflect` to geometry/ray.wgsl",
    );
    let wrong = "// Wrong.\n//\n// provides: deflect\n// needs: geometry/ray\n\nfn deflect(ray: Ray, index: f32) -> Ray {\n    return ray;\n}\n";
    recipe_fault(
        "wrong_signature",
        &[("a", wrong)],
        &recipe(&[("deflect", plain("a"))]),
        "a.wgsl:6:1",
        "has not the signature of the slot `deflect`",
        "write `fn deflect(ray: Ray) -> Ray`",
    );
    let report = composer(&[("a", wrong)])
        .compose(&recipe(&[("deflect", plain("a"))]))
        .unwrap_err()
        .to_string();
    assert!(
        report.contains("slots/deflect.wgsl:5:1") && report.contains("pipeline.ron:2:4"),
        "{report}"
    );
    for (name, types, words) in [
        (
            "wrong_parameter",
            "ray: vec2<f32>",
            "`ray` is `vec2f`, in the slot `Ray`",
        ),
        (
            "wrong_result",
            "ray: Ray) -> vec3f { return ray.origin; }\nfn other(x: f32",
            "gives `vec3f`, the slot `Ray`",
        ),
    ] {
        let text = format!(
            "// A.\n//\n// provides: deflect\n// needs: geometry/ray\n\nfn deflect({types}) -> Ray {{\n    return Ray();\n}}\n"
        );
        recipe_fault(
            name,
            &[("a", &text)],
            &recipe(&[("deflect", plain("a"))]),
            "a.wgsl:6:",
            words,
            "the module has fn deflect(",
        );
    }
    let own = "// A.\n//\n// provides: deflect\n\nstruct Ray {\n    origin: vec3f,\n}\n\nfn deflect(ray: Ray) -> Ray {\n    return ray;\n}\n";
    recipe_fault(
        "struct_of_its_own",
        &[("a", own)],
        &recipe(&[("deflect", plain("a"))]),
        "a.wgsl:9:12",
        "`ray` is the `Ray` of `a`, in the slot the `Ray` of `geometry/ray`",
        "take the types from where the slot has them: `// needs: geometry/ray`",
    );
    recipe_fault(
        "missing_function",
        &[("a", "// A.\n//\n// provides: deflect\n")],
        &recipe(&[("deflect", plain("a"))]),
        "a.wgsl:3:14",
        "has no function `deflect`",
        "the slot's signature",
    );
    module(
        "wrong_signature_alone",
        "a",
        wrong,
        "a.wgsl:6:1",
        "has not the signature",
        "write `fn deflect(ray: Ray) -> Ray`",
    );
    recipe_fault(
        "number_out_of_range",
        &[],
        &recipe(&[("deflect", numbered("optics/bent", "bend", 7.0))]),
        "pipeline.ron:2:4",
        "goes from 0 to 2 rad",
        "7 is outside",
    );
    recipe_fault(
        "number_not_whole",
        &[],
        &recipe(&[("intersect", numbered("geometry/taps", "taps", 2.5))]),
        "pipeline.ron:2:4",
        "`taps` of `geometry/taps` is a whole number",
        "2.5 is none",
    );
    let nan = composer(&[]).compose(&recipe(&[(
        "deflect",
        numbered("optics/bent", "bend", f64::NAN),
    )]));
    assert!(nan.unwrap_err().to_string().contains("NaN is outside"));
    let requiring = "// A.\n//\n// provides: deflect\n// needs: geometry/ray\n// requires: intersect = geometry/plane\n\nfn deflect(ray: Ray) -> Ray {\n    return ray;\n}\n";
    recipe_fault(
        "requirement_not_met",
        &[("a", requiring)],
        &recipe(&[("deflect", plain("a"))]),
        "a.wgsl:5:14",
        "is valid only with `geometry/plane` in the slot `intersect`",
        "fill `intersect` with `geometry/plane`",
    );
    compose(
        &composer(&[("a", requiring)]),
        &recipe(&[
            ("deflect", plain("a")),
            ("intersect", plain("geometry/plane")),
        ]),
    );
}

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
fn a_filling_that_nothing_asks_for_is_warned_of() {
    let composer = composer(&[]);
    let warnings = composer.warnings(&recipe(&[
        ("shift", plain("optics/bent")),
        ("deflect", plain("optics/bent")),
    ]));
    told(
        "unused_filling",
        &warnings,
        "pipeline.ron:2:4",
        "nothing here asks for the slot `shift`",
        "without effect",
    );
    assert!(warnings.is_ok());
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
