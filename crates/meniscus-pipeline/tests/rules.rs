//! Each rule by itself: when it leaves something out, when it does not, and what else goes with it.

mod common;

use common::{composer, load};
use meniscus_pipeline::{Explanation, Facts, Outlook, Plan, Pruning, Rule, SceneBounds};
use meniscus_source::Report;

/// Modules that list pixels and count them, and that change nothing under some fact.
const MORE: &[(&str, &str)] = &[
    (
        "passes/listing",
        "// Lists.\n//\n// skeleton: screen\n// outputs: colour, shown\n\nstruct List {\n    count: atomic<u32>,\n    pixels: array<u32>,\n}\n\nvar<storage, read_write> listed: List;\n\nfn screen(pixel: vec2f) -> vec2f {\n    return pixel;\n}\n\nfn also(at: vec2f) {\n    atomicAdd(&listed.count, 1u);\n}\n\nfn write_colour(at: vec2f) -> vec4f {\n    return vec4f(at, 0.0, 1.0);\n}\n\nfn write_shown(at: vec2f) -> vec4f {\n    return vec4f(0.0);\n}\n",
    ),
    (
        "passes/count",
        "// Counts.\n//\n// skeleton: compute\n// workgroup: 1\n\nvar<storage, read> counted: array<u32>;\nvar<storage, read_write> counts: array<u32, 3>;\n\nfn compute(thread: vec3u) {\n    counts[0] = counted[0];\n    counts[1] = 1u;\n    counts[2] = 1u;\n}\n",
    ),
    (
        "screen/same",
        "// The nearest texel.\n//\n// provides: fetch\n// identity when not waves: within 0.25 px\n\nvar seen: texture_2d<f32>;\nvar shown_of_seen: texture_2d<f32>;\n\nfn fetch(at: vec2f) -> vec4f {\n    return textureLoad(seen, vec2i(at), 0);\n}\n\nfn fetched(at: vec2f) -> vec4f {\n    return textureLoad(shown_of_seen, vec2i(at), 0);\n}\n",
    ),
    (
        "screen/exact",
        "// The nearest texel.\n//\n// provides: fetch\n// identity when not waves or camera_submerged: exactly\n\nvar seen: texture_2d<f32>;\nvar shown_of_seen: texture_2d<f32>;\n\nfn fetch(at: vec2f) -> vec4f {\n    return textureLoad(seen, vec2i(at), 0);\n}\n\nfn fetched(at: vec2f) -> vec4f {\n    return textureLoad(shown_of_seen, vec2i(at), 0);\n}\n",
    ),
    (
        "screen/first",
        "// The first of two.\n//\n// provides: fetch\n// slots: first: fetch, then: fetch\n// identity when not waves: within 0.1 px\n\nfn fetch(at: vec2f) -> vec4f {\n    return first(at);\n}\n\nfn fetched(at: vec2f) -> vec4f {\n    return first_fetched(at);\n}\n",
    ),
];

/// Textures and buffers that tests connect, and the steps between them.
fn text(steps: &str) -> String {
    format!(
        r#"Pipeline(
    about: "A test's.",
    textures: {{
        "seen":  (format: Rgba16Float, size: Frame),
        "other": (format: Rgba16Float, size: Frame),
        "depth": (format: Depth32Float, size: Frame),
        "frame": (format: Rgba16Float, size: Frame),
    }},
    buffers: {{
        "list": (bytes: 4, bytes_per_pixel: 4, zeroed: true),
        "arguments": (bytes: 12, indirect: true),
    }},
    sequence: [{steps}],
    output: (colour: "frame"),
)"#
    )
}

const NEAR: &str = r#"Draw(name: "near", skeleton: "passes/draw", geometry: NearSide,
    writes: { "colour": "frame", "depth": "depth" }),"#;
const FAR: &str = r#"Draw(name: "far", skeleton: "passes/draw", geometry: FarSide,
    writes: { "colour": "seen" }),"#;
