//! Whatever a text holds, composition ends, with a shader or with messages.

mod common;

use std::collections::BTreeMap;

use common::{BASE, library, plain, recipe, sources};
use meniscus_shader::{Composer, Filling, Library, Recipe};
use meniscus_source::ron::Spanned;
use meniscus_source::{Report, SourceFile};
use proptest::prelude::*;

/// Reads a module, checks it, and composes with it in a slot and as a skeleton.
fn survive(path: &str, text: &str) {
    let (composer, report) = library(&[(path, text)]);
    let _ = (report.to_string(), composer.check_module(path).to_string());
    for slots in [
        vec![("deflect", plain(path))],
        vec![
            ("intersect", plain("geometry/taps")),
            ("shift", plain(path)),
        ],
    ] {
        let _ = composer
            .compose(&recipe(&slots))
            .map_err(|report| report.to_string());
    }
    let _ = composer.compose(&Recipe {
        skeleton: Spanned::unplaced(path.to_owned()),
        ..recipe(&[])
    });
}

/// Pieces that mean something to headers or to WGSL.
fn pieces() -> impl Strategy<Value = String> {
    const WORDS: &[&str] = &[
        "// ",
        "\n",
        "\r\n",
        "provides:",
        "needs:",
        "slots:",
        "requires:",
        "number ",
        "when ",
        "skeleton: screen",
        "outputs:",
        "workgroup:",
        "deflect",
        "intersect",
        "geometry/ray",
        "../../etc",
        "a/b",
        ",",
        "=",
        ":",
        ";",
        "{",
        "}",
        "(",
        ")",
        "<",
        ">",
        "fn ",
        "struct ",
        "var",
        "override ",
        "const ",
        "alias ",
        "const_assert ",
        "@",
        "@builtin(",
        "Ray",
        "f32",
        "vec3f",
        "1e999",
        "0x",
        "99999999999999999999",
        "1.",
        "/*",
        "*/",
        "é",
        "\u{2028}",
        "\u{202e}",
        "\u{feff}",
        "𝔘",
        "\0",
        "enable f16;",
        "return ",
        "let ",
        "->",
        "array<",
        "ptr<function,",
        "texture_2d<f32>",
        "loop ",
        "switch ",
        "else if ",
    ];
    prop_oneof![4 => prop::sample::select(WORDS).prop_map(str::to_owned), 1 => any::<char>().prop_map(String::from)]
}

/// Changes to a text: at a place (a part of its length), so many letters replaced by a piece.
fn edits() -> impl Strategy<Value = Vec<(f64, usize, String)>> {
    prop::collection::vec((0.0..1.0, 0usize..12, pieces()), 1..6)
}

fn edited(text: &str, edits: &[(f64, usize, String)]) -> String {
    let mut letters: Vec<char> = text.chars().collect();
    for (at, cut, piece) in edits {
        let start = (at * letters.len() as f64) as usize;
        let end = (start + cut).min(letters.len());
        letters.splice(start..end, piece.chars());
    }
    letters.into_iter().collect()
}

/// As many cases as `PROPTEST_CASES` says, or a few.
fn config() -> ProptestConfig {
    let mut config = ProptestConfig::default();
    if std::env::var_os("PROPTEST_CASES").is_none() {
        config.cases = 300;
    }
    config.failure_persistence = None;
    config
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn any_text_may_be_a_module(text in prop::collection::vec(pieces(), 0..60).prop_map(|p| p.concat())) {
        survive("any", &text);
    }

    #[test]
    fn a_module_may_be_spoilt_anywhere(which in 0..BASE.len(), edits in edits()) {
        let (path, text) = BASE[which];
        survive(path, &edited(text, &edits));
    }

    #[test]
    fn a_path_may_be_anything(path in prop::collection::vec(pieces(), 0..6).prop_map(|p| p.concat())) {
        survive(&path, BASE[4].1);
        survive(&format!("slots/{path}"), BASE[3].1);
    }
}

fn filling(text: &str) -> String {
    format!("// A.\n//\n// provides: shift\n\nfn shift(x: f32) -> f32 {{\n{text}\n}}\n")
}

#[test]
fn deep_and_long_texts_end_with_a_message() {
    let n = 60_000;
    let repeated = |open: &str, inner: &str, close: &str| {
        format!("{}{inner}{}", open.repeat(n), close.repeat(n))
    };
    for body in [
        format!("return {};", repeated("(", "x", ")")),
        format!("return x{};", " + x".repeat(n)),
        format!("return {}x;", "-".repeat(n)),
        format!("return x{};", ".x".repeat(n)),
        format!("return x{};", "[0]".repeat(n)),
        format!("return {};", repeated("abs(", "x", ")")),
        format!("return {};", repeated("f32(1 + ", "x", ", 2)")),
        format!("var y: {};", repeated("array<", "f32", ", 2>")),
        repeated("{", "", "}"),
        repeated("if true {", "", "}"),
        format!("if true {{}}{}", " else if true {}".repeat(n)),
        repeated("loop {", "", "}"),
        repeated("switch 1 { default: {", "", "}}"),
        "/*".repeat(n),
        format!("return {};", "9".repeat(n)),
        format!("return x; {}", "let y = x; ".repeat(n / 4)),
        "é".repeat(n),
    ] {
        let text = filling(&body);
        let (composer, headers) = library(&[("a", &text)]);
        let report = composer.check_module("a");
        let said = headers.to_string() + &report.to_string();
        // Lengths that are harmless may be right; everything else is told, and at its place.
        assert!(
            said.is_empty() || said.contains("a.wgsl:"),
            "{}: {said:.300}",
            &body[..20.min(body.len())]
        );
    }
}

