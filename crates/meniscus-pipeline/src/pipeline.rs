//! A pipeline as it is meant, variants resolved.

use std::collections::BTreeMap;
use std::sync::Arc;

use meniscus_shader::Filling;
use meniscus_source::ron::{Entries, Spanned, from_source};
use meniscus_source::{Diagnostic, Report, SourceFile};

use crate::file::{
    self, BufferFile, Dispatch, File, Over, PipelineFile, Runs, Step, TextureFile, Value,
};
use crate::plan::{Buffer, Geometry, Texture};
use crate::variant;

/// The longest chain of variants of variants.
const MAX_CHAIN: usize = 16;
/// The most passes of a pipeline, repetitions counted.
const MAX_PASSES: usize = 1024;

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
    /// Passes in order.
    pub passes: Vec<Pass>,
    /// The texture that comes out.
    pub output: Spanned<String>,
}

/// A pass as it is declared.
#[derive(Debug, Clone)]
pub struct Pass {
    /// Unique within the pipeline.
    pub name: Spanned<String>,
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
        output: read.output.colour,
    };
    add_steps(&mut pipeline.passes, read.sequence, "", &mut report);
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

/// How many passes steps come to.
fn count(steps: &[Step]) -> usize {
    let one = |step: &Step| match step {
        // An empty repetition costs time, too.
        Step::Repeat(repeat) => (repeat.times.value as usize)
            .saturating_mul(count(&repeat.sequence))
            .max(1),
        _ => 1,
    };
    steps.iter().map(one).fold(0, usize::saturating_add).max(1)
}

/// Unrolls steps into passes; those of a repetition are numbered from 1.
pub(crate) fn add_steps(
    passes: &mut Vec<Pass>,
    steps: Vec<Step>,
    suffix: &str,
    report: &mut Report,
) {
    for step in steps {
        let pass = match step {
            Step::Draw(d) => (
                d.name,
                PassOver::Draw(d.geometry),
                d.skeleton,
                d.when,
                d.slots,
                d.reads,
                d.writes,
            ),
            Step::Screen(s) => (
                s.name,
                PassOver::Screen(s.over, s.runs),
                s.skeleton,
                s.when,
                s.slots,
                s.reads,
                s.writes,
            ),
            Step::Compute(c) => (
                c.name,
                PassOver::Compute(c.dispatch),
                c.skeleton,
                c.when,
                c.slots,
                c.reads,
                Entries::default(),
            ),
            Step::Repeat(repeat) => {
                let times = repeat.times.value as usize;
                let all = times
                    .saturating_mul(count(&repeat.sequence))
                    .saturating_add(passes.len());
                if times == 0 || all > MAX_PASSES {
                    let wrong = Diagnostic::error(format!(
                        "a pipeline has 1 to {MAX_PASSES} passes, repetitions counted"
                    ));
                    report.add(match &repeat.times.place {
                        Some(place) => wrong.at(place, "so many times"),
                        None => wrong,
                    });
                    continue;
                }
                for time in 1..=times {
                    add_steps(
                        passes,
                        repeat.sequence.clone(),
                        &format!("{suffix}.{time}"),
                        report,
                    );
                }
                continue;
            }
        };
        let (mut name, over, skeleton, when, slots, reads, writes) = pass;
        if passes.len() >= MAX_PASSES {
            let many = Diagnostic::error(format!(
                "a pipeline has 1 to {MAX_PASSES} passes, repetitions counted"
            ));
            report.add(match &name.place {
                Some(place) => many.at(place, "one too many"),
                None => many,
            });
            return;
        }
        name.value.push_str(suffix);
        if let Some(first) = passes.iter().find(|p| p.name.value == name.value) {
            let mut twice = Diagnostic::error(format!("two passes are called `{}`", name.value));
            if let (Some(second), Some(first)) = (&name.place, &first.name.place) {
                twice = twice
                    .at(second, "the second")
                    .see(first, "the first")
                    .with_help("give it another name");
            }
            report.add(twice);
        }
        let mut filled = BTreeMap::new();
        let mut numbers = BTreeMap::new();
        for (slot, value) in slots.iter() {
            if let Value::Number(number) = value.value {
                let place = value.place.clone();
                numbers.insert(
                    slot.value.clone(),
                    Spanned {
                        value: number,
                        place,
                    },
                );
                continue;
            }
            match file::filling(slot, value) {
                Ok(filling) => {
                    filled.insert(slot.value.clone(), filling);
                }
                Err(wrong) => report.add(wrong),
            }
        }
        passes.push(Pass {
            name,
            over,
            skeleton,
            when,
            slots: filled,
            numbers,
            reads: file::connections(&reads),
            writes: writes.0,
        });
    }
}

impl Pipeline {
    /// Changes one thing: `PASS.SLOT[.SLOT…]` to a module, or `PASS.SLOT[.SLOT…].NUMBER` to a
    /// number. The value is a module's path, a number, or a filling in RON.
    ///
    /// # Errors
    /// When the path leads nowhere or the value is of the wrong kind.
    pub fn set(&mut self, key: &str, value: &str) -> Result<(), Report> {
        let (key, value) = (key.trim(), value.trim());
        let literal = value.starts_with(['(', '"', '{']) || value.parse::<f64>().is_ok();
        let text = if literal {
            value.to_owned()
        } else {
            format!("\"{}\"", value.escape_default())
        };
        let file = SourceFile::new(format!("--with {key}"), text);
        let value: Spanned<Value> = from_source(&file)?;
        self.put(&Spanned::unplaced(key.to_owned()), &value)?;
        self.name = format!("{} {key}={}", self.name, file.text.trim_matches('"'));
        Ok(())
    }
}
