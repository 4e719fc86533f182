//! A seeded, cheap fuzzer: texts that differ a little from honest ones, over and over.
//!
//! A hundred thousand cases are run as a rule; `MENISCUS_FUZZ=5000000` runs as many.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

/// How many cases are run unless the environment says otherwise.
const CASES: u64 = 100_000;
/// The longest text that is tried, bytes.
const LONGEST: usize = 1 << 15;

/// Knuth's MMIX generator, with its upper bits.
pub struct Random(u64);

impl Random {
    /// A number below `end`, which is not 0.
    fn below(&mut self, end: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % end
    }

    fn one_of<'t, T>(&mut self, items: &'t [T]) -> &'t T {
        &items[self.below(items.len())]
    }
}

/// Bytes that parsers stumble over.
const BYTES: &[&[u8]] = &[
    b"\0",
    b"\r\n",
    b"\r",
    b"\"",
    b"\\",
    b"/*",
    b"*/",
    b"//",
    b"{",
    b"}",
    b"((((((((",
    b"))))",
    b"[",
    b"]",
    b"<",
    b">",
    b",",
    b";",
    b":",
    b"=",
    b"@",
    b".",
    b"-",
    b"0x",
    b"1e999",
    b"-0.0",
    b"NaN",
    b"inf",
    b"18446744073709551616",
    b"\xef\xbb\xbf",
    b"\xe2\x80\xa8",
    b"\xc2\x85",
    b"\xf0\x9f\x8c\x8a",
    b"\xcc\x81",
    b"\xff",
    b"\xed\xa0\x80",
    b"r#\"",
    b"'",
    b"#![enable(",
];

/// Takes honest texts, and words to put among theirs, and makes others of them.
pub struct Mutator<'t> {
    corpus: &'t [String],
    words: &'t [&'t str],
}

impl<'t> Mutator<'t> {
    /// The corpus has a text at least, and the words one.
    pub fn new(corpus: &'t [String], words: &'t [&'t str]) -> Self {
        assert!(!corpus.is_empty() && !words.is_empty());
        Self { corpus, words }
    }

    fn text(&self, random: &mut Random) -> String {
        let mut text = random.one_of(self.corpus).clone().into_bytes();
        for _ in 0..1 + random.below(6) {
            match random.below(3) {
                0 => self.change_bytes(&mut text, random),
                _ => self.change_words(&mut text, random),
            }
            text.truncate(LONGEST);
        }
        String::from_utf8_lossy(&text).into_owned()
    }

    fn change_bytes(&self, text: &mut Vec<u8>, random: &mut Random) {
        let from = random.below(text.len() + 1);
        let to = (from + random.below(40)).min(text.len());
        match random.below(6) {
            0 => drop(text.drain(from..to)),
            1 => text.truncate(from),
            2 => drop(text.splice(from..from, random.one_of(BYTES).iter().copied())),
            3 => {
                let copy = text[from..to].to_vec();
                let often = 1 + random.below(50);
                drop(text.splice(to..to, copy.repeat(often)));
            }
            4 => {
                let other = random.one_of(self.corpus).as_bytes();
                let start = random.below(other.len() + 1);
                text.truncate(from);
                text.extend(&other[start..]);
            }
            _ => {
                if let Some(byte) = text.get_mut(from) {
                    *byte ^= 1 << random.below(8);
                }
            }
        }
    }

    /// Exchanges, drops, repeats and puts in whole words and marks.
    fn change_words(&self, text: &mut Vec<u8>, random: &mut Random) {
        let in_word = |byte: u8| byte == b'_' || byte.is_ascii_alphanumeric();
        let word = |text: &[u8], at: usize| {
            let inside = text.get(at).is_some_and(|b| in_word(*b));
            let before = text[..at]
                .iter()
                .rev()
                .take_while(|b| inside && in_word(**b));
            let start = at - before.count();
            let length = text[at..].iter().take_while(|b| in_word(**b)).count();
            start..(at + length.max(1)).min(text.len())
        };
        let at = random.below(text.len() + 1);
        let first = word(text, at);
        let at = random.below(text.len() + 1);
        let second = word(text, at);
        let new = match random.below(5) {
            0 => Vec::new(),
            1 => random.one_of(self.words).as_bytes().to_vec(),
            2 => text[second].to_vec(),
            3 => text[first.clone()].repeat(2),
            _ => [
                &text[first.clone()],
                b" ",
                random.one_of(self.words).as_bytes(),
            ]
            .concat(),
        };
        text.splice(first, new);
    }

    /// Runs cases; `survive` must come back from every text, and gets the number of the case.
    ///
    /// # Panics
    /// With the text, when it panics. How long the longest takes is printed.
    pub fn run(&self, share: u64, survive: impl Fn(u64, &str)) {
        let cases = std::env::var("MENISCUS_FUZZ").ok();
        let cases = cases.and_then(|n| n.parse().ok()).unwrap_or(CASES) / share;
        let start = Instant::now();
        let mut slowest = (Duration::ZERO, 0);
        for case in 0..cases {
            // A case by its number is always the same.
            let mut random = Random(case.wrapping_mul(0x9e37_79b9_7f4a_7c15));
            random.below(2);
            let text = self.text(&mut random);
            let began = Instant::now();
            let outcome = catch_unwind(AssertUnwindSafe(|| survive(case, &text)));
            let took = began.elapsed();
            assert!(outcome.is_ok(), "case {case} panics:\n{text}");
            slowest = slowest.max((took, case));
        }
        let (longest, which) = slowest;
        let all = start.elapsed();
        println!("{cases} cases in {all:.1?}; the longest, {which}, in {longest:.1?}");
    }
}
