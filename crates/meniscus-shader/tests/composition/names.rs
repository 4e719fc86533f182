//! What things are called in a shader.

use crate::common::{compose, composer, item, plain, recipe};
use crate::{BOTH, SEEN, with};

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
