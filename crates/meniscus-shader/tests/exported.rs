//! What other tools say of exported shaders: `spirv-val` of SPIR-V, `glslangValidator` of both GLSLs
//! and of HLSL. Every pass of every pipeline that comes with meniscus is tried, and what tells which
//! points it shows. Where a tool is missing, the test says so and holds nothing.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Arc, LazyLock};

use meniscus_pipeline::{Facts, Pipelines, Plan};
use meniscus_shader::{Composer, Entry, Language, Library, Shader};
use meniscus_source::read_tree;

/// A shader, its numbers, and where it was met first.
struct Met {
    shader: Arc<Shader>,
    numbers: BTreeMap<String, f64>,
    name: String,
}

/// Each shader of the built-in pipelines once: over still water, and over and under waves, with those
/// that tell what is shown.
static MET: LazyLock<Vec<Met>> = LazyLock::new(|| {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let modules = read_tree(&root.join("shader-modules"), "wgsl").unwrap();
    let (library, report) = Library::new(modules.iter().map(|(n, f)| (n.as_str(), f.clone())));
    assert!(report.is_ok(), "{report}");
    let composer = Composer::new(library);
    let files = read_tree(&root.join("pipelines"), "ron").unwrap();
    let pipelines = Pipelines::new(files.iter().map(|(n, f)| (n.as_str(), f.clone())));
    let names: Vec<String> = pipelines.names().map(str::to_owned).collect();
    let moments: [&[&'static str]; 2] = [&[], &["waves", "displaced", "camera_submerged"]];
    let mut met: BTreeMap<String, Met> = BTreeMap::new();
    for name in &names {
        let pipeline = pipelines
            .load(name)
            .unwrap_or_else(|report| panic!("{report}"));
        for facts in moments {
            let plan = Plan::new(&pipeline, &composer, &Facts::new(facts.to_vec()), true)
                .unwrap_or_else(|report| panic!("{name}\n{report}"));
            for pass in plan.passes {
                met.entry(pass.shader.hash.clone()).or_insert_with(|| Met {
                    name: format!("{name}: {} under {facts:?}", pass.name),
                    shader: pass.shader.clone(),
                    numbers: pass.numbers.clone(),
                });
            }
        }
    }
    assert!(met.len() > 50, "{} shaders", met.len());
    met.into_values().collect()
});

/// Whether a tool can be started; says so where it cannot.
fn is_there(tool: &str) -> bool {
    let there = Command::new(tool).arg("--version").output().is_ok();
    if !there {
        eprintln!("{tool} is missing: nothing is held against it");
    }
    there
}

/// A shader of a language: a file for each stage, or one.
struct Files {
    met: &'static Met,
    paths: Vec<PathBuf>,
}

/// Writes every shader in a language.
fn write(folder: &Path, language: Language) -> Vec<Files> {
    let write = |(number, met): (usize, &'static Met)| {
        let parts = met.shader.export(language, &met.numbers);
        let parts = parts.unwrap_or_else(|wrong| panic!("{}: {}", met.name, wrong.render()));
        let paths = parts.into_iter().map(|part| {
            let path = folder.join(format!("{number}.{}", part.stage.unwrap_or("all")));
            std::fs::write(&path, part.bytes).unwrap();
            path
        });
        let paths = paths.collect();
        Files { met, paths }
    };
    MET.iter().enumerate().map(write).collect()
}

/// Adds what a tool says of a shader that it refuses.
fn hold(met: &Met, tool: &mut Command, wrong: &mut Vec<String>) {
    let said = tool.output().expect("it could be started before");
    if !said.status.success() {
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let words = text(&said.stdout) + &text(&said.stderr);
        wrong.push(format!("{}\n{words}", met.name));
    }
}

/// Asserts that nothing was refused.
fn nothing(wrong: &[String]) {
    let count = MET.len();
    assert!(
        wrong.is_empty(),
        "{} of {count}:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}

#[test]
fn spirv_is_valid() {
    if !is_there("spirv-val") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let mut wrong = Vec::new();
    for Files { met, paths } in write(folder.path(), Language::SpirV) {
        let mut tool = Command::new("spirv-val");
        tool.args(["--target-env", "vulkan1.1"]).args(&paths);
        hold(met, &mut tool, &mut wrong);
    }
    nothing(&wrong);
}

/// What one stage hands on, the next takes.
fn compiles_and_links(language: Language) {
    if !is_there("glslangValidator") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let mut wrong = Vec::new();
    for Files { met, paths } in write(folder.path(), language) {
        let mut tool = Command::new("glslangValidator");
        hold(met, tool.arg("-l").args(&paths), &mut wrong);
    }
    nothing(&wrong);
}

#[test]
fn glsl_compiles_and_links() {
    compiles_and_links(Language::Glsl);
}

#[test]
fn glsl_es_compiles_and_links() {
    compiles_and_links(Language::GlslEs);
}

/// glslang's reader of HLSL knows no cast of a number to an array, `(uint[4])0`, which HLSL has and
/// naga fills arrays with: for it, they stay empty.
fn without_array_casts(text: &str) -> String {
    let line = |line: &str| match line.split_once(" = (") {
        Some((declared, value)) if value.ends_with("])0;") => format!("{declared};\n"),
        _ => format!("{line}\n"),
    };
    text.lines().map(line).collect()
}

#[test]
fn hlsl_compiles() {
    if !is_there("glslangValidator") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let mut wrong = Vec::new();
    for Files { met, paths } in write(folder.path(), Language::Hlsl) {
        let [file] = paths.as_slice() else {
            panic!("HLSL holds all stages");
        };
        let text = std::fs::read_to_string(file).unwrap();
        std::fs::write(file, without_array_casts(&text)).unwrap();
        let entries = match &met.shader.entry {
            Entry::Render { vertex, fragment } => vec![("vert", vertex), ("frag", fragment)],
            Entry::Compute { name, .. } => vec![("comp", name)],
        };
        for (stage, entry) in entries {
            let mut tool = Command::new("glslangValidator");
            tool.args(["-D", "-V", "-S", stage, "-e", entry, "-o"]);
            hold(
                met,
                tool.arg(folder.path().join("out")).arg(file),
                &mut wrong,
            );
        }
    }
    nothing(&wrong);
}
