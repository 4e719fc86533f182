//! Where declarations, attributes and brackets end.

use crate::lexer::{Kind, Token};

/// The token after the item that begins at `start`: past its semicolon, or past its body.
pub(super) fn item_end(tokens: &[Token], start: usize) -> usize {
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
pub(super) fn skip_attributes(tokens: &[Token]) -> usize {
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
pub(super) fn inside(tokens: &[Token], open: char, close: char) -> &[Token] {
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
