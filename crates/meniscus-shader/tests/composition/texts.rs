//! What stands in the text, and that it is what runs.

use crate::common::{compose, composer, output, plain, recipe};
use crate::{BOTH, SEEN, with};
use meniscus_shader::{Entry, Recipe, Stage};

#[test]
fn only_what_is_written_is_composed() {
    let composer = composer(&[SEEN]);
    let both = recipe(&[("intersect", plain(SEEN.0))]);
    let colour = Recipe {
        outputs: vec![output("colour")],
        ..both.clone()
    };
    let shader = compose(&composer, &colour);
    assert!(
        shader.bindings.is_empty() && !shader.text.contains("seen"),
        "{}",
        shader.text
    );
    assert!(shader.overrides.is_empty());
    assert_eq!(compose(&composer, &both).bindings.len(), 1);
}

#[test]
fn directives_come_first_and_once() {
    let directed = |slot: &str, result: &str| {
        format!(
            "// D.\n//\n// provides: {slot}\n// needs: geometry/ray\n\ndiagnostic(off, derivative_uniformity);\n\nfn {slot}(ray: Ray) -> {result} {{\n    return {};\n}}\n",
            if result == "Ray" { "ray" } else { "1.0" }
        )
    };
    let (a, b) = (directed("deflect", "Ray"), directed("intersect", "f32"));
    let shader = compose(
        &composer(&[("a", &a), ("b", &b)]),
        &recipe(&[("deflect", plain("a")), ("intersect", plain("b"))]),
    );
    assert!(
        shader
            .text
            .starts_with("diagnostic(off, derivative_uniformity);"),
        "{}",
        shader.text
    );
    assert_eq!(shader.text.matches("diagnostic(").count(), 1);
    let mut colour = recipe(&[("intersect", plain("b"))]);
    colour.outputs = vec![output("colour")];
    let shader = compose(&composer(&[("b", &b)]), &colour);
    assert!(
        !shader.text.contains("diagnostic("),
        "of a module that is not there: {}",
        shader.text
    );
}

#[test]
fn a_screen_skeleton_runs_in_every_stage() {
    let composer = composer(&[SEEN]);
    for stage in [Stage::Render, Stage::Compute, Stage::List] {
        let mut wanted = recipe(&[
            ("intersect", plain(SEEN.0)),
            ("deflect", plain("optics/bent")),
        ]);
        wanted.stage = stage;
        wanted.outputs[1].format = "r32float".into();
        let shader = compose(&composer, &wanted);
        assert_eq!(
            matches!(shader.entry, Entry::Render { .. }),
            stage == Stage::Render
        );
        let listed = shader.bindings.iter().any(|b| b.resource == "pass_pixels");
        assert_eq!(listed, stage == Stage::List);
        crate::keep(&format!("screen_in_{stage:?}"), &shader.text);
    }
}

#[test]
fn the_text_says_what_runs() {
    let filling = with(
        BOTH.0,
        &[
            ("first", with(SEEN.0, &[], &[], &[("seen", "near")])),
            (
                "then",
                with("geometry/taps", &[("tap", plain(SEEN.0))], &[], &[]),
            ),
        ],
        &[],
        &[],
    );
    let composer = composer(&[BOTH, SEEN]);
    for stage in [Stage::Render, Stage::Compute, Stage::List] {
        let mut wanted = recipe(&[
            ("intersect", filling.clone()),
            ("deflect", plain("optics/bent")),
        ]);
        wanted.stage = stage;
        wanted.outputs[1].format = "r32float".into();
        let shader = compose(&composer, &wanted);
        let mut parsed = naga::front::wgsl::parse_str(&shader.text).unwrap();
        naga::compact::compact(&mut parsed, naga::compact::KeepUnused::No);
        let again = |module: &naga::Module| {
            let info = naga::valid::Validator::new(
                naga::valid::ValidationFlags::all(),
                naga::valid::Capabilities::empty(),
            )
            .validate(module)
            .unwrap();
            naga::back::wgsl::write_string(module, &info, naga::back::wgsl::WriterFlags::all())
                .unwrap()
        };
        assert_eq!(again(&parsed), again(&shader.module), "{stage:?}");
    }
}

#[test]
fn what_only_looks_used_is_not_in_the_text() {
    // A local variable is called like a slot's function, which reads a texture.
    let slot = "// S.\n\nvar film: texture_2d<f32>;\n\n// What shows.\nfn shift(x: f32) -> f32 {\n    return textureLoad(film, vec2i(0), 0).x;\n}\n\nfn beside(x: f32) -> f32 {\n    return x;\n}\n";
    let calling = "// P.\n//\n// provides: intersect\n// needs: geometry/ray\n// slots: shift\n\nfn intersect(ray: Ray) -> f32 {\n    let shift = ray.origin.x;\n    return beside(shift);\n}\n";
    let composer = composer(&[("slots/shift", slot), ("geometry/calling", calling)]);
    let shader = compose(
        &composer,
        &recipe(&[("intersect", plain("geometry/calling"))]),
    );
    assert!(shader.bindings.is_empty());
    assert!(
        !shader.text.contains("film") && !shader.text.contains("What shows."),
        "{}",
        shader.text
    );
    assert!(shader.text.contains("fn beside("));
    // What is written out is valid by itself.
    let parsed = naga::front::wgsl::parse_str(&shader.text).unwrap();
    naga::valid::Validator::new(
        naga::valid::ValidationFlags::all(),
        naga::valid::Capabilities::empty(),
    )
    .validate(&parsed)
    .unwrap();
}
