//! Modules, pipelines and scenes: the built-in ones, and those of directories.

use std::path::PathBuf;
use std::sync::Arc;

use include_dir::{Dir, include_dir};
use meniscus_pipeline::{Pipeline, Pipelines};
use meniscus_scene::{Library as SceneLibrary, Scene, SceneSource, Setting};
use meniscus_shader::{Composer, Library};
use meniscus_source::{Diagnostic, Report, SourceFile, read_tree};

use crate::preset::Preset;

static MODULES: Dir = include_dir!("$CARGO_MANIFEST_DIR/shader-modules");
static PIPELINES: Dir = include_dir!("$CARGO_MANIFEST_DIR/pipelines");
static PRESETS: Dir = include_dir!("$CARGO_MANIFEST_DIR/examples/presets");
static SCENES: Dir = include_dir!("$CARGO_MANIFEST_DIR/examples/scenes");

/// Directories that add to what is built in, or replace parts of it.
#[derive(Debug, Clone, Default)]
pub struct Sources {
    /// Folders with WGSL modules.
    pub modules: Vec<PathBuf>,
    /// Folders with pipelines in RON.
    pub pipelines: Vec<PathBuf>,
    /// Folders with scenes in RON.
    pub scenes: Vec<PathBuf>,
}

/// Everything that can be named on a command line.
#[derive(Debug)]
pub struct Project {
    /// Composes shaders from the modules.
    pub composer: Composer,
    /// Pipelines by name.
    pub pipelines: Pipelines,
    /// Scenes by name.
    pub scenes: SceneLibrary,
    /// What is wrong with the modules' headers; the modules are there nevertheless.
    pub warnings: Report,
}

type Files = Vec<(String, Arc<SourceFile>)>;

fn embedded(dir: &Dir, prefix: &str, ending: &str, found: &mut Files) {
    for file in dir.files() {
        let path = file.path().to_string_lossy().replace('\\', "/");
        let stem = path.strip_suffix(ending).and_then(|p| p.strip_suffix('.'));
        if let (Some(stem), Some(text)) = (stem, file.contents_utf8()) {
            found.push((
                stem.to_owned(),
                SourceFile::new(format!("{prefix}/{path}"), text),
            ));
        }
    }
    for inner in dir.dirs() {
        embedded(inner, prefix, ending, found);
    }
}

/// Embedded files, then those of folders, which replace them.
fn collect(
    dir: &Dir,
    prefix: &str,
    ending: &str,
    folders: &[PathBuf],
    report: &mut Report,
) -> Files {
    let mut found = Files::new();
    embedded(dir, prefix, ending, &mut found);
    for folder in folders {
        match read_tree(folder, ending) {
            Ok(files) => found.extend(files),
            Err(wrong) => report.extend(wrong),
        }
    }
    found
}

fn borrowed(files: &Files) -> impl Iterator<Item = (&str, Arc<SourceFile>)> {
    files
        .iter()
        .map(|(name, file)| (name.as_str(), file.clone()))
}

impl Project {
    /// Reads what is built in and the given directories.
    ///
    /// # Errors
    /// When a directory or file cannot be read.
    pub fn open(sources: &Sources) -> Result<Self, Report> {
        let mut report = Report::default();
        let modules = collect(
            &MODULES,
            "shader-modules",
            "wgsl",
            &sources.modules,
            &mut report,
        );
        let pipelines = collect(
            &PIPELINES,
            "pipelines",
            "ron",
            &sources.pipelines,
            &mut report,
        );
        let mut built_in = Files::new();
        embedded(&SCENES, "examples/scenes", "ron", &mut built_in);
        let mut scenes = SceneLibrary::new(
            built_in
                .iter()
                .map(|(_, file)| SceneSource::embedded(&file.name, &file.text)),
        );
        for folder in &sources.scenes {
            if let Err(wrong) = scenes.add_directory(folder) {
                report.extend(wrong);
            }
        }
        let (library, warnings) = Library::new(borrowed(&modules));
        report.into_result(Self {
            composer: Composer::new(library),
            pipelines: Pipelines::new(borrowed(&pipelines)),
            scenes,
            warnings,
        })
    }

    /// A pipeline by its name, or by the path of a `.ron` file.
    ///
    /// # Errors
    /// When there is none, or it is wrong.
    pub fn pipeline(&self, name: &str) -> Result<Pipeline, Report> {
        if name.ends_with(".ron") {
            let file = SourceFile::read(name.as_ref())?;
            return self.pipelines.load_file(name, &file);
        }
        self.pipelines.load(name)
    }

    /// The names that patterns like `refraction/*` stand for, in order, each once.
    ///
    /// # Errors
    /// When a pattern matches nothing.
    pub fn pipeline_names(&self, patterns: &[String]) -> Result<Vec<String>, Report> {
        let mut names: Vec<String> = Vec::new();
        for pattern in patterns {
            let found: Vec<String> = match pattern.strip_suffix('*') {
                Some(start) => {
                    let matching = self
                        .pipelines
                        .names()
                        .filter(|name| name.starts_with(start));
                    matching.map(str::to_owned).collect()
                }
                None => vec![pattern.clone()],
            };
            if found.is_empty() {
                return Err(
                    Diagnostic::error(format!("no pipeline matches `{pattern}`"))
                        .with_suggestion(pattern, self.pipelines.names())
                        .into(),
                );
            }
            for name in found {
                if !names.contains(&name) {
                    names.push(name);
                }
            }
        }
        Ok(names)
    }

    /// The names of the built-in presets.
    pub fn preset_names(&self) -> Vec<String> {
        let mut presets = Files::new();
        embedded(&PRESETS, "examples/presets", "ron", &mut presets);
        presets.into_iter().map(|(name, _)| name).collect()
    }

    /// A preset by its name, or by the path of a `.ron` file.
    ///
    /// # Errors
    /// When there is none, or it is wrong.
    pub fn preset(&self, name: &str) -> Result<Preset, Report> {
        if name.ends_with(".ron") {
            return Preset::read(&SourceFile::read(name.as_ref())?);
        }
        let mut presets = Files::new();
        embedded(&PRESETS, "examples/presets", "ron", &mut presets);
        match presets.iter().find(|(known, _)| known == name) {
            Some((_, file)) => Preset::read(file),
            None => Err(Diagnostic::error(format!("there is no preset `{name}`"))
                .with_suggestion(name, presets.iter().map(|(known, _)| known.as_str()))
                .into()),
        }
    }

    /// A scene with settings.
    ///
    /// # Errors
    /// When there is none, or it or a setting is wrong.
    pub fn scene(&self, name: &str, settings: &[Setting]) -> Result<Scene, Report> {
        self.scenes.load(name, settings)
    }
}
