//! Mistakes in pipeline files: the place, the words and the way to mend each.

mod common;

use common::{changed, composer, load, pipelines, plan};
use meniscus_pipeline::{Facts, Plan};

fn told(name: &str, text: &str, place: &str, words: &str, hint: &str) {
    let report = plan(text).map(|_| ()).unwrap_err().to_string();
    for wanted in [place, words, hint] {
        assert!(
            report.contains(wanted),
            "{name}: no `{wanted}` in\n{report}"
        );
    }
    assert!(
        !report.contains("File`"),
        "{name}: a name of the program's own in\n{report}"
    );
    insta::assert_snapshot!(name, report);
}

#[test]
fn texts_that_are_no_pipelines() {
    told(
        "ron_syntax",
        &changed("size: Frame),\n    },", "size: Frame,\n    },"),
        "p.ron:7:5",
        "",
        "",
    );
    told(
        "unknown_field",
        &changed("about:", "abot:"),
        "p.ron:2:5",
        "`Pipeline` has no field `abot`",
        "did you mean `about`?",
    );
    told(
        "unknown_inner_field",
        &changed("geometry: All", "geometri: All"),
        "p.ron:13:",
        "`Draw` has no field `geometri`",
        "did you mean `geometry`?",
    );
    told(
        "unknown_step",
        &changed("Screen(name", "Screan(name"),
        "p.ron:16:",
        "`Screan`",
        "did you mean `Screen`?",
    );
    told(
        "unknown_format",
        &changed("Rgba16Float", "Rgba16Flot"),
        "p.ron:4:",
        "`Rgba16Flot` is no Format",
        "did you mean `Rgba16Float`?",
    );
    told(
        "missing_field",
        &changed("    about: \"Draws, then fetches.\",\n", ""),
        "p.ron:",
        "`Pipeline` lacks the field `about`",
        "",
    );
    told(
        "twice",
        &changed("\"depth\": (format", "\"seen\": (format"),
        "p.ron:5:9",
        "`seen` stands here twice",
        "",
    );
    told(
        "number_for_module",
        &changed("\"fetch\": \"screen/texel\"", "\"fetch\": 3"),
        "p.ron:17:31",
        "the slot `fetch` wants a module",
        "",
    );
    told("nothing", "", "p.ron:1:1", "", "");
    told(
        "nan",
        &changed("2.0", "NaN"),
        "p.ron:14:60",
        "`gain` is no finite number",
        "",
    );
    told(
        "too_large",
        &changed("2.0", "1e999"),
        "p.ron:14:60",
        "`gain` is no finite number",
        "",
    );
}

#[test]
fn names_and_numbers_that_are_not_there() {
    told(
        "unknown_module",
        &changed("screen/texel", "screen/texl"),
        "p.ron:17:31",
        "no module `screen/texl`",
        "did you mean `screen/texel`?",
    );
    told(
        "unknown_slot",
        &changed("\"shade\":", "\"shad\":"),
        "p.ron:14:22",
        "no slot `shad`",
        "did you mean `shade`?",
    );
    told(
        "unknown_number",
        &changed("\"gain\"", "\"gian\""),
        "p.ron:14:60",
        "no number `gian`",
        "did you mean `gain`?",
    );
    told(
        "out_of_range",
        &changed("2.0", "5"),
        "p.ron:14:60",
        "`gain` of `shading/bright` goes from 0 to 4",
        "5 is outside",
    );
    told(
        "not_whole",
        &changed("\"gain\": 2.0", "\"taps\": 2.5"),
        "p.ron:14:60",
        "is a whole number",
        "2.5 is none",
    );
    told(
        "unknown_output",
        &changed("\"colour\": \"frame\"", "\"color\": \"frame\""),
        "p.ron:18:23",
        "has no output `color`",
        "did you mean `colour`?",
    );
    told(
        "unknown_texture",
        &changed("\"colour\": \"frame\"", "\"colour\": \"fram\""),
        "p.ron:18:33",
        "there is no texture `fram`",
        "did you mean `frame`?",
    );
    told(
        "unknown_final_output",
        &changed("output: (colour: \"frame\")", "output: (colour: \"fram\")"),
        "p.ron:20:22",
        "there is no texture `fram`",
        "did you mean `frame`?",
    );
    told(
        "unknown_fact",
        &changed("slots: { \"fetch\"", "when: \"wave\", slots: { \"fetch\""),
        "p.ron:17:19",
        "there is no fact `wave`",
        "did you mean `waves`?",
    );
    told(
        "unknown_read",
        &changed(
            "slots: { \"fetch\"",
            "reads: { \"sen\": \"seen\" }, slots: { \"fetch\"",
        ),
        "p.ron:17:29",
        "`fetch` reads no `sen`",
        "did you mean `seen`?",
    );
    told(
        "read_of_nothing",
        &changed(
            "slots: { \"fetch\"",
            "reads: { \"seen\": \"sene\" }, slots: { \"fetch\"",
        ),
        "p.ron:16:22",
        "there is no such texture",
        "did you mean `seen`?",
    );
}

