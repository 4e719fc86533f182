//! Tokens of WGSL, with their places: enough to rename identifiers and to find module-scope items.
//! What the tokens mean is naga's business.

use std::ops::Range;

/// One token. Comments and white space are not tokens.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Token {
    pub kind: Kind,
    pub range: Range<usize>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// An identifier or keyword.
    Word,
    /// A number, with its suffix.
    Number,
    /// Any other character.
    Mark(char),
}

/// Splits a text into tokens. Never fails: what is no WGSL becomes marks, for naga to complain of.
pub(crate) fn tokens(text: &str) -> Vec<Token> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(c) = text[at..].chars().next() {
        let rest = &text[at..];
        let (kind, length) = if c == ' ' {
            (None, rest.bytes().take_while(|&b| b == b' ').count())
        } else if c.is_whitespace() {
            (None, c.len_utf8())
        } else if rest.starts_with("//") {
            (None, rest.find(is_line_break).unwrap_or(rest.len()))
        } else if rest.starts_with("/*") {
            (None, block_comment(rest))
        } else if c == '_' || unicode_start(c) {
            (Some(Kind::Word), word(rest))
        } else if c.is_ascii_digit()
            || (c == '.' && rest[1..].starts_with(|d: char| d.is_ascii_digit()))
        {
            (Some(Kind::Number), number(rest))
        } else {
            (Some(Kind::Mark(c)), c.len_utf8())
        };
        if let Some(kind) = kind {
            found.push(Token {
                kind,
                range: at..at + length,
            });
        }
        at += length;
    }
    found
}

/// Length of the word that a text begins with.
fn word(text: &str) -> usize {
    let ascii = text
        .bytes()
        .take_while(|&b| b == b'_' || b.is_ascii_alphanumeric())
        .count();
    if text.as_bytes().get(ascii).is_none_or(u8::is_ascii) {
        return ascii;
    }
    text.find(|c| !(c == '_' || unicode_continue(c)))
        .unwrap_or(text.len())
}

fn is_line_break(c: char) -> bool {
    matches!(
        c,
        '\n' | '\r' | '\u{b}' | '\u{c}' | '\u{85}' | '\u{2028}' | '\u{2029}'
    )
}

fn unicode_start(c: char) -> bool {
    c.is_alphabetic()
}

fn unicode_continue(c: char) -> bool {
    c.is_alphanumeric()
}

/// Length of a block comment, nested ones included; an open one reaches to the end.
fn block_comment(text: &str) -> usize {
    let bytes = text.as_bytes();
    let mut depth = 0usize;
    let mut at = 0;
    while at < bytes.len() {
        match &bytes[at..(at + 2).min(bytes.len())] {
            b"/*" => {
                depth += 1;
                at += 2;
            }
            b"*/" => {
                depth -= 1;
                at += 2;
                if depth == 0 {
                    return at;
                }
            }
            _ => at += 1,
        }
    }
    bytes.len()
}

fn number(text: &str) -> usize {
    let mut previous = ' ';
    // `0xe+1` is a sum, `0x1p+1` and `1e+1` are numbers.
    let exponent = if text.starts_with("0x") || text.starts_with("0X") {
        ['p', 'P']
    } else {
        ['e', 'E']
    };
    for (at, c) in text.char_indices() {
        let exponent_sign = matches!(c, '+' | '-') && exponent.contains(&previous);
        if !(c.is_ascii_alphanumeric() || c == '.' || exponent_sign) {
            return at;
        }
        previous = c;
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<&str> {
        tokens(text).into_iter().map(|t| &text[t.range]).collect()
    }

    #[test]
    fn comments_are_skipped_and_numbers_stay_whole() {
        assert_eq!(
            words("fn a(/* x /* y */ */b: vec2f) // c\n{ return .5e-3f+0x1p+4; }"),
            [
                "fn", "a", "(", "b", ":", "vec2f", ")", "{", "return", ".5e-3f", "+", "0x1p+4",
                ";", "}"
            ]
        );
    }

    #[test]
    fn a_hexadecimal_number_ends_before_a_sum() {
        assert_eq!(
            words("0xe+taps-1e-3*0xfp-2"),
            ["0xe", "+", "taps", "-", "1e-3", "*", "0xfp-2"]
        );
    }

    #[test]
    fn any_text_is_split_without_loss_of_order() {
        for text in [
            "/*",
            "/* /*",
            "é+ñ_1",
            "\u{85}//\u{2028}x",
            "1.",
            "\"€\"",
            "/",
        ] {
            let found = tokens(text);
            assert!(found.windows(2).all(|w| w[0].range.end <= w[1].range.start));
            assert!(
                found
                    .iter()
                    .all(|t| !t.range.is_empty() && text.get(t.range.clone()).is_some())
            );
        }
    }
}
