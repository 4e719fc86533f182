//! Modules that differ a little from honest ones: reading, checking and composing them ends, with a
//! shader or with messages at places in what was written.

mod common;
#[path = "../../meniscus-source/tests/common/mutate.rs"]
mod mutate;

use std::path::Path;

use common::{library, plain, recipe};
use meniscus_shader::{Library, Recipe};
use meniscus_source::ron::Spanned;
use meniscus_source::{Report, SourceFile, read_tree};
use mutate::Mutator;

const WORDS: &[&str] = &[
    "// provides: deflect\n",
    "// provides: intersect\n",
    "// needs: geometry/ray\n",
    "// needs: a\n",
    "// slots: shift\n",
    "// slots: a: deflect\n",
    "// requires: intersect = geometry/plane\n",
    "// number bend: 0 to 1 m, step 0.1, live\n",
    "// when waves: a\n",
    "// skeleton: screen\n",
    "// skeleton: draw\n",
    "// skeleton: compute\n",
    "// outputs: colour, distance\n",
    "// workgroup: 8, 8\n",
    "// flat: x\n",
    "fn",
    "struct",
    "var",
    "var<storage, read_write>",
    "const",
    "override",
    "alias",
    "const_assert",
    "enable f16;",
    "@group(0)",
    "@interpolate(flat)",
    "if",
    "else",
    "loop",
    "for",
    "while",
    "switch",
    "default",
    "return",
    "discard",
    "let",
    "deflect",
    "intersect",
    "shift",
    "bend",
    "Ray",
    "vec3f",
    "vec3<f32>",
    "array<f32, 3>",
    "mat3x3f",
    "texture_2d<f32>",
    "ptr<function, f32>",
    "f32",
    "u32",
    "textureLoad",
    "live_numbers",
    "LiveNumbers",
    "PassVarying",
    "fragment_main",
    "_",
    "/",
    "<<",
    "&&",
    "->",
    "1e38",
    "4294967295u",
    "0xffffffff",
    "1i",
    "0.5h",
];

/// The texts of the product's modules, and those of the small library.
fn corpus() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shader-modules");
    let ours = read_tree(&folder, "wgsl").unwrap_or_else(|report| panic!("{report}"));
    let small = common::BASE.iter().map(|(_, text)| (*text).to_owned());
    ours.into_iter()
        .map(|(_, file)| file.text.clone())
        .chain(small)
        .collect()
}

/// That messages stand inside what was written, and can be shown.
fn told_well(report: &Report, shown: bool) {
    for label in report.0.iter().flat_map(|diagnostic| &diagnostic.labels) {
        let place = &label.place;
        assert!(
            place.file.text.get(place.range.clone()).is_some(),
            "{label:?}"
        );
    }
    if shown {
        assert_eq!(report.to_string().is_empty(), report.0.is_empty());
    }
}

#[test]
fn reading_ends() {
    Mutator::new(&corpus(), WORDS).run(1, |case, text| {
        let file = SourceFile::new("case.wgsl", text);
        let paths = ["a/case", "slots/case"];
        let (library, report) = Library::new([(paths[case as usize % 2], file)]);
        assert_eq!(library.modules().count(), 1);
        told_well(&report, case.is_multiple_of(64));
    });
}

#[test]
fn composing_ends() {
    let small: Vec<String> = common::BASE
        .iter()
        .map(|(_, text)| (*text).to_owned())
        .collect();
    Mutator::new(&small, WORDS).run(10, |case, text| {
        let (composer, report) = library(&[("a", text)]);
        told_well(&report, false);
        told_well(&composer.check_module("a"), case.is_multiple_of(16));
        let slot = ["deflect", "intersect", "shift"][case as usize % 3];
        let fillings = [(slot, plain("a"))];
        let as_skeleton = Recipe {
            skeleton: Spanned::unplaced("a".to_owned()),
            ..recipe(&[])
        };
        for recipe in [recipe(&fillings), as_skeleton] {
            match composer.compose(&recipe) {
                // What comes out is what naga accepts, and says what runs.
                Ok(shader) if case.is_multiple_of(16) => {
                    let parsed =
                        naga::front::wgsl::parse_str(&shader.text).unwrap_or_else(|wrong| {
                            panic!("{}\n{}", wrong.emit_to_string(&shader.text), shader.text)
                        });
                    let everything = naga::valid::ValidationFlags::all();
                    let plain = naga::valid::Capabilities::empty();
                    naga::valid::Validator::new(everything, plain)
                        .validate(&parsed)
                        .unwrap_or_else(|wrong| panic!("{wrong:?}\n{}", shader.text));
                }
                Ok(_) => {}
                Err(report) => told_well(&report, case.is_multiple_of(16)),
            }
        }
    });
}
