//! The module-scope items of a WGSL text: their names, kinds, places and signatures.

mod brackets;
mod types;
mod words;

use std::ops::Range;

use brackets::{inside, item_end, skip_attributes};
use types::{declared_type, fields, function, join};
use words::{Filter, Spellings, longest_chain, words};

use crate::lexer::{Kind, Token, tokens};
pub(crate) use types::{type_words, without_aliases};

/// A text and what it declares.
#[derive(Debug)]
pub(crate) struct Outline {
    pub tokens: Vec<Token>,
    pub items: Vec<Item>,
    /// `enable`, `requires` and `diagnostic` directives, which must come first in a shader.
    pub directives: Vec<Range<usize>>,
    /// What is neither a declaration nor a directive.
    pub strays: Vec<Range<usize>>,
    /// The words of all items.
    filter: Filter,
}

/// One declaration.
#[derive(Debug, Clone)]
pub(crate) struct Item {
    pub kind: ItemKind,
    pub name: String,
    pub name_range: Range<usize>,
    /// From its attributes to its closing brace or semicolon.
    pub range: Range<usize>,
    /// The same in tokens.
    pub tokens: Range<usize>,
    /// Those of the tokens that are names of items, of locals, or of WGSL's own things: not members,
    /// not attributes.
    pub words: Vec<usize>,
    /// The `words`, each spelling once.
    pub spellings: Vec<Spelling>,
    /// Its longest chain, on which a parser recurses, and the token where it is reached.
    pub chain: (usize, usize),
}

/// A word of an item. There are many, and composition reads them all, so they are small.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Spelling {
    /// Where it stands first; see [`MAX_LENGTH`].
    start: u32,
    end: u32,
    /// Whether an opening bracket follows some of them, as where a function is meant.
    pub called: bool,
}

impl Spelling {
    fn new(range: &Range<usize>, called: bool) -> Self {
        Self {
            start: range.start as u32,
            end: range.end as u32,
            called,
        }
    }

    /// The word, in the text that it was found in.
    pub fn of(self, text: &str) -> &str {
        &text[self.start as usize..self.end as usize]
    }
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum ItemKind {
    /// Parameters in order, and the type of the result (empty for none).
    Function {
        parameters: Vec<Field>,
        result: String,
    },
    /// Members in order.
    Struct(Vec<Field>),
    /// `var`, with its address space (empty for textures and samplers) and its type.
    Variable { space: String, ty: String },
    /// `override`, with its type (empty when inferred).
    Override { ty: String },
    /// `const`, with its type (empty when inferred).
    Constant { ty: String },
    /// `alias`, with what it stands for.
    Alias(String),
    /// `const_assert`, which has no name but is given one.
    Assertion,
}

/// A parameter or member.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Field {
    pub name: String,
    pub ty: String,
}

/// The longest text of which an outline is made, in bytes; of a longer one, it is empty.
pub(crate) const MAX_LENGTH: usize = 16 << 20;

impl Outline {
    pub fn of(text: &str) -> Self {
        let text = if text.len() > MAX_LENGTH { "" } else { text };
        let mut outline = Self {
            tokens: tokens(text),
            items: Vec::new(),
            directives: Vec::new(),
            strays: Vec::new(),
            filter: Filter::default(),
        };
        let mut spellings = Spellings::new(outline.tokens.len());
        let mut start = 0;
        while start < outline.tokens.len() {
            let end = item_end(&outline.tokens, start);
            outline.add(text, start, end, &mut spellings);
            start = end;
        }
        outline.filter = spellings.filter;
        outline
    }

    /// Whether an item has a word.
    pub fn has_word(&self, text: &str, word: &str) -> bool {
        let mut words = self.items.iter().flat_map(|item| &item.spellings);
        self.filter.may_hold(word) && words.any(|spelling| spelling.of(text) == word)
    }

    pub fn item(&self, name: &str) -> Option<&Item> {
        self.items.iter().find(|item| item.name == name)
    }

