//! What an item mentions: names, and how deep its expressions go.

use std::ops::Range;

use std::hash::Hasher;

use rustc_hash::FxHasher;

use super::Spelling;
use super::brackets::inside;
use crate::lexer::{Kind, Token};

/// The words of an item by their spellings: a hash table that is not cleared between the items of a
/// text, since what other items left counts as free.
pub(super) struct Spellings {
    /// Item, counted from 1, and place among its spellings; a power of two of them, twice as many as
    /// tokens.
    table: Vec<(u32, u32)>,
    /// Those of all items.
    pub filter: Filter,
}

/// A set of words that may say of a word that it is in it though it is not, and never the other way
/// round.
#[derive(Debug, Clone, Default)]
pub(crate) struct Filter([u64; 16]);

impl Filter {
    fn bit(hash: u64) -> (usize, u64) {
        // The upper bits are the well-mixed ones.
        ((hash >> 60) as usize, 1 << ((hash >> 54) & 63))
    }

    fn add(&mut self, hash: u64) {
        let (word, bit) = Self::bit(hash);
        self.0[word] |= bit;
    }

    /// Whether a word may be in it.
    pub fn may_hold(&self, word: &str) -> bool {
        let (place, bit) = Self::bit(hash(word));
        self.0[place] & bit != 0
    }
}

fn hash(word: &str) -> u64 {
    let mut hasher = FxHasher::default();
    hasher.write(word.as_bytes());
    hasher.finish()
}

impl Spellings {
    /// For a text of so many tokens.
    pub fn new(tokens: usize) -> Self {
        Self {
            table: vec![(0, 0); (2 * tokens).next_power_of_two()],
            filter: Filter::default(),
        }
    }

    /// Adds a word of an item, counted from 1, unless one is there that is spelt so.
    fn add(&mut self, text: &str, item: usize, spelling: Spelling, known: &mut Vec<Spelling>) {
        let word = spelling.of(text);
        let hash = hash(word);
        let last = self.table.len() - 1;
        // The upper bits are the well-mixed ones.
        let mut at = (hash ^ (hash >> 32)) as usize & last;
        loop {
            let (there, place) = self.table[at];
            if there as usize != item {
                self.table[at] = (item as u32, known.len() as u32);
                self.filter.add(hash);
                known.push(spelling);
                return;
            }
            let there = &mut known[place as usize];
            if there.of(text) == word {
                there.called |= spelling.called;
                return;
            }
            at = (at + 1) & last;
        }
    }
}

/// The tokens of an item that are names which may refer to something, and their spellings. Items are
/// counted from 1.
pub(super) fn words(
    text: &str,
    tokens: &[Token],
    range: Range<usize>,
    is_struct: bool,
    (spellings, item): (&mut Spellings, usize),
) -> (Vec<usize>, Vec<Spelling>) {
    let mut found = Vec::with_capacity(range.len() / 2);
    let mut firsts = Vec::with_capacity(range.len().min(64) / 4);
    let mut at = range.start;
    let own = &tokens[..range.end];
    let kind = |index: usize| own.get(index).map(|t| t.kind);
    let mut before = None;
    while let Some(this) = kind(at) {
        if this == Kind::Mark('@') {
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
            before = None;
            continue;
        }
        if this == Kind::Word && before != Some(Kind::Mark('.')) {
            let after = kind(at + 1);
            // A member's declaration, but not the type after the colon.
            let declared = is_struct && at > range.start + 1 && after == Some(Kind::Mark(':'));
            if !declared {
                found.push(at);
                let called = after == Some(Kind::Mark('('));
                let spelling = Spelling::new(&tokens[at].range, called);
                spellings.add(text, item, spelling, &mut firsts);
            }
        }
        before = Some(this);
        at += 1;
    }
    (found, firsts)
}

/// The longest chain of operators, accesses, template lists, `else if`s and brackets in an item, and
/// the token where it is reached.
pub(super) fn longest_chain(text: &str, tokens: &[Token], range: Range<usize>) -> (usize, usize) {
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
            Kind::Word if is(text, &tokens[index], "else") => elses += 1,
            _ => {}
        }
        let length = chain + open.len() + elses;
        if length > longest.0 {
            longest = (length, index);
        }
    }
    longest
}

/// Names after `let`, `var` and `const` within an item's tokens.
pub(super) fn declared<'t>(text: &'t str, tokens: &'t [Token]) -> impl Iterator<Item = &'t str> {
    let keyword = |token: &Token| {
        let keywords = ["let", "var", "const"];
        keywords.iter().any(|keyword| is(text, token, keyword))
    };
    let after = |(index, _): (usize, &Token)| {
        let mut next = index + 1;
        if tokens.get(next).map(|t| t.kind) == Some(Kind::Mark('<')) {
            next += inside(&tokens[next..], '<', '>').len() + 2;
        }
        tokens.get(next).map(|name| &text[name.range.clone()])
    };
    let found = tokens.iter().enumerate().filter(move |(_, t)| keyword(t));
    found.filter_map(after)
}

/// Whether a token is this word.
fn is(text: &str, token: &Token, word: &str) -> bool {
    token.range.len() == word.len() && text[token.range.clone()] == *word
}
