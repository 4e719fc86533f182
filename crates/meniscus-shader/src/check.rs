//! Modules by themselves: each with its own closure, so that no other module hides what is missing,
//! and so that three broken modules give three reports.

use std::collections::{BTreeMap, BTreeSet};

use meniscus_source::ron::Spanned;
use meniscus_source::{Diagnostic, Place, Report};

use crate::compose::{Composer, Output, Recipe, Stage};
use crate::library::{Library, Module, Role};
use crate::outline::{Item, ItemKind, Outline};
use crate::{instance, ir, numbers, text};

impl Composer {
    /// Checks numbers that a pass gives its skeleton: that they are declared, in range, and of
    /// their type. Those of fillings are checked when they are composed.
    pub fn check_numbers(&self, skeleton: &str, values: &BTreeMap<String, Spanned<f64>>) -> Report {
        let module = self.library().get(skeleton);
        module.map_or_else(Report::default, |m| numbers::check_numbers(m, values))
    }

    /// Checks one module with what it needs, its slots filled by their default bodies: that it is
    /// valid WGSL, that it needs what it uses, that it fills its slot. Needs that it does not use
    /// are warned of. For a skeleton, the entry points with all its outputs are checked too.
    pub fn check_module(&self, path: &str) -> Report {
        let library = self.library();
        let module = match library.find(path, None) {
            Ok(module) => module,
            Err(unknown) => return unknown.into(),
        };
        let mut report = unused_needs(library, module);
        if module.role() == Role::Filling {
            report.extend(instance::check_filling(library, module));
        }
        let alone = instance::resolve(
            library,
            module,
            None,
            &BTreeMap::new(),
            BTreeMap::new(),
            &BTreeSet::new(),
        )
        .and_then(|instances| text::write_module(&instances))
        .and_then(|written| ir::check(&written, library));
        let sound = alone.is_ok();
        report.extend(alone.err().unwrap_or_default());
        if sound && module.role() == Role::Skeleton {
            report.extend(self.compose(&all_outputs(module)).err().unwrap_or_default());
        }
        report
    }

    /// Checks every module of the library by itself, in the order of their paths; see
    /// [`Composer::check_module`]. What [`Library::new`] reports is not repeated. Modules that do not
    /// say what inputs they are made for are warned of.
    pub fn check_library(&self) -> Report {
        let mut report = Report::default();
        for module in self.library().modules() {
            report.extend(self.check_module(&module.path));
            if let Some(warning) = missing_domain(module) {
                report.add(warning);
            }
        }
        report
    }
}

/// A skeleton with every output and the slots' defaults.
fn all_outputs(skeleton: &Module) -> Recipe {
    Recipe {
        skeleton: Spanned::unplaced(skeleton.path.clone()),
        slots: BTreeMap::new(),
        reads: BTreeMap::new(),
        outputs: skeleton
            .header
            .outputs
            .iter()
            .map(|name| Output {
                name: Spanned {
                    value: name.text.clone(),
                    place: Some(name.place.clone()),
                },
                format: "rgba16float".into(),
            })
            .collect(),
        facts: BTreeSet::new(),
        stage: Stage::Render,
    }
}

/// A warning where a module has functions that take something, and does not say what they are made
/// for. What slots and bodies of passes take is said by those that fill and run them.
fn missing_domain(module: &Module) -> Option<Diagnostic> {
    if !matches!(module.role(), Role::Filling | Role::Shared) || !module.header.domain.is_empty() {
        return None;
    }
    let takes = |item: &&Item| matches!(&item.kind, ItemKind::Function { parameters, .. } if !parameters.is_empty());
    let function = module.functions().find(takes)?;
    let place = Place::new(&module.file, function.name_range.clone());
    let message = format!("`{}` declares no domain", module.path);
    Some(
        Diagnostic::warning(message)
            .at(&place, "for which inputs is this made?")
            .with_help(format!(
                "say it in the header, so that `meniscus stress` can try it: `// domain: {}(ARGUMENT -1e4 to 1e4)`, or in words",
                function.name
            )),
    )
}

/// Warnings about needs of which no name is used. What a needed module needs comes with it; if that
/// is all that is used, it is what should be needed.
fn unused_needs(library: &Library, module: &Module) -> Report {
    let outline = &module.outline;
    let used: BTreeSet<&str> = outline
        .items
        .iter()
        .flat_map(|item| Outline::spelt(&module.file.text, item))
        .map(|(word, _)| word)
        .collect();
    let is_used = |needed: &Module| {
        let mut items = needed.outline.items.iter();
        items.any(|item| used.contains(item.name.as_str()))
    };
    let mut report = Report::default();
    for need in &module.header.needs {
        let Some(needed) = library.get(&need.text).filter(|needed| !is_used(needed)) else {
            continue;
        };
        let wrong = Diagnostic::warning(format!(
            "`{}` needs `{}` and uses nothing of it",
            module.path, need.text
        ))
        .at(&need.place, "not used");
        let direct = |other: &Module| module.header.needs.iter().any(|n| n.text == other.path);
        let behind = library.closure(needed).into_iter().skip(1);
        let instead: Vec<String> = behind
            .filter(|other| is_used(other) && !direct(other))
            .map(|other| format!("`{}`", other.path))
            .collect();
        report.add(match instead.is_empty() {
            true => wrong.with_help("leave it out"),
            false => wrong.with_help(format!(
                "need {} instead, which it uses by way of it",
                instead.join(", ")
            )),
        });
    }
    report
}
