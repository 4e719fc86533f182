//! What a device computes beside what the evaluator computes, bit by bit.

use std::collections::BTreeSet;

use meniscus_shader::Composer;
use meniscus_source::{Diagnostic, Report};
use naga::{Expression, MathFunction};
use serde::Serialize;

use super::{Choice, Declared, Device, Host, Kernel, Specimen, WATERS};
use crate::{Column, Input, Lanes};

/// How many numbers of a function's results differ between a device and the evaluator.
#[derive(Debug, Clone, Serialize)]
pub struct Agreement {
    /// The module's path.
    pub module: String,
    /// The function's name.
    pub function: String,
    /// The device.
    pub device: String,
    /// Inputs tried, over all waters.
    pub inputs: usize,
    /// Numbers of all results.
    pub numbers: usize,
    /// Those of them that differ in any bit; both zeros are equal, and all NaN.
    pub differ: usize,
    /// Whole numbers and truth values among these.
    pub decisions: usize,
    /// The largest distance of floating-point numbers, ulp.
    pub largest_ulp: f64,
    /// Where it is: the input's numbers, by their names.
    pub worst_numbers: Vec<(String, f64)>,
    /// Built-ins that the function uses and that drivers may round in their own way.
    pub built_ins: BTreeSet<String>,
}

/// Waters that a function which reads them is tried in: from above and from below.
const TRIED: [(f64, bool); 2] = [WATERS[0], WATERS[1]];

impl Agreement {
    /// Runs a declared function on a device and with the evaluator, on as many inputs in each of two
    /// waters if it reads them: a quarter special ones, the rest random.
    ///
    /// # Errors
    /// Where the module or its domain is wrong, a run stops, or the device cannot run the function.
    pub fn run(
        device: &dyn Device,
        composer: &Composer,
        all: &[Declared],
        declared: &Declared,
        host: &Host,
        inputs: usize,
        seed: u64,
    ) -> Result<Self, Report> {
        let specimen = Specimen::new(composer, &declared.module, &Choice::of_waves())?;
        let function = specimen.function(&declared.name)?;
        let reads_water = function.resources().any(|name| name == "water");
        let waters = if reads_water { &TRIED[..] } else { &TRIED[..1] };
        let mut found = Self {
            module: declared.module.clone(),
            function: declared.name.clone(),
            device: device.name(),
            inputs: 0,
            numbers: 0,
            differ: 0,
            decisions: 0,
            largest_ulp: 0.0,
            worst_numbers: Vec::new(),
            built_ins: BTreeSet::new(),
        };
        for &(index, above) in waters {
            let mut host = host.clone();
            host.water(index, above);
            let domain = declared.domain(all, &function, &host)?;
            let mut rng = fastrand::Rng::with_seed(seed);
            let mut tried: Vec<Input> = domain.special(inputs / 4, &mut rng);
            tried.extend((tried.len()..inputs).map(|_| domain.draw(&mut rng)));
            let arguments = domain.lanes(&function, &tried);
            let connected = specimen.connect(&function, &host)?;
            let ours = function
                .call(&arguments, tried.len(), &connected.resources())
                .map_err(|trap| specimen.explain(&trap))?;
            let kernel = Kernel::new(&specimen, &function, &host)?;
            let launch = device.launcher(&kernel)?;
            let words = kernel.pack(&arguments, tried.len());
            let words = launch(&words, tried.len()).map_err(Diagnostic::error)?;
            let theirs = kernel.unpack(&words, tried.len());
            found.built_ins.extend(built_ins(&kernel.module));
            found.inputs += tried.len();
            if let Some(lane) = found.compare(&ours, &theirs) {
                let numbers = domain.numbers(&tried[lane]);
                let names = function.numbers().map(|(name, _)| name);
                found.worst_numbers = names.zip(numbers).collect();
            }
        }
        Ok(found)
    }

    /// Whether the function is of plain arithmetic: no built-in that drivers round in their own way.
    pub fn is_plain(&self) -> bool {
        self.built_ins.is_empty()
    }

    /// Takes in the results of a run; the lane with a larger distance than was known, if there is one.
    fn compare(&mut self, ours: &Lanes<f32>, theirs: &Lanes<f32>) -> Option<usize> {
        let mut worst = None;
        for (ours, theirs) in ours.columns.iter().zip(&theirs.columns) {
            for lane in 0..ours.len() {
                self.numbers += 1;
                let (equal, ulps) = match (ours, theirs) {
                    (Column::Float(a), Column::Float(b)) => {
                        let (a, b) = (a[lane], b[lane]);
                        let equal = a == b || (a.is_nan() && b.is_nan());
                        (equal, crate::ulp::ulps(b, f64::from(a)))
                    }
                    _ => {
                        let equal = ours.as_f64(lane) == theirs.as_f64(lane);
                        self.decisions += usize::from(!equal);
                        (equal, 0.0)
                    }
                };
                self.differ += usize::from(!equal);
                let first = worst.is_none() && self.worst_numbers.is_empty();
                if !equal && (first || ulps > self.largest_ulp) {
                    self.largest_ulp = self.largest_ulp.max(ulps);
                    worst = Some(lane);
                }
            }
        }
        worst
    }
}

/// Built-ins of a shader that WGSL lets drivers round otherwise than operation by operation. Division
/// and square root are as exact as can be on software drivers, and so are not among them.
fn built_ins(module: &naga::Module) -> BTreeSet<String> {
    let functions = module.functions.iter().map(|(_, f)| f);
    let all = functions.chain(module.entry_points.iter().map(|e| &e.function));
    let name = |expression: &Expression| match expression {
        Expression::Math { fun, .. } => is_free(*fun).then(|| format!("{fun:?}")),
        Expression::ImageSample { .. } => Some("textureSample".to_owned()),
        _ => None,
    };
    all.flat_map(|f| f.expressions.iter())
        .filter_map(|(_, e)| name(e))
        .collect()
}

fn is_free(fun: MathFunction) -> bool {
    use MathFunction as M;
    matches!(
        fun,
        M::Normalize
            | M::InverseSqrt
            | M::Pow
            | M::Exp
            | M::Exp2
            | M::Log
            | M::Log2
            | M::Sin
            | M::Cos
            | M::Tan
            | M::Asin
            | M::Acos
            | M::Atan
            | M::Atan2
            | M::Sinh
            | M::Cosh
            | M::Tanh
            | M::Asinh
            | M::Acosh
            | M::Atanh
            | M::Fma
            | M::Mix
            | M::SmoothStep
            | M::Refract
            | M::Reflect
            | M::Length
            | M::Distance
    )
}