#[test]
fn passes_that_cannot_run() {
    let seen = |format: &str| {
        changed(
            "(format: Rgba16Float, size: Guarded)",
            &format!("(format: {format}, size: Guarded)"),
        )
    };
    let order = changed(
        "Draw(name: \"draw\"",
        "Screen(name: \"early\", skeleton: \"passes/fetch\", slots: { \"fetch\": \"screen/texel\" }, writes: { \"colour\": \"frame\" }),\n        Draw(name: \"draw\"",
    );
    told(
        "read_before_written",
        &order,
        "p.ron:13:22",
        "`early` reads `seen` before any pass has written it",
        "put the pass that writes it before this one",
    );
    told(
        "read_and_written",
        &changed("\"colour\": \"frame\"", "\"colour\": \"seen\""),
        "p.ron:16:22",
        "reads and writes `seen` at once",
        "write another texture",
    );
    told(
        "wrong_format",
        &seen("R32Uint"),
        "p.ron:13:20",
        "does not fit the format R32Uint",
        "",
    );
    told(
        "integers_as_colour",
        &changed("\"colour\": \"seen\"", "\"count\": \"seen\""),
        "p.ron:13:20",
        "does not fit the format Rgba16Float",
        "",
    );
    let depth = changed(
        "slots: { \"fetch\": \"screen/texel\" }",
        "slots: { \"fetch\": (\"screen/texel\", { \"reads\": { \"seen\": \"depth\" } }) }",
    );
    told(
        "depth_as_colour",
        &depth,
        "p.ron:16:22",
        "has the format Depth32Float, which",
        "declare it as `texture_depth_2d`",
    );
    let filtered = seen("Rgba32Float").replace("screen/texel", "screen/smooth");
    told(
        "unfilterable",
        &filtered,
        "p.ron:16:22",
        "which no sampler can filter",
        "use textureLoad",
    );
    told(
        "sizes",
        &changed("Depth32Float, size: Guarded", "Depth32Float, size: Frame"),
        "p.ron:13:20",
        "textures of different sizes",
        "",
    );
    told(
        "no_depth_texture",
        &changed("Depth32Float", "R32Float"),
        "p.ron:13:20",
        "`depth` is no depth texture",
        "Depth32Float",
    );
    told(
        "colour_into_depth",
        &changed(
            "\"colour\": \"seen\", \"depth\": \"depth\"",
            "\"colour\": \"depth\"",
        ),
        "p.ron:15:33",
        "cannot be written to the depth texture",
        "write `depth` to it",
    );
    told(
        "twice_written",
        &changed(
            "\"colour\": \"seen\", \"depth\": \"depth\"",
            "\"colour\": \"seen\", \"shown\": \"seen\"",
        ),
        "p.ron:15:50",
        "writes `seen` twice",
        "again here",
    );
    told(
        "never_written",
        &changed(
            "Screen(name: \"fetch\"",
            "Screen(when: \"waves\", name: \"fetch\"",
        ),
        "p.ron:20:22",
        "no pass writes the output `frame`",
        "",
    );
    told(
        "same_name",
        &changed("Screen(name: \"fetch\"", "Screen(name: \"draw\""),
        "the second",
        "two passes are called `draw`",
        "another name",
    );
    let many = changed(
        "Screen(name: \"fetch\"",
        "Repeat(times: 9, sequence: [Repeat(times: 999, sequence: [])]), Screen(name: \"fetch\"",
    );
    told(
        "too_many_passes",
        &many,
        "p.ron:16:23",
        "1 to 1024 passes",
        "",
    );
    let list = |arguments: &str| {
        changed(
            "skeleton: \"passes/fetch\",",
            &format!(
                "skeleton: \"passes/fetch\", over: List(pixels: \"list\", arguments: \"{arguments}\"),"
            ),
        )
    };
    told(
        "no_arguments",
        &list("list"),
        "p.ron:16:95",
        "holds no arguments of a dispatch",
        "declare it with `indirect: true`",
    );
    told(
        "unknown_buffer",
        &list("argument"),
        "p.ron:16:95",
        "there is no buffer `argument`",
        "did you mean `arguments`?",
    );
    let store = |extra: &str| {
        changed(
            "Screen(name: \"fetch\"",
            &format!(
                "Compute(name: \"store\", skeleton: \"passes/store\", {extra}), Screen(name: \"fetch\""
            ),
        )
    };
    told(
        "storage_format",
        &store("dispatch: Pixels(Frame), reads: {\"stored\": \"depth\"}"),
        "p.ron:16:23",
        "has the format Depth32Float, and Rgba16Float is written to it",
        "give the texture another format",
    );
    told(
        "no_groups",
        &store("dispatch: Fixed(0, 1, 1), reads: {\"stored\": \"frame\"}"),
        "p.ron:16:23",
        "1 to 65535 workgroups",
        "",
    );
    plan(&store(
        "dispatch: Pixels(Frame), reads: {\"stored\": \"frame\"}",
    ))
    .unwrap();
}

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
        insta::assert_snapshot!(name, text);
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
    let mut pipeline = load(common::PIPELINE).unwrap();
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

#[test]
fn what_is_shown_follows_a_fillings_own_connections() {
    let text = changed("\"fetch\": \"screen/texel\"", "\"fetch\": (\"screen/sum\", { \"first\": (\"screen/texel\", { \"reads\": { \"seen\": \"other\" } }), \"then\": \"screen/texel\" })")
        .replace("\"seen\":  (format", "\"other\": (format: Rgba16Float, size: Guarded), \"seen\": (format")
        .replace("Screen(name", "Draw(name: \"second\", skeleton: \"passes/draw\", geometry: All, writes: { \"colour\": \"other\" }), Screen(name");
    let pipeline = load(&text).unwrap();
    let plan = Plan::new(&pipeline, &composer(&[]), &Facts::default(), true)
        .unwrap_or_else(|report| panic!("{report}"));
    let last = plan.passes.last().unwrap();
    let mut read: Vec<_> = last
        .shader
        .bindings
        .iter()
        .map(|b| b.resource.as_str())
        .collect();
    read.sort_unstable();
    assert_eq!(read, ["other (shown)", "seen (shown)"]);
}
