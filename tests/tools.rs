//! `diff`, `graph`, `compose`, `new` and `schema` through the built program.

mod common;

use common::{folder, meniscus, text, words, write};
use serde_json::Value;

#[test]
fn a_pipeline_does_the_same_as_itself_and_differs_both_ways_from_another() {
    let same = meniscus(words("diff refraction/combined refraction/combined")).done();
    assert!(same.contains("does the same"), "{same}");
    let there = meniscus(words("diff refraction/combined refraction/paper")).done();
    let back = meniscus(words("diff refraction/paper refraction/combined")).done();
    let told = |out: &str| out.lines().skip(1).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(told(&there).len(), told(&back).len());
    for (there, back) in told(&there).iter().zip(told(&back)) {
        // `X is A, not B` there is `X is B, not A` back.
        let (what, sides) = there.split_once(" is ").expect("a difference");
        let (new, old) = sides.split_once(", not ").expect("two sides");
        assert_eq!(back, format!("{what} is {old}, not {new}"));
    }
    meniscus(words("diff refraction/combined refraction/papper"))
        .refused(&["did you mean `refraction/paper`?"]);
}

#[test]
fn a_graph_shows_every_pass_in_both_forms() {
    let folder = folder();
    let file = folder.path().join("bounded.svg");
    meniscus([
        "graph",
        "refraction/bounded",
        "--with",
        "narrow.intersect.taps=1",
        "-o",
        text(&file),
    ])
    .done();
    let picture = std::fs::read_to_string(&file).expect("a picture");
    let dot = meniscus(words("graph refraction/bounded --format dot")).done();
    for name in ["near", "broad", "narrow", "trace"] {
        assert!(picture.contains(&format!(". {name}<")), "{name}: {picture}");
        assert!(dot.contains(&format!("\"p {name}\" [")), "{name}: {dot}");
    }
    // A pass that the facts leave out is not there.
    assert!(!dot.contains("mirror"), "{dot}");
    let submerged = words("graph refraction/bounded --format dot --facts camera_submerged");
    assert!(meniscus(submerged).done().contains("\"p mirror\""));
    meniscus(words("graph refraction/bounded --facts wafes")).refused(&["`waves`"]);
    meniscus(["graph", "refraction/bounded", "-o", text(folder.path())]).refused(&["directory"]);
}

#[test]
fn a_pass_is_composed_to_every_language_with_its_numbers() {
    let folder = folder();
    let file = folder.path().join("trace.spv");
    let compose = |format: &str| {
        let line = format!("compose refraction/combined --pass narrow --format {format}");
        line.split(' ').map(str::to_owned).collect::<Vec<_>>()
    };
    assert!(meniscus(compose("hlsl")).done().contains("SV_Target0"));
    assert!(
        meniscus(compose("msl"))
            .done()
            .contains("#include <metal_stdlib>")
    );
    meniscus(compose("spirv")).refused(&["-o narrow.spv"]);
    let mut arguments = compose("spirv");
    arguments.extend(["-o".to_owned(), text(&file).to_owned()]);
    meniscus(arguments).done();
    let words_of = std::fs::read(&file).expect("SPIR-V");
    assert_eq!(words_of[..4], 0x0723_0203_u32.to_le_bytes());
    assert_eq!(words_of.len() % 4, 0);
    // GLSL has no say in which corner a flat value comes from: what to set is told beside it.
    let drawn = meniscus(words("compose refraction/none --pass all --format glsl")).done();
    assert!(drawn.contains("#version 450") && drawn.contains("GL_FIRST_VERTEX_CONVENTION"));
    let count = "compose refraction/bounded --pass count --format glsl";
    assert!(meniscus(words(count)).done().starts_with("#version 450"));
    // A number stands in the text instead of its `override`.
    let taps = |value: u32| {
        let with = format!("narrow.intersect.taps={value}");
        let mut arguments = words("compose refraction/refined --pass narrow --format hlsl --with");
        arguments.push(&with);
        meniscus(arguments).done()
    };
    assert_ne!(taps(1), taps(2));
    assert_eq!(taps(2), taps(2));
}

