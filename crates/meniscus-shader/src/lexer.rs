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
    // Code has a token in about four bytes, a module's header none in hundreds.
    let mut found = Vec::with_capacity(text.len() / 6);
    let bytes = text.as_bytes();
    let mut at = 0;
    while let Some(&byte) = bytes.get(at) {
        if matches!(byte, b' ' | b'\n') {
            at += 1;
            continue;
        }
        if byte.is_ascii_alphabetic() {
            let length = word(&text[at..]);
            found.push(Token {
                kind: Kind::Word,
                range: at..at + length,
            });
            at += length;
            continue;
        }
        if byte.is_ascii_punctuation() && !matches!(byte, b'/' | b'.' | b'_') {
            found.push(Token {
                kind: Kind::Mark(byte.into()),
                range: at..at + 1,
            });
            at += 1;
            continue;
        }
        let rest = &text[at..];
        let Some(c) = rest.chars().next() else { break };
        let (kind, length) = if c.is_whitespace() {
            (None, c.len_utf8())
        } else if rest.starts_with("//") {
            (None, line(rest))
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

/// For each byte, whether it is an ASCII character of a word.
const IN_WORD: [bool; 256] = {
    let mut table = [false; 256];
    let mut byte = 0_u8;
    while byte < 128 {
        table[byte as usize] = byte == b'_' || byte.is_ascii_alphanumeric();
        byte += 1;
    }
    table
};

/// Length of the word that a text begins with.
fn word(text: &str) -> usize {
    let bytes = text.as_bytes();
    let others = |&byte: &u8| !IN_WORD[byte as usize];
    let ascii = bytes.iter().position(others).unwrap_or(bytes.len());
    if bytes.get(ascii).is_none_or(u8::is_ascii) {
        return ascii;
    }
    text.find(|c| !(c == '_' || unicode_continue(c)))
        .unwrap_or(text.len())
}

/// Length of a line, without its break.
fn line(text: &str) -> usize {
    let bytes = text.as_bytes();
    let mut at = 0;
    loop {
        // All line breaks begin with one of these bytes; most of the time none does.
        let candidate = bytes[at..]
            .iter()
            .position(|b| matches!(b, b'\n' | 0x0b | 0x0c | b'\r' | 0xc2 | 0xe2));
        let Some(offset) = candidate else {
            return bytes.len();
        };
        at += offset;
        if text[at..].starts_with(is_line_break) {
            return at;
        }
        at += text[at..].chars().next().map_or(1, char::len_utf8);
    }
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
