//! Whatever a pipeline file holds, reading and planning it ends, with a plan or with messages.

mod common;

use common::{PIPELINE, composer, load, pipelines};
use meniscus_pipeline::{Facts, Plan};
use meniscus_shader::Composer;
use proptest::prelude::*;

/// Reads a text and plans it; a second one is its variant.
fn survive(composer: &Composer, text: &str) {
    for (name, text) in [
        ("p", text.to_owned()),
        (
            "v",
            format!("Variant(of: \"p\", about: \"\", set: {{ {text} }})"),
        ),
    ] {
        match pipelines(&[("p", text.as_str()), (name, text.as_str())]).load(name) {
            Ok(pipeline) => {
                for shown in [false, true] {
                    let _ = Plan::new(&pipeline, composer, &Facts::default(), shown)
                        .map_err(|report| report.to_string());
                }
                let _ = pipeline.warnings(composer, &Facts::default()).to_string();
            }
            Err(report) => {
                assert!(!report.to_string().is_empty());
            }
        }
    }
}

fn pieces() -> impl Strategy<Value = String> {
    const WORDS: &[&str] = &[
        "Pipeline(",
        "Variant(",
        "Draw(",
        "Screen(",
        "Compute(",
        "Repeat(",
        "times: ",
        "sequence: [",
        "slots: {",
        "reads: {",
        "writes: {",
        "name: \"",
        "of: \"",
        "set: {",
        "\"draw.shade\"",
        "\"draw.shade.gain\"",
        "\"fetch\"",
        "(",
        ")",
        "[",
        "]",
        "{",
        "}",
        ",",
        ":",
        "\"",
        "NaN",
        "inf",
        "1e999",
        "-1",
        "99999999999999999999999999999999999999999999",
        "0x7f",
        "1_000",
        "true",
        "'a'",
        "Some(",
        "None",
        "r#\"",
        "/*",
        "*/",
        "//",
        "\n",
        "\r\n",
        "#![enable(implicit_some)]",
        "#![enable(",
        "é",
        "\u{202e}",
        "\u{feff}",
        "\0",
        "\\u{1F600}",
        "\\",
        "over: List(pixels: \"list\", arguments: \"arguments\")",
        "runs: Compute",
        "dispatch: Fixed(1, 1, 1)",
        "when: \"not waves\"",
        "format: R32Uint",
        "size: Frame",
        "\"depth\"",
        "\"seen\"",
        "\"frame\"",
        "\"../../x\"",
        "passes/store",
    ];
    prop_oneof![5 => prop::sample::select(WORDS).prop_map(str::to_owned), 1 => any::<char>().prop_map(String::from)]
}

fn config() -> ProptestConfig {
    let mut config = ProptestConfig::default();
    if std::env::var_os("PROPTEST_CASES").is_none() {
        config.cases = 400;
    }
    config.failure_persistence = None;
    config
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn any_text_may_be_a_pipeline(text in prop::collection::vec(pieces(), 0..50).prop_map(|p| p.concat())) {
        survive(&composer(&[]), &text);
    }

    #[test]
    fn a_pipeline_may_be_spoilt_anywhere(edits in prop::collection::vec((0.0..1.0, 0usize..15, pieces()), 1..5)) {
        let mut letters: Vec<char> = PIPELINE.chars().collect();
        for (at, cut, piece) in edits {
            let start = (at * letters.len() as f64) as usize;
            let end = (start + cut).min(letters.len());
            letters.splice(start..end, piece.chars());
        }
        survive(&composer(&[]), &letters.into_iter().collect::<String>());
    }

    #[test]
    fn a_setting_may_be_anything(key in prop::collection::vec(pieces(), 0..5).prop_map(|p| p.concat()), value in prop::collection::vec(pieces(), 0..8).prop_map(|p| p.concat())) {
        let mut pipeline = load(PIPELINE).unwrap();
        for key in [key.as_str(), "draw.shade", "draw.shade.gain", "fetch.fetch.inner.x"] {
            let _ = pipeline.set(key, &value).map_err(|report| report.to_string());
        }
        let _ = Plan::new(&pipeline, &composer(&[]), &Facts::default(), false).map_err(|report| report.to_string());
    }
}

#[test]
fn deep_and_long_files_end() {
    let n = 5_000;
    let composer = composer(&[]);
    for text in [
        "(".repeat(n),
        "[".repeat(n),
        "{\"a\":".repeat(n),
        "Some(".repeat(n),
        "/*".repeat(n),
        "Repeat(times: 9, sequence: [".repeat(n),
        format!(
            "\"draw.shade\": {}\"x\"",
            "(\"screen/sum\", { \"first\": ".repeat(n)
        ),
        common::changed(
            "{ \"gain\": 2.0 }",
            &format!(
                "{{ {} }}",
                (0..n).map(|i| format!("\"g{i}\": 1,")).collect::<String>()
            ),
        ),
        common::changed(
            "\"screen/texel\"",
            &format!(
                "{}\"screen/texel\"{}",
                "(\"screen/sum\", { \"first\": ".repeat(30),
                " })".repeat(30)
            ),
        ),
        common::changed("\"screen/texel\"", &format!("\"{}\"", "x".repeat(500_000))),
        format!("Pipeline(about: \"{}\"", "\\u{41}".repeat(n)),
    ] {
        survive(&composer, &text);
    }
    let steps = "Repeat(times: 1000, sequence: [".repeat(20) + &"])".repeat(20);
    assert!(
        load(&common::changed(
            "Draw(name",
            &format!("{steps}, Draw(name")
        ))
        .unwrap_err()
        .to_string()
        .contains("1024 passes")
    );
}
