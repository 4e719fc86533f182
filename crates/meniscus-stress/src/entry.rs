//! Running entry points: compute grids, pixels, vertices.

use std::sync::Arc;

use naga::{Binding, BuiltIn, ShaderStage};
use rayon::prelude::*;

use crate::code::Code;
use crate::error::Trap;
use crate::function::{bind, result_kinds};
use crate::machine::{Blind, Machine, Shared, Stop};
use crate::number::Scalar;
use crate::op::{LANES, Leaf};
use crate::resources::Resources;
use crate::shape::{Column, Lanes, Shape};

/// An entry point, ready to be run in any number system.
#[derive(Debug, Clone)]
pub struct Entry {
    code: Arc<Code>,
    stage: ShaderStage,
    workgroup: [u32; 3],
}

/// The pixels of a fragment entry point, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Pixels<S> {
    /// What each pixel returns.
    pub value: Lanes<S>,
    /// Whether the pixel was not discarded.
    pub kept: Vec<bool>,
}

/// Gives the component of an input in a lane; none where there is no such input.
pub type Feed<'a> = dyn Fn(&Binding, usize, usize) -> Option<f64> + Sync + 'a;

/// Gives what a vertex stage would have interpolated at a pixel's centre (x right, y down, in
/// pixels) for a `@location`; none where there is no such location.
pub type Varying<'a> = dyn Fn(u32, [f32; 2]) -> Option<[f32; 4]> + Sync + 'a;

impl Entry {
    pub(crate) fn new(code: Arc<Code>, stage: ShaderStage, workgroup: [u32; 3]) -> Self {
        Self {
            code,
            stage,
            workgroup,
        }
    }

