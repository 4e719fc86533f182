//! How long composition takes, beside naga alone, and naga_oil and wesl on the same parts.
//!
//! `cargo bench -p meniscus-shader --features compare --bench compose`

use std::any::Any;
use std::collections::{BTreeMap, BTreeSet};
use std::hint::black_box;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use criterion::{Criterion, criterion_group, criterion_main};
use meniscus_shader::{Composer, Filling, Library, Output, Recipe, Shader, Stage};
use meniscus_source::ron::Spanned;
use meniscus_source::{SourceFile, read_tree};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga_oil::compose::{
    ComposableModuleDescriptor, ImportDefinition, NagaModuleDescriptor, ShaderLanguage,
};
use wesl::{CompileOptions, EscapeMangler, ModulePath, VirtualResolver};

type Sources = Vec<(String, Arc<SourceFile>)>;

fn sources() -> Sources {
    read_tree(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shader-modules"),
        "wgsl",
    )
    .expect("the modules can be read")
}

fn library(sources: &Sources) -> Library {
    let (library, report) = Library::new(
        sources
            .iter()
            .map(|(path, file)| (path.as_str(), file.clone())),
    );
    // Some that are left out may be named.
    drop(report);
    library
}

/// The narrow phase of `refraction/combined`, the largest shader that needs no list.
fn recipe() -> Recipe {
    let unplaced = |text: &str| Spanned::unplaced(text.to_owned());
    let fillings = [
        ("deflect", "optics/refracted_ray"),
        ("intersect", "geometry/tangent_plane"),
        ("reproject", "screen/through_flat_water"),
        ("colour", "screen/resampled"),
    ];
    Recipe {
        skeleton: unplaced("passes/redirect"),
        slots: fillings
            .map(|(slot, path)| (slot.to_owned(), Filling::plain(unplaced(path))))
            .into(),
        reads: BTreeMap::new(),
        outputs: vec![Output {
            name: unplaced("colour"),
            format: "rgba16float".into(),
        }],
        facts: BTreeSet::from(["waves".to_owned()]),
        stage: Stage::Render,
    }
}

/// The parts of a composed text, as naga_oil modules that import each other's names.
fn oil_parts(shader: &Shader) -> Vec<(String, String, Vec<ImportDefinition>)> {
    let mut parts: Vec<(String, String)> = Vec::new();
    for part in shader.text.split("// ---- ").skip(1) {
        let (name, text) = part.split_once('\n').expect("a part has a first line");
        // The entry points belong to the skeleton: a shader's own file.
        match parts.last_mut() {
            Some((_, skeleton)) if name == "entry points" => skeleton.push_str(text),
            _ => parts.push((
                name.split(' ').next().unwrap_or(name).replace('/', "::"),
                text.to_owned(),
            )),
        }
    }
    let names = |text: &str| -> Vec<String> {
        text.lines()
            .filter_map(|line| {
                let line = line.split_once(") var").map_or(line, |(_, rest)| rest);
                let rest = [
                    "fn ",
                    "struct ",
                    "const ",
                    "override ",
                    "<uniform> ",
                    "<storage, read> ",
                    " ",
                ]
                .iter()
                .find_map(|start| line.strip_prefix(start).filter(|_| !line.starts_with("  ")))?;
                Some(
                    rest.chars()
                        .take_while(|c| c.is_alphanumeric() || *c == '_')
                        .collect(),
                )
            })
            .collect()
    };
    // naga_oil replaces the members of a struct that are called like an imported function, too.
    let items: BTreeSet<String> = parts.iter().flat_map(|(_, text)| names(text)).collect();
    for (_, text) in &mut parts {
        for name in &items {
            for end in [".", ";", ")", " ", ","] {
                *text = text.replace(&format!(".{name}{end}"), &format!(".{name}_member{end}"));
            }
            *text = text.replace(
                &format!("\n    {name}: "),
                &format!("\n    {name}_member: "),
            );
        }
    }
    let mut made = Vec::new();
    for (index, (path, text)) in parts.iter().enumerate() {
        let words: BTreeSet<&str> = text
            .split(|c: char| !(c.is_alphanumeric() || c == '_'))
            .collect();
        let mut imports = Vec::new();
        let mut header = if index + 1 < parts.len() {
            format!("#define_import_path {path}\n")
        } else {
            String::new()
        };
        for (other, theirs) in &parts[..index] {
            let used: Vec<String> = names(theirs)
                .into_iter()
                .filter(|name| words.contains(name.as_str()))
                .collect();
            if !used.is_empty() {
                header.push_str(&format!("#import {other}::{{{}}}\n", used.join(", ")));
                imports.push(ImportDefinition {
                    import: other.clone(),
                    items: used,
                });
            }
        }
        made.push((path.clone(), header + &typed(text), imports));
    }
    made
}

/// naga_oil loses constants without a type.
fn typed(text: &str) -> String {
    let typed = |line: &str| match line
        .strip_prefix("const ")
        .and_then(|rest| rest.split_once(" = "))
    {
        Some((name, value)) if value.starts_with(|c: char| c.is_ascii_digit()) => {
            let ty = if value.ends_with("u;") {
                "u32"
            } else if value.contains(['.', 'e']) {
                "f32"
            } else {
                "i32"
            };
            format!("const {name}: {ty} = {value}")
        }
        _ => line.to_owned(),
    };
    text.lines().map(|line| typed(line) + "\n").collect()
}

