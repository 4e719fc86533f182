//! A module by itself, ready to be run: for tests and for whoever wants to try its functions.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use meniscus_source::{Place, Report};
use naga::valid::ModuleInfo;

use crate::compose::Composer;
use crate::filling::Filling;
use crate::names::{Names, name_all};
use crate::{instance, ir, text};

/// A module with all that it needs, without entry points. Its resources have no bindings: they are
/// connected by name. What is not a slot's, a number's or declared twice keeps its written name.
#[derive(Debug)]
pub struct Alone {
    /// The IR; every function of the module is in it.
    pub module: naga::Module,
    /// naga's analysis of it, without bindings.
    pub info: ModuleInfo,
    /// For every number by its path (`taps`, `step.taps`), the name of the `override` in the IR.
    pub overrides: BTreeMap<String, String>,
    /// The module's own functions: as written, in the order of the file, and as in the IR.
    pub functions: Vec<(String, String)>,
    source: text::Source,
}

impl Alone {
    /// The name in the IR of a function of the module, by its written name.
    pub fn function(&self, name: &str) -> Option<&str> {
        let found = self.functions.iter().find(|(written, _)| written == name);
        found.map(|(_, name)| name.as_str())
    }

    /// The module with entry points of a caller's own, in WGSL. What they do not use is pruned;
    /// resources are bound in group 0, those of the entry points as these say, the module's after
    /// them in the order of their names.
    ///
    /// # Errors
    /// naga's message, where the entry points are wrong.
    pub fn with_entries(&self, entries: &str) -> Result<naga::Module, Report> {
        ir::with_entries(&format!("{}\n{entries}", self.source.text))
    }

    /// Where a range of the source that naga parsed was written.
    pub fn place(&self, range: Range<usize>) -> Option<Place> {
        self.source.origin(range)
    }
}

impl Composer {
    /// A module with what it needs; its slots filled as said, the others by what the facts choose.
    ///
    /// # Errors
    /// Where there is no such module, a filling does not suit, or WGSL is wrong.
    pub fn module(
        &self,
        path: &str,
        slots: &BTreeMap<String, Filling>,
        facts: &BTreeSet<String>,
    ) -> Result<Alone, Report> {
        let library = self.library();
        let module = library.find(path, None)?;
        let instances = instance::resolve(library, module, None, slots, BTreeMap::new(), facts)?;
        let written = text::write_module(&instances)?;
        let names: Names = name_all(&instances).0.pop().unwrap_or_default();
        let (ir, info) = ir::check(&written, library)?;
        let functions = module
            .functions()
            .filter_map(|item| {
                Some((
                    item.name.clone(),
                    names.get(item.name.as_str())?.to_string(),
                ))
            })
            .collect();
        // A filling by itself has a role that is nobody's path.
        let plain = |path: String| {
            path.strip_prefix("filling.")
                .map(str::to_owned)
                .unwrap_or(path)
        };
        Ok(Alone {
            module: ir,
            info,
            overrides: written
                .overrides
                .into_iter()
                .map(|(path, name)| (plain(path), name))
                .collect(),
            functions,
            source: written.source,
        })
    }
}
