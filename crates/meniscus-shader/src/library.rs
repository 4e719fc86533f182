//! All modules that are known, by their paths.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use meniscus_source::{Diagnostic, Place, Report, SourceFile};
use rustc_hash::FxHashSet;

use crate::header::{Header, Name};
use crate::names::slot_function;
use crate::outline::{Item, ItemKind, MAX_LENGTH, Outline};

/// The folder of slot files.
const SLOTS: &str = "slots/";
/// How many modules are read in about the time in which a thread is started.
const WORTH_A_THREAD: usize = 16;

/// One WGSL file.
#[derive(Debug)]
pub struct Module {
    /// Its path without the ending: `optics/refracted_ray`.
    pub path: String,
    /// Its text.
    pub file: Arc<SourceFile>,
    /// What its leading comment says.
    pub header: Header,
    pub(crate) header_range: Range<usize>,
    pub(crate) outline: Outline,
}

/// What a module is, by its place and header.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// A named signature with a default body.
    Slot,
    /// The body of a pass.
    Skeleton,
    /// Fills a slot.
    Filling,
    /// Declarations that others need.
    Shared,
}

impl Module {
    /// Reads a module's header and outline.
    fn read(path: &str, file: &Arc<SourceFile>, report: &mut Report) -> Self {
        let (header, header_range) = Header::read(file, report);
        let module = Self {
            path: path.to_owned(),
            file: file.clone(),
            header,
            header_range,
            outline: Outline::of(&file.text),
        };
        if file.text.len() > MAX_LENGTH {
            let size = format!("`{path}` is larger than {} MiB", MAX_LENGTH >> 20);
            report.add(
                Diagnostic::error(size)
                    .at(&module.place(0..0), "not read")
                    .with_help("a module is a few functions: split it"),
            );
        }
        module.check_purity(report);
        module.check_outline(report);
        module
    }

    /// What is no declaration would not reach naga, so it is told here.
    fn check_outline(&self, report: &mut Report) {
        for stray in &self.outline.strays {
            let word = self
                .outline
                .tokens
                .iter()
                .find(|t| t.range.start == stray.start);
            let word = word.map_or("", |t| &self.file.text[t.range.clone()]);
            let keywords = [
                "fn",
                "struct",
                "var",
                "const",
                "override",
                "alias",
                "const_assert",
                "enable",
            ];
            let place = self.place(stray.start..stray.start + word.len().max(1));
            let wrong = Diagnostic::error(format!(
                "`{}` holds something that is no declaration",
                self.path
            ));
            report.add(match keywords.contains(&word) {
                true => wrong.at(&place, "the declaration that begins here is not finished"),
                false => wrong
                    .at(&place, "a declaration begins with a keyword")
                    .with_suggestion(word, keywords),
            });
        }
        let slot = self.path.strip_prefix(SLOTS);
        let own = self.header.slots.iter().map(|used| &used.name);
        for name in own
            .chain(self.header.slots.iter().map(|used| &used.slot))
            .filter(|n| !is_identifier(&n.text))
        {
            report.add(
                Diagnostic::error(format!("`{}` is no name for a slot", name.text))
                    .at(&name.place, "letters, digits and `_`, a letter first"),
            );
        }
        if let Some(slot) = slot
            && (!is_identifier(slot) || self.functions().next().is_none())
        {
            report.add(
                Diagnostic::error(format!("`{}` is no slot", self.path))
                    .at(
                        &self.place(0..0),
                        "a slot file is named by an identifier and declares functions",
                    )
                    .with_help("only slots stand in `slots/`, directly"),
            );
        }
    }

    /// What it is.
    pub fn role(&self) -> Role {
        if self.path.starts_with(SLOTS) {
            Role::Slot
        } else if self.header.skeleton.is_some() {
            Role::Skeleton
        } else if self.header.provides.is_some() {
            Role::Filling
        } else {
            Role::Shared
        }
    }

    /// The last part of the path.
    pub fn leaf(&self) -> &str {
        self.path.rsplit('/').next().unwrap_or(&self.path)
    }

    pub(crate) fn place(&self, range: Range<usize>) -> Place {
        Place::new(&self.file, range)
    }

    pub(crate) fn item(&self, name: &str) -> Option<&Item> {
        self.outline.item(name)
    }

    /// Functions, which for a slot are its contract.
    pub(crate) fn functions(&self) -> impl Iterator<Item = &Item> {
        self.outline
            .items
            .iter()
            .filter(|item| matches!(item.kind, ItemKind::Function { .. }))
    }

    /// The names of its functions, in the order of the file.
    pub fn function_names(&self) -> impl Iterator<Item = &str> {
        self.functions().map(|item| item.name.as_str())
    }
}

/// Whether a text can be a WGSL name.
fn is_identifier(text: &str) -> bool {
    let mut letters = text.chars();
    letters
        .next()
        .is_some_and(|c| c.is_alphabetic() || c == '_')
        && letters.all(|c| c.is_alphanumeric() || c == '_')
}

/// Reads modules, and what is wrong with them, in the order of the files.
fn read_modules(files: &[(&&str, &Arc<SourceFile>)]) -> (Vec<(String, Module)>, Report) {
    let mut report = Report::default();
    let read = |(path, file): &(&&str, &Arc<SourceFile>)| {
        ((**path).to_owned(), Module::read(path, file, &mut report))
    };
    let modules = files.iter().map(read).collect();
    (modules, report)
}

/// All modules, by path.
#[derive(Debug, Default)]
pub struct Library {
    modules: BTreeMap<String, Module>,
}

