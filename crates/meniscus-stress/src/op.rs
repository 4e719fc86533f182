//! The register code that a function becomes: what the evaluator's machine runs.
//!
//! Registers hold a number for each lane. There are two files of them, one for what WGSL calls
//! `f32` and one for `i32`, `u32` (as bits) and `bool` (0 or 1). Structures, vectors and arrays
//! exist only while compiling: each of their numbers has a register of its own.

use crate::number::{Elementary, Whole};

/// Lanes that run together; a mask of them fits a `u64`.
pub(crate) const LANES: usize = 64;

/// Number of a register in one of the two files.
pub(crate) type Register = u32;

/// Stands where a register may be absent.
pub(crate) const NONE: Register = u32::MAX;

/// Marks registers of the pool of constants until their place is known.
pub(crate) const CONSTANT: Register = 1 << 30;

/// A register and its file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Leaf {
    Float(Register),
    Int(Register),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Float1 {
    Negate,
    Magnitude,
    Sign,
    Root,
    InverseRoot,
    Quantize,
    Whole(Whole),
    Elementary(Elementary),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Float2 {
    Plus,
    Minus,
    Times,
    Over,
    Smaller,
    Larger,
    Power,
    Angle,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Compare {
    Less,
    LessEqual,
    Equal,
    NotEqual,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Int1 {
    Negate,
    Not,
    LogicalNot,
    ToBool,
    Magnitude,
    Sign,
    LeadingZeros,
    TrailingZeros,
    Ones,
    Reverse,
    FirstTrailing,
    FirstLeadingSigned,
    FirstLeadingUnsigned,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Int2 {
    Plus,
    Minus,
    Times,
    OverSigned,
    OverUnsigned,
    RemainderSigned,
    RemainderUnsigned,
    And,
    Or,
    Xor,
    ShiftLeft,
    ShiftRightSigned,
    ShiftRightUnsigned,
    LessSigned,
    LessUnsigned,
    LessEqualSigned,
    LessEqualUnsigned,
    Equal,
    NotEqual,
    SmallerSigned,
    SmallerUnsigned,
    LargerSigned,
    LargerUnsigned,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Axis {
    X,
    Y,
    Width,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum AtomicKind {
    Add,
    Subtract,
    And,
    Or,
    Xor,
    MinSigned,
    MinUnsigned,
    MaxSigned,
    MaxUnsigned,
    Exchange,
    CompareExchange,
}

/// Where memory lies that lanes share.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Memory {
    /// A buffer, by its slot among the resources.
    Buffer(u32),
    /// The workgroup's.
    Workgroup,
}

/// A place in shared memory, in words: a constant plus a register where there is one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Address {
    pub memory: Memory,
    pub offset: u32,
    pub register: Register,
}

#[derive(Debug, Clone, Copy)]
pub(crate) enum Op {
    Float1 {
        f: Float1,
        to: Register,
        a: Register,
    },
    Float2 {
        f: Float2,
        to: Register,
        a: Register,
        b: Register,
    },
    Fused {
        to: Register,
        a: Register,
        b: Register,
        c: Register,
    },
    Compare {
        f: Compare,
        to: Register,
        a: Register,
        b: Register,
    },
    IsNan {
        to: Register,
        a: Register,
    },
    IsInfinite {
        to: Register,
        a: Register,
    },
    SelectFloat {
        to: Register,
        condition: Register,
        yes: Register,
        no: Register,
    },
    MoveFloat {
        to: Register,
        from: Register,
    },
    /// A move in the active lanes only.
    StoreFloat {
        to: Register,
        from: Register,
    },
    /// `to` = the register of the list that `index` names, lane by lane.
    PickFloat {
        to: Register,
        index: Register,
        list: u32,
    },
    /// The register of the list that `index` names = `from`, in the active lanes.
    PutFloat {
        list: u32,
        index: Register,
        from: Register,
    },
    FloatToSigned {
        to: Register,
        a: Register,
    },
    FloatToUnsigned {
        to: Register,
        a: Register,
    },
    SignedToFloat {
        to: Register,
        a: Register,
    },
    UnsignedToFloat {
        to: Register,
        a: Register,
    },
    FloatBits {
        to: Register,
        a: Register,
    },
    BitsFloat {
        to: Register,
        a: Register,
    },
    HalfBits {
        to: Register,
        a: Register,
    },
    BitsHalf {
        to: Register,
        a: Register,
    },
    /// The exponent that `frexp` returns.
    Exponent {
        to: Register,
        a: Register,
    },
    /// `a` · 2^`exponent`
    Scale {
        to: Register,
        a: Register,
        exponent: Register,
    },
    Derivative {
        axis: Axis,
        coarse: bool,
        to: Register,
        a: Register,
    },

    Int1 {
        f: Int1,
        to: Register,
        a: Register,
    },
    Int2 {
        f: Int2,
        to: Register,
        a: Register,
        b: Register,
    },
    Extract {
        signed: bool,
        to: Register,
        a: Register,
        offset: Register,
        count: Register,
    },
    Insert {
        to: Register,
        a: Register,
        b: Register,
        offset: Register,
        count: Register,
    },
    SelectInt {
        to: Register,
        condition: Register,
        yes: Register,
        no: Register,
    },
    MoveInt {
        to: Register,
        from: Register,
    },
    StoreInt {
        to: Register,
        from: Register,
    },
    PickInt {
        to: Register,
        index: Register,
        list: u32,
    },
    PutInt {
        list: u32,
        index: Register,
        from: Register,
    },

    LoadFloat {
        to: Register,
        at: Address,
    },
    LoadInt {
        to: Register,
        at: Address,
    },
    SaveFloat {
        at: Address,
        from: Register,
    },
    SaveInt {
        at: Address,
        from: Register,
    },
    /// The number of elements of an array at the end of a buffer.
    Length {
        to: Register,
        slot: u32,
        offset: u32,
        stride: u32,
    },
    /// `compare` is used by the exchange that compares alone, `swapped` too.
    Atomic {
        f: AtomicKind,
        at: Address,
        value: Register,
        compare: Register,
        to: Register,
        swapped: Register,
    },
    Image {
        index: u32,
    },

    /// Lanes where the condition fails wait in `rest`; goes on at `end` where none is left.
    If {
        condition: Register,
        rest: u32,
        end: u32,
    },
    /// The active lanes wait in `done`; those of `rest` go on.
    Else {
        done: u32,
        rest: u32,
        end: u32,
    },
    /// The lanes of the mask come back.
    Join {
        mask: u32,
    },
    /// The active lanes go away into the mask.
    Leave {
        mask: u32,
    },
    Clear {
        mask: u32,
    },
    Save {
        mask: u32,
    },
    /// Those of the mask where the condition holds become the active lanes.
    Enter {
        mask: u32,
        condition: Register,
        end: u32,
    },
    SkipIfNone {
        end: u32,
    },
    LoopStart {
        counter: u32,
        broken: u32,
    },
    LoopHead {
        counter: u32,
        continued: u32,
    },
    BreakIf {
        condition: Register,
        broken: u32,
    },
    Again {
        head: u32,
    },
    Barrier,
}

/// Which level of a texture is sampled.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Level {
    Zero,
    Exact(Leaf),
    Auto,
    Bias(Register),
    Gradient { x: [Register; 3], y: [Register; 3] },
}

/// What is read from or written to a texture. Absent coordinates are [`NONE`].
#[derive(Debug, Clone)]
pub(crate) enum ImageOp {
    Load {
        image: u32,
        at: [Register; 3],
        layer: Register,
        level: Register,
        to: Vec<Leaf>,
    },
    Store {
        image: u32,
        format: naga::StorageFormat,
        at: [Register; 3],
        layer: Register,
        from: Vec<Leaf>,
    },
    Sample {
        image: u32,
        sampler: u32,
        at: [Register; 3],
        layer: Register,
        offset: [i32; 3],
        level: Level,
        compare: Register,
        gather: Option<u8>,
        clamp_to_edge: bool,
        to: Vec<Leaf>,
    },
    Size {
        image: u32,
        level: Register,
        to: Vec<Register>,
    },
    Levels {
        image: u32,
        to: Register,
    },
    Layers {
        image: u32,
        to: Register,
    },
}
