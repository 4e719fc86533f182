//! Whether a filling's functions have the types of its slot's, as naga understands them: `vec3<f32>`
//! is `vec3f`, an alias is what it stands for, and two structs of one name are the same where one
//! module declares both, or their members are alike.

use std::collections::BTreeSet;
use std::ops::Range;

use meniscus_source::{Diagnostic, Place};
use naga::{ArraySize, Handle, Type, TypeInner};

use crate::ir;
use crate::library::{Library, Module};
use crate::outline::{Item, ItemKind, Outline, type_words, without_aliases};
use crate::text::MAX_CHAIN;

/// The message about a function of a module that has not the types of the slot's; none where it has
/// them.
pub(crate) fn compare(
    library: &Library,
    (module, item): (&Module, &Item),
    (slot, wanted): (&Module, &Item),
) -> Option<Diagnostic> {
    let ours = Written::of(library, module, item);
    let theirs = Written::of(library, slot, wanted);
    let (difference, place) = difference(ours.as_ref()?, theirs.as_ref()?)?;
    let (there, own) = (place_of(slot, wanted), place_of(module, item));
    let (there_line, own_line) = (one_line(there.text()), one_line(own.text()));
    let place = place.map_or(own, |range| module.place(range));
    let help = match there_line == own_line {
        true => {
            let needs = slot.header.needs.iter().map(|need| need.text.as_str());
            let needs = needs.collect::<Vec<_>>().join(", ");
            format!("take the types from where the slot has them: `// needs: {needs}`")
        }
        false => format!("write `{there_line}`"),
    };
    Some(
        Diagnostic::error(format!(
            "`{}` has not the signature of the slot `{}`",
            module.path,
            slot.leaf()
        ))
        .at(&place, difference)
        .see(&there, "the slot's signature")
        .with_help(format!(
            "the slot has   {there_line}\nthe module has {own_line}"
        ))
        .with_help(help),
    )
}

/// A function's signature: its place.
pub(crate) fn place_of(module: &Module, item: &Item) -> Place {
    let text = &module.file.text[item.range.clone()];
    let end = text.find('{').unwrap_or(text.len());
    let length = text[..end].trim_end().len();
    module.place(item.range.start..item.range.start + length)
}

/// A function's signature, on one line.
pub(crate) fn written(module: &Module, item: &Item) -> String {
    one_line(place_of(module, item).text())
}

/// A text on one line.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A function's signature as it was written.
struct Written<'l> {
    module: &'l Module,
    item: &'l Item,
    closure: Vec<&'l Module>,
    /// Names and types of the parameters, and the type of the result, aliases resolved.
    parameters: Vec<(&'l str, String)>,
    result: String,
}

impl<'l> Written<'l> {
    fn of(library: &'l Library, module: &'l Module, item: &'l Item) -> Option<Self> {
        let ItemKind::Function { parameters, result } = &item.kind else {
            return None;
        };
        let closure = library.closure(module);
        let alias = |name: &str| match &find(&closure, name)?.1.kind {
            ItemKind::Alias(ty) => Some(ty.as_str()),
            _ => None,
        };
        let plain = |ty: &str| without_aliases(ty, &alias);
        let parameters = parameters.iter().map(|p| (p.name.as_str(), plain(&p.ty)));
        let (parameters, result) = (parameters.collect(), plain(result));
        Some(Self {
            module,
            item,
            closure,
            parameters,
            result,
        })
    }

    /// The types, the result's last.
    fn types(&self) -> impl Iterator<Item = &str> {
        let parameters = self.parameters.iter().map(|(_, ty)| ty.as_str());
        parameters.chain([self.result.as_str()])
    }

    /// What a word of a type means: the module that declares it.
    fn owner(&self, word: &str) -> Option<&'l Module> {
        find(&self.closure, word).map(|(module, _)| module)
    }

    /// Where the parameter of a number stands, or the result.
    fn part(&self, number: usize) -> Option<Range<usize>> {
        let tokens = &self.module.outline.tokens[self.item.tokens.clone()];
        let text = &self.module.file.text;
        let word = self.parameters.get(number)?.0;
        // The function's own name may be the same word, so look behind it.
        let after = |range: &Range<usize>| range.start >= self.item.name_range.end;
        let mut ranges = tokens.iter().map(|t| t.range.clone());
        ranges.find(|range| after(range) && text[range.clone()] == *word)
    }

    /// What naga makes of the signature; none where it does not understand it, which the check of
    /// the module by itself tells.
    fn understood(&self) -> Option<Understood> {
        let mut text = String::new();
        let mut chain = self.item.chain.0;
        let mut seen = BTreeSet::new();
        let mut open: Vec<&str> = self.types().flat_map(type_words).collect();
        while let Some(word) = open.pop() {
            let Some((owner, item)) = find(&self.closure, word).filter(|_| seen.insert(word))
            else {
                continue;
            };
            if matches!(
                item.kind,
                ItemKind::Function { .. } | ItemKind::Variable { .. }
            ) {
                continue;
            }
            text.push_str(&owner.file.text[item.range.clone()]);
            text.push('\n');
            chain = chain.max(item.chain.0);
            let mentioned = Outline::spelt(&owner.file.text, item);
            open.extend(mentioned.map(|(word, _)| word));
        }
        text.push_str("fn signature(");
        for (number, (_, ty)) in self.parameters.iter().enumerate() {
            text.push_str(&format!("p{number}: {ty}, "));
        }
        text.push(')');
        if !self.result.is_empty() {
            text.push_str(&format!(" -> {}", self.result));
        }
        text.push_str(" {}\n");
        if chain > MAX_CHAIN {
            return None;
        }
        let module = ir::parse_apart(&text, chain)?;
        let (_, function) = module.functions.iter().next()?;
        Some(Understood {
            types: function.arguments.iter().map(|a| a.ty).collect(),
            result: function.result.as_ref().map(|result| result.ty),
            module,
        })
    }
}