impl Library {
    /// Reads modules from texts with their paths (without `.wgsl`); a later text replaces an
    /// earlier one of the same path. What is wrong with headers comes back beside the library,
    /// which holds every module nevertheless.
    pub fn new<'a>(
        sources: impl IntoIterator<Item = (&'a str, Arc<SourceFile>)>,
    ) -> (Self, Report) {
        let latest: BTreeMap<&str, Arc<SourceFile>> = sources.into_iter().collect();
        let files: Vec<_> = latest.iter().collect();
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let parts = cores.min(files.len() / WORTH_A_THREAD).max(1);
        let mut read = files.chunks(files.len().div_ceil(parts).max(1));
        let first = read.next().unwrap_or_default();
        let parts: Vec<_> = std::thread::scope(|scope| {
            let others: Vec<_> = read
                .map(|files| scope.spawn(move || read_modules(files)))
                .collect();
            let first = read_modules(first);
            let others = others.into_iter().map(|thread| match thread.join() {
                Ok(read) => read,
                Err(panic) => std::panic::resume_unwind(panic),
            });
            std::iter::once(first).chain(others).collect()
        });
        let mut report = Report::default();
        let mut modules = BTreeMap::new();
        for (part, wrong) in parts {
            modules.extend(part);
            report.extend(wrong);
        }
        let library = Self { modules };
        for module in library.modules.values() {
            library.check_names(module, &mut report);
        }
        (library, report)
    }

    /// The module of a path.
    pub fn get(&self, path: &str) -> Option<&Module> {
        self.modules.get(path)
    }

    /// All modules in the order of their paths.
    pub fn modules(&self) -> impl Iterator<Item = &Module> {
        self.modules.values()
    }

    /// The slot of a name.
    pub fn slot(&self, name: &str) -> Option<&Module> {
        self.modules.get(&format!("{SLOTS}{name}"))
    }

    /// Names of all slots.
    pub fn slot_names(&self) -> impl Iterator<Item = &str> {
        self.modules
            .range(SLOTS.to_owned()..)
            .map_while(|(path, _)| path.strip_prefix(SLOTS))
    }

    /// Where a resource variable of this name is declared first, in the order of the modules.
    pub fn declaration(&self, variable: &str) -> Option<Place> {
        self.modules.values().find_map(|module| {
            let item = module.item(variable)?;
            matches!(item.kind, ItemKind::Variable { .. })
                .then(|| module.place(item.name_range.clone()))
        })
    }

    /// The module that a name in a header stands for, or what is wrong with the name.
    pub(crate) fn find(&self, name: &str, place: Option<&Place>) -> Result<&Module, Diagnostic> {
        self.get(name).ok_or_else(|| {
            let mut diagnostic = Diagnostic::error(format!("there is no module `{name}`"));
            if let Some(place) = place {
                diagnostic = diagnostic.at(place, "unknown module");
            }
            diagnostic.with_suggestion(name, self.modules.keys().map(String::as_str))
        })
    }

    /// A module and all that it needs, directly or not.
    pub(crate) fn closure<'l>(&'l self, module: &'l Module) -> Vec<&'l Module> {
        let mut seen = FxHashSet::from_iter([module.path.as_str()]);
        let mut all = vec![module];
        let mut next = 0;
        while let Some(module) = all.get(next).copied() {
            next += 1;
            for need in &module.header.needs {
                if let Some(needed) = self.get(&need.text)
                    && seen.insert(&needed.path)
                {
                    all.push(needed);
                }
            }
        }
        all
    }

    pub(crate) fn cannot_be_needed(need: &Name) -> Diagnostic {
        Diagnostic::error(format!(
            "`{}` cannot be needed: it is a filling, a slot or a skeleton",
            need.text
        ))
        .at(&need.place, "")
        .with_help(
            "call the slot instead (`slots: …`), or move what both use into a module of its own",
        )
    }

    fn check_names(&self, module: &Module, report: &mut Report) {
        let header = &module.header;
        for need in &header.needs {
            match self.find(&need.text, Some(&need.place)) {
                Err(unknown) => report.add(unknown),
                Ok(needed) if matches!(needed.role(), Role::Shared) => {}
                Ok(_) => report.add(Self::cannot_be_needed(need)),
            }
        }
        let slots = header
            .slots
            .iter()
            .map(|used| &used.slot)
            .chain(&header.provides)
            .chain(header.requires.iter().map(|r| &r.slot));
        for slot in slots {
            if self.slot(&slot.text).is_none() {
                report.add(self.unknown_slot(&slot.text, Some(&slot.place)));
            }
        }
        let modules = header.requires.iter().map(|r| &r.module);
        for Name { text, place } in modules.chain(header.when.iter().map(|w| &w.module)) {
            if let Err(unknown) = self.find(text, Some(place)) {
                report.add(unknown);
            }
        }
        for used in &header.slots {
            let Some(slot) = self.slot(&used.slot.text) else {
                continue;
            };
            for function in slot.functions() {
                let name = slot_function(slot, &function.name, &used.name.text);
                if let Some(item) = module.item(&name) {
                    report.add(
                        Diagnostic::error(format!(
                            "`{}` both declares `{name}` and calls the slot of that name",
                            module.path
                        ))
                        .at(&used.name.place, "called")
                        .see(&module.place(item.name_range.clone()), "declared")
                        .with_help(format!(
                            "give the slot a name of its own: `slots: inner: {}`",
                            used.slot.text
                        )),
                    );
                }
            }
        }
        module.check_declared_numbers(report);
    }

    /// The message about a slot that is not there.
    pub(crate) fn unknown_slot(&self, name: &str, place: Option<&Place>) -> Diagnostic {
        let mut diagnostic = Diagnostic::error(format!("there is no slot `{name}`"));
        if let Some(place) = place {
            diagnostic = diagnostic.at(place, "unknown slot");
        }
        diagnostic.with_suggestion(name, self.slot_names())
    }
}