    /// The words of an item, each spelling once.
    pub fn spelt<'t>(text: &'t str, item: &'t Item) -> impl Iterator<Item = (&'t str, Spelling)> {
        item.spellings.iter().map(|s| (s.of(text), *s))
    }

    /// Names that an item declares within: parameters and local variables.
    pub fn locals<'t>(&'t self, text: &'t str, item: &'t Item) -> impl Iterator<Item = &'t str> {
        let parameters = match &item.kind {
            ItemKind::Function { parameters, .. } => Some(parameters),
            _ => None,
        };
        let tokens = parameters.map_or(&[][..], |_| &self.tokens[item.tokens.clone()]);
        let parameters = parameters.into_iter().flatten().map(|p| p.name.as_str());
        parameters.chain(words::declared(text, tokens))
    }

    fn add(&mut self, text: &str, start: usize, end: usize, spellings: &mut Spellings) {
        let part = &self.tokens[start..end];
        let range = part[0].range.start..part[end - start - 1].range.end;
        let word = |token: &Token| token.kind == Kind::Word;
        let keyword_at = skip_attributes(part);
        let Some(keyword) = part.get(keyword_at) else {
            self.strays.push(range);
            return;
        };
        let rest = &part[keyword_at + 1..];
        match &text[keyword.range.clone()] {
            "enable" | "requires" | "diagnostic" => self.directives.push(range),
            found @ ("fn" | "struct" | "var" | "override" | "const" | "alias" | "const_assert") => {
                // A variable's address space stands between the keyword and the name.
                let (space, rest) = match (found, rest.first().map(|t| t.kind)) {
                    ("var", Some(Kind::Mark('<'))) => {
                        let close = rest
                            .iter()
                            .position(|t| t.kind == Kind::Mark('>'))
                            .unwrap_or(rest.len() - 1);
                        (join(text, &rest[1..close.max(1)]), &rest[close + 1..])
                    }
                    _ => (String::new(), rest),
                };
                let name_token = rest.first().filter(|t| word(t) && found != "const_assert");
                let (name, name_range) = match name_token {
                    Some(token) => (text[token.range.clone()].to_owned(), token.range.clone()),
                    None if found == "const_assert" => (
                        format!("const_assert {}", self.items.len()),
                        keyword.range.clone(),
                    ),
                    None => {
                        self.strays.push(range);
                        return;
                    }
                };
                let after = rest.get(1..).unwrap_or(&[]);
                let kind = match found {
                    "fn" => function(text, after),
                    "struct" => ItemKind::Struct(fields(text, inside(after, '{', '}'))),
                    "var" => ItemKind::Variable {
                        space,
                        ty: declared_type(text, after),
                    },
                    "override" => ItemKind::Override {
                        ty: declared_type(text, after),
                    },
                    "const" => ItemKind::Constant {
                        ty: declared_type(text, after),
                    },
                    "alias" => {
                        let ty = after.split_last().map_or(&[][..], |(_, ty)| ty);
                        ItemKind::Alias(join(text, ty.get(1..).unwrap_or(&[])))
                    }
                    _ => ItemKind::Assertion,
                };
                let counted = (spellings, self.items.len() + 1);
                let (words, spellings) =
                    words(text, &self.tokens, start..end, found == "struct", counted);
                self.items.push(Item {
                    tokens: start..end,
                    words,
                    spellings,
                    chain: longest_chain(text, &self.tokens, start..end),
                    kind,
                    name,
                    name_range,
                    range,
                });
            }
            // A lone semicolon is allowed.
            ";" if part.len() == 1 => {}
            _ => self.strays.push(range),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_are_found_with_kinds_and_signatures() {
        let text = "enable f16;\n@id(3) override taps: i32 = 2;\nconst A = array(1, 2);\n\
            struct Ray { @size(16) origin: vec3<f32>, direction: vec3f }\n\
            var<storage, read> waves: array<Wave, 4>;\nvar seen: texture_2d<f32>;\n\
            alias V = vec2<f32>;\n@must_use fn deflect(a: ptr<function, Ray>, b: vec3<f32>) -> Ray { if true { } }\n\
            fn nothing() {}\nconst_assert true;";
        let outline = Outline::of(text);
        let names: Vec<_> = outline.items.iter().map(|i| i.name.as_str()).collect();
        assert_eq!(
            names,
            [
                "taps",
                "A",
                "Ray",
                "waves",
                "seen",
                "V",
                "deflect",
                "nothing",
                "const_assert 8"
            ]
        );
        assert_eq!(outline.directives.len(), 1);
        let field = |name: &str, ty: &str| Field {
            name: name.into(),
            ty: ty.into(),
        };
        assert_eq!(
            outline.items[2].kind,
            ItemKind::Struct(vec![field("origin", "vec3f"), field("direction", "vec3f")])
        );
        assert_eq!(
            outline.items[3].kind,
            ItemKind::Variable {
                space: "storage,read".into(),
                ty: "array<Wave,4>".into()
            }
        );
        assert_eq!(
            outline.items[6].kind,
            ItemKind::Function {
                parameters: vec![field("a", "ptr<function,Ray>"), field("b", "vec3f")],
                result: "Ray".into()
            }
        );
        assert_eq!(&text[outline.items[6].range.clone()][..9], "@must_use");
        assert!(
            matches!(&outline.items[7].kind, ItemKind::Function { result, .. } if result.is_empty())
        );
    }

    #[test]
    fn words_are_told_from_members_and_attributes_and_strays_are_kept() {
        let text = "@compute @workgroup_size(width) fn f(@builtin(position) p: V) { let q = p.width + width; }\n\
            struct S { @size(width) width: width2 }\n;fnn g() {}\nfn";
        let outline = Outline::of(text);
        let words = |item: &Item| {
            item.words
                .iter()
                .map(|&i| &text[outline.tokens[i].range.clone()])
                .collect::<Vec<_>>()
                .join(" ")
        };
        assert_eq!(words(&outline.items[0]), "width fn f p V let q p width");
        assert_eq!(words(&outline.items[1]), "struct S width width2");
        let locals: Vec<_> = outline.locals(text, &outline.items[0]).collect();
        assert_eq!(locals, ["p", "q"]);
        let strays: Vec<_> = outline.strays.iter().map(|r| &text[r.clone()]).collect();
        assert_eq!(strays, ["fnn g() {}", "fn"]);
    }

    #[test]
    fn broken_texts_are_outlined_without_a_panic() {
        for text in [
            "fn",
            "fn (",
            "struct S {",
            "var<",
            "var<storage",
            "@",
            "@a(",
            "fn f() -> ",
            "}}};",
            "alias;",
            "alias A",
            "override :;",
        ] {
            Outline::of(text);
        }
    }
}