/// A signature in naga's types.
struct Understood {
    module: naga::Module,
    types: Vec<Handle<Type>>,
    result: Option<Handle<Type>>,
}

/// What differs, in words, and where in the first; none where nothing does.
fn difference(ours: &Written, theirs: &Written) -> Option<(String, Option<Range<usize>>)> {
    // Mostly the words are equal and mean the same.
    let same_words = ours.types().eq(theirs.types());
    let same_meaning = |word| {
        let (ours, theirs) = (ours.owner(word), theirs.owner(word));
        ours.map(|m| &m.path) == theirs.map(|m| &m.path)
    };
    if same_words && ours.types().flat_map(type_words).all(same_meaning) {
        return None;
    }
    let (one, other) = (ours.parameters.len(), theirs.parameters.len());
    if one != other {
        let count = |number: usize| match number {
            0 => "no parameters".to_owned(),
            1 => "one parameter".to_owned(),
            _ => format!("{number} parameters"),
        };
        let words = format!("takes {}, the slot has {}", count(one), count(other));
        return Some((words, None));
    }
    let understood = ours.understood().zip(theirs.understood());
    let equal = |number: usize| match &understood {
        Some((a, b)) => match (a.types.get(number), b.types.get(number)) {
            (Some(x), Some(y)) => same((&a.module, *x), (&b.module, *y)),
            _ => match (a.result, b.result) {
                (Some(x), Some(y)) => same((&a.module, x), (&b.module, y)),
                (x, y) => x.is_none() && y.is_none(),
            },
        },
        None => ours.types().nth(number) == theirs.types().nth(number),
    };
    let mut types = ours.types().zip(theirs.types()).enumerate();
    let (number, (a, b)) = types.find(|(number, _)| !equal(*number))?;
    let named = |ty: &str, written: &Written| {
        // Structs of one name are told apart by who declares them.
        let owner = type_words(ty).find_map(|word| written.owner(word));
        match owner.filter(|_| a == b) {
            Some(owner) => format!("the `{ty}` of `{}`", owner.path),
            None if ty.is_empty() => "nothing".to_owned(),
            None => format!("`{ty}`"),
        }
    };
    let (a, b) = (named(a, ours), named(b, theirs));
    Some(match ours.parameters.get(number) {
        Some((name, _)) => (
            format!("`{name}` is {a}, in the slot {b}"),
            ours.part(number),
        ),
        None => (format!("gives {a}, the slot {b}"), None),
    })
}

/// Whether two types of two modules are the same.
fn same((m, a): (&naga::Module, Handle<Type>), (n, b): (&naga::Module, Handle<Type>)) -> bool {
    let (first, second) = (&m.types[a], &n.types[b]);
    match (&first.inner, &second.inner) {
        (TypeInner::Struct { members: x, .. }, TypeInner::Struct { members: y, .. }) => {
            let alike = |(x, y): (&naga::StructMember, &naga::StructMember)| {
                x.name == y.name && x.offset == y.offset && same((m, x.ty), (n, y.ty))
            };
            first.name == second.name && x.len() == y.len() && x.iter().zip(y).all(alike)
        }
        (
            TypeInner::Array { base, size, .. },
            TypeInner::Array {
                base: other,
                size: length,
                ..
            },
        ) => {
            let named = |module: &naga::Module, size: &ArraySize| match size {
                ArraySize::Pending(number) => module.overrides[*number].name.clone(),
                _ => None,
            };
            let lengths = match (named(m, size), named(n, length)) {
                (None, None) => size == length,
                (one, other) => one == other,
            };
            lengths && same((m, *base), (n, *other))
        }
        (
            TypeInner::Pointer { base, space },
            TypeInner::Pointer {
                base: other,
                space: there,
            },
        ) => space == there && same((m, *base), (n, *other)),
        (one, other) => one == other,
    }
}

/// An item by its name, and who declares it, the closest first.
fn find<'l>(closure: &[&'l Module], name: &str) -> Option<(&'l Module, &'l Item)> {
    let found = |module: &&'l Module| module.item(name).map(|item| (*module, item));
    closure.iter().find_map(found)
}
