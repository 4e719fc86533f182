//! What a pipeline puts into slots.

use std::collections::BTreeMap;

use meniscus_source::Place;
use meniscus_source::ron::Spanned;

/// A module in a slot, with its numbers, its own slots, and what it reads.
#[derive(Debug, Clone, PartialEq)]
pub struct Filling {
    /// The module's path.
    pub module: Spanned<String>,
    /// Values of its numbers, where they differ from the defaults.
    pub numbers: BTreeMap<String, Spanned<f64>>,
    /// Fillings of its slots, and of those of the modules within.
    pub slots: BTreeMap<String, Filling>,
    /// Resources that its variables are connected to, where the names differ.
    pub reads: BTreeMap<String, Spanned<String>>,
    /// Where the slot's name was written.
    pub slot_place: Option<Place>,
}

impl Filling {
    /// A module as it is.
    pub fn plain(module: Spanned<String>) -> Self {
        Self {
            module,
            numbers: BTreeMap::new(),
            slots: BTreeMap::new(),
            reads: BTreeMap::new(),
            slot_place: None,
        }
    }

    /// All its numbers and those of the fillings within, by their paths below `path`.
    pub fn numbers_below(&self, path: &str, found: &mut BTreeMap<String, Spanned<f64>>) {
        for (name, value) in &self.numbers {
            found.insert(format!("{path}.{name}"), value.clone());
        }
        for (slot, filling) in &self.slots {
            filling.numbers_below(&format!("{path}.{slot}"), found);
        }
    }
}
