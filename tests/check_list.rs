//! What can be had without a GPU: lists, checks, composed shaders and help.

mod common;

use common::{Said, meniscus, program_without_adapter, run, words};

/// Runs the program where there is no adapter to be found.
fn blind(line: &str) -> Said {
    run(program_without_adapter().args(words(line)))
}

/// The lines below a title of the list, as names and purposes.
fn listed<'a>(list: &'a str, title: &str) -> Vec<(&'a str, &'a str)> {
    let lines = list.lines().skip_while(|line| *line != title).skip(1);
    let lines = lines.take_while(|line| line.starts_with("  "));
    lines
        .map(|line| {
            let (name, purpose) = line.trim().split_once("  ").unwrap_or((line.trim(), ""));
            (name, purpose.trim())
        })
        .collect()
}

#[test]
fn everything_is_listed_with_its_purpose() {
    let list = blind("list").done();
    for (title, least, one) in [
        ("slots", 10, "deflect"),
        ("modules", 30, "optics/refracted_ray"),
        ("pipelines", 6, "refraction/combined"),
        ("scenes", 2, "pool-128k"),
    ] {
        let lines = listed(&list, title);
        assert!(lines.len() >= least, "{title}: {list}");
        assert!(
            lines.iter().any(|(name, _)| *name == one),
            "{title}: {list}"
        );
        for (name, purpose) in lines {
            // A sentence, and not the first half of one.
            assert!(purpose.len() > 10, "{title}: {name}: {purpose}");
            assert!(purpose.ends_with(['.', '…']), "{title}: {name}: {purpose}");
        }
        let alone = blind(&format!("list {title}")).done();
        assert_eq!(listed(&alone, title), listed(&list, title));
        assert_eq!(
            alone
                .lines()
                .filter(|l| !l.starts_with(' ') && !l.is_empty())
                .count(),
            1
        );
    }
    let settings = blind("list settings").done();
    for (key, meaning) in listed(&settings, "settings") {
        assert!(
            key.contains('.') && meaning.ends_with(')'),
            "{key}: {meaning}"
        );
    }
}

#[test]
fn what_is_built_in_is_valid_without_a_gpu() {
    let said = blind("check");
    assert_eq!(said.err, "");
    let told = said.done();
    assert!(told.contains("all valid"), "{told}");
    assert!(!told.contains(" 0 "), "{told}");
    let told = blind("check refraction/none refraction/b*").done();
    assert!(told.contains("all valid"), "{told}");
}

#[test]
fn composed_shaders_are_valid_wgsl() {
    let above = &["waves,displaced", "waves"][..];
    let below = &["waves,displaced,camera_submerged"][..];
    for (pipeline, passes, moments) in [
        ("refraction/none", &["all", "sky"][..], above),
        ("refraction/combined", &["near", "broad", "narrow"], above),
        ("refraction/combined", &["broad", "narrow_submerged"], below),
        (
            "refraction/paper-literal",
            &["near", "broad", "narrow"],
            above,
        ),
    ] {
        for pass in passes {
            for facts in moments {
                let line = format!("compose {pipeline} --pass {pass} --facts {facts}");
                let text = blind(&line).done();
                let module = naga::front::wgsl::parse_str(&text)
                    .unwrap_or_else(|e| panic!("{line}: {}", e.emit_to_string(&text)));
                naga::valid::Validator::new(
                    naga::valid::ValidationFlags::all(),
                    naga::valid::Capabilities::default(),
                )
                .validate(&module)
                .unwrap_or_else(|e| panic!("{line}: {}", e.emit_to_string(&text)));
                assert!(!module.entry_points.is_empty(), "{line}");
                // Byte for byte the same whenever it is composed.
                assert_eq!(text, blind(&line).done());
            }
        }
    }
}

#[test]
fn changes_show_in_composed_shaders() {
    let line = "compose refraction/combined --pass narrow";
    let before = blind(line).done();
    let with = format!("{line} --with narrow.deflect=optics/rotated_refracted_ray");
    let after = blind(&with).done();
    assert!(!before.contains("optics/rotated_refracted_ray"));
    assert!(after.contains("optics/rotated_refracted_ray"));
}

#[test]
fn every_command_has_help_that_tells_of_each_option() {
    let help = meniscus(["--help"]).done();
    for command in [
        "list", "check", "compose", "render", "ablate", "compare", "adapters",
    ] {
        assert!(help.contains(command), "{help}");
        let help = meniscus([command, "--help"]).done();
        let options = help.lines().filter(|l| l.trim_start().starts_with("--"));
        for option in options {
            // What an option does stands beside it or in the next line.
            let after = help.split_once(option).map_or("", |(_, after)| after);
            let beside = option.trim().split_once("  ").is_some();
            let below = after.lines().nth(1).is_some_and(|l| l.starts_with("     "));
            assert!(beside || below, "{command}: {option}");
        }
    }
    // Without a command the help is shown, as an error.
    let nothing = meniscus([""; 0]);
    nothing.refused(&["Usage: meniscus", "ablate"]);
}
