//! Composition: a recipe in, a validated shader out.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use meniscus_source::ron::Spanned;
use meniscus_source::{Diagnostic, Report};

use crate::filling::Filling;
use crate::library::{Library, Role};
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

/// A text, and the resources that its variables are connected to.
type Key = (String, BTreeMap<String, String>);

/// Composes recipes from one library and keeps what it has composed.
#[derive(Debug)]
pub struct Composer {
    library: Library,
    kept: Mutex<HashMap<Key, Arc<Shader>>>,
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
        let key = (written.source.text.clone(), written.resources.clone());
        let lock = || self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(shader) = lock().get(&key) {
            return Ok(shader.clone());
        }
        self.composed.fetch_add(1, Ordering::Relaxed);
        let shader = Arc::new(ir::shader(written, &self.library)?);
        Ok(lock().entry(key).or_insert(shader).clone())
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
            let skeletons = self.library.modules().filter(|m| m.role() == Role::Skeleton);
            return Err(wrong
                .with_suggestion(&skeleton.path, skeletons.map(|m| m.path.as_str()))
                .into());
        }
        let instances = instance::resolve(
            &self.library,
            skeleton,
            place,
            &recipe.slots,
            recipe.reads.clone(),
            &recipe.facts,
        )?;
        let entry = entry::write(skeleton, recipe)?;
        text::write(&instances, entry)
    }
}
