//! Composition: a recipe in, a validated shader out.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use meniscus_source::ron::Spanned;
use meniscus_source::{Diagnostic, Place, Report, Severity};

use crate::filling::Filling;
use crate::library::{Library, Module, Role};
use crate::shader::Shader;
use crate::{entry, instance, ir, text};

/// What a pass wants composed.
#[derive(Debug, Clone)]
pub struct Recipe {
    /// The skeleton's path.
    pub skeleton: Spanned<String>,
    /// Fillings by slot.
    pub slots: BTreeMap<String, Filling>,
    /// Resources that variables are connected to, where the names differ.
    pub reads: BTreeMap<String, String>,
    /// Outputs that are written, in order.
    pub outputs: Vec<Output>,
    /// What holds of the scene; slots without a filling may choose by it.
    pub facts: BTreeSet<String>,
    /// How a screen skeleton runs.
    pub stage: Stage,
}

/// An output that a pass writes.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// Its name in the skeleton.
    pub name: Spanned<String>,
    /// The WGSL name of its texel format, for compute shaders: `rgba16float`.
    pub format: String,
}

/// How a screen skeleton runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// As the skeleton says; a screen skeleton in a fragment shader.
    Render,
    /// A screen skeleton in a compute shader, a thread a pixel.
    Compute,
    /// A screen skeleton in a compute shader, over the pixels of a list.
    List,
}

/// The blake3 hash of a text, and the resources that its variables are connected to.
type Key = ([u8; 32], BTreeMap<String, String>);

type Composed = OnceLock<Result<Arc<Shader>, Report>>;

/// Composes recipes from one library and keeps what it has composed.
#[derive(Debug)]
pub struct Composer {
    library: Library,
    kept: Mutex<HashMap<Key, Arc<Composed>>>,
    composed: AtomicU64,
}

impl Composer {
    /// A composer for a library.
    pub fn new(library: Library) -> Self {
        Self {
            library,
            kept: Mutex::default(),
            composed: AtomicU64::new(0),
        }
    }

    /// The modules it composes from.
    pub fn library(&self) -> &Library {
        &self.library
    }

    /// How many shaders were parsed and validated so far; recipes whose texts are equal share one.
    pub fn composed(&self) -> u64 {
        self.composed.load(Ordering::Relaxed)
    }

    /// The shader of a recipe.
    ///
    /// # Errors
    /// Everything that is wrong with the recipe and with the modules it is made of.
    pub fn compose(&self, recipe: &Recipe) -> Result<Arc<Shader>, Report> {
        let written = self.write(recipe)?;
        // Text and connections hold everything that decides the outcome, so they are the key.
        let hash = blake3::hash(written.source.text.as_bytes());
        let key = (*hash.as_bytes(), written.resources.clone());
        let lock = || self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let cell = lock().entry(key.clone()).or_default().clone();
        // Whoever comes second waits for the first rather than compose the same.
        let shader = cell.get_or_init(|| {
            self.composed.fetch_add(1, Ordering::Relaxed);
            let paths: BTreeSet<String> = written
                .modules
                .iter()
                .map(|(path, _)| path.clone())
                .collect();
            ir::shader(written, &self.library)
                .map(Arc::new)
                .map_err(|wrong| self.all_faults(&paths, wrong))
        });
        if shader.is_err() {
            // Its messages name the places of this recipe, not of the next one.
            lock().remove(&key);
        }
        shader.clone()
    }

    /// naga tells the first fault of a text only, so each module is asked by itself; a fault that
    /// shows nowhere but in the whole stays.
    fn all_faults(&self, paths: &BTreeSet<String>, whole: Report) -> Report {
        let mut report = whole;
        for path in paths {
            let Some(module) = self
                .library
                .get(path)
                .filter(|m| m.role() != Role::Skeleton)
            else {
                continue;
            };
            for fault in self.check_module(path).0 {
                let told = |known: &Diagnostic| {
                    let place = |d: &Diagnostic| {
                        d.labels.iter().find(|l| l.primary).map(|l| l.place.clone())
                    };
                    place(known) == place(&fault)
                };
                let own = fault
                    .labels
                    .iter()
                    .any(|l| l.primary && l.place.file == module.file);
                if fault.severity == Severity::Error && own && !report.0.iter().any(told) {
                    report.add(fault);
                }
            }
        }
        report
    }

    /// What is likely not meant in a recipe that can be composed: fillings that nothing asks for.
    pub fn warnings(&self, recipe: &Recipe) -> Report {
        let Some(skeleton) = self.library.get(&recipe.skeleton) else {
            return Report::default();
        };
        self.resolve(skeleton, recipe)
            .map(|instances| instances.unused)
            .unwrap_or_default()
    }

    /// Where a variable of a recipe's shader, by its name there, is declared; none for those that
    /// the entry points declare.
    pub fn declaration(&self, recipe: &Recipe, variable: &str) -> Option<Place> {
        self.write(recipe).ok()?.declarations.remove(variable)
    }

    fn resolve<'l>(
        &'l self,
        skeleton: &'l Module,
        recipe: &Recipe,
    ) -> Result<instance::Instances<'l>, Report> {
        instance::resolve(
            &self.library,
            skeleton,
            recipe.skeleton.place.as_ref(),
            &recipe.slots,
            recipe.reads.clone(),
            &recipe.facts,
        )
    }

    /// Resolves and concatenates, without naga.
    fn write(&self, recipe: &Recipe) -> Result<text::Written, Report> {
        let place = recipe.skeleton.place.as_ref();
        let skeleton = self.library.find(&recipe.skeleton, place)?;
        if skeleton.role() != Role::Skeleton {
            let mut wrong = Diagnostic::error(format!("`{}` is no skeleton", skeleton.path));
            if let Some(place) = place {
                wrong = wrong.at(place, "a skeleton is wanted here");
            }
            let skeletons = self
                .library
                .modules()
                .filter(|m| m.role() == Role::Skeleton);
            return Err(wrong
                .with_suggestion(&skeleton.path, skeletons.map(|m| m.path.as_str()))
                .into());
        }
        let instances = self.resolve(skeleton, recipe);
        let entry = entry::write(skeleton, recipe);
        match (instances, entry) {
            (Ok(mut instances), Ok(entry)) => {
                instances.live = true;
                text::write(&instances, entry)
            }
            (instances, entry) => {
                let mut report = instances.err().unwrap_or_default();
                report.extend(entry.err().unwrap_or_default());
                Err(report)
            }
        }
    }
}