const FETCH: &str = r#"Screen(name: "fetch", skeleton: "passes/fetch", over: Water,
    slots: { "fetch": "screen/texel" }, writes: { "colour": "frame" }),"#;
const SHORT: &str = r#"Shortcut(name: "short", instead_of: ["far", "fetch"], identity: ["fetch.fetch"],
    sequence: [Draw(name: "straight", like: ["far"], writes: { "colour": "frame", "depth": "depth" })]),"#;

fn plan(steps: &str, facts: &[&str], pruning: Pruning) -> Result<Plan, Report> {
    let facts = Facts::new(facts.iter().copied());
    Plan::pruned(
        &load(&text(steps))?,
        &composer(MORE),
        &facts,
        pruning,
        false,
    )
}

/// The names of the passes that are left.
#[track_caller]
fn left(steps: &str, facts: &[&str], pruning: Pruning) -> Vec<String> {
    let plan = plan(steps, facts, pruning).unwrap_or_else(|report| panic!("{report}"));
    plan.passes.into_iter().map(|pass| pass.name).collect()
}

/// What an explanation says of passes that are left out: name, rule, promise.
fn dropped(steps: &str, facts: &[&str]) -> Vec<(String, &'static str, &'static str)> {
    let pipeline = load(&text(steps)).unwrap_or_else(|report| panic!("{report}"));
    let outlook = outlook(facts);
    let said = Explanation::new(&pipeline, &composer(MORE), &outlook, Pruning::Approximate);
    let said = said.unwrap_or_else(|report| panic!("{report}"));
    let passes = said.passes.into_iter();
    passes
        .filter_map(|pass| Some((pass.name, pass.dropped?)))
        .map(|(name, dropped)| (name, dropped.rule, dropped.promise))
        .collect()
}

fn outlook(facts: &[&str]) -> Outlook {
    let scene = common::scene();
    let size = glam::UVec2::new(64, 36);
    Outlook {
        facts: Facts::new(facts.iter().copied()),
        ..Outlook::new(&scene, &SceneBounds::new(&scene), size)
    }
}

fn name(rule: Rule) -> &'static str {
    rule.name()
}

