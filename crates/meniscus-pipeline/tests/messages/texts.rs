//! Texts that are no pipelines, and names in them that are not there.

use crate::common::changed;
use crate::told;

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
