//! The rules by which something is left out of a plan.

/// Why something is left out. Each rule is tested by itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Rule {
    /// A pass's own `when` chooses another way of making the same picture.
    When,
    /// A draw of a side of the water of which nothing may be seen.
    UnseenSide,
    /// A pass over pixels that may show water, where no pixel does.
    NoWater,
    /// A pass over pixels that cannot show water, where every pixel may.
    AllWater,
    /// A shortcut's passes run instead: see [`crate::Shortcut`].
    Shortcut,
    /// A pass over a list to which nothing is ever added.
    EmptyList,
    /// A pass that writes nothing which is read later, comes out, or is counted.
    Unread,
    /// A texture or buffer that no pass reads or writes.
    Unused,
    /// Triangles of a pass of which nothing can be in its view: see [`crate::Cull`].
    OutOfView,
}

/// What a rule promises of the pictures with and without what it leaves out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Promise {
    /// They are made of different declarations: there is no picture without the choice.
    Choice,
    /// Every output holds the same bits.
    Exact,
    /// What is shown moves by no more than so many pixels.
    Within(f64),
}

impl Rule {
    /// Every rule.
    pub const ALL: [Self; 9] = [
        Self::When,
        Self::UnseenSide,
        Self::NoWater,
        Self::AllWater,
        Self::Shortcut,
        Self::EmptyList,
        Self::Unread,
        Self::Unused,
        Self::OutOfView,
    ];

    /// Its name in explanations.
    pub const fn name(self) -> &'static str {
        match self {
            Self::When => "when",
            Self::UnseenSide => "unseen side",
            Self::NoWater => "no water",
            Self::AllWater => "all water",
            Self::Shortcut => "shortcut",
            Self::EmptyList => "empty list",
            Self::Unread => "unread",
            Self::Unused => "unused",
            Self::OutOfView => "out of view",
        }
    }

    /// What it says, in a sentence.
    pub const fn says(self) -> &'static str {
        match self {
            Self::When => "a pass runs where its own `when` holds",
            Self::UnseenSide => {
                "a side of the water of which nothing may be seen need not be drawn"
            }
            Self::NoWater => "where no pixel may show water, nothing runs over those that do",
            Self::AllWater => "where every pixel may show water, nothing runs over the others",
            Self::Shortcut => "shorter passes run instead of those that would change nothing",
            Self::EmptyList => "nothing runs over a list to which no pass adds",
            Self::Unread => "what nobody reads need not be made",
            Self::Unused => "what no pass uses takes no memory",
            Self::OutOfView => "triangles that cannot appear in a pass's view are not drawn by it",
        }
    }

    /// What it promises where it leaves something out; `within_px` is what a shortcut's modules say.
    pub fn promise(self, within_px: f64) -> Promise {
        match self {
            Self::When => Promise::Choice,
            Self::Shortcut if within_px > 0.0 => Promise::Within(within_px),
            _ => Promise::Exact,
        }
    }
}

/// A pass that is left out.
#[derive(Debug, Clone, PartialEq)]
pub struct Dropped {
    /// The pass's name in the pipeline.
    pub pass: String,
    /// The rule.
    pub rule: Rule,
    /// The facts, or whatever else the rule refers to, in words.
    pub because: String,
    /// By how much of a pixel what is shown may move.
    pub within_px: f64,
}

impl Dropped {
    pub(crate) fn exactly(pass: &str, rule: Rule, because: impl Into<String>) -> Self {
        Self {
            pass: pass.to_owned(),
            rule,
            because: because.into(),
            within_px: 0.0,
        }
    }
}
