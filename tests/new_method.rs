//! A method is data: the built program runs one that it has never seen, and its code names none.

mod common;

use std::path::{Path, PathBuf};

use common::{folder, json, meniscus, number, row, text, write};

/// Half as much refraction as there should be.
const MODULE: &str = "\
// Bends light half as much as water does: the mean of the camera's ray and the refracted one.
//
// provides: deflect
// needs: geometry/ray, optics/deflected, optics/snell, water/body

fn deflect(incident: Ray, normal: vec3f) -> Deflected {
    let behind = refracted(incident.direction, normal, water.relative_index);
    if behind.total {
        return Deflected(Ray(incident.origin, reflect(incident.direction, normal)), true);
    }
    return Deflected(Ray(incident.origin, normalize(incident.direction + behind.direction)), false);
}
";

const PIPELINE: &str = r#"Variant(
    of: "refraction/combined",
    about: "Half the refraction, of a method that the program has never seen.",
    set: { "narrow.deflect": "optics/half_refracted" },
)
"#;

#[test]
fn a_method_that_the_program_has_never_seen_runs() {
    let there = folder();
    let path = |name: &str| there.path().join(name);
    write(&path("modules/optics/half_refracted.wgsl"), MODULE);
    write(&path("pipelines/mine/half.ron"), PIPELINE);
    let (modules, pipelines) = (path("modules"), path("pipelines"));
    let known = ["--modules", text(&modules), "--pipelines", text(&pipelines)];
    let listed = meniscus(known.iter().chain(&["list"])).done();
    for wanted in [
        "optics/half_refracted",
        "Bends light half as much",
        "mine/half",
        "Half the refraction",
    ] {
        assert!(listed.contains(wanted), "{listed}");
    }
    meniscus(known.iter().chain(&["check", "mine/half"])).done();

    let (results, out) = (path("results.json"), path("out"));
    let table = meniscus(known.iter().chain(&[
        "ablate",
        "refraction/combined",
        "mine/half",
        "--set",
        "pool.triangles=4k",
        "--size",
        "160x90",
        "--rounds",
        "2",
        "--json",
        text(&results),
        "--out",
        text(&out),
    ]))
    .done();
    assert!(table.contains("mine/half"), "{table}");

    let results = json(&results);
    let mean = |pipeline: &str| number(row(&results, pipeline), "/error/position_px/mean");
    // It bends light wrongly, so that it is further from the truth than the one that it varies.
    assert!(mean("mine/half") > 4.0 * mean("refraction/combined"));
    let shaders = |pipeline: &str| row(&results, pipeline)["shaders"]["narrow"].clone();
    assert_ne!(shaders("mine/half"), shaders("refraction/combined"));

    let picture = |name: &str| {
        let file = out.join(name);
        image::open(&file)
            .unwrap_or_else(|e| panic!("{}: {e}", file.display()))
            .to_rgb8()
    };
    let (mine, combined) = (picture("mine-half.png"), picture("refraction-combined.png"));
    let pixels = mine.pixels().zip(combined.pixels());
    let other = pixels.filter(|(a, b)| a != b).count();
    assert!(other > 160 * 90 / 10, "{other} pixels differ");
}

#[test]
fn a_module_of_a_directory_takes_the_place_of_a_built_in_one() {
    let there = folder();
    let path = |name: &str| there.path().join(name);
    write(&path("modules/optics/refracted_ray.wgsl"), MODULE);
    let modules = path("modules");
    let composed = |arguments: &[&str]| {
        let line = ["compose", "refraction/combined", "--pass", "narrow"];
        meniscus(arguments.iter().chain(&line)).done()
    };
    let (before, after) = (composed(&[]), composed(&["--modules", text(&modules)]));
    let half = "normalize(incident.direction + behind.direction)";
    assert!(!before.contains(half), "{before}");
    assert!(after.contains(half), "{after}");
}

/// Files below a directory, with this ending.
fn files(folder: &Path, ending: &str, found: &mut Vec<PathBuf>) {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    for entry in entries {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            files(&path, ending, found);
        } else if path.extension().is_some_and(|e| e == ending) {
            found.push(path);
        }
    }
}

/// Paths of all modules and pipelines, as they are named in files and on the command line.
fn names() -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut names = Vec::new();
    for (folder, ending) in [("shader-modules", "wgsl"), ("pipelines", "ron")] {
        let mut found = Vec::new();
        files(&root.join(folder), ending, &mut found);
        assert!(!found.is_empty(), "{folder} holds nothing");
        names.extend(found.iter().map(|file| {
            let inside = file.strip_prefix(root.join(folder)).expect("inside");
            let parts: Vec<_> = inside.iter().map(|p| p.to_string_lossy()).collect();
            parts
                .join("/")
                .trim_end_matches(&format!(".{ending}"))
                .to_owned()
        }));
    }
    names
}

/// What of a source file is not test code: tests stand at the end of a file, or in files of their
/// own.
fn product(file: &Path) -> Option<String> {
    let name = file.file_stem().map(|stem| stem.to_string_lossy());
    let tests = name.is_some_and(|name| name == "tests" || name.ends_with("_tests"));
    let text = std::fs::read_to_string(file).expect("a source file");
    let end = text.find("#[cfg(test)]\nmod ").unwrap_or(text.len());
    (!tests).then(|| text[..end].to_owned())
}

/// Strict on purpose: messages and help texts count as well, which are the comments of the command
/// line's arguments. Other comments may give examples, and tests may name what they test. `xtask` is
/// left out: it is no part of the program, but a script that types its command line.
#[test]
fn no_code_names_a_module_or_a_pipeline() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut sources = Vec::new();
    for krate in std::fs::read_dir(root.join("crates")).expect("crates") {
        let krate = krate.expect("an entry").path();
        let source = krate.join("src");
        if source.is_dir() && !krate.ends_with("xtask") {
            files(&source, "rs", &mut sources);
        }
    }
    let names = names();
    let mut found = Vec::new();
    for file in &sources {
        let Some(text) = product(file) else { continue };
        let help = file.iter().any(|part| part == "cli");
        for (line, words) in text.lines().enumerate() {
            let words = match help {
                true => words,
                false => words.split("//").next().unwrap_or_default(),
            };
            // What stands between other characters than those of paths.
            let parts = words.split(|c: char| !(c.is_alphanumeric() || "/_-".contains(c)));
            for part in parts.filter(|part| names.iter().any(|name| name == part)) {
                found.push(format!("{}:{}: {part}", file.display(), line + 1));
            }
        }
    }
    assert!(sources.len() > 50, "only {} sources", sources.len());
    assert!(found.is_empty(), "{}", found.join("\n"));
}
