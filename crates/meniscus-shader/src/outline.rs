//! The module-scope items of a WGSL text: their names, kinds, places and signatures.

use std::collections::{BTreeSet, HashSet};
use std::ops::Range;

use crate::lexer::{Kind, Token, tokens};

/// A text and what it declares.
#[derive(Debug)]
pub(crate) struct Outline {
    pub tokens: Vec<Token>,
    pub items: Vec<Item>,
    /// `enable`, `requires` and `diagnostic` directives, which must come first in a shader.
    pub directives: Vec<Range<usize>>,
    /// What is neither a declaration nor a directive.
    pub strays: Vec<Range<usize>>,
}

/// One declaration.
#[derive(Debug, Clone)]
pub(crate) struct Item {
    pub kind: ItemKind,
    pub name: String,
    pub name_range: Range<usize>,
    /// From its attributes to its closing brace or semicolon.
    pub range: Range<usize>,
    /// Those of the tokens that are names of items, of locals, or of WGSL's own things: not members,
    /// not attributes.
    pub words: Vec<usize>,
    /// The first of the `words` of each spelling.
    pub spellings: Vec<usize>,
    /// Its longest chain, on which a parser recurses, and the token where it is reached.
    pub chain: (usize, usize),
    /// Names that it declares within: parameters and local variables.
    pub locals: BTreeSet<String>,
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
    /// `const`.
    Constant,
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

impl Outline {
    pub fn of(text: &str) -> Self {
        let mut outline = Self {
            tokens: tokens(text),
            items: Vec::new(),
            directives: Vec::new(),
            strays: Vec::new(),
        };
        let mut start = 0;
        while start < outline.tokens.len() {
            let end = item_end(&outline.tokens, start);
            outline.add(text, start, end);
            start = end;
        }
        outline
    }

    pub fn item(&self, name: &str) -> Option<&Item> {
        self.items.iter().find(|item| item.name == name)
    }