    /// Its name in WGSL.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.code.name
    }

    /// Its stage.
    #[must_use]
    pub fn stage(&self) -> ShaderStage {
        self.stage
    }

    /// Threads of a workgroup, for a compute stage.
    #[must_use]
    pub fn workgroup(&self) -> [u32; 3] {
        self.workgroup
    }

    /// Names of the global variables that must be connected.
    pub fn resources(&self) -> impl Iterator<Item = &str> {
        self.code.slots.iter().map(|slot| slot.name.as_str())
    }

    /// What it returns; none where it returns nothing.
    #[must_use]
    pub fn result(&self) -> Option<&Shape> {
        self.code.result_shape.as_ref()
    }

    /// What each number of the result is bound to, in the order of [`Shape::leaves`].
    #[must_use]
    pub fn outputs(&self) -> &[Option<Binding>] {
        &self.code.result_bindings
    }

    fn no_input(&self, binding: &Binding) -> Trap {
        let input = match binding {
            Binding::BuiltIn(built_in) => format!("the built-in value {built_in:?}"),
            Binding::Location { location, .. } => format!("@location({location})"),
        };
        Trap::NoInput {
            entry: self.code.name.clone(),
            input,
        }
    }

    fn fill<S: Scalar>(
        &self,
        machine: &mut Machine<'_, S>,
        first: usize,
        count: usize,
        input: &Feed<'_>,
    ) -> Result<(), Trap> {
        for argument in &self.code.arguments {
            for (binding, range) in &argument.bindings {
                for (component, leaf) in argument.leaves[range.clone()].iter().enumerate() {
                    for lane in 0..count {
                        let Some(value) = input(binding, first + lane, component) else {
                            return Err(self.no_input(binding));
                        };
                        match *leaf {
                            Leaf::Float(r) => {
                                machine.floats[r as usize][lane] = S::from_f64(value);
                            }
                            Leaf::Int(r) => {
                                machine.ints[r as usize][lane] = value as i64 as u32;
                            }
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// Runs a compute entry point over a grid of workgroups, several at a time.
    ///
    /// # Errors
    ///
    /// A [`Trap`]: a resource that is missing, an endless loop, another stage than compute.
    pub fn dispatch<S: Scalar>(
        &self,
        groups: [u32; 3],
        resources: &Resources<'_>,
    ) -> Result<(), Trap> {
        if self.stage != ShaderStage::Compute {
            return Err(Trap::WrongStage {
                name: self.code.name.clone(),
                wanted: "compute",
            });
        }
        let bound = bind(&self.code, resources)?;
        let threads: usize = self.workgroup.iter().map(|&n| n as usize).product();
        let count: u64 = groups.iter().map(|&n| u64::from(n)).product();
        let start = || {
            let machines = (0..threads.div_ceil(LANES)).map(|_| Machine::<S>::new(&self.code));
            (
                machines.collect::<Vec<_>>(),
                Shared::<S>::new(self.code.workgroup_words),
            )
        };
        (0..count)
            .into_par_iter()
            .try_for_each_init(start, |(machines, shared), index| {
                let group = split(index, groups.map(u64::from)).map(|n| n as u32);
                shared.clear();
                for (i, machine) in machines.iter_mut().enumerate() {
                    let first = i * LANES;
                    let lanes = (threads - first).min(LANES);
                    let input = |binding: &Binding, lane: usize, component: usize| {
                        self.compute_input(binding, lane, component, group, groups)
                    };
                    self.fill(machine, first, lanes, &input)?;
                    machine.launch(lanes);
                }
                // All lanes go on to the next barrier before any goes beyond it.
                loop {
                    let mut ended = true;
                    for machine in machines.iter_mut() {
                        ended &= machine.run(&bound, shared, &mut Blind)? == Stop::End;
                    }
                    if ended {
                        return Ok(());
                    }
                }
            })
    }

    fn compute_input(
        &self,
        binding: &Binding,
        lane: usize,
        component: usize,
        group: [u32; 3],
        groups: [u32; 3],
    ) -> Option<f64> {
        let local = split(lane as u64, self.workgroup.map(u64::from)).map(|n| n as u32);
        let Binding::BuiltIn(built_in) = binding else {
            return None;
        };
        let value = match built_in {
            BuiltIn::GlobalInvocationId => {
                let size = self.workgroup.get(component)?;
                group
                    .get(component)?
                    .wrapping_mul(*size)
                    .wrapping_add(*local.get(component)?)
            }
            BuiltIn::LocalInvocationId => *local.get(component)?,
            BuiltIn::LocalInvocationIndex => lane as u32,
            BuiltIn::WorkGroupId => *group.get(component)?,
            BuiltIn::WorkGroupSize => *self.workgroup.get(component)?,
            BuiltIn::NumWorkGroups => *groups.get(component)?,
            _ => return None,
        };
        Some(f64::from(value))
    }

    /// Runs a fragment entry point at every pixel of a picture, several rows at a time.
    ///
    /// Depth is 0 and w is 1, as of a triangle that covers the picture.
    ///
    /// # Errors
    ///
    /// A [`Trap`]: a resource or an input that is missing, an endless loop, another stage.
    pub fn shade<S: Scalar>(
        &self,
        [width, height]: [u32; 2],
        resources: &Resources<'_>,
        varying: &Varying<'_>,
    ) -> Result<Pixels<S>, Trap> {
        if self.stage != ShaderStage::Fragment {
            return Err(Trap::WrongStage {
                name: self.code.name.clone(),
                wanted: "fragment",
            });
        }
        let bound = bind(&self.code, resources)?;
        let kinds = result_kinds(&self.code);
        let (width, height) = (width as usize, height as usize);
        let blank = |lanes: usize| Pixels {
            value: Lanes {
                columns: kinds.iter().map(|&k| Column::zeros(k, lanes)).collect(),
            },
            kept: vec![true; lanes],
        };
        let start = || Machine::<S>::new(&self.code);
        // Two rows at a time, four lanes to a quad.
        let rows = (0..height.div_ceil(2))
            .into_par_iter()
            .map_init(start, |machine, pair| {
                let mut rows = blank(2 * width);
                for first in (0..width).step_by(LANES / 2) {
                    let quads = (width - first).min(LANES / 2).div_ceil(2);
                    let at =
                        |lane: usize| [first + lane / 4 * 2 + lane % 2, 2 * pair + lane % 4 / 2];
                    let inside = |lane: usize| at(lane)[0] < width && at(lane)[1] < height;
                    let input = |binding: &Binding, lane: usize, component: usize| {
                        fragment_input(binding, at(lane), component, varying)
                    };
                    self.fill(machine, 0, 4 * quads, &input)?;
                    let real = (0..4 * quads)
                        .filter(|&l| inside(l))
                        .fold(0, |m, l| m | 1 << l);
                    machine.launch_quads(4 * quads, real);
                    let mut shared = Shared::new(self.code.workgroup_words);
                    while machine.run(&bound, &mut shared, &mut Blind)? != Stop::End {}
                    for lane in (0..4 * quads).filter(|&l| inside(l)) {
                        let pixel = lane % 4 / 2 * width + at(lane)[0];
                        rows.kept[pixel] = machine.discarded() >> lane & 1 == 0;
                        for (&leaf, column) in self.code.result.iter().zip(&mut rows.value.columns)
                        {
                            machine.take_one(leaf, lane, column, pixel);
                        }
                    }
                }
                Ok(rows)
            });
        let rows: Vec<Pixels<S>> = rows.collect::<Result<_, Trap>>()?;
        let mut whole = blank(0);
        for pair in rows {
            whole.kept.extend(pair.kept);
            for (to, from) in whole.value.columns.iter_mut().zip(pair.value.columns) {
                to.append(from);
            }
        }
        whole.kept.truncate(width * height);
        whole
            .value
            .columns
            .iter_mut()
            .for_each(|c| c.truncate(width * height));
        Ok(whole)
    }

    /// Runs an entry point of any stage in lanes whose inputs the caller gives.
    ///
    /// Each four lanes count as 2 × 2 pixels where derivatives are taken.
    ///
    /// # Errors
    ///
    /// A [`Trap`]: a resource or an input that is missing, an endless loop.
    pub fn invoke<S: Scalar>(
        &self,
        lanes: usize,
        resources: &Resources<'_>,
        input: &Feed<'_>,
    ) -> Result<Lanes<S>, Trap> {
        let bound = bind(&self.code, resources)?;
        let kinds = result_kinds(&self.code);
        let mut value = Lanes {
            columns: kinds.iter().map(|&k| Column::zeros(k, lanes)).collect(),
        };
        let mut machine = Machine::<S>::new(&self.code);
        let mut shared = Shared::new(self.code.workgroup_words);
        for first in (0..lanes).step_by(LANES) {
            let count = (lanes - first).min(LANES);
            self.fill(&mut machine, first, count, input)?;
            machine.launch(count);
            while machine.run(&bound, &mut shared, &mut Blind)? != Stop::End {}
            for (&leaf, column) in self.code.result.iter().zip(&mut value.columns) {
                machine.take(leaf, column, first, count);
            }
        }
        Ok(value)
    }
}

/// The place of an index in a grid, x fastest.
fn split(index: u64, size: [u64; 3]) -> [u64; 3] {
    let (x, y) = (size[0].max(1), size[1].max(1));
    [index % x, index / x % y, index / x / y]
}

fn fragment_input(
    binding: &Binding,
    [x, y]: [usize; 2],
    component: usize,
    varying: &Varying<'_>,
) -> Option<f64> {
    let centre = [x as f32 + 0.5, y as f32 + 0.5];
    match binding {
        Binding::BuiltIn(BuiltIn::Position { .. }) => {
            [f64::from(centre[0]), f64::from(centre[1]), 0.0, 1.0]
                .get(component)
                .copied()
        }
        Binding::BuiltIn(BuiltIn::FrontFacing | BuiltIn::SampleMask) => Some(1.0),
        Binding::BuiltIn(BuiltIn::SampleIndex) => Some(0.0),
        Binding::Location { location, .. } => varying(*location, centre)?
            .get(component)
            .map(|&x| f64::from(x)),
        Binding::BuiltIn(_) => None,
    }
}

impl<S: Scalar> Machine<'_, S> {
    fn take_one(&self, leaf: Leaf, lane: usize, column: &mut Column<S>, at: usize) {
        match (leaf, column) {
            (Leaf::Float(r), Column::Float(c)) => c[at] = self.floats[r as usize][lane],
            (Leaf::Int(r), Column::Sint(c)) => c[at] = self.ints[r as usize][lane] as i32,
            (Leaf::Int(r), Column::Uint(c)) => c[at] = self.ints[r as usize][lane],
            (Leaf::Int(r), Column::Bool(c)) => c[at] = self.ints[r as usize][lane] != 0,
            _ => {}
        }
    }
}

impl<S: Scalar> Column<S> {
    fn append(&mut self, other: Self) {
        match (self, other) {
            (Self::Float(to), Self::Float(from)) => to.extend(from),
            (Self::Sint(to), Self::Sint(from)) => to.extend(from),
            (Self::Uint(to), Self::Uint(from)) => to.extend(from),
            (Self::Bool(to), Self::Bool(from)) => to.extend(from),
            _ => {}
        }
    }

    fn truncate(&mut self, lanes: usize) {
        match self {
            Self::Float(c) => c.truncate(lanes),
            Self::Sint(c) => c.truncate(lanes),
            Self::Uint(c) => c.truncate(lanes),
            Self::Bool(c) => c.truncate(lanes),
        }
    }
}
