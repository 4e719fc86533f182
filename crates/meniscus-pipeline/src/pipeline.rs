//! A pipeline as it is meant, variants resolved.

use std::collections::BTreeMap;
use std::sync::Arc;

use meniscus_shader::Filling;
use meniscus_source::ron::{Entries, Spanned, from_source};
use meniscus_source::{Diagnostic, Report, SourceFile};

use crate::file::{self, BufferFile, Dispatch, File, Over, PipelineFile, Runs, TextureFile, Value};
use crate::plan::{Buffer, Geometry, Texture};
use crate::shortcut::Shortcut;
use crate::steps::Steps;
use crate::variant;

/// The longest chain of variants of variants.
const MAX_CHAIN: usize = 16;

/// A pipeline: sequences, and the textures and buffers between them.
#[derive(Debug, Clone)]
pub struct Pipeline {
    /// Its name, with the changes made to it on the command line.
    pub name: String,
    /// One line about it.
    pub about: String,
    /// Whether others are compared with it where nothing else is said.
    pub baseline: bool,
    /// Textures by name.
    pub textures: BTreeMap<String, Spanned<Texture>>,
    /// Buffers by name.
    pub buffers: BTreeMap<String, Spanned<Buffer>>,
    /// Buffers that hold lists of pixels which results count, by the name of what is counted.
    pub lists: BTreeMap<String, Spanned<String>>,
    /// Passes in order, those of shortcuts where they would run.
    pub passes: Vec<Pass>,
    /// Shorter ways to the same picture, by name.
    pub shortcuts: BTreeMap<String, Shortcut>,
    /// The texture that comes out.
    pub output: Spanned<String>,
}

/// A pass as it is declared.
#[derive(Debug, Clone)]
pub struct Pass {
    /// Unique within the pipeline.
    pub name: Spanned<String>,
    /// The shortcut that it belongs to.
    pub shortcut: Option<String>,
    /// Passes whose fillings it takes over where it has none of its own, the first one's numbers and
    /// connections too.
    pub like: Vec<Spanned<String>>,
    /// What it runs over.
    pub over: PassOver,
    /// The skeleton's path.
    pub skeleton: Spanned<String>,
    /// The rule on facts under which it runs.
    pub when: Option<Spanned<String>>,
    /// Fillings by slot.
    pub slots: BTreeMap<String, Filling>,
    /// Values of the skeleton's numbers, where they differ from the defaults.
    pub numbers: BTreeMap<String, Spanned<f64>>,
    /// Resources by variable, where the names differ.
    pub reads: BTreeMap<String, Spanned<String>>,
    /// Textures by output, in the order they were written; `depth` is the depth texture.
    pub writes: Vec<(Spanned<String>, Spanned<String>)>,
}

/// What a declared pass runs over.
#[derive(Debug, Clone, PartialEq)]
pub enum PassOver {
    /// Triangles.
    Draw(Geometry),
    /// Pixels.
    Screen(Over, Runs),
    /// Threads.
    Compute(Dispatch),
}

/// All pipeline files, by name.
#[derive(Debug, Default, Clone)]
pub struct Pipelines {
    files: BTreeMap<String, Arc<SourceFile>>,
}

