//! Runs register code: 64 lanes at a time, those that are not meant masked out.

mod float;
mod image;
mod int;
mod memory;

use crate::code::Code;
use crate::error::Trap;
use crate::number::Scalar;
use crate::op::{LANES, Op, Register};
pub(crate) use memory::{Bound, Connected, Shared};

/// A number in each lane.
pub(crate) type Column<T> = [T; LANES];

/// Watches a run, operation by operation.
pub(crate) trait Observer<S> {
    /// An operation has just been done; `floats` holds its operands and its result.
    fn after(&mut self, _at: usize, _floats: &[Column<S>], _active: u64) {}
}

/// Sees nothing.
pub(crate) struct Blind;

impl<S> Observer<S> for Blind {}

/// Why the machine stopped.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Stop {
    /// The code has ended.
    End,
    /// All lanes of the workgroup must come here.
    Barrier,
}

/// Registers and masks of 64 lanes.
#[derive(Debug)]
pub(crate) struct Machine<'c, S> {
    code: &'c Code,
    pub(crate) floats: Vec<Column<S>>,
    pub(crate) ints: Vec<Column<u32>>,
    masks: Vec<u64>,
    counters: Vec<u32>,
    active: u64,
    launched: u64,
    /// Lanes that may write to what others see; the rest only helps with derivatives.
    writing: u64,
    /// The active lanes as all ones, where `fresh` says so.
    active_words: Column<u32>,
    fresh: bool,
    next: usize,
    /// Lanes where a comparison was too close to call.
    pub(crate) undecided: u64,
}

impl<'c, S: Scalar> Machine<'c, S> {
    pub(crate) fn new(code: &'c Code) -> Self {
        let mut floats = vec![[S::default(); LANES]; code.floats as usize];
        let mut ints = vec![[0; LANES]; code.ints as usize];
        for (column, &constant) in floats.iter_mut().zip(&code.float_constants) {
            *column = [S::from_f64(constant); LANES];
        }
        for (column, &constant) in ints.iter_mut().zip(&code.int_constants) {
            *column = [constant; LANES];
        }
        Self {
            code,
            floats,
            ints,
            masks: vec![0; code.masks as usize],
            counters: vec![0; code.counters as usize],
            active: 0,
            launched: 0,
            writing: u64::MAX,
            active_words: [0; LANES],
            fresh: false,
            next: 0,
            undecided: 0,
        }
    }

    /// Starts anew with the first `lanes` lanes, of which those of a mask may write.
    pub(crate) fn launch_quads(&mut self, lanes: usize, writing: u64) {
        self.launch(lanes);
        self.writing = writing;
    }

    /// Starts anew with the first `lanes` lanes.
    pub(crate) fn launch(&mut self, lanes: usize) {
        self.writing = u64::MAX;
        self.launched = if lanes >= LANES {
            u64::MAX
        } else {
            (1 << lanes) - 1
        };
        self.set_active(self.launched);
        self.masks.fill(0);
        self.counters.fill(0);
        self.undecided = 0;
        self.next = 0;
    }

    /// Lanes that `discard` ended.
    pub(crate) fn discarded(&self) -> u64 {
        self.masks[0]
    }

    /// Runs code that needs nothing and cannot fail.
    pub(crate) fn run_constant(&mut self) {
        self.launch(1);
        let mut shared = Shared::default();
        // Constant expressions hold neither loops nor resources.
        let _ = self.run(&Bound::default(), &mut shared, &mut Blind);
    }

    fn set_active(&mut self, active: u64) {
        self.active = active;
        self.fresh = false;
    }

    /// The lanes where a truth value is true.
    fn lanes_where(&self, condition: Register) -> u64 {
        let column = &self.ints[condition as usize];
        let mut bits = 0;
        for (i, eight) in column.chunks_exact(8).enumerate() {
            let mut byte = 0_u64;
            for (j, &truth) in eight.iter().enumerate() {
                byte |= u64::from(truth & 1) << j;
            }
            bits |= byte << (8 * i);
        }
        bits
    }

    /// The active lanes as words of all ones.
    fn active_words(&mut self) -> &Column<u32> {
        if !self.fresh {
            for (i, word) in self.active_words.iter_mut().enumerate() {
                *word = ((self.active >> i & 1) as u32).wrapping_neg();
            }
            self.fresh = true;
        }
        &self.active_words
    }