#[test]
fn a_pass_runs_where_its_own_rule_holds_whatever_is_pruned() {
    let steps = FETCH.replace("over: Water", r#"when: "waves or camera_submerged""#);
    let steps = format!("{NEAR}{FAR}{steps}");
    for pruning in [Pruning::Exact, Pruning::Approximate] {
        assert_eq!(
            left(&steps, &[], pruning),
            ["near"],
            "nobody reads the far side"
        );
        assert_eq!(left(&steps, &["waves"], pruning), ["near", "far", "fetch"]);
        assert_eq!(left(&steps, &["camera_submerged"], pruning).len(), 3);
    }
    // Whether there are waves is not known to a plan that leaves nothing out.
    assert_eq!(left(&steps, &[], Pruning::None).len(), 3);
    let steps = steps.replace("waves or camera_submerged", "camera_submerged");
    assert_eq!(left(&steps, &[], Pruning::None), ["near", "far"]);
    assert_eq!(
        dropped(&steps, &[])[1],
        ("fetch".into(), name(Rule::When), "choice")
    );
}

#[test]
fn a_side_that_is_not_seen_is_not_drawn_and_reads_as_empty() {
    let steps = format!("{NEAR}{FAR}{FETCH}");
    let exact = |facts: &[&str]| left(&steps, facts, Pruning::Exact);
    assert_eq!(exact(&["waves"]), ["near", "far", "fetch"]);
    assert_eq!(exact(&["waves", "not near_visible"]), ["far", "fetch"]);
    assert_eq!(exact(&["waves", "not far_visible"]), ["near", "fetch"]);
    let hidden = ["waves", "not far_visible", "not near_visible"];
    assert_eq!(exact(&hidden), ["fetch"]);
    assert_eq!(
        left(&steps, &hidden, Pruning::None),
        ["near", "far", "fetch"]
    );
    // What is read stays, and holds what it is cleared to; a depth that nobody reads does not.
    let empty = plan(&steps, &hidden, Pruning::Exact).unwrap();
    let textures: Vec<_> = empty.textures.keys().map(String::as_str).collect();
    assert_eq!(textures, ["frame", "seen"]);
    let all = steps.replace("NearSide", "All");
    assert_eq!(left(&all, &["not near_visible"], Pruning::Exact)[0], "near");
    assert_eq!(left(&all, &hidden, Pruning::Exact), ["fetch"]);
    assert_eq!(
        dropped(&steps, &hidden)[0],
        ("near".into(), name(Rule::UnseenSide), "exact")
    );
}

#[test]
fn passes_over_water_and_over_the_rest_run_where_there_is_any() {
    let dry = FETCH
        .replace("Water", "Dry")
        .replace("\"fetch\", sk", "\"sky\", sk");
    let steps = format!("{NEAR}{FAR}{dry}{FETCH}");
    let exact = |facts: &[&str]| left(&steps, facts, Pruning::Exact);
    assert_eq!(exact(&[]), ["near", "far", "sky", "fetch"]);
    assert_eq!(exact(&["not dry_visible"]), ["near", "far", "fetch"]);
    assert_eq!(exact(&["not water_visible"]), ["near", "far", "sky"]);
    let neither = ["not water_visible", "not dry_visible"];
    assert_eq!(exact(&neither), ["near"], "nobody reads the far side");
    assert_eq!(left(&steps, &neither, Pruning::None).len(), 4);
    let rules: Vec<_> = dropped(&steps, &neither).into_iter().map(|d| d.1).collect();
    let expected = [Rule::Unread, Rule::AllWater, Rule::NoWater].map(name);
    assert_eq!(rules, expected);
}

#[test]
fn what_nobody_reads_is_not_made_nor_what_it_is_made_of() {
    let chain = FETCH
        .replace("Water", "All")
        .replace("\"colour\": \"frame\"", "\"colour\": \"other\"");
    let steps = format!("{NEAR}{FAR}{chain}");
    assert_eq!(left(&steps, &[], Pruning::Exact), ["near"]);
    assert_eq!(left(&steps, &[], Pruning::None), ["near", "far", "fetch"]);
    let made = plan(&steps, &[], Pruning::Exact).unwrap();
    let textures: Vec<_> = made.textures.keys().map(String::as_str).collect();
    // The depth is tested against.
    assert_eq!(textures, ["depth", "frame"]);
    assert!(made.buffers.is_empty());
}

const LISTING: &str = r#"Screen(name: "listing", skeleton: "passes/listing", over: Water,
    reads: { "listed": "list" }, writes: { "colour": "other" }),"#;
const COUNT: &str = r#"Compute(name: "count", skeleton: "passes/count", dispatch: Fixed(1, 1, 1),
    reads: { "counted": "list", "counts": "arguments" }),"#;
const TRACE: &str = r#"Screen(name: "trace", skeleton: "passes/fetch",
    over: List(pixels: "list", arguments: "arguments"), writes: { "colour": "frame" }),"#;

#[test]
fn a_pass_that_fills_a_buffer_stays_as_long_as_anybody_reads_it() {
    let steps = format!("{NEAR}{LISTING}{COUNT}{TRACE}");
    let all = ["near", "listing", "count", "trace"];
    assert_eq!(left(&steps, &[], Pruning::Exact), all);
    // Also before it in the frame: that is what the last frame left.
    let steps = format!("{NEAR}{COUNT}{TRACE}{LISTING}");
    assert_eq!(left(&steps, &[], Pruning::Exact).len(), 4);
    // And results that count a list.
    let counted = text(&format!("{NEAR}{LISTING}"))
        .replace("sequence", "lists: { \"n\": \"list\" }, sequence");
    let plan = Plan::new(
        &load(&counted).unwrap(),
        &composer(MORE),
        &Facts::default(),
        false,
    );
    assert_eq!(plan.unwrap().passes.len(), 2);
    assert_eq!(
        left(&format!("{NEAR}{LISTING}"), &[], Pruning::Exact),
        ["near"]
    );
}

