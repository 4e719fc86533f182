//! From naga's IR to register code.

mod access;
mod builder;
mod constant;
mod expression;
mod function;
mod image;
mod integer;
mod math;
mod operator;
mod pack;
mod place;
mod statement;
mod types;

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

use naga::valid::ModuleInfo;
use naga::{Handle, Module};

use crate::code::{Code, Site};
use crate::error::{Trap, Unsupported};

/// How a module is to be run.
#[derive(Debug, Clone)]
pub struct Settings {
    /// Values of `override`s by name, or by number where they have an `@id`.
    pub numbers: BTreeMap<String, f64>,
    /// Whether `fma` rounds once. Shading languages do not promise it; software Vulkan rounds
    /// twice.
    pub fused: bool,
    /// How often a loop may go round before the run stops.
    pub loop_cap: u32,
}

impl Default for Settings {
    /// No numbers set, `fma` rounds once, loops go round at most 65,536 times.
    fn default() -> Self {
        Self {
            numbers: BTreeMap::new(),
            fused: true,
            loop_cap: 1 << 16,
        }
    }
}

/// A module whose functions and entry points can be run on the CPU, in any number system.
///
/// Functions are compiled when they are first asked for.
#[derive(Debug)]
pub struct Program {
    module: Module,
    info: ModuleInfo,
    settings: Settings,
    constants: Vec<Option<Vec<constant::Folded>>>,
    compiled: Mutex<BTreeMap<String, Arc<Code>>>,
}

impl Program {
    /// From a validated module.
    ///
    /// # Errors
    ///
    /// [`Trap::NoOverride`] where a number is set that the module does not have.
    pub fn new(module: &Module, info: &ModuleInfo, settings: Settings) -> Result<Self, Trap> {
        let known = || module.overrides.iter().map(|(_, o)| o);
        for name in settings.numbers.keys() {
            if !known().any(|o| constant::is_called(o, name)) {
                let known = known().filter_map(|o| o.name.clone()).collect();
                return Err(Trap::NoOverride {
                    name: name.clone(),
                    known,
                });
            }
        }
        let constants = constant::fold_all(module, info, &settings);
        let (module, info) = (module.clone(), info.clone());
        Ok(Self {
            module,
            info,
            settings,
            constants,
            compiled: Mutex::default(),
        })
    }

    fn context(&self) -> builder::Context<'_> {
        builder::Context {
            module: &self.module,
            info: &self.info,
            settings: &self.settings,
            constants: &self.constants,
        }
    }

    /// The module that runs.
    #[must_use]
    pub fn module(&self) -> &Module {
        &self.module
    }

    /// Names of the functions, in the order of the source.
    pub fn function_names(&self) -> impl Iterator<Item = &str> {
        self.module
            .functions
            .iter()
            .filter_map(|(_, f)| f.name.as_deref())
    }

    /// A function that is not an entry point.
    ///
    /// # Errors
    ///
    /// [`Trap::NoFunction`], or [`Trap::Unsupported`] with the construct and its place.
    pub fn function(&self, name: &str) -> Result<crate::Function, Trap> {
        let found = self
            .module
            .functions
            .iter()
            .find(|(_, f)| f.name.as_deref() == Some(name));
        let Some((handle, _)) = found else {
            let known = self.function_names().map(str::to_owned).collect();
            return Err(Trap::NoFunction {
                name: name.to_owned(),
                known,
            });
        };
        let code = self.compiled(&format!("fn {name}"), Root::Function(handle))?;
        Ok(crate::Function::new(code))
    }

    /// An entry point.
    ///
    /// # Errors
    ///
    /// [`Trap::NoFunction`], or [`Trap::Unsupported`] with the construct and its place.
    pub fn entry(&self, name: &str) -> Result<crate::Entry, Trap> {
        let Some(index) = self.module.entry_points.iter().position(|e| e.name == name) else {
            let known = self
                .module
                .entry_points
                .iter()
                .map(|e| e.name.clone())
                .collect();
            return Err(Trap::NoFunction {
                name: name.to_owned(),
                known,
            });
        };
        let code = self.compiled(&format!("entry {name}"), Root::Entry(index))?;
        let point = &self.module.entry_points[index];
        let mut workgroup = point.workgroup_size;
        for (axis, size) in point.workgroup_size_overrides.iter().flatten().enumerate() {
            if let Some(expression) = size {
                workgroup[axis] = self.workgroup_size(*expression, name)?;
            }
        }
        Ok(crate::Entry::new(code, point.stage, workgroup))
    }

    fn workgroup_size(
        &self,
        expression: Handle<naga::Expression>,
        entry: &str,
    ) -> Result<u32, Trap> {
        self.context()
            .integer(expression)
            .filter(|s| (1..=1024).contains(s))
            .ok_or_else(|| {
                let construct = "a workgroup of this size".to_owned();
                Unsupported {
                    construct,
                    site: Site {
                        function: entry.to_owned(),
                        span: None,
                    },
                }
                .into()
            })
    }

    fn compiled(&self, key: &str, root: Root) -> Result<Arc<Code>, Trap> {
        // A poisoned lock means that a compilation panicked; the map itself is still whole.
        let lock = || {
            self.compiled
                .lock()
                .unwrap_or_else(std::sync::PoisonError::into_inner)
        };
        if let Some(code) = lock().get(key) {
            return Ok(Arc::clone(code));
        }
        let code = Arc::new(function::compile(self.context(), root)?);
        lock().insert(key.to_owned(), Arc::clone(&code));
        Ok(code)
    }
}

/// What is compiled.
#[derive(Debug, Clone, Copy)]
enum Root {
    Function(Handle<naga::Function>),
    Entry(usize),
}
