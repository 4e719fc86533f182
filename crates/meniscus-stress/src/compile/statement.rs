//! Statements: control flow by masks of lanes.

use naga::{AtomicFunction, Block, Expression, Handle, Statement, SwitchCase, SwitchValue};

use super::builder::{Builder, Place, Result, Value};
use super::types;
use crate::op::{AtomicKind, Int1, Int2, Leaf, NONE, Op, Register};
use crate::shape::Kind;

/// Blocks nested deeper than this are refused, so that compiling needs a bounded stack.
const MOST_NESTED: usize = 200;

/// Jumps to the end of the block that holds them.
type Exits = Vec<usize>;

impl Builder<'_> {
    /// Writes a block down. Registers taken in it are free again behind it.
    pub(super) fn block(&mut self, block: &Block) -> Result<()> {
        let level = self.level();
        let mut exits = Exits::new();
        self.statements(block, &mut exits)?;
        self.land(&exits);
        self.release(level);
        Ok(())
    }

    pub(super) fn land(&mut self, exits: &[usize]) {
        let end = self.next_op();
        for &exit in exits {
            self.aim(exit, end);
        }
    }

    pub(super) fn statements(&mut self, block: &Block, exits: &mut Exits) -> Result<()> {
        self.frame()?.depth += 1;
        if self.frame()?.depth > MOST_NESTED {
            return self.unsupported(format!("a block nested deeper than {MOST_NESTED}"));
        }
        for (statement, span) in block.span_iter() {
            self.go_to(*span);
            self.check_size()?;
            self.statement(statement, *span, exits)?;
        }
        self.frame()?.depth -= 1;
        Ok(())
    }

    fn statement(
        &mut self,
        statement: &Statement,
        span: naga::Span,
        exits: &mut Exits,
    ) -> Result<()> {
        match *statement {
            Statement::Emit(ref range) => {
                let function = self.frame()?.function;
                for handle in range.clone() {
                    self.go_to(function.expressions.get_span(handle));
                    self.emit(handle)?;
                }
                Ok(())
            }
            Statement::Block(ref block) => self.statements(block, exits),
            Statement::If {
                condition,
                ref accept,
                ref reject,
            } => {
                self.branch(condition, accept, reject)?;
                self.skip_if_none(exits);
                Ok(())
            }
            Statement::Switch {
                selector,
                ref cases,
            } => {
                self.switch(selector, cases)?;
                self.skip_if_none(exits);
                Ok(())
            }
            Statement::Loop {
                ref body,
                ref continuing,
                break_if,
            } => {
                self.endless(body, continuing, break_if, span)?;
                self.skip_if_none(exits);
                Ok(())
            }
            Statement::Break => {
                let mask = self.frame()?.breaks.last().copied();
                self.leave(mask, exits)
            }
            Statement::Continue => {
                let mask = self.frame()?.continues.last().copied();
                self.leave(mask, exits)
            }
            Statement::Kill => self.leave(Some(0), exits),
            Statement::Return { value } => self.give_back(value, exits),
            Statement::ControlBarrier(_) => {
                self.push(Op::Barrier);
                Ok(())
            }
            // Lanes and workgroups see each other's writes at once.
            Statement::MemoryBarrier(_) => Ok(()),
            Statement::Store { pointer, value } => {
                let from = self.leaves(value)?;
                let Value::Place(place) = self.value(pointer)? else {
                    return self.wrong();
                };
                let Some(inner) = types::pointee(self.module, self.type_of(pointer)) else {
                    return self.wrong();
                };
                self.store(&place, &inner, &from)
            }
            Statement::ImageStore {
                image,
                coordinate,
                array_index,
                value,
            } => self.image_store(image, coordinate, array_index, value),
            Statement::Atomic {
                pointer,
                fun,
                value,
                result,
            } => self.atomic(pointer, fun, value, result),
            Statement::WorkGroupUniformLoad { pointer, result } => {
                self.push(Op::Barrier);
                let Value::Place(place) = self.value(pointer)? else {
                    return self.wrong();
                };
                let Some(inner) = types::pointee(self.module, self.type_of(pointer)) else {
                    return self.wrong();
                };
                let leaves = self.load(&place, &inner)?;
                self.push(Op::Barrier);
                self.set(result, Value::Leaves(leaves))
            }
            Statement::Call {
                function,
                ref arguments,
                result,
            } => {
                let returned = self.call(function, arguments)?;
                self.skip_if_none(exits);
                match result {
                    Some(result) => self.set(result, Value::Leaves(returned)),
                    None => Ok(()),
                }
            }
            Statement::ImageAtomic { .. } => self.unsupported("an atomic operation on a texture"),
            Statement::RayQuery { .. } | Statement::RayPipelineFunction(_) => {
                self.unsupported("a ray query")
            }
            Statement::SubgroupBallot { .. }
            | Statement::SubgroupGather { .. }
            | Statement::SubgroupCollectiveOperation { .. } => {
                self.unsupported("a subgroup operation")
            }
            Statement::CooperativeStore { .. } => self.unsupported("a cooperative matrix"),
        }
    }

    /// Computes an expression now, whatever it was before: in a loop it may be another time round.
    fn emit(&mut self, handle: Handle<Expression>) -> Result<()> {
        let value = self.compute(handle)?;
        self.set(handle, value)
    }

    pub(super) fn set(&mut self, handle: Handle<Expression>, value: Value) -> Result<()> {
        match self.frame()?.values.get_mut(handle.index()) {
            Some(slot) => {
                *slot = Some(value);
                Ok(())
            }
            None => self.wrong(),
        }
    }

    fn skip_if_none(&mut self, exits: &mut Exits) {
        exits.push(self.push(Op::SkipIfNone { end: 0 }));
    }

    pub(super) fn leave(&mut self, mask: Option<u32>, exits: &mut Exits) -> Result<()> {
        let Some(mask) = mask else {
            return self.wrong();
        };
        self.push(Op::Leave { mask });
        self.skip_if_none(exits);
        Ok(())
    }

    fn branch(
        &mut self,
        condition: Handle<Expression>,
        accept: &Block,
        reject: &Block,
    ) -> Result<()> {
        let condition = self.single_int(condition)?;
        let rest = self.mask();
        let test = self.push(Op::If {
            condition,
            rest,
            end: 0,
        });
        self.block(accept)?;
        if reject.is_empty() {
            let end = self.next_op();
            self.aim(test, end);
            self.push(Op::Join { mask: rest });
            return Ok(());
        }
        let done = self.mask();
        let turn = self.push(Op::Else { done, rest, end: 0 });
        self.aim(test, turn as u32);
        self.block(reject)?;
        let end = self.next_op();
        self.aim(turn, end);
        self.push(Op::Join { mask: done });
        Ok(())
    }

    fn switch(&mut self, selector: Handle<Expression>, cases: &[SwitchCase]) -> Result<()> {
        let level = self.level();
        let selector = self.single_int(selector)?;
        let (entered, done) = (self.mask(), self.mask());
        self.push(Op::Save { mask: entered });
        self.push(Op::Clear { mask: done });
        // Cases that fall through are empty in WGSL: they share the body of the next that is not.
        let mut conditions: Vec<Option<Register>> = Vec::new();
        let (mut group, mut is_default) = (None, false);
        let mut groups = Vec::new();
        for case in cases {
            match case.value {
                SwitchValue::Default => is_default = true,
                SwitchValue::I32(n) => group = Some(self.either(group, selector, n as u32)),
                SwitchValue::U32(n) => group = Some(self.either(group, selector, n)),
            }
            if case.fall_through {
                if !case.body.is_empty() {
                    return self.unsupported("a case that falls through");
                }
                continue;
            }
            conditions.push(group);
            groups.push((group, is_default, &case.body));
            (group, is_default) = (None, false);
        }
        let mut any = self.int_constant(0);
        for condition in conditions.iter().flatten() {
            any = self.int2(Int2::Or, any, *condition);
        }
        let none = self.int1(Int1::LogicalNot, any);
        self.frame()?.breaks.push(done);
        for (condition, is_default, body) in groups {
            let condition = match (condition, is_default) {
                (Some(condition), false) => condition,
                (Some(condition), true) => self.int2(Int2::Or, condition, none),
                (None, _) => none,
            };
            let enter = self.push(Op::Enter {
                mask: entered,
                condition,
                end: 0,
            });
            self.block(body)?;
            self.push(Op::Leave { mask: done });
            let end = self.next_op();
            self.aim(enter, end);
        }
        self.frame()?.breaks.pop();
        self.push(Op::Join { mask: done });
        self.release(level);
        Ok(())
    }

    fn either(&mut self, so_far: Option<Register>, selector: Register, value: u32) -> Register {
        let value = self.int_constant(value);
        let this = self.int2(Int2::Equal, selector, value);
        so_far.map_or(this, |so_far| self.int2(Int2::Or, so_far, this))
    }

    fn endless(
        &mut self,
        body: &Block,
        continuing: &Block,
        break_if: Option<Handle<Expression>>,
        span: naga::Span,
    ) -> Result<()> {
        let level = self.level();
        let (broken, continued) = (self.mask(), self.mask());
        let counter = self.code.counters;
        self.code.counters += 1;
        self.push(Op::LoopStart { counter, broken });
        let head = self.next_op();
        self.push(Op::LoopHead { counter, continued });
        self.frame()?.breaks.push(broken);
        self.frame()?.continues.push(continued);
        // What the body computes is in scope in `continuing`: one level for both.
        let mut exits = Exits::new();
        self.statements(body, &mut exits)?;
        self.land(&exits);
        self.push(Op::Join { mask: continued });
        self.frame()?.continues.pop();
        let mut exits = Exits::new();
        self.skip_if_none(&mut exits);
        self.statements(continuing, &mut exits)?;
        if let Some(condition) = break_if {
            let condition = self.single_int(condition)?;
            self.push(Op::BreakIf { condition, broken });
        }
        self.land(&exits);
        self.go_to(span);
        self.push(Op::Again { head });
        self.frame()?.breaks.pop();
        self.push(Op::Join { mask: broken });
        self.release(level);
        Ok(())
    }

    fn atomic(
        &mut self,
        pointer: Handle<Expression>,
        fun: AtomicFunction,
        value: Handle<Expression>,
        result: Option<Handle<Expression>>,
    ) -> Result<()> {
        let signed = self.kind_of(value)? == Kind::Sint;
        let mut compare = NONE;
        let f = match fun {
            AtomicFunction::Add => AtomicKind::Add,
            AtomicFunction::Subtract => AtomicKind::Subtract,
            AtomicFunction::And => AtomicKind::And,
            AtomicFunction::ExclusiveOr => AtomicKind::Xor,
            AtomicFunction::InclusiveOr => AtomicKind::Or,
            AtomicFunction::Min if signed => AtomicKind::MinSigned,
            AtomicFunction::Min => AtomicKind::MinUnsigned,
            AtomicFunction::Max if signed => AtomicKind::MaxSigned,
            AtomicFunction::Max => AtomicKind::MaxUnsigned,
            AtomicFunction::Exchange { compare: None } => AtomicKind::Exchange,
            AtomicFunction::Exchange {
                compare: Some(expected),
            } => {
                compare = self.single_int(expected)?;
                AtomicKind::CompareExchange
            }
        };
        let Leaf::Int(value) = self.single(value)? else {
            return self.unsupported("an atomic operation on floating-point numbers");
        };
        let Value::Place(Place::Memory(at)) = self.value(pointer)? else {
            return self.wrong();
        };
        let (to, swapped) = (self.int(), self.int());
        self.push(Op::Atomic {
            f,
            at,
            value,
            compare,
            to,
            swapped,
        });
        let Some(result) = result else { return Ok(()) };
        let mut leaves = vec![Leaf::Int(to)];
        if f == AtomicKind::CompareExchange {
            leaves.push(Leaf::Int(swapped));
        }
        self.set(result, Value::Leaves(leaves))
    }
}
