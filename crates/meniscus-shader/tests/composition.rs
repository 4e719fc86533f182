//! What composition promises: instances, names, connections, pruning.

mod common;

use common::{compose, composer, item, number, output, plain, recipe, written};
use meniscus_shader::{Entry, Filling, Recipe, Stage};

fn with(
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
const BOTH: (&str, &str) = (
    "geometry/both",
    "// Two in one.\n//\n// provides: intersect\n// needs: geometry/ray\n// slots: first: intersect, then: intersect\n\n\
     fn intersect(ray: Ray) -> f32 {\n    return first(ray) + then(ray);\n}\n",
);

/// A filling with a helper, a type and a resource of its own.
const SEEN: (&str, &str) = (
    "screen/seen",
    "// What is seen.\n//\n// provides: intersect\n// needs: geometry/ray\n// number scale: 0 to 9\n\n\
     // The scale.\noverride scale: f32 = 1.0;\n\nvar seen: texture_2d<f32>;\n\nstruct Texel {\n    scale: f32,\n    seen: vec4f,\n}\n\n\
     fn texel_at(ray: Ray) -> Texel {\n    let seen = textureLoad(seen, vec2i(ray.origin.xy), 0);\n    return Texel(scale, seen);\n}\n\n\
     fn unused(ray: Ray) -> f32 {\n    return 1.0;\n}\n\n\
     fn intersect(ray: Ray) -> f32 {\n    let texel = texel_at(ray);\n    return texel.seen.x * texel.scale;\n}\n",
);

#[test]
fn the_same_module_stands_twice_with_other_numbers_and_resources() {
    let filling = with(
        BOTH.0,
        &[
            (
                "first",
                with(SEEN.0, &[], &[("scale", 2.0)], &[("seen", "near picture")]),
            ),
            ("then", with(SEEN.0, &[], &[("scale", 3.0)], &[])),
        ],
        &[],
        &[],
    );
    let shader = compose(&composer(&[BOTH, SEEN]), &recipe(&[("intersect", filling)]));
    assert_eq!(
        shader.overrides["intersect.first.scale"],
        "intersect_first_scale"
    );
    assert_eq!(
        shader.overrides["intersect.then.scale"],
        "intersect_then_scale"
    );
    let resources: Vec<_> = shader
        .bindings
        .iter()
        .map(|b| (b.variable.as_str(), b.resource.as_str()))
        .collect();
    assert_eq!(
        resources,
        [("seen", "seen"), ("seen_from_near_picture", "near picture")]
    );
    // The type says the same in both and stands once; the helper differs and stands twice.
    assert_eq!(shader.text.matches("struct Texel").count(), 1);
    assert!(
        item(&shader, "fn texel_at(")
            .contains("Texel(intersect_first_scale, seen_from_near_picture)")
    );
    assert!(item(&shader, "fn texel_at_2(").contains("Texel(intersect_then_scale, seen)"));
    // Members and locals keep their meaning.
    assert!(shader.text.contains("texel.seen.x * texel.scale"));
    assert!(!shader.text.contains("fn unused"), "unreachable");
    assert!(item(&shader, "fn intersect(").contains("intersect_first(ray) + intersect_then(ray)"));
    insta::assert_snapshot!("twice_in_one_shader", shader.text);
}

#[test]
fn what_is_the_same_stands_once() {
    let same = with(
        BOTH.0,
        &[
            ("first", plain("geometry/plane")),
            ("then", plain("geometry/plane")),
        ],
        &[],
        &[],
    );
    let shader = compose(&composer(&[BOTH]), &recipe(&[("intersect", same)]));
    assert_eq!(
        shader
            .text
            .matches("-ray.origin.z / ray.direction.z")
            .count(),
        1,
        "{}",
        shader.text
    );
    assert!(
        shader
            .text
            .contains("intersect_first(ray) + intersect_first(ray)")
    );
    assert_eq!(shader.text.matches("struct Ray").count(), 1);
}

#[test]
fn an_unfilled_slot_takes_the_nearest_enclosing_filling() {
    let tripled = (
        "water/tripled",
        "// T.\n//\n// provides: shift\n\nfn shift(x: f32) -> f32 {\n    return 3.0 * x;\n}\n",
    );
    let halved = (
        "water/halved",
        "// H.\n//\n// provides: shift\n\nfn shift(x: f32) -> f32 {\n    return 0.5 * x;\n}\n",
    );
    let composer = composer(&[BOTH, tripled, halved]);
    let shift = |shader: &meniscus_shader::Shader, name: &str| {
        item(shader, &format!("fn {name}(x: f32)")).to_owned()
    };

    // The plane calls `shift`: the one beside it, else the one around it, else the pass's.
    let inner = with("geometry/plane", &[("shift", plain(tripled.0))], &[], &[]);
    let mixed = with(
        BOTH.0,
        &[("first", inner), ("then", plain("geometry/plane"))],
        &[],
        &[],
    );
    let shader = compose(
        &composer,
        &recipe(&[("intersect", mixed.clone()), ("shift", plain(halved.0))]),
    );
    assert!(shift(&shader, "intersect_first_shift").contains("3.0 * x"));
    assert!(shift(&shader, "shift").contains("0.5 * x"));
    assert!(item(&shader, "fn intersect_first(").contains("intersect_first_shift("));
    assert!(item(&shader, "fn intersect_then(").contains("return shift("));

    let around = with(
        BOTH.0,
        &[
            ("first", plain("geometry/plane")),
            ("shift", plain(tripled.0)),
        ],
        &[],
        &[],
    );
    let shader = compose(
        &composer,
        &recipe(&[("intersect", around), ("shift", plain(halved.0))]),
    );
    assert!(shift(&shader, "intersect_shift").contains("3.0 * x"));
    assert!(
        !shader.text.contains("0.5 * x"),
        "nothing asks for it: {}",
        shader.text
    );

    let bare = compose(&composer, &recipe(&[("intersect", mixed)]));
    assert!(
        shift(&bare, "shift").contains("return x;"),
        "the slot's own body"
    );
}

#[test]
fn a_default_is_resolved_where_it_is_asked_for() {
    // The slot's default calls another slot, which the asking filling fills for itself.
    let slot = (
        "slots/scaled",
        "// S.\n//\n// slots: shift\n\nfn scaled(x: f32) -> f32 {\n    return 2.0 * shift(x);\n}\n",
    );
    let user = (
        "a",
        "// A.\n//\n// provides: intersect\n// needs: geometry/ray\n// slots: scaled\n\nfn intersect(ray: Ray) -> f32 {\n    return scaled(1.0);\n}\n",
    );
    let tripled = (
        "water/tripled",
        "// T.\n//\n// provides: shift\n\nfn shift(x: f32) -> f32 {\n    return 3.0 * x;\n}\n",
    );
    let filling = with(user.0, &[("shift", plain(tripled.0))], &[], &[]);
    let shader = compose(
        &composer(&[slot, user, tripled]),
        &recipe(&[("intersect", filling)]),
    );
    assert!(shader.text.contains("3.0 * x"), "{}", shader.text);
}

#[test]
fn a_combinator_without_its_own_fillings_calls_the_next_one_out() {
    // `tap` is an intersect; unfilled, it is not the combinator itself but the default behind it.
    let shader = compose(
        &composer(&[]),
        &recipe(&[("intersect", plain("geometry/taps"))]),
    );
    assert!(
        item(&shader, "fn intersect(").contains("sum += intersect_intersect(ray)"),
        "{}",
        shader.text
    );
    assert!(item(&shader, "fn intersect_intersect(").contains("return 0.0;"));
}

#[test]
fn numbers_are_found_by_their_paths() {
    let taps = with(
        "geometry/taps",
        &[(
            "tap",
            with(
                "geometry/taps",
                &[("tap", plain("geometry/plane"))],
                &[("taps", 4.0)],
                &[],
            ),
        )],
        &[("taps", 3.0)],
        &[],
    );
    let shader = compose(
        &composer(&[]),
        &recipe(&[
            ("intersect", taps.clone()),
            ("deflect", plain("optics/bent")),
        ]),
    );
    let paths: Vec<_> = shader
        .overrides
        .iter()
        .map(|(path, name)| (path.as_str(), name.as_str()))
        .collect();
    assert_eq!(
        paths,
        [
            ("deflect.bend", "deflect_bend"),
            ("intersect.tap.taps", "intersect_tap_taps"),
            ("intersect.taps", "intersect_taps"),
        ]
    );
    for name in shader.overrides.values() {
        assert!(
            shader
                .module
                .overrides
                .iter()
                .any(|(_, o)| o.name.as_ref() == Some(name)),
            "{name}"
        );
    }
    let mut all = Default::default();
    taps.numbers_below("intersect", &mut all);
    assert!(all.keys().all(|path| shader.overrides.contains_key(path)));
}

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
fn a_module_may_be_called_like_what_wgsl_has() {
    // A slot named `reflect` and one that a combinator calls `step`; others still mean WGSL's own.
    let slot = (
        "slots/reflect",
        "// R.\n\nfn reflect(x: f32) -> f32 {\n    return x;\n}\n",
    );
    let calls = (
        "a",
        "// A.\n//\n// provides: intersect\n// needs: geometry/ray\n// slots: reflect, step: intersect\n\nfn intersect(ray: Ray) -> f32 {\n    return reflect(1.0) + step(ray);\n}\n",
    );
    let own = (
        "b",
        "// B.\n//\n// provides: deflect\n// needs: geometry/ray\n\nfn mix(x: f32) -> f32 {\n    return x;\n}\n\nfn deflect(ray: Ray) -> Ray {\n    return Ray(reflect(ray.origin, ray.direction) * mix(1.0), vec3f(step(0.5, 0.2)));\n}\n",
    );
    let filling = with("a", &[("step", plain("geometry/plane"))], &[], &[]);
    let shader = compose(
        &composer(&[slot, calls, own]),
        &recipe(&[("intersect", filling), ("deflect", plain("b"))]),
    );
    assert!(
        shader.text.contains("reflect(ray.origin, ray.direction)")
            && shader.text.contains("step(0.5, 0.2)")
    );
    assert!(
        !shader.text.contains("fn reflect(") && !shader.text.contains("fn mix("),
        "{}",
        shader.text
    );
}

#[test]
fn made_up_names_avoid_written_ones() {
    // A local of the caller is called as the combinator's filling would be.
    let calls = (
        "a",
        "// A.\n//\n// provides: intersect\n// needs: geometry/ray\n// slots: first: intersect\n\n\
        const intersect_first_2 = 1.0;\n\nfn intersect(ray: Ray) -> f32 {\n    let intersect_first = 2.0;\n    return first(ray) + intersect_first + intersect_first_2;\n}\n",
    );
    let filling = with("a", &[("first", plain("geometry/plane"))], &[], &[]);
    let shader = compose(&composer(&[calls]), &recipe(&[("intersect", filling)]));
    assert!(
        item(&shader, "fn intersect(")
            .contains("intersect_first_3(ray) + intersect_first + intersect_first_2"),
        "{}",
        shader.text
    );
}

#[test]
fn attributes_and_members_are_not_renamed() {
    let twice = (
        "a",
        "// A.\n//\n// provides: intersect\n// needs: geometry/ray\n// slots: shift\n\n\
        const size = 16u;\n\nstruct Packed {\n    @size(size) size: f32,\n    position: f32,\n}\n\nfn position(x: f32) -> f32 {\n    return shift(x);\n}\n\n\
        fn intersect(ray: Ray) -> f32 {\n    var p = Packed(1.0, 2.0);\n    p.position = position(p.size);\n    return p.position;\n}\n",
    );
    let tripled = (
        "water/tripled",
        "// T.\n//\n// provides: shift\n\nfn shift(x: f32) -> f32 {\n    return 3.0 * x;\n}\n",
    );
    let filling = with(
        BOTH.0,
        &[
            ("first", with("a", &[("shift", plain(tripled.0))], &[], &[])),
            ("then", plain("a")),
        ],
        &[],
        &[],
    );
    let shader = compose(
        &composer(&[BOTH, twice, tripled]),
        &recipe(&[("intersect", filling)]),
    );
    assert!(
        shader.text.contains("@builtin(position) position")
            && shader.text.contains("@size(size) size: f32"),
        "{}",
        shader.text
    );
    assert!(
        shader.text.contains("p.position = position_2(p.size)"),
        "{}",
        shader.text
    );
    assert_eq!(shader.text.matches("struct Packed").count(), 1);
}

#[test]
fn a_pass_and_a_filling_may_read_differently() {
    let look = composer(&[BOTH, SEEN]);
    let filling = with(
        BOTH.0,
        &[
            ("first", with(SEEN.0, &[], &[], &[("seen", "seen")])),
            ("then", plain(SEEN.0)),
        ],
        &[],
        &[],
    );
    let mut wanted = recipe(&[("intersect", filling)]);
    wanted.reads.insert("seen".into(), "far".into());
    let shader = compose(&look, &wanted);
    let mut resources: Vec<_> = shader
        .bindings
        .iter()
        .map(|b| b.resource.as_str())
        .collect();
    resources.sort_unstable();
    assert_eq!(resources, ["far", "seen"], "{:?}", shader.bindings);
}

#[test]
fn resources_that_differ_only_in_odd_letters_stay_apart() {
    let filling = with(
        BOTH.0,
        &[
            ("first", with(SEEN.0, &[], &[], &[("seen", "a b")])),
            ("then", with(SEEN.0, &[], &[], &[("seen", "a_b")])),
        ],
        &[],
        &[],
    );
    let shader = compose(&composer(&[BOTH, SEEN]), &recipe(&[("intersect", filling)]));
    let mut resources: Vec<_> = shader
        .bindings
        .iter()
        .map(|b| b.resource.as_str())
        .collect();
    resources.sort_unstable();
    assert_eq!(resources, ["a b", "a_b"]);
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
        insta::assert_snapshot!(format!("screen_in_{stage:?}"), shader.text);
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
fn signatures_are_compared_by_what_their_types_are() {
    let slot = "// T.\n//\n// needs: geometry/ray\n\nalias Texel = vec2<f32>;\n\nconst COUNT = 3;\n\nfn tapped(ray: Ray, at: Texel, weights: array<f32, COUNT>) -> mat3x3f {\n    return mat3x3f();\n}\n";
    let filling = "// F.\n//\n// provides: tapped\n// needs: geometry/ray\n\nalias Weights = array<f32, 2 + 1>;\n\nfn tapped(r: Ray, texel: vec2f, w: Weights) -> mat3x3<f32> {\n    return mat3x3f(r.origin * w[0], vec3f(texel, w[1]), vec3f());\n}\n";
    let check = |filling: &str| {
        let composer = composer(&[("slots/tapped", slot), ("geometry/tapping", filling)]);
        composer.check_module("geometry/tapping")
    };
    assert_eq!(check(filling).to_string(), "");
    // Another length, another kind of scalar, another order: each is another type.
    for (was, is) in [
        ("2 + 1", "2 + 2"),
        ("texel: vec2f", "texel: vec2i"),
        ("mat3x3<f32>", "mat3x4<f32>"),
    ] {
        let report = check(&filling.replace(was, is)).to_string();
        assert!(report.contains("has not the signature"), "{is}: {report}");
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
