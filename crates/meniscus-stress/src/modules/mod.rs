//! Shader modules of a library, ready to be run, with the domains that their headers declare.

mod agreement;
mod assay;
mod declared;
mod domain;
mod exhaustive;
mod host;
mod kernel;
mod truth;

use std::collections::{BTreeMap, BTreeSet};

use meniscus_shader::{Alone, Composer, Filling, Library};
use meniscus_source::{Diagnostic, Place, Report};

pub use agreement::Agreement;
pub use assay::{Assay, WATERS, Worst, WorstCase};
pub use declared::{Declared, declared};
pub use exhaustive::Exhaustive;
pub use host::{Connected, Host};
pub use kernel::{Device, Kernel, Launcher, Read, Texels};
pub use truth::{truth, truth_about, truth_names};

use crate::{Domain, Function, Program, Settings, Site, Trap};

/// How a module is taken from a library.
#[derive(Debug, Clone, Default)]
pub struct Choice {
    /// Fillings of its slots.
    pub slots: BTreeMap<String, Filling>,
    /// What holds of the scene: chooses the fillings of slots that are not said.
    pub facts: BTreeSet<String>,
    /// Values of its numbers, by their paths (`taps`, `step.taps`).
    pub numbers: BTreeMap<String, f64>,
    /// Whether `fma` rounds once.
    pub fused: bool,
}

impl Choice {
    /// What is chosen where water has waves that rays meet: flat water is the least part of that.
    pub fn of_waves() -> Self {
        Self {
            facts: ["waves", "displaced"].map(str::to_owned).into(),
            ..Self::default()
        }
    }
}

/// A module of a library with what it needs, ready to be run function by function.
#[derive(Debug)]
pub struct Specimen {
    path: String,
    alone: Alone,
    program: Program,
    /// Values of `override`s by their names in the IR.
    numbers: BTreeMap<String, f64>,
}

impl Specimen {
    /// Composes a module with what it needs.
    ///
    /// # Errors
    /// Where there is no such module, a filling does not suit, WGSL is wrong, or there is no such
    /// number.
    pub fn new(composer: &Composer, path: &str, choice: &Choice) -> Result<Self, Report> {
        let alone = composer.module(path, &choice.slots, &choice.facts)?;
        let mut numbers = BTreeMap::new();
        for (name, value) in &choice.numbers {
            let Some(known) = alone.overrides.get(name) else {
                let unknown = Diagnostic::error(format!("`{path}` has no number `{name}`"));
                let known = alone.overrides.keys().map(String::as_str);
                return Err(unknown.with_suggestion(name, known).into());
            };
            numbers.insert(known.clone(), *value);
        }
        let settings = Settings {
            numbers: numbers.clone(),
            fused: choice.fused,
            ..Settings::default()
        };
        let program = Program::new(&alone.module, &alone.info, settings)
            .map_err(|trap| Report::from(Diagnostic::error(trap.to_string())))?;
        Ok(Self {
            path: path.to_owned(),
            alone,
            program,
            numbers,
        })
    }

    /// The module's path.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// The written names of the module's own functions, in the order of its file.
    pub fn function_names(&self) -> impl Iterator<Item = &str> {
        self.alone
            .functions
            .iter()
            .map(|(written, _)| written.as_str())
    }

    /// A function by its written name.
    ///
    /// # Errors
    /// Where there is none, or it holds something that cannot run on the CPU.
    pub fn function(&self, name: &str) -> Result<Function, Report> {
        let Some(known) = self.alone.function(name) else {
            let unknown = Diagnostic::error(format!("`{}` has no function `{name}`", self.path));
            return Err(unknown.with_suggestion(name, self.function_names()).into());
        };
        self.program
            .function(known)
            .map_err(|trap| self.explain(&trap))
    }

    /// Buffers, textures and samplers for everything that a function reads.
    ///
    /// # Errors
    /// Where the host has a value of another kind than the shader reads.
    pub fn connect(&self, function: &Function, host: &Host) -> Result<Connected, Report> {
        host.connect(self.program.module(), function.resources())
    }

    /// The same with every `f32` that the function reads moved by at most so many ulps; 0 stays.
    pub(crate) fn connect_nearby(
        &self,
        function: &Function,
        host: &Host,
        ulps: i64,
        seed: u64,
    ) -> Result<Connected, Report> {
        let mut rng = fastrand::Rng::with_seed(seed);
        let module = self.program.module();
        host.connect_moved(module, function.resources(), &mut |number| {
            crate::stress::nudged(number, ulps, &mut rng)
        })
    }

    /// Where the inputs of a function lie, as the header says; none where it says nothing.
    ///
    /// # Errors
    /// Where the header's words do not fit the function.
    pub fn domain(
        &self,
        library: &Library,
        name: &str,
        function: &Function,
        host: &Host,
    ) -> Result<Option<(Domain, Option<String>)>, Report> {
        let (all, report) = declared(library);
        report.into_result(())?;
        let own = |d: &&Declared| d.module == self.path && d.name == name;
        match all.iter().find(own) {
            Some(found) => Ok(Some((
                found.domain(&all, function, host)?,
                found.against.clone(),
            ))),
            None => Ok(None),
        }
    }

    /// Where a place of the evaluator was written.
    pub fn place(&self, site: &Site) -> Option<Place> {
        self.alone.place(site.span.clone()?)
    }

    /// A trap in words, with the place that it happened at.
    pub fn explain(&self, trap: &Trap) -> Report {
        let site = match trap {
            Trap::Unsupported(unsupported) => Some(&unsupported.site),
            Trap::EndlessLoop { site, .. } => Some(site),
            _ => None,
        };
        let mut diagnostic = Diagnostic::error(format!("`{}`: {trap}", self.path));
        if let Some(place) = site.and_then(|site| self.place(site)) {
            diagnostic = diagnostic.at(&place, "here");
        }
        diagnostic.into()
    }
}