    fn add(&mut self, text: &str, start: usize, end: usize) {
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
                    "const" => ItemKind::Constant,
                    "alias" => {
                        let ty = after.split_last().map_or(&[][..], |(_, ty)| ty);
                        ItemKind::Alias(join(text, ty.get(1..).unwrap_or(&[])))
                    }
                    _ => ItemKind::Assertion,
                };
                let words = words(text, &self.tokens, start..end, found == "struct");
                let mut known = HashSet::new();
                let spellings = words
                    .iter()
                    .copied()
                    .filter(|&index| known.insert(&text[self.tokens[index].range.clone()]))
                    .collect();
                self.items.push(Item {
                    locals: locals(text, &self.tokens[start..end], &kind),
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

/// The tokens of an item that are names which may refer to something.
fn words(text: &str, tokens: &[Token], range: Range<usize>, is_struct: bool) -> Vec<usize> {
    let mut found = Vec::new();
    let mut at = range.start;
    while at < range.end {
        let kind = |index: usize| {
            tokens
                .get(index)
                .filter(|_| range.contains(&index))
                .map(|t| t.kind)
        };
        if kind(at) == Some(Kind::Mark('@')) {
            // The arguments of these are words of their own; those of others are expressions.
            let name = tokens.get(at + 1).map_or("", |t| &text[t.range.clone()]);
            let own = matches!(
                name,
                "builtin" | "interpolate" | "diagnostic" | "early_depth_test" | "blend_src"
            );
            at += 2;
            if own && kind(at) == Some(Kind::Mark('(')) {
                at += inside(&tokens[at..range.end], '(', ')').len() + 2;
            }
            continue;
        }
        let member = at > range.start && kind(at - 1) == Some(Kind::Mark('.'));
        // A member's declaration, but not the type after the colon.
        let declared = is_struct && at > range.start + 1 && kind(at + 1) == Some(Kind::Mark(':'));
        if kind(at) == Some(Kind::Word) && !member && !declared {
            found.push(at);
        }
        at += 1;
    }
    found
}

/// The longest chain of operators, accesses, template lists, `else if`s and brackets in an item, and
/// the token where it is reached.
fn longest_chain(text: &str, tokens: &[Token], range: Range<usize>) -> (usize, usize) {
    // How long the chain was when each open bracket was met: a comma goes back to that.
    let mut open: Vec<usize> = Vec::new();
    let mut chain = 0;
    let mut elses = 0;
    let mut longest = (0, range.start);
    for index in range {
        match tokens[index].kind {
            Kind::Mark(';') => chain = 0,
            Kind::Mark('{') => {
                chain = 0;
                open.push(0);
            }
            Kind::Mark('}') => {
                chain = 0;
                open.pop();
            }
            Kind::Mark('(' | '[') => {
                chain += 1;
                open.push(chain);
            }
            Kind::Mark(')' | ']') => drop(open.pop()),
            Kind::Mark(',') => chain = open.last().copied().unwrap_or(0),
            Kind::Mark(
                '+' | '-' | '*' | '/' | '%' | '&' | '|' | '^' | '!' | '~' | '<' | '>' | '.',
            ) => chain += 1,
            Kind::Word if &text[tokens[index].range.clone()] == "else" => elses += 1,
            _ => {}
        }
        let length = chain + open.len() + elses;
        if length > longest.0 {
            longest = (length, index);
        }
    }
    longest
}

/// Names of parameters, and those after `let`, `var` and `const` within a body.
fn locals(text: &str, tokens: &[Token], kind: &ItemKind) -> BTreeSet<String> {
    let ItemKind::Function { parameters, .. } = kind else {
        return BTreeSet::new();
    };
    let mut names: BTreeSet<String> = parameters.iter().map(|p| p.name.clone()).collect();
    for (index, token) in tokens.iter().enumerate() {
        if !matches!(&text[token.range.clone()], "let" | "var" | "const") {
            continue;
        }
        let mut next = index + 1;
        if tokens.get(next).map(|t| t.kind) == Some(Kind::Mark('<')) {
            next += inside(&tokens[next..], '<', '>').len() + 2;
        }
        if let Some(name) = tokens.get(next) {
            names.insert(text[name.range.clone()].to_owned());
        }
    }
    names
}

/// The token after the item that begins at `start`: past its semicolon, or past its body.
fn item_end(tokens: &[Token], start: usize) -> usize {
    let mut depth = 0i32;
    for (index, token) in tokens.iter().enumerate().skip(start) {
        match token.kind {
            Kind::Mark('(' | '[' | '{') => depth += 1,
            Kind::Mark(')' | ']') => depth -= 1,
            Kind::Mark('}') => {
                depth -= 1;
                if depth <= 0 {
                    return index + 1;
                }
            }
            Kind::Mark(';') if depth <= 0 => return index + 1,
            _ => {}
        }
    }
    tokens.len()
}

/// Index of the first token that belongs to no attribute.
fn skip_attributes(tokens: &[Token]) -> usize {
    let mut at = 0;
    while tokens.get(at).is_some_and(|t| t.kind == Kind::Mark('@')) {
        at += 2;
        if tokens.get(at).is_some_and(|t| t.kind == Kind::Mark('(')) {
            at += inside(&tokens[at..], '(', ')').len() + 2;
        }
    }
    at.min(tokens.len())
}

/// The tokens between the first `open` and its `close`.
fn inside(tokens: &[Token], open: char, close: char) -> &[Token] {
    let Some(start) = tokens.iter().position(|t| t.kind == Kind::Mark(open)) else {
        return &[];
    };
    let mut depth = 0;
    for (index, token) in tokens.iter().enumerate().skip(start) {
        if token.kind == Kind::Mark(open) {
            depth += 1;
        } else if token.kind == Kind::Mark(close) {
            depth -= 1;
            if depth == 0 {
                return &tokens[start + 1..index];
            }
        }
    }
    &tokens[start + 1..]
}

fn function(text: &str, after: &[Token]) -> ItemKind {
    let parameters = inside(after, '(', ')');
    let rest = after.get(parameters.len() + 2..).unwrap_or(&[]);
    let body = rest
        .iter()
        .position(|t| t.kind == Kind::Mark('{'))
        .unwrap_or(rest.len());
    let arrow = rest[..body].get(2..).unwrap_or(&[]);
    let arrow = &arrow[skip_attributes(arrow)..];
    ItemKind::Function {
        parameters: fields(text, parameters),
        result: join(text, arrow),
    }
}

/// Splits `name: type, …` at the commas that stand outside brackets.
fn fields(text: &str, tokens: &[Token]) -> Vec<Field> {
    let mut found = Vec::new();
    let mut depth = 0i32;
    let mut start = 0;
    for index in 0..=tokens.len() {
        let kind = tokens.get(index).map(|t| t.kind);
        match kind {
            Some(Kind::Mark('(' | '[' | '<')) => depth += 1,
            Some(Kind::Mark(')' | ']' | '>')) => depth -= 1,
            Some(Kind::Mark(',' | ';')) if depth <= 0 => {}
            None => {}
            _ => continue,
        }
        let ends = kind.is_none() || (depth <= 0 && matches!(kind, Some(Kind::Mark(',' | ';'))));
        if ends {
            let field = &tokens[start..index];
            let field = &field[skip_attributes(field)..];
            if let [name, _, ty @ ..] = field {
                found.push(Field {
                    name: text[name.range.clone()].to_owned(),
                    ty: join(text, ty),
                });
            }
            start = index + 1;
        }
    }
    found
}

/// The type in `: type = …;`, empty when it is inferred.
fn declared_type(text: &str, after: &[Token]) -> String {
    match after.first().map(|t| t.kind) {
        Some(Kind::Mark(':')) => {
            let end = after
                .iter()
                .position(|t| matches!(t.kind, Kind::Mark('=' | ';')))
                .unwrap_or(after.len());
            join(text, &after[1..end])
        }
        _ => String::new(),
    }
}

/// A type with every alias in it replaced by what it stands for.
pub(crate) fn without_aliases<'a>(ty: &str, alias: &dyn Fn(&str) -> Option<&'a str>) -> String {
    let mut ty = ty.to_owned();
    // Aliases cannot be recursive; if these are, naga says so.
    for _ in 0..8 {
        let found = tokens(&ty);
        let replaced: String = found
            .iter()
            .map(|t| &ty[t.range.clone()])
            .map(|word| alias(word).unwrap_or(word))
            .collect();
        let replaced = join(&replaced, &tokens(&replaced));
        if replaced == ty || replaced.len() > 1000 {
            break;
        }
        ty = replaced;
    }
    ty
}

/// A type as written, without white space and with WGSL's short names (`vec3f`, not `vec3<f32>`).
fn join(text: &str, tokens: &[Token]) -> String {
    let mut joined: String = tokens.iter().map(|t| &text[t.range.clone()]).collect();
    if !joined.contains("32>") && !joined.contains("f16>") {
        return joined;
    }
    for (word, letter) in [("f32", 'f'), ("u32", 'u'), ("i32", 'i'), ("f16", 'h')] {
        for size in 2..=4 {
            joined = joined.replace(&format!("vec{size}<{word}>"), &format!("vec{size}{letter}"));
            for rows in 2..=4 {
                joined = joined.replace(
                    &format!("mat{size}x{rows}<{word}>"),
                    &format!("mat{size}x{rows}{letter}"),
                );
            }
        }
    }
    joined
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
        let locals: Vec<_> = outline.items[0].locals.iter().map(String::as_str).collect();
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
