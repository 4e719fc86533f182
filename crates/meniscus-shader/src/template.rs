//! What a new module begins as.

use std::sync::Arc;

use meniscus_source::{Diagnostic, Report, SourceFile};
use rustc_hash::FxHashSet;

use crate::compose::Composer;
use crate::library::{Library, Module, Role};

impl Library {
    /// The text of a new module of a path that fills a slot: what is to be said of it, the slot's
    /// needs, its signature and its default body, ready to be changed. It composes.
    ///
    /// # Errors
    /// When the path is no module's or is taken, when there is no such slot, or when the slot's
    /// default body does not serve as a module.
    pub fn template(&self, path: &str, slot: &str) -> Result<String, Report> {
        check_path(path)?;
        if let Some(taken) = self.get(path) {
            return Err(Diagnostic::error(format!(
                "there is a module `{path}` already: {}",
                taken.file.name
            ))
            .with_help("take another name")
            .into());
        }
        let Some(found) = self.slot(slot) else {
            return Err(self.unknown_slot(slot, None).into());
        };
        let text = write(found, slot);
        let file = SourceFile::new(format!("{path}.wgsl"), text.clone());
        let sources = self.modules().map(|m| (m.path.as_str(), m.file.clone()));
        let added: [(&str, Arc<SourceFile>); 1] = [(path, file)];
        // What is wrong with other modules' headers is not this one's matter.
        let (library, _) = Library::new(sources.chain(added));
        Composer::new(library).check_module(path).into_result(text)
    }

    /// Whether a module calls a slot: itself, or through what it needs and the default fillings of
    /// slots that it calls.
    pub fn calls(&self, module: &Module, slot: &str) -> bool {
        let mut waiting = vec![module];
        let mut seen = FxHashSet::default();
        while let Some(module) = waiting.pop() {
            if !seen.insert(module.path.as_str()) {
                continue;
            }
            for used in &module.header.slots {
                if used.slot.text == slot && used.name.text == slot {
                    return true;
                }
                waiting.extend(self.slot(&used.slot.text));
            }
            let chosen = module.header.when.iter().map(|when| &when.module);
            let others = module.header.needs.iter().chain(chosen);
            waiting.extend(others.filter_map(|other| self.get(&other.text)));
        }
        false
    }
}

fn check_path(path: &str) -> Result<(), Diagnostic> {
    let part = |part: &str| {
        part.starts_with(|c: char| c.is_ascii_alphabetic())
            && part.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
    };
    if !path.split('/').all(part) {
        return Err(
            Diagnostic::error(format!("`{path}` is no name for a module")).with_help(
                "write FOLDER/NAME in letters, digits and `_`, a letter first: optics/my_ray",
            ),
        );
    }
    if path.starts_with("slots/") {
        return Err(Diagnostic::error(format!(
            "`{path}` would be a slot: those stand in `slots/`"
        ))
        .with_help("take another folder"));
    }
    Ok(())
}

fn write(slot: &Module, name: &str) -> String {
    debug_assert_eq!(slot.role(), Role::Slot);
    let header = &slot.header;
    let names = |names: Vec<&str>| names.join(", ");
    let mut text = format!(
        "// Say here in one sentence what this does; then spaces, units, the equation and its source,\n\
         // and what comes out where it fails.\n\
         // The slot: {}\n//\n// provides: {name}\n",
        header.purpose
    );
    if !header.needs.is_empty() {
        let needs = header.needs.iter().map(|need| need.text.as_str()).collect();
        text.push_str(&format!("// needs: {}\n", names(needs)));
    }
    if !header.slots.is_empty() {
        let used = |used: &crate::header::SlotUse| match used.name.text == used.slot.text {
            true => used.slot.text.clone(),
            false => format!("{}: {}", used.name.text, used.slot.text),
        };
        let slots: Vec<String> = header.slots.iter().map(used).collect();
        text.push_str(&format!("// slots: {}\n", slots.join(", ")));
    }
    let body = slot.file.text.get(slot.header_range.end..);
    text.push('\n');
    text.push_str(body.unwrap_or_default().trim());
    text.push('\n');
    text
}
