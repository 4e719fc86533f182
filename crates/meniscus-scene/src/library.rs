//! Scene files by name.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use meniscus_source::ron::Spanned;
use meniscus_source::{Diagnostic, Report, SourceFile};

use crate::Scene;
use crate::description::Document;
use crate::lower::stem;
use crate::settings::{Setting, located};

/// A scene file that has a name.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneSource {
    /// What it is loaded by: the file's name without folder and extension.
    pub name: String,
    /// The text.
    pub file: Arc<SourceFile>,
    /// Where mesh files are searched; none for texts in the program itself.
    pub base_dir: Option<PathBuf>,
}

impl SceneSource {
    /// A text in the program itself; its path gives the name.
    pub fn embedded(path: &str, text: &str) -> Self {
        Self {
            name: stem(path),
            file: SourceFile::new(path, text),
            base_dir: None,
        }
    }

    /// A file.
    ///
    /// # Errors
    /// When it cannot be read.
    pub fn read(path: &Path) -> Result<Self, Diagnostic> {
        let file = SourceFile::read(path)?;
        Ok(Self {
            name: stem(&file.name),
            file,
            base_dir: path.parent().map(Path::to_owned),
        })
    }

    /// The line that the file says about itself.
    ///
    /// # Errors
    /// When the file is not a scene file.
    pub fn about(&self) -> Result<String, Report> {
        Ok(Document::read(&self.file)?.about().to_owned())
    }

    /// Makes the scene; a variant of another one needs a library, see [`Library::load`].
    ///
    /// # Errors
    /// See [`Scene::load`].
    pub fn load(&self, settings: &[Setting]) -> Result<Scene, Report> {
        let scene = Scene::load(&self.file, self.base_dir.as_deref(), settings)?;
        Ok(Scene {
            name: self.name.clone(),
            ..scene
        })
    }
}

/// Scene files by name; what is added later stands in for what has the same name.
#[derive(Debug, Clone, Default)]
pub struct Library {
    scenes: BTreeMap<String, SceneSource>,
}

impl Library {
    /// A library of texts in the program itself.
    pub fn new(scenes: impl IntoIterator<Item = SceneSource>) -> Self {
        let mut library = Self::default();
        scenes.into_iter().for_each(|scene| library.add(scene));
        library
    }

    /// Adds a scene, in place of another of its name.
    pub fn add(&mut self, scene: SceneSource) {
        self.scenes.insert(scene.name.clone(), scene);
    }

    /// Adds the `.ron` files of a directory.
    ///
    /// # Errors
    /// When the directory or a file in it cannot be read.
    pub fn add_directory(&mut self, directory: &Path) -> Result<(), Report> {
        let cannot = |error: std::io::Error| {
            Diagnostic::error(format!(
                "cannot read scenes from `{}`: {error}",
                directory.display()
            ))
        };
        let mut report = Report::default();
        for entry in std::fs::read_dir(directory).map_err(cannot)? {
            let path = entry.map_err(cannot)?.path();
            if path.extension().is_some_and(|extension| extension == "ron") {
                match SceneSource::read(&path) {
                    Ok(scene) => self.add(scene),
                    Err(diagnostic) => report.add(diagnostic),
                }
            }
        }
        report.into_result(())
    }

    /// All scenes, by name.
    pub fn iter(&self) -> impl Iterator<Item = &SceneSource> {
        self.scenes.values()
    }

    /// A scene of the library, or the file if `name` is a path that ends in `.ron`.
    ///
    /// # Errors
    /// When there is none; the message names a near one.
    pub fn find(&self, name: &str) -> Result<SceneSource, Diagnostic> {
        if let Some(scene) = self.scenes.get(name) {
            return Ok(scene.clone());
        }
        if name.ends_with(".ron") {
            return SceneSource::read(Path::new(name));
        }
        Err(Diagnostic::error(format!("unknown scene `{name}`"))
            .with_suggestion(name, self.scenes.keys().map(String::as_str))
            .with_help("a scene is named as in `meniscus list`, or by the path of a .ron file"))
    }

    /// Makes a scene. A variant's settings come before those given here, so these win.
    ///
    /// # Errors
    /// See [`Library::find`] and [`Scene::load`]; also when variants go round in a circle.
    pub fn load(&self, name: &str, settings: &[Setting]) -> Result<Scene, Report> {
        let asked = self.find(name)?;
        let (mut source, mut settings, mut passed) = (asked.clone(), settings.to_vec(), Vec::new());
        while let Document::Variant(variant) = Document::read(&source.file)? {
            passed.push(source.name.clone());
            let base = self
                .find(&variant.of)
                .map_err(|fault| located(fault, &variant.of.place))?;
            if passed.contains(&base.name) {
                let message = format!("scene `{}` is a variant of itself", base.name);
                return Err(located(Diagnostic::error(message), &variant.of.place)
                    .with_help(format!(
                        "the chain is {} → {}",
                        passed.join(" → "),
                        base.name
                    ))
                    .into());
            }
            let own = variant.set.iter().map(|(key, value)| Setting {
                key: key.clone(),
                value: Spanned {
                    value: value.value.0.clone(),
                    place: value.place.clone(),
                },
            });
            settings = own.chain(settings).collect();
            source = base;
        }
        Ok(Scene {
            name: asked.name,
            ..source.load(&settings)?
        })
    }
}