    fn active_lanes(&self) -> impl Iterator<Item = usize> + use<'c, S> {
        ones(self.active)
    }

    fn writing_lanes(&self) -> impl Iterator<Item = usize> + use<'c, S> {
        ones(self.active & self.writing)
    }

    /// Runs to the end or to a barrier.
    pub(crate) fn run<O: Observer<S>>(
        &mut self,
        bound: &Bound<'_>,
        shared: &mut Shared<S>,
        observer: &mut O,
    ) -> Result<Stop, Trap> {
        let code = self.code;
        while let Some(op) = code.ops.get(self.next) {
            let at = self.next;
            self.next += 1;
            match *op {
                Op::Float1 { .. }
                | Op::Float2 { .. }
                | Op::Fused { .. }
                | Op::Compare { .. }
                | Op::IsNan { .. }
                | Op::IsInfinite { .. }
                | Op::SelectFloat { .. }
                | Op::MoveFloat { .. }
                | Op::StoreFloat { .. }
                | Op::PickFloat { .. }
                | Op::PutFloat { .. }
                | Op::FloatToSigned { .. }
                | Op::FloatToUnsigned { .. }
                | Op::SignedToFloat { .. }
                | Op::UnsignedToFloat { .. }
                | Op::FloatBits { .. }
                | Op::BitsFloat { .. }
                | Op::HalfBits { .. }
                | Op::BitsHalf { .. }
                | Op::Exponent { .. }
                | Op::Scale { .. }
                | Op::Derivative { .. } => {
                    self.float(op);
                    observer.after(at, &self.floats, self.active);
                }
                Op::Int1 { .. }
                | Op::Int2 { .. }
                | Op::Extract { .. }
                | Op::Insert { .. }
                | Op::SelectInt { .. }
                | Op::MoveInt { .. }
                | Op::StoreInt { .. }
                | Op::PickInt { .. }
                | Op::PutInt { .. } => self.int(op),
                Op::LoadFloat { .. }
                | Op::LoadInt { .. }
                | Op::SaveFloat { .. }
                | Op::SaveInt { .. }
                | Op::Length { .. }
                | Op::Atomic { .. } => self.memory(op, bound, shared),
                Op::Image { index } => self.image(index, bound),
                Op::Barrier => return Ok(Stop::Barrier),
                _ => self.control(op, at)?,
            }
        }
        Ok(Stop::End)
    }

    fn control(&mut self, op: &Op, at: usize) -> Result<(), Trap> {
        match *op {
            Op::If {
                condition,
                rest,
                end,
            } => {
                let chosen = self.active & self.lanes_where(condition);
                self.masks[rest as usize] = self.active & !chosen;
                self.set_active(chosen);
                if chosen == 0 {
                    self.next = end as usize;
                }
            }
            Op::Else { done, rest, end } => {
                self.masks[done as usize] = self.active;
                let rest = self.masks[rest as usize];
                self.set_active(rest);
                if rest == 0 {
                    self.next = end as usize;
                }
            }
            Op::Join { mask } => {
                let back = self.masks[mask as usize];
                if back & !self.active != 0 {
                    self.set_active(self.active | back);
                }
            }
            Op::Leave { mask } => {
                self.masks[mask as usize] |= self.active;
                self.set_active(0);
            }
            Op::Clear { mask } => self.masks[mask as usize] = 0,
            Op::Save { mask } => self.masks[mask as usize] = self.active,
            Op::Enter {
                mask,
                condition,
                end,
            } => {
                let chosen = self.masks[mask as usize] & self.lanes_where(condition);
                self.set_active(chosen);
                if chosen == 0 {
                    self.next = end as usize;
                }
            }
            Op::SkipIfNone { end } if self.active == 0 => self.next = end as usize,
            Op::LoopStart { counter, broken } => {
                self.counters[counter as usize] = 0;
                self.masks[broken as usize] = 0;
            }
            Op::LoopHead { counter, continued } => {
                self.masks[continued as usize] = 0;
                let round = &mut self.counters[counter as usize];
                *round += 1;
                if *round > self.code.loop_cap {
                    let (site, cap) = (self.code.site(at), self.code.loop_cap);
                    return Err(Trap::EndlessLoop { site, cap });
                }
            }
            Op::BreakIf { condition, broken } => {
                let out = self.active & self.lanes_where(condition);
                self.masks[broken as usize] |= out;
                self.set_active(self.active & !out);
            }
            Op::Again { head } if self.active != 0 => self.next = head as usize,
            // The others are done before.
            _ => {}
        }
        Ok(())
    }
}

/// The places of a word's ones, lowest first.
fn ones(mut left: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = left.trailing_zeros() as usize;
        left &= left.wrapping_sub(1);
        (lane < LANES).then_some(lane)
    })
}