impl Pipelines {
    /// Files with their names (paths without `.ron`); a later one replaces an earlier.
    pub fn new<'a>(files: impl IntoIterator<Item = (&'a str, Arc<SourceFile>)>) -> Self {
        Self {
            files: files
                .into_iter()
                .map(|(name, file)| (name.to_owned(), file))
                .collect(),
        }
    }

    /// Names in order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.files.keys().map(String::as_str)
    }

    /// The file of a name.
    pub fn file(&self, name: &str) -> Option<&Arc<SourceFile>> {
        self.files.get(name)
    }

    /// Reads a pipeline, following variants to their origin.
    ///
    /// # Errors
    /// When the name is unknown, a file is wrong, or variants form a circle.
    pub fn load(&self, name: &str) -> Result<Pipeline, Report> {
        self.follow(&Spanned::unplaced(name.to_owned()), &mut Vec::new())
    }

    /// Reads a pipeline from a file that is not among the known ones; what it is a variant of is.
    ///
    /// # Errors
    /// As [`Pipelines::load`].
    pub fn load_file(&self, name: &str, file: &Arc<SourceFile>) -> Result<Pipeline, Report> {
        self.read(name, file, &mut vec![name.to_owned()])
    }

    fn follow(&self, name: &Spanned<String>, chain: &mut Vec<String>) -> Result<Pipeline, Report> {
        let placed = |diagnostic: Diagnostic, words: &str| match &name.place {
            Some(place) => diagnostic.at(place, words),
            None => diagnostic,
        };
        let Some(file) = self.files.get(&name.value) else {
            let unknown = Diagnostic::error(format!("there is no pipeline `{}`", name.value));
            return Err(placed(unknown, "unknown pipeline")
                .with_suggestion(&name.value, self.names())
                .into());
        };
        chain.push(name.value.clone());
        if chain[..chain.len() - 1].contains(&name.value) || chain.len() > MAX_CHAIN {
            let circle = Diagnostic::error(format!(
                "variants of each other, or more than {MAX_CHAIN} in a chain: {}",
                chain.join(" → ")
            ));
            return Err(placed(circle, "comes back here").into());
        }
        self.read(&name.value, file, chain)
    }

    fn read(
        &self,
        name: &str,
        file: &Arc<SourceFile>,
        chain: &mut Vec<String>,
    ) -> Result<Pipeline, Report> {
        match from_source::<File>(file)? {
            File::Pipeline(read) => build(name, read),
            File::Variant(variant) => {
                let mut pipeline = self.follow(&variant.of, chain)?;
                pipeline.name = name.to_owned();
                pipeline.about.clone_from(&variant.about);
                pipeline.baseline = false;
                variant::apply(&mut pipeline, variant)?;
                Ok(pipeline)
            }
        }
    }
}

fn build(name: &str, read: PipelineFile) -> Result<Pipeline, Report> {
    let mut report = Report::default();
    let mut pipeline = Pipeline {
        name: name.to_owned(),
        about: read.about,
        baseline: read.baseline,
        textures: textures(read.textures),
        buffers: buffers(read.buffers),
        lists: file::connections(&read.lists),
        passes: Vec::new(),
        shortcuts: BTreeMap::new(),
        output: read.output.colour,
    };
    let mut steps = Steps::default();
    steps.add(read.sequence, "");
    steps.end(&mut pipeline, None, &mut report);
    report.into_result(pipeline)
}

pub(crate) fn textures(declared: Entries<TextureFile>) -> BTreeMap<String, Spanned<Texture>> {
    let placed = |(key, t): (Spanned<String>, TextureFile)| {
        let value = Texture {
            format: t.format,
            size: t.size,
        };
        let place = key.place;
        (key.value, Spanned { value, place })
    };
    declared.0.into_iter().map(placed).collect()
}

pub(crate) fn buffers(declared: Entries<BufferFile>) -> BTreeMap<String, Spanned<Buffer>> {
    let placed = |(key, b): (Spanned<String>, BufferFile)| {
        let value = Buffer {
            bytes: b.bytes.into(),
            bytes_per_pixel: b.bytes_per_pixel.into(),
            indirect: b.indirect,
            zeroed: b.zeroed,
        };
        let place = key.place;
        (key.value, Spanned { value, place })
    };
    declared.0.into_iter().map(placed).collect()
}

impl Pipeline {
    /// Changes one thing: `PASS.SLOT[.SLOT…]` to a module, or `PASS.SLOT[.SLOT…].NUMBER` to a
    /// number. The value is a module's path, a number, or a filling in RON.
    ///
    /// # Errors
    /// When the path leads nowhere or the value is of the wrong kind.
    pub fn set(&mut self, key: &str, value: &str) -> Result<(), Report> {
        self.set_from("--with", key, value)
    }

    /// The same for a value that messages are to say came from `origin`: `--try`.
    ///
    /// # Errors
    /// As [`Pipeline::set`].
    pub fn set_from(&mut self, origin: &str, key: &str, value: &str) -> Result<(), Report> {
        let (key, value) = (key.trim(), value.trim());
        let literal = value.starts_with(['(', '"', '{']) || value.parse::<f64>().is_ok();
        let text = if literal {
            value.to_owned()
        } else {
            format!("\"{}\"", value.escape_default())
        };
        let file = SourceFile::new(format!("{origin} {key}"), text);
        let value: Spanned<Value> = from_source(&file)?;
        self.put(&Spanned::unplaced(key.to_owned()), &value)?;
        self.name = format!("{} {key}={}", self.name, file.text.trim_matches('"'));
        Ok(())
    }
}
