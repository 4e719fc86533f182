//! Numbers that a pipeline sets: live ones in a buffer, constants in the text.

mod common;

use std::collections::BTreeMap;

use common::{compose, composer, item, library, number, plain, recipe};
use meniscus_shader::{BindingKind, Filling, LIVE_NUMBERS, Shader};

/// Adds what is live to what it calls.
const LIVE: (&str, &str) = (
    "geometry/raised",
    "// Raised.\n//\n// provides: intersect\n// needs: geometry/ray\n// slots: tap: intersect\n// number lift: -2 to 8 m, step 0.5, live\n// number times: 0 to 9, live\n\noverride lift: f32 = 1.5;\noverride times: u32 = 2u;\noverride never: f32 = 0.0;\n\nfn intersect(ray: Ray) -> f32 {\n    return tap(ray) + lift * f32(times);\n}\n",
);

/// Sums as many taps as a constant says, kept in an array of that length.
const SUMMED: (&str, &str) = (
    "geometry/summed",
    "// Summed.\n//\n// provides: intersect\n// needs: geometry/ray\n// slots: tap: intersect\n// number taps: 1 to 16, step 1\n\n// How many.\nconst taps: i32 = 4;\nconst last = taps - 1;\n\nfn intersect(ray: Ray) -> f32 {\n    var kept = array<f32, taps>();\n    for (var i = 0; i < taps; i++) {\n        kept[i] = tap(ray);\n    }\n    return kept[last];\n}\n",
);

fn with(path: &str, numbers: &[(&str, f64)], tap: Option<Filling>) -> Filling {
    let mut filling = plain(path);
    for (name, value) in numbers {
        filling.numbers.insert((*name).to_owned(), number(*value));
    }
    filling.slots.extend(tap.map(|tap| ("tap".to_owned(), tap)));
    filling
}

fn same_as_text(shader: &Shader) {
    let parsed = naga::front::wgsl::parse_str(&shader.text);
    let mut parsed =
        parsed.unwrap_or_else(|wrong| panic!("{}", wrong.emit_to_string(&shader.text)));
    naga::compact::compact(&mut parsed, naga::compact::KeepUnused::No);
    assert_eq!(parsed.functions.len(), shader.module.functions.len());
    assert_eq!(parsed.types.len(), shader.module.types.len());
    assert_eq!(parsed.overrides.len(), shader.module.overrides.len());
}

#[test]
fn live_numbers_are_members_of_a_buffer_that_is_only_read() {
    let composer = composer(&[LIVE]);
    let twice = with(
        LIVE.0,
        &[("lift", 3.0)],
        Some(with(LIVE.0, &[], Some(plain("geometry/plane")))),
    );
    let shader = compose(&composer, &recipe(&[("intersect", twice)]));
    same_as_text(&shader);
    let names: Vec<_> = shader
        .live
        .iter()
        .map(|n| (n.path.as_str(), n.member()))
        .collect();
    assert_eq!(
        names,
        [
            ("intersect.lift", "intersect_lift"),
            ("intersect.tap.lift", "intersect_tap_lift"),
            ("intersect.tap.times", "intersect_tap_times"),
            ("intersect.times", "intersect_times"),
        ]
    );
    let binding = shader.bindings.iter().find(|b| b.resource == LIVE_NUMBERS);
    let kind = binding.expect("a buffer").kind;
    assert!(matches!(
        kind,
        BindingKind::Storage {
            read_only: true,
            ..
        }
    ));
    assert!(shader.overrides.is_empty() && shader.module.overrides.is_empty());
    assert_eq!(
        shader.number("intersect.lift"),
        Some("live_numbers.intersect_lift")
    );
    assert_eq!(shader.number("intersect.never"), None);
    // Where each stands is naga's layout, the values are the module's.
    let offsets: Vec<_> = shader.live.iter().map(|n| n.offset).collect();
    assert_eq!(offsets, [0, 4, 8, 12]);
    let words = |bytes: Vec<u8>| -> Vec<[u8; 4]> {
        bytes
            .chunks(4)
            .map(|word| word.try_into().unwrap())
            .collect()
    };
    let (lift, times) = (1.5_f32.to_le_bytes(), 2_u32.to_le_bytes());
    assert_eq!(
        words(shader.live_bytes(|_| None)),
        [lift, lift, times, times]
    );
    let set = |name: &str| (name == "live_numbers.intersect_lift").then_some(3.0);
    let three = 3_f32.to_le_bytes();
    assert_eq!(words(shader.live_bytes(set)), [three, lift, times, times]);
}

#[test]
fn a_live_number_stays_in_its_range_whatever_is_given() {
    let composer = composer(&[LIVE]);
    let shader = compose(
        &composer,
        &recipe(&[("intersect", with(LIVE.0, &[], None))]),
    );
    let [lift, times] = shader.live.as_slice() else {
        panic!("{:?}", shader.live)
    };
    for (given, becomes) in [
        (-9.0, -2.0),
        (1e300, 8.0),
        (f64::NAN, 1.5),
        (f64::NEG_INFINITY, -2.0),
    ] {
        assert_eq!(lift.bytes(given), f32::to_le_bytes(becomes), "{given}");
    }
    for (given, becomes) in [(-1.0, 0), (3.7, 3), (1e9, 9), (f64::NAN, 2)] {
        assert_eq!(times.bytes(given), u32::to_le_bytes(becomes), "{given}");
    }
}

