//! Passes that cannot run.

use crate::common::{changed, composer, load, plan};
use crate::told;
use meniscus_pipeline::{Facts, Plan};

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