fn oil(parts: &[(String, String, Vec<ImportDefinition>)]) -> naga::Module {
    let mut composer = naga_oil::compose::Composer::default();
    let (last, modules) = parts.split_last().expect("a shader has parts");
    for (path, source, _) in modules {
        composer
            .add_composable_module(ComposableModuleDescriptor {
                source,
                file_path: path,
                language: ShaderLanguage::Wgsl,
                ..Default::default()
            })
            .unwrap_or_else(|error| panic!("{path}: {error}\n{source}"));
    }
    let module = composer
        .make_naga_module(NagaModuleDescriptor {
            source: &last.1,
            file_path: &last.0,
            ..Default::default()
        })
        .unwrap_or_else(|error| panic!("{error}"));
    module
}

/// The parts for wesl: the same with its own words for imports. It keeps the bindings.
fn wesl_parts(parts: &[(String, String, Vec<ImportDefinition>)]) -> Vec<(ModulePath, String)> {
    let part = |(path, text, imports): &(String, String, Vec<ImportDefinition>)| {
        let mut made = String::new();
        for ImportDefinition { import, items } in imports {
            made.push_str(&format!(
                "import package::{import}::{{{}}};\n",
                items.join(", ")
            ));
        }
        for line in text.lines().filter(|line| !line.starts_with('#')) {
            made.push_str(line);
            made.push('\n');
        }
        let path = format!("package::{path}").parse();
        (path.expect("a path"), made)
    };
    parts.iter().map(part).collect()
}

fn wesl(parts: &[(ModulePath, String)]) -> Flat {
    let mut resolver = VirtualResolver::new();
    for (path, text) in parts {
        resolver.add_module(path.clone(), text.as_str().into());
    }
    let (root, _) = parts.last().expect("a shader has parts");
    let options = CompileOptions::default();
    let compiled = wesl::compile(root, &resolver, &EscapeMangler, &options)
        .unwrap_or_else(|error| panic!("{error}"));
    flat(&compiled.to_string())
}

/// A module and what naga found out about it.
type Flat = (naga::Module, naga::valid::ModuleInfo);

fn flat(text: &str) -> Flat {
    let module = naga::front::wgsl::parse_str(text).expect("the text parses");
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .expect("the module is valid");
    (module, info)
}

fn benchmarks(criterion: &mut Criterion) {
    let sources = sources();
    let recipe = recipe();
    let read = || Composer::new(library(&sources));
    let shader = read()
        .compose(&recipe)
        .unwrap_or_else(|report| panic!("{report}"));
    let parts = oil_parts(&shader);
    eprintln!(
        "{} modules in the library, {} parts and {} lines in the shader",
        sources.len(),
        parts.len(),
        shader.text.lines().count()
    );
    // naga_oil is given no others than these; ours wants the slots besides.
    let headings = shader
        .text
        .lines()
        .filter_map(|l| l.strip_prefix("// ---- "));
    let used: BTreeSet<&str> = headings.filter_map(|l| l.split(' ').next()).collect();
    let is_used = |path: &str| used.contains(path) || path.starts_with("slots/");
    let same = sources.iter().filter(|(path, _)| is_used(path));
    let same: Sources = same.cloned().collect();
    eprintln!("{} of the modules are enough", same.len());
    let read_same = || Composer::new(library(&same));
    let composer = read();
    let text = shader.text.clone();
    // On a machine that does other things, too, only the least times of runs in turns compare.
    let wesl_parts = wesl_parts(&parts);
    let mut least = [Duration::MAX; 6];
    let read_and_compose = |composer: Composer| -> Box<dyn Any> {
        let shader = composer.compose(&recipe);
        Box::new((composer, shader))
    };
    for round in 0..100 {
        let fresh = read();
        // What comes out is dropped when the clock has stopped.
        let runs: [&dyn Fn() -> Box<dyn Any>; 6] = [
            &|| Box::new(flat(&text)),
            &|| Box::new(fresh.compose(&recipe)),
            &|| read_and_compose(read_same()),
            &|| read_and_compose(read()),
            &|| Box::new(oil(&parts)),
            &|| Box::new(wesl(&wesl_parts)),
        ];
        // Nobody is always the first after the reading, or after a rival.
        for turn in 0..runs.len() {
            let which = (turn + round) % runs.len();
            let start = Instant::now();
            let made = black_box(runs[which]());
            least[which] = start.elapsed().min(least[which]);
            drop(made);
        }
    }
    let names = [
        "naga alone",
        "meniscus, modules read",
        "meniscus, with reading the same parts",
        "meniscus, with reading all modules",
        "naga_oil",
        "wesl, and naga on what it writes",
    ];
    for (name, time) in names.iter().zip(least) {
        eprintln!(
            "{name:38} {:6.2} ms  {:5.2} × naga alone",
            time.as_secs_f64() * 1e3,
            time.as_secs_f64() / least[0].as_secs_f64()
        );
    }
    criterion.bench_function("naga alone: parse and validate the flat text", |b| {
        b.iter(|| flat(&text))
    });
    criterion.bench_function("meniscus: compose, the library read before", |b| {
        b.iter_batched_ref(
            || Composer::new(library(&sources)),
            |composer| composer.compose(&recipe).map(|s| s.hash.len()),
            criterion::BatchSize::SmallInput,
        );
    });
    criterion.bench_function("meniscus: read all modules and compose", |b| {
        b.iter(|| read().compose(&recipe).map(|s| s.hash.len()))
    });
    criterion.bench_function("meniscus: compose again what is kept", |b| {
        b.iter(|| composer.compose(&recipe).map(|s| s.hash.len()))
    });
    criterion.bench_function("naga_oil: compose the same parts", |b| {
        b.iter(|| oil(&parts))
    });
    criterion.bench_function("wesl: compile the same parts, and naga alone", |b| {
        b.iter(|| wesl(&wesl_parts))
    });
}

criterion_group! {
    name = all;
    config = Criterion::default().sample_size(30).measurement_time(Duration::from_secs(4));
    targets = benchmarks
}
criterion_main!(all);