#[test]
fn a_new_module_is_sound_and_its_next_steps_can_be_taken() {
    let folder = folder();
    let modules = folder.path().join("modules");
    let all = meniscus(words("list slots")).done();
    let slots: Vec<&str> = all
        .lines()
        .filter_map(|line| line.strip_prefix("  ")?.split_whitespace().next())
        .collect();
    assert!(slots.contains(&"deflect"), "{all}");
    for slot in &slots {
        let name = format!("mine/new_{slot}");
        let new = [
            "new",
            "module",
            &name,
            "--slot",
            slot,
            "--dir",
            text(&modules),
        ];
        let said = meniscus(new).done();
        let steps: Vec<&str> = said
            .lines()
            .filter_map(|line| line.strip_prefix("  meniscus eval "))
            .collect();
        assert!(!steps.is_empty(), "{said}");
        for step in steps {
            let mut arguments = vec!["eval"];
            arguments.extend(step.split(' ').filter(|word| !word.is_empty()));
            meniscus(arguments).done();
        }
        assert!(said.contains(&format!("{slot}=")), "{said}");
    }
    // The variant that it proposes is one.
    let deflect = meniscus([
        "new",
        "module",
        "mine/other",
        "--slot",
        "deflect",
        "--dir",
        text(&modules),
    ]);
    let said = deflect.done();
    let variant = &said[said.find("Variant(").expect("a variant")..];
    let pipelines = folder.path().join("pipelines");
    write(&pipelines.join("mine/other.ron"), variant);
    let out = meniscus([
        "check",
        "--modules",
        text(&modules),
        "--pipelines",
        text(&pipelines),
    ])
    .done();
    assert!(out.contains("all valid"), "{out}");
}

#[test]
fn a_new_module_replaces_nothing() {
    let folder = folder();
    let new = |name: &str, slot: &str| {
        meniscus([
            "new",
            "module",
            name,
            "--slot",
            slot,
            "--dir",
            text(folder.path()),
        ])
    };
    new("mine/first", "deflect").done();
    let file = folder.path().join("mine/first.wgsl");
    write(&file, "mine");
    new("mine/first", "deflect").refused(&["is there already"]);
    assert_eq!(std::fs::read_to_string(&file).expect("a file"), "mine");
    new("optics/snell", "deflect").refused(&["there is a module `optics/snell` already"]);
    new("mine/second", "deflekt").refused(&["did you mean `deflect`?"]);
    for odd in [
        "../up",
        "/up",
        "a//b",
        "a/",
        "",
        "slots/mine",
        "a.b",
        "a b",
        "ü",
    ] {
        new(odd, "deflect").refused(&[]);
    }
    let left: Vec<_> = std::fs::read_dir(folder.path())
        .expect("a folder")
        .collect();
    assert_eq!(left.len(), 1, "{left:?}");
    new("mine/first.wgsl/third", "deflect").refused(&[]);
}

#[test]
fn the_schema_is_json_and_knows_pipelines_and_variants() {
    let out = meniscus(["schema"]).done();
    let schema: Value = serde_json::from_str(&out).expect("JSON");
    for kind in ["Pipeline", "Variant"] {
        assert!(schema["$defs"][kind]["properties"]["about"].is_object());
    }
    let out = meniscus(["schema", "scene"]).done();
    let schema: Value = serde_json::from_str(&out).expect("JSON");
    assert!(schema["$defs"]["Scene"]["properties"]["camera"].is_object());
}

#[test]
fn a_slot_that_asks_for_an_unknown_fact_is_refused() {
    let folder = folder();
    let slot = include_str!("../shader-modules/slots/surface.wgsl");
    let odd = slot.replace("when waves", "when wafes");
    assert_ne!(slot, odd);
    write(&folder.path().join("slots/surface.wgsl"), odd);
    meniscus(["check", "--modules", text(folder.path()), "refraction/none"]).refused(&[
        "surface.wgsl:",
        "there is no fact `wafes`",
        "did you mean `waves`?",
    ]);
}
