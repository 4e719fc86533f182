//! Signatures: parameters, members and types, as written.

use super::brackets::{inside, skip_attributes};
use super::{Field, ItemKind};
use crate::lexer::{Kind, Token, tokens};

pub(super) fn function(text: &str, after: &[Token]) -> ItemKind {
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
pub(super) fn fields(text: &str, tokens: &[Token]) -> Vec<Field> {
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
pub(super) fn declared_type(text: &str, after: &[Token]) -> String {
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

/// The names in a type.
pub(crate) fn type_words(ty: &str) -> impl Iterator<Item = &str> {
    ty.split(|c: char| !(c.is_alphanumeric() || c == '_'))
        .filter(|word| word.starts_with(|c: char| c.is_alphabetic() || c == '_'))
}

/// A type with every alias in it replaced by what it stands for.
pub(crate) fn without_aliases<'a>(ty: &str, alias: &dyn Fn(&str) -> Option<&'a str>) -> String {
    let mut ty = ty.to_owned();
    // Mostly there is none, and the type is what it was written as.
    if !type_words(&ty).any(|word| alias(word).is_some()) {
        return ty;
    }
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
pub(super) fn join(text: &str, tokens: &[Token]) -> String {
    let word = |token: &Token| &text[token.range.clone()];
    let mut joined = String::with_capacity(tokens.len() * 6);
    let mut rest = tokens;
    while let Some((first, others)) = rest.split_first() {
        joined.push_str(word(first));
        rest = others;
        if let [open, scalar, close, after @ ..] = others
            && (open.kind, close.kind) == (Kind::Mark('<'), Kind::Mark('>'))
            && let Some(letter) = short(word(first), word(scalar))
        {
            joined.push(letter);
            rest = after;
        }
    }
    joined
}

/// The letter at the end of the short name of a vector or matrix type of these scalars.
fn short(ty: &str, scalar: &str) -> Option<char> {
    let size = |c: u8| (b'2'..=b'4').contains(&c);
    let matrix = match ty.as_bytes() {
        [b'v', b'e', b'c', length] if size(*length) => false,
        [b'm', b'a', b't', columns, b'x', rows] if size(*columns) && size(*rows) => true,
        _ => return None,
    };
    match scalar {
        "f32" => Some('f'),
        "f16" => Some('h'),
        "u32" if !matrix => Some('u'),
        "i32" if !matrix => Some('i'),
        _ => None,
    }
}