#[test]
fn costly_constants_are_bounded() {
    for text in [
        "var y = array<f32, 1000000000>(); return y[3];",
        "const y = array<vec4f, 100000000>(); return y[7].x;",
        "let y = 1u << 4000000000u; return f32(y);",
        "for (var i = 0; i >= 0; i += 0) { } return x;",
    ] {
        survive("a", &filling(text));
    }
}

fn report_of(modules: &[(String, String)], slots: &[(&str, Filling)]) -> Report {
    let named = modules.iter().map(|(path, text)| {
        (
            path.as_str(),
            SourceFile::new(format!("{path}.wgsl"), text.as_str()),
        )
    });
    let base = sources(&[]);
    let base = base
        .iter()
        .map(|(path, file)| (path.as_str(), file.clone()));
    let (library, mut report) = Library::new(base.chain(named));
    if let Err(wrong) = Composer::new(library).compose(&recipe(slots)) {
        report.extend(wrong);
    }
    report
}

#[test]
fn ten_thousand_modules_in_a_chain_a_circle_or_a_lattice() {
    let n = 10_000;
    let start = (
        "start".to_owned(),
        filling("return x;").replace("// provides: shift", "// provides: shift\n// needs: m0"),
    );
    let slots = [
        ("intersect", plain("geometry/plane")),
        ("shift", plain("start")),
    ];
    let module = |i: usize, needs: String| {
        (
            format!("m{i}"),
            format!("// M.\n//\n// needs: {needs}\n\nconst m{i} = 1.0;\n"),
        )
    };

    let mut chain: Vec<_> = (0..n - 1)
        .map(|i| module(i, format!("m{}", i + 1)))
        .collect();
    chain.push(module(n - 1, "geometry/ray".into()));
    chain.push(start.clone());
    assert!(report_of(&chain, &slots).to_string().contains("deep"));

    let mut circle: Vec<_> = (0..n)
        .map(|i| module(i, format!("m{}", (i + 1) % n)))
        .collect();
    circle.push(start.clone());
    assert!(!report_of(&circle, &slots).is_ok());
    let mut short: Vec<_> = (0..50)
        .map(|i| module(i, format!("m{}", (i + 1) % 50)))
        .collect();
    short.push(start.clone());
    assert!(
        report_of(&short, &slots)
            .to_string()
            .contains("modules need each other: m0 → m1 → ")
    );

    // Every layer needs both of the next: 2^80 ways, 160 modules.
    let mut lattice: Vec<_> = (0..160)
        .map(|i| {
            let next = (i / 2 + 1) * 2;
            module(
                i,
                if next < 160 {
                    format!("m{next}, m{}", next + 1)
                } else {
                    "geometry/ray".into()
                },
            )
        })
        .collect();
    lattice.push(start);
    assert!(report_of(&lattice, &slots).is_ok());
}

#[test]
fn slots_that_lead_to_slots_end() {
    let n = 10_000;
    let slot = |i: usize, calls: &str| {
        (
            format!("slots/s{i}"),
            format!(
                "// S.\n//\n// slots: {calls}\n\nfn s{i}(x: f32) -> f32 {{\n    return x;\n}}\n"
            ),
        )
    };
    let user = (
        "start".to_owned(),
        filling("return s0(x);").replace("// provides: shift", "// provides: shift\n// slots: s0"),
    );
    let slots = [
        ("intersect", plain("geometry/plane")),
        ("shift", plain("start")),
    ];
    for circle in [false, true] {
        let mut modules: Vec<_> = (0..n)
            .map(|i| {
                slot(
                    i,
                    &format!(
                        "s{}",
                        if circle {
                            (i + 1) % n
                        } else {
                            (i + 1).min(n - 1)
                        }
                    ),
                )
            })
            .collect();
        modules.push(user.clone());
        assert!(!report_of(&modules, &slots).is_ok());
    }
    let mut deep = plain("geometry/plane");
    // RON itself nests no deeper than 128.
    for _ in 0..300 {
        deep = Filling {
            slots: BTreeMap::from([("tap".to_owned(), deep)]),
            ..plain("geometry/taps")
        };
    }
    assert!(
        report_of(&[], &[("intersect", deep)])
            .to_string()
            .contains("deep")
    );
}

#[test]
fn windows_line_ends_change_nothing_but_themselves() {
    let unix: Vec<(&str, String)> = BASE
        .iter()
        .map(|(path, text)| (*path, (*text).to_owned()))
        .collect();
    let dos: Vec<(&str, String)> = BASE
        .iter()
        .map(|(path, text)| (*path, text.replace('\n', "\r\n")))
        .collect();
    let compose = |modules: &[(&str, String)]| {
        let modules: Vec<(&str, &str)> = modules
            .iter()
            .map(|(path, text)| (*path, text.as_str()))
            .collect();
        let slots = [
            ("deflect", plain("optics/bent")),
            ("intersect", plain("geometry/taps")),
        ];
        common::compose(&common::composer(&modules), &recipe(&slots))
            .text
            .clone()
    };
    assert_eq!(compose(&dos).replace("\r\n", "\n"), compose(&unix));
}