#[test]
fn what_no_entry_point_uses_of_live_numbers_is_not_bound() {
    let composer = composer(&[LIVE]);
    let mut wanted = recipe(&[("intersect", with(LIVE.0, &[], None))]);
    wanted
        .outputs
        .retain(|output| output.name.value == "colour");
    let shader = compose(&composer, &wanted);
    assert!(shader.live.is_empty() && shader.bindings.is_empty());
    assert_eq!(shader.live_bytes(|_| Some(1.0)), Vec::<u8>::new());
}

#[test]
fn a_module_by_itself_has_its_live_numbers_as_overrides() {
    let alone = composer(&[LIVE])
        .module(LIVE.0, &BTreeMap::new(), &Default::default())
        .unwrap_or_else(|report| panic!("{report}"));
    assert!(alone.overrides.contains_key("lift") && alone.overrides.contains_key("times"));
}

#[test]
fn shaders_differ_in_constants_and_not_in_live_numbers() {
    let composer = composer(&[LIVE, SUMMED]);
    let taps = |taps: f64| {
        compose(
            &composer,
            &recipe(&[("intersect", with(SUMMED.0, &[("taps", taps)], None))]),
        )
    };
    let hashes: std::collections::BTreeSet<_> =
        (1..=16).map(|n| taps(n.into()).hash.clone()).collect();
    assert_eq!((hashes.len(), composer.composed()), (16, 16));
    // The default is one of them.
    let plain = compose(&composer, &recipe(&[("intersect", plain(SUMMED.0))]));
    assert!(hashes.contains(&plain.hash));
    assert_eq!(composer.composed(), 16);
    for step in 0..10 {
        let lift = [("lift", f64::from(step) * 0.5)];
        compose(
            &composer,
            &recipe(&[("intersect", with(LIVE.0, &lift, None))]),
        );
    }
    assert_eq!(composer.composed(), 17);
}

#[test]
fn a_constant_sizes_the_arrays_of_its_own_instance() {
    let composer = composer(&[SUMMED]);
    let inner = with(SUMMED.0, &[("taps", 7.0)], Some(plain("geometry/plane")));
    let nested = with(SUMMED.0, &[("taps", 3.0)], Some(inner));
    let shader = compose(&composer, &recipe(&[("intersect", nested)]));
    same_as_text(&shader);
    assert_eq!(
        item(&shader, "// How many."),
        "// How many.\nconst intersect_tap_taps: i32 = 7;"
    );
    assert!(shader.text.contains("const intersect_taps: i32 = 3;"));
    let lengths: Vec<_> = shader
        .module
        .types
        .iter()
        .filter_map(|(_, ty)| match ty.inner {
            naga::TypeInner::Array {
                size: naga::ArraySize::Constant(size),
                ..
            } => Some(size.get()),
            _ => None,
        })
        .collect();
    assert_eq!(lengths, [7, 3]);
    // What is made of a constant follows it.
    assert!(
        shader.text.contains("= intersect_tap_taps - 1;")
            && shader.text.contains("= intersect_taps - 1;")
    );
}

#[test]
fn numbers_that_cannot_be_set_are_told_where_they_are_declared() {
    let change = |from: &str, to: &str| LIVE.1.replace(from, to);
    let constant = |from: &str, to: &str| SUMMED.1.replace(from, to);
    for (text, place, words) in [
        (
            change("lift: f32 = 1.5", "lift: bool = true"),
            "a.wgsl:9:10",
            "a type that a buffer can hold",
        ),
        (
            change("lift: f32 = 1.5", "lift = 1.5"),
            "a.wgsl:9:10",
            "a type that a buffer can hold",
        ),
        (
            change("f32 = 1.5", "f32 = 1.0 + 0.5"),
            "a.wgsl:9:10",
            "must be a plain number",
        ),
        (
            change(" = 1.5", ""),
            "a.wgsl:9:10",
            "must be a plain number",
        ),
        (
            change("    return", "    let lift = 1.0;\n    return"),
            "a.wgsl:9:10",
            "has the same name",
        ),
        (
            constant("step 1", "step 1, live"),
            "a.wgsl:9:7",
            "cannot change while a plan runs",
        ),
        (
            constant("taps: i32 = 4", "taps = 4"),
            "a.wgsl:9:7",
            "has no type",
        ),
        (
            constant("// provides: intersect\n", ""),
            "a.wgsl:8:7",
            "only those of fillings can be set",
        ),
    ] {
        let (_, report) = library(&[("a", &text)]);
        let report = report.to_string();
        assert!(
            report.contains(words) && report.contains(place),
            "{words}: {report}"
        );
    }
    let beyond = composer(&[SUMMED]).compose(&recipe(&[(
        "intersect",
        with(SUMMED.0, &[("taps", 17.0)], None),
    )]));
    assert!(
        beyond
            .unwrap_err()
            .to_string()
            .contains("`taps` of `geometry/summed` goes from 1 to 16")
    );
    let broken = composer(&[SUMMED]).compose(&recipe(&[(
        "intersect",
        with(SUMMED.0, &[("taps", 2.5)], None),
    )]));
    assert!(
        broken
            .unwrap_err()
            .to_string()
            .contains("is a whole number")
    );
}
