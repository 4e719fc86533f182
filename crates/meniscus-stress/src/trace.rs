//! The WGSL line at which `f32` and `f64` part.

use crate::code::{Code, Site};
use crate::error::Trap;
use crate::function::{Function, bind, result_kinds};
use crate::machine::{Column as Register, Machine, Observer, Shared, Stop};
use crate::number::{Scalar, Shadow};
use crate::op::Op;
use crate::resources::Resources;
use crate::shape::{Column, Lanes};

/// An expression whose `f32` result is further from `f64`'s than its operands were.
#[derive(Debug, Clone, PartialEq)]
pub struct Parting {
    /// The expression.
    pub site: Site,
    /// How far its operands were apart, together, in ulps of `f32`.
    pub arriving: f64,
    /// How far its result is apart, in ulps of `f32`.
    pub leaving: f64,
    /// The result in `f32`.
    pub single: f32,
    /// The result in `f64`.
    pub double: f64,
}

/// Where one lane's `f32` run and its `f64` run part.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    /// The first expression that parts them by more than was asked, beyond what arrives.
    pub first: Option<Parting>,
    /// The expression that parts them most, beyond what arrives.
    pub worst: Option<Parting>,
    /// The first expression whose operands are finite and whose `f32` result is not.
    pub not_finite: Option<Site>,
    /// Comparisons and conversions to integers that come out differently. `f32`'s way is taken.
    pub branches: Vec<Site>,
    /// The result in both.
    pub value: Lanes<Shadow>,
}

impl Function {
    /// Runs one lane in `f32` and `f64` side by side and tells where they part by more than
    /// `ulps` beyond what arrives.
    ///
    /// What arrives is the sum of the operands' errors; twice that is expected, because an error
    /// of half an ulp below a power of two is one of a whole ulp above it.
    ///
    /// # Errors
    ///
    /// As [`call`](Self::call); and [`Trap::ArgumentShape`] where there is no such lane.
    pub fn trace(
        &self,
        arguments: &[Lanes<f32>],
        lane: usize,
        resources: &Resources<'_>,
        ulps: f64,
    ) -> Result<Trace, Trap> {
        let code = self.code();
        let only = |a: &Lanes<f32>| Lanes {
            columns: a.columns.iter().map(|c| one(c, lane)).collect(),
        };
        let arguments: Vec<Lanes<Shadow>> = arguments.iter().map(only).collect();
        self.check(&arguments, 1)?;
        let bound = bind(code, resources)?;
        let mut machine = Machine::<Shadow>::new(code);
        for (argument, given) in code.arguments.iter().zip(&arguments) {
            for (&leaf, column) in argument.leaves.iter().zip(&given.columns) {
                machine.fill(leaf, column, 0, 1);
            }
        }
        machine.launch(1);
        let mut watcher = Watcher {
            code,
            ulps,
            first: None,
            worst: None,
            not_finite: None,
            branches: Vec::new(),
        };
        let mut shared = Shared::new(code.workgroup_words);
        while machine.run(&bound, &mut shared, &mut watcher)? != Stop::End {}
        let mut value = Lanes {
            columns: result_kinds(code)
                .iter()
                .map(|&k| Column::zeros(k, 1))
                .collect(),
        };
        for (&leaf, column) in code.result.iter().zip(&mut value.columns) {
            machine.take(leaf, column, 0, 1);
        }
        let Watcher {
            first,
            worst,
            not_finite,
            branches,
            ..
        } = watcher;
        Ok(Trace {
            first,
            worst,
            not_finite,
            branches,
            value,
        })
    }
}

fn one(column: &Column<f32>, lane: usize) -> Column<Shadow> {
    match column {
        Column::Float(c) => Column::Float(
            c.get(lane)
                .map(|&x| Shadow::from_f32(x))
                .into_iter()
                .collect(),
        ),
        Column::Sint(c) => Column::Sint(c.get(lane).copied().into_iter().collect()),
        Column::Uint(c) => Column::Uint(c.get(lane).copied().into_iter().collect()),
        Column::Bool(c) => Column::Bool(c.get(lane).copied().into_iter().collect()),
    }
}

struct Watcher<'c> {
    code: &'c Code,
    ulps: f64,
    first: Option<Parting>,
    worst: Option<Parting>,
    not_finite: Option<Site>,
    branches: Vec<Site>,
}

impl Watcher<'_> {
    fn parted(&mut self, at: usize, operands: &[Shadow], result: Shadow) {
        let finite = operands.iter().all(|x| x.single.is_finite());
        if self.not_finite.is_none() && finite && !result.single.is_finite() {
            self.not_finite = Some(self.code.site(at));
        }
        let arriving: f64 = operands.iter().map(|x| x.ulps()).sum();
        let leaving = result.ulps();
        // What arrives infinitely far apart is not this expression's fault.
        if !arriving.is_finite() || leaving <= 2.0 * arriving + self.ulps {
            return;
        }
        let site = self.code.site(at);
        let Shadow { single, double } = result;
        let parting = Parting {
            site,
            arriving,
            leaving,
            single,
            double,
        };
        let growth = |p: &Parting| p.leaving - p.arriving;
        if self
            .worst
            .as_ref()
            .is_none_or(|worst| growth(worst) < growth(&parting))
        {
            self.worst = Some(parting.clone());
        }
        self.first.get_or_insert(parting);
    }

    fn branched(&mut self, at: usize) {
        let site = self.code.site(at);
        if self.branches.last() != Some(&site) {
            self.branches.push(site);
        }
    }
}

impl Observer<Shadow> for Watcher<'_> {
    fn after(&mut self, at: usize, floats: &[Register<Shadow>], active: u64) {
        if active & 1 == 0 {
            return;
        }
        let of = |register: u32| floats[register as usize][0];
        match self.code.ops[at] {
            Op::Float1 { to, a, .. } | Op::Scale { to, a, .. } => {
                self.parted(at, &[of(a)], of(to));
            }
            Op::Float2 { to, a, b, .. } => self.parted(at, &[of(a), of(b)], of(to)),
            Op::Fused { to, a, b, c } => self.parted(at, &[of(a), of(b), of(c)], of(to)),
            Op::Compare { a, b, .. } if of(a).is_undecided(of(b)) => self.branched(at),
            Op::FloatToSigned { a, .. } if of(a).single.to_i32() != of(a).double.to_i32() => {
                self.branched(at);
            }
            Op::FloatToUnsigned { a, .. } if of(a).single.to_u32() != of(a).double.to_u32() => {
                self.branched(at);
            }
            _ => {}
        }
    }
}
