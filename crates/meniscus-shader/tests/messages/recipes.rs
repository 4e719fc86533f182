//! What a pipeline asks for and cannot have.

use crate::common::{compose, composer, output, plain, recipe, written};
use crate::{header, module, numbered, recipe_fault, told};

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
