//! Variants and settings.

use crate::common::{composer, load, pipelines};
use meniscus_pipeline::{Facts, Plan};

#[test]
fn variants_that_lead_nowhere() {
    let report = |text: &str| {
        pipelines(&[("p", text)])
            .load("p")
            .map(|_| ())
            .unwrap_err()
            .to_string()
    };
    for (name, text, place, words, hint) in [
        (
            "variant_of_nothing",
            "Variant(of: \"bas\", about: \"\", set: {})",
            "p.ron:1:13",
            "there is no pipeline `bas`",
            "did you mean `base`?",
        ),
        (
            "variant_of_itself",
            "Variant(of: \"p\", about: \"\", set: {})",
            "p.ron:1:13",
            "variants of each other",
            "",
        ),
        (
            "set_no_pass",
            "Variant(of: \"base\", about: \"\", set: {\"drew.shade\": \"shading/bright\"})",
            "p.ron:1:38",
            "has no pass `drew`",
            "did you mean `draw`?",
        ),
        (
            "set_no_slot",
            "Variant(of: \"base\", about: \"\", set: {\"draw.shad.gain\": 1})",
            "p.ron:1:38",
            "nothing fills `shad`",
            "did you mean `shade`?",
        ),
        (
            "set_pass",
            "Variant(of: \"base\", about: \"\", set: {\"draw\": 1})",
            "p.ron:1:38",
            "names a pass",
            "PASS.SLOT",
        ),
        (
            "set_nan",
            "Variant(of: \"base\", about: \"\", set: {\"draw.shade.gain\": NaN})",
            "p.ron:1:38",
            "finite number",
            "",
        ),
    ] {
        let text = report(text);
        for wanted in [place, words, hint] {
            assert!(text.contains(wanted), "{name}: no `{wanted}` in\n{text}");
        }
        crate::keep(name, &text);
    }
    let chain: Vec<(String, String)> = (0..40)
        .map(|i| {
            (
                format!("v{i}"),
                format!("Variant(of: \"v{}\", about: \"\", set: {{}})", i + 1),
            )
        })
        .collect();
    let chain: Vec<(&str, &str)> = chain
        .iter()
        .map(|(a, b)| (a.as_str(), b.as_str()))
        .collect();
    let report = pipelines(&chain).load("v0").unwrap_err().to_string();
    assert!(report.contains("more than 16 in a chain"), "{report}");
}

#[test]
fn settings_from_the_command_line_are_checked_alike() {
    let mut pipeline = load(crate::common::PIPELINE).unwrap();
    for (key, value, words) in [
        ("draw.shade.gain", "NaN", "finite"),
        ("draw.shade.gain", "1e999", "finite"),
        ("draw.shade.gain", "inf", "finite"),
        ("draw.shade.gain.x", "1", "nothing fills `gain`"),
        ("", "1", "has no pass ``"),
        ("draw", "x", "names a pass"),
        ("draw.shade", "\"unclosed", ""),
        ("draw.shade", "(((", ""),
    ] {
        let report = pipeline.set(key, value).unwrap_err().to_string();
        assert!(report.contains(words), "{key}={value}: {report}");
    }
    pipeline.set("draw.shade.gain", "99").unwrap();
    let report = Plan::new(&pipeline, &composer(&[]), &Facts::default(), false)
        .unwrap_err()
        .to_string();
    assert!(
        report.contains("`gain` of `shading/bright` goes from 0 to 4"),
        "{report}"
    );
}