#[test]
fn nothing_runs_over_a_list_to_which_nothing_is_added() {
    let steps = format!("{NEAR}{LISTING}{COUNT}{TRACE}");
    let dry = ["not water_visible"];
    assert_eq!(left(&steps, &dry, Pruning::Exact), ["near"]);
    let plan = plan(&steps, &dry, Pruning::Exact).unwrap();
    assert!(plan.buffers.is_empty());
    let rules: Vec<_> = dropped(&steps, &dry).into_iter().map(|d| d.1).collect();
    let expected = [Rule::NoWater, Rule::Unread, Rule::EmptyList].map(name);
    assert_eq!(rules, expected);
}

#[test]
fn a_shortcut_is_taken_where_all_fillings_are_the_identity() {
    let with =
        |filling: &str| format!("{NEAR}{FAR}{FETCH}{SHORT}").replace("\"screen/texel\"", filling);
    let whole = ["near", "far", "fetch"];
    let short = ["near", "straight"];
    let same = with("\"screen/same\"");
    for (facts, pruning, expected) in [
        (&[][..], Pruning::Approximate, &short[..]),
        (&[], Pruning::Exact, &whole),
        (&[], Pruning::None, &whole),
        (&["waves"], Pruning::Approximate, &whole),
    ] {
        assert_eq!(
            left(&same, facts, pruning),
            expected,
            "{facts:?} {pruning:?}"
        );
    }
    let exact = with("\"screen/exact\"");
    assert_eq!(left(&exact, &[], Pruning::Exact), short);
    assert_eq!(left(&exact, &["waves"], Pruning::Exact), whole);
    assert_eq!(
        left(&exact, &["waves", "camera_submerged"], Pruning::Exact),
        short
    );
    let texel = with("\"screen/texel\"");
    assert_eq!(
        left(&texel, &[], Pruning::Approximate),
        whole,
        "says nothing"
    );
    let both = with(r#"("screen/first", { "first": "screen/same", "then": "screen/exact" })"#);
    assert_eq!(left(&both, &[], Pruning::Approximate), short);
    let one = with(r#"("screen/first", { "first": "screen/same", "then": "screen/texel" })"#);
    assert_eq!(left(&one, &[], Pruning::Approximate), whole);
    assert_eq!(
        dropped(&same, &[]),
        [
            ("far".into(), name(Rule::Shortcut), "within"),
            ("fetch".into(), name(Rule::Shortcut), "within")
        ]
    );
}

#[test]
fn a_shortcut_moves_as_much_as_its_slots_together_and_each_as_its_largest_module() {
    let second = FETCH
        .replace("\"fetch\", skel", "\"second\", skel")
        .replace(
            "\"screen/texel\"",
            r#"("screen/first", { "first": "screen/same", "then": "screen/exact" })"#,
        );
    let first = FETCH.replace("screen/texel", "screen/same");
    let short = SHORT
        .replace("\"fetch\"]", "\"fetch\", \"second\"]")
        .replace("[\"fetch.fetch\"]", "[\"fetch.fetch\", \"second.fetch\"]");
    let pipeline = load(&text(&format!("{NEAR}{FAR}{first}{second}{short}"))).unwrap();
    let said = Explanation::new(
        &pipeline,
        &composer(MORE),
        &outlook(&[]),
        Pruning::Approximate,
    );
    assert_eq!(said.unwrap().within_px, 0.5);
}

#[test]
fn what_several_shortcuts_move_adds_up() {
    let reads = "reads: { \"seen\": \"other\" }, slots: { \"fetch\": \"screen/same\" }";
    let fetch = FETCH.replace("screen/texel", "screen/same");
    let deep = FAR.replace("\"far\"", "\"deep\"");
    let deep = deep.replace("\"seen\"", "\"other\"");
    let other = FETCH.replace("\"fetch\", skel", "\"second\", skel");
    let other = other.replace("slots: { \"fetch\": \"screen/texel\" }", reads);
    let short = SHORT
        .replace("\"short\"", "\"shorter\"")
        .replace("\"straight\"", "\"straighter\"")
        .replace("\"far\"", "\"deep\"")
        .replace("\"fetch\"]", "\"second\"]")
        .replace("fetch.fetch", "second.fetch");
    let steps = format!("{NEAR}{FAR}{fetch}{deep}{other}{SHORT}{short}");
    let moves = |facts: &[&str], pruning| plan(&steps, facts, pruning).unwrap().within_px;
    assert_eq!(
        left(&steps, &[], Pruning::Approximate),
        ["near", "straight", "straighter"]
    );
    assert_eq!(moves(&[], Pruning::Approximate), 0.5);
    assert_eq!(moves(&[], Pruning::Exact), 0.0);
    assert_eq!(moves(&["waves"], Pruning::Approximate), 0.0);
}

#[test]
fn a_shortcut_wants_the_fillings_that_it_names() {
    let steps = format!("{NEAR}{FAR}{FETCH}{SHORT}").replace("screen/texel", "screen/same");
    let shade = "geometry: FarSide,\n    slots: { \"shade\": \"shading/bright\" },";
    let steps = steps.replace("geometry: FarSide,", shade).replace(
        "identity:",
        "filled: { \"far.shade\": \"shading/bright\" }, identity:",
    );
    assert_eq!(
        left(&steps, &[], Pruning::Approximate),
        ["near", "straight"]
    );
    let mut pipeline = load(&text(&steps)).unwrap();
    pipeline.set("far.shade", "slots/shade").unwrap();
    let plan = Plan::new(&pipeline, &composer(MORE), &Facts::default(), false).unwrap();
    assert_eq!(plan.passes.len(), 3);
}

#[test]
fn a_shortcut_s_pass_takes_over_what_the_other_is_filled_with_now() {
    let steps = format!("{NEAR}{FAR}{FETCH}{SHORT}").replace("screen/texel", "screen/same");
    let mut pipeline = load(&text(&steps)).unwrap();
    let gain = |pipeline: &meniscus_pipeline::Pipeline| {
        let plan = Plan::new(pipeline, &composer(MORE), &Facts::default(), false).unwrap();
        plan.passes[1].numbers.values().copied().collect::<Vec<_>>()
    };
    assert!(gain(&pipeline).is_empty());
    pipeline
        .set("far.shade", "(\"shading/bright\", { \"gain\": 3 })")
        .unwrap();
    assert_eq!(gain(&pipeline), [3.0]);
}

#[test]
fn a_shortcut_is_not_taken_where_another_pass_reads_what_it_does_not_make() {
    let late = FETCH
        .replace("\"fetch\", skel", "\"late\", skel")
        .replace("Water", "All");
    let first = FETCH.replace("screen/texel", "screen/same");
    let steps = format!("{NEAR}{FAR}{first}{SHORT}{late}");
    let names = left(&steps, &[], Pruning::Approximate);
    assert_eq!(names, ["near", "far", "fetch", "late"]);
}

#[test]
fn shortcuts_that_lead_nowhere_are_told_where() {
    for (from, to, words) in [
        (
            "\"far\", \"fetch\"]",
            "\"far\", \"fetsh\"]",
            &["no pass `fetsh`", "did you mean `fetch`?"][..],
        ),
        ("\"far\", \"fetch\"]", "]", &["`short` stands for no pass"]),
        (
            "\"fetch.fetch\"",
            "\"fetch.fetsh\"",
            &["nothing fills `fetsh` in `fetch`", "`fetch`?"],
        ),
        (
            "\"fetch.fetch\"",
            "\"fetch\"",
            &["names no slot", "PASS.SLOT"],
        ),
        (
            "\"fetch.fetch\"",
            "\"fitch.fetch\"",
            &["no pass `fitch`", "`fetch`?"],
        ),
        (
            "like: [\"far\"]",
            "like: [\"fur\"]",
            &["no pass `fur`", "`far`?"],
        ),
        ("like: [\"far\"], ", "", &["`straight` has no `skeleton`"]),
        (
            "like: [\"far\"]",
            "skeleton: \"passes/draw\"",
            &["`straight` has no `geometry`"],
        ),
    ] {
        let steps = format!("{NEAR}{FAR}{FETCH}{SHORT}");
        assert!(steps.contains(from), "{from}");
        let report = load(&text(&steps.replace(from, to)))
            .unwrap_err()
            .to_string();
        for word in words {
            assert!(report.contains(word), "`{word}` is missing in\n{report}");
        }
        assert!(report.contains("p.ron:"), "{report}");
    }
    let nested = SHORT.replace("sequence: [", &format!("sequence: [{SHORT}"));
    let report = load(&text(&format!("{NEAR}{FAR}{FETCH}{nested}"))).unwrap_err();
    assert!(
        report.to_string().contains("a shortcut holds no other"),
        "{report}"
    );
    let twice = SHORT.replace("straight", "again");
    let report = load(&text(&format!("{NEAR}{FAR}{FETCH}{SHORT}{twice}"))).unwrap_err();
    assert!(report.to_string().contains("two shortcuts"), "{report}");
}

#[test]
fn a_module_with_an_unknown_fact_is_told_where_it_is_needed() {
    let unknown = MORE[2].1.replace("not waves", "not wafes");
    let composer = composer(&[("screen/same", &unknown)]);
    let steps = format!("{NEAR}{FAR}{FETCH}{SHORT}").replace("screen/texel", "screen/same");
    let pipeline = load(&text(&steps)).unwrap();
    let report = Plan::new(&pipeline, &composer, &Facts::default(), false).unwrap_err();
    let said = report.to_string();
    assert!(
        said.contains("same.wgsl:4:") && said.contains("`waves`?"),
        "{said}"
    );
}

#[test]
fn a_variant_that_takes_away_a_pass_takes_away_its_shortcuts() {
    let steps = format!("{NEAR}{FAR}{FETCH}{SHORT}").replace("screen/texel", "screen/same");
    let base = text(&steps);
    let variant = r#"Variant(of: "p", about: "", remove: ["fetch"])"#;
    let pipelines = common::pipelines(&[("p", &base), ("v", variant)]);
    let changed = pipelines.load("v").unwrap();
    assert!(changed.shortcuts.is_empty());
    let names: Vec<_> = changed
        .passes
        .iter()
        .map(|p| p.name.value.as_str())
        .collect();
    assert_eq!(names, ["near", "far"]);
}

#[test]
fn every_rule_has_a_name_of_its_own_and_a_sentence() {
    let mut names: Vec<_> = Rule::ALL.iter().map(|rule| rule.name()).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), Rule::ALL.len());
    assert!(Rule::ALL.iter().all(|rule| rule.says().contains(' ')));
}

#[test]
fn shortcuts_that_differ_are_told_apart() {
    let steps = format!("{NEAR}{FAR}{FETCH}{SHORT}");
    let a = load(&text(&steps)).unwrap();
    let without = load(&text(&format!("{NEAR}{FAR}{FETCH}"))).unwrap();
    assert_eq!(
        meniscus_pipeline::diff(&a, &without),
        [
            "the pass `straight` is left out",
            "the shortcut `short` is gone"
        ]
    );
    let other = load(&text(&steps.replace("[\"far\", \"fetch\"]", "[\"far\"]"))).unwrap();
    assert_eq!(
        meniscus_pipeline::diff(&a, &other),
        [
            "the shortcut `short` is instead of `far` where `fetch.fetch` change nothing, not instead of `far`, `fetch` where `fetch.fetch` change nothing"
        ]
    );
    assert!(meniscus_pipeline::diff(&a, &a).is_empty());
}
