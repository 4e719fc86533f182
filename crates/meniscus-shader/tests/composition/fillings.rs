//! Which module fills which slot, and how often a module stands in a shader.

use crate::common::{compose, composer, item, plain, recipe};
use crate::{BOTH, SEEN, with};

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
    crate::keep("twice_in_one_shader", &shader.text);
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
