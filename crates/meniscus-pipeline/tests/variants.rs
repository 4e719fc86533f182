//! Variants: what they add, remove and set, and how they differ in words.

mod common;

use common::{composer, pipelines};
use meniscus_pipeline::{Facts, Pipeline, Plan, diff};

fn variant(text: &str) -> (Pipeline, Pipeline) {
    let all = pipelines(&[("v", text)]);
    let load = |name: &str| all.load(name).unwrap_or_else(|report| panic!("{report}"));
    (load("base"), load("v"))
}

#[test]
fn a_variant_adds_removes_and_connects() {
    let (base, changed) = variant(
        r#"Variant(of: "base", about: "More.",
            textures: { "half": (format: Rgba16Float, size: Frame), "seen": (format: Rgba32Float, size: Guarded) },
            buffers: { "more": (bytes: 4) },
            insert_after: { "draw": [
                Screen(name: "between", skeleton: "passes/fetch", slots: { "fetch": "screen/texel" }, writes: { "colour": "half" }),
            ] },
            set: {
                "draw.shade.gain": 3,
                "fetch.reads.seen": "half",
                "between.writes.colour": "half",
            },
        )"#,
    );
    let plan = Plan::new(&changed, &composer(&[]), &Facts::default(), false)
        .unwrap_or_else(|report| panic!("{report}"));
    let names: Vec<_> = plan.passes.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["draw", "between", "fetch"]);
    assert_eq!(plan.passes[2].shader.bindings[0].resource, "half");
    assert_eq!(
        diff(&base, &changed),
        [
            "in `draw`, `shade.gain` is 3, not 2",
            "the pass `between` is added behind `draw`, with `passes/fetch`",
            "in `fetch`, what is read as `seen` is `half`, and was not there",
            "the texture `half` is Rgba16Float, as large as the frame, and was not there",
            "the texture `seen` is Rgba32Float, with a guard band, not Rgba16Float, with a guard band",
            "the buffer `more` is 4 bytes, and was not there",
        ]
    );
    assert!(diff(&base, &base).is_empty());
}

#[test]
fn a_removed_pass_is_gone_and_told() {
    let (base, changed) =
        variant(r#"Variant(of: "base", about: "", remove: ["fetch"], output: (colour: "seen"))"#);
    assert_eq!(changed.passes.len(), 1);
    assert_eq!(
        diff(&base, &changed),
        [
            "the pass `fetch` is left out",
            "`seen` comes out, not `frame`"
        ]
    );
    Plan::new(&changed, &composer(&[]), &Facts::default(), false)
        .unwrap_or_else(|report| panic!("{report}"));
}

#[test]
fn passes_that_are_not_there_are_told() {
    for text in [
        r#"Variant(of: "base", about: "", remove: ["fetsh"])"#,
        r#"Variant(of: "base", about: "", insert_after: { "fetsh": [] })"#,
    ] {
        let report = pipelines(&[("v", text)]).load("v").unwrap_err().to_string();
        assert!(
            report.contains("v.ron:1:") && report.contains("did you mean `fetch`?"),
            "{report}"
        );
    }
    let twice = r#"Variant(of: "base", about: "", insert_after: { "draw": [Screen(name: "fetch", skeleton: "passes/fetch", writes: {})] })"#;
    let report = pipelines(&[("v", twice)])
        .load("v")
        .unwrap_err()
        .to_string();
    assert!(report.contains("two passes are called `fetch`"), "{report}");
}

#[test]
fn a_graph_has_every_pass_and_what_lies_between() {
    let odd = common::PIPELINE.replace("\"draw\"", "\"dr\\\"aw <&\"");
    let plan = common::plan(&odd).unwrap_or_else(|report| panic!("{report}"));
    let all = pipelines(&[("odd", &odd)]);
    let pipeline = all.load("odd").unwrap_or_else(|report| panic!("{report}"));
    insta::assert_snapshot!("graph", plan.dot(&pipeline));
    let picture = plan.svg(&pipeline);
    assert!(picture.contains("dr&quot;aw &lt;&amp;"), "{picture}");
    for name in plan.textures.keys() {
        assert!(picture.contains(&format!(">{name}<")), "{picture}");
    }
    // A dot for each target, and for what the second pass reads.
    let written = picture.matches("is written").count();
    let targets = plan
        .passes
        .iter()
        .flat_map(|p| p.targets.iter().chain(&p.depth));
    assert_eq!(written, targets.count());
    assert!(picture.contains("seen is read"), "{picture}");
}
