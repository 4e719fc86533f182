//! Functions of modules give on the graphics adapter what they give in the evaluator.
//!
//! On a software adapter (Mesa's llvmpipe) single operations agree bit for bit, and so do nine of ten
//! functions that use no built-in which drivers may round in their own way. The others hold sums that
//! its compiler rearranges, as WGSL lets it: (a + b) − a is taken for b. There, where such built-ins
//! are used, and on hardware that contracts products and sums, what is asked is that the adapter errs
//! by no more than inputs a few ulps away do.
//!
//! `MENISCUS_FUNCTION_INPUTS` sets how many inputs are tried per function; 10,000 by default, of which
//! one in twenty is judged.

use std::collections::{BTreeMap, BTreeSet};

use meniscus::gpu::{Gpu, GpuError};
use meniscus::stress::modules::{
    Assay, Choice, Declared, Device as _, Host, Kernel, Specimen, WATERS, declared,
};
use meniscus::stress::{Column, Effort, Lanes};
use meniscus::{FunctionsOnGpu, Project, Sources};
use naga::{Expression, MathFunction};

/// The adapter; none, with a loud word, where there is none.
fn adapter() -> Option<FunctionsOnGpu> {
    match Gpu::open(None) {
        Ok(gpu) => Some(FunctionsOnGpu(gpu)),
        Err(GpuError::NoAdapter { .. }) => {
            eprintln!("SKIPPED: there is no graphics adapter, nothing was compared with a GPU");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

fn inputs() -> usize {
    let said = std::env::var("MENISCUS_FUNCTION_INPUTS").ok();
    said.and_then(|s| s.parse().ok()).unwrap_or(10_000)
}

fn project() -> Project {
    Project::open(&Sources::default()).unwrap_or_else(|e| panic!("{e}"))
}

/// Declared functions; domains of structures belong to whatever takes them.
fn functions(project: &Project) -> (Vec<Declared>, Vec<Declared>) {
    let (all, report) = declared(project.composer.library());
    assert!(report.0.is_empty(), "{report}");
    let is_function = |d: &&Declared| {
        let module = project.composer.library().get(&d.module);
        module.is_some_and(|m| m.file.text.contains(&format!("fn {}(", d.name)))
    };
    let functions = all.iter().filter(is_function).cloned().collect();
    (all, functions)
}

/// Built-ins that drivers may round otherwise than the evaluator, of those that a kernel uses.
fn inexact(kernel: &Kernel) -> BTreeSet<String> {
    let module = &kernel.module;
    let functions = module.functions.iter().map(|(_, f)| f);
    let all = functions.chain(module.entry_points.iter().map(|e| &e.function));
    let name = |expression: &Expression| match expression {
        Expression::Math { fun, .. } => match fun {
            MathFunction::Normalize
            | MathFunction::InverseSqrt
            | MathFunction::Pow
            | MathFunction::Exp
            | MathFunction::Exp2
            | MathFunction::Log
            | MathFunction::Log2
            | MathFunction::Sin
            | MathFunction::Cos
            | MathFunction::Tan
            | MathFunction::Fma
            | MathFunction::Mix
            | MathFunction::SmoothStep
            | MathFunction::Refract
            | MathFunction::Reflect
            | MathFunction::Length
            | MathFunction::Distance => Some(format!("{fun:?}")),
            _ => None,
        },
        Expression::ImageSample { .. } => Some("textureSample".to_owned()),
        _ => None,
    };
    all.flat_map(|f| f.expressions.iter())
        .filter_map(|(_, e)| name(e))
        .collect()
}

/// How many numbers differ, of how many, and the largest distance in units in the last place.
#[derive(Default)]
struct Difference {
    numbers: usize,
    differ: usize,
    largest: f64,
    first: Option<(usize, usize)>,
}

fn difference(cpu: &Lanes<f32>, gpu: &Lanes<f32>) -> Difference {
    let mut found = Difference::default();
    for (leaf, (ours, theirs)) in cpu.columns.iter().zip(&gpu.columns).enumerate() {
        for lane in 0..ours.len() {
            let (equal, ulps) = match (ours, theirs) {
                (Column::Float(a), Column::Float(b)) => {
                    let (a, b) = (a[lane], b[lane]);
                    let ulps = meniscus::stress::ulp::ulps(b, f64::from(a));
                    (a == b || (a.is_nan() && b.is_nan()), ulps)
                }
                _ => (ours.as_f64(lane) == theirs.as_f64(lane), 0.0),
            };
            found.numbers += 1;
            if !equal {
                found.differ += 1;
                found.largest = found.largest.max(ulps);
                found.first.get_or_insert((leaf, lane));
            }
        }
    }
    found
}

#[test]
fn functions_of_plain_arithmetic_agree_bit_for_bit_with_a_software_adapter() {
    let Some(gpu) = adapter() else { return };
    let project = project();
    let (all, functions) = functions(&project);
    let mut wrong = Vec::new();
    let (mut plain, mut alike) = (0, 0);
    let mut by_built_in: BTreeMap<String, f64> = BTreeMap::new();
    for declared in &functions {
        let name = format!("{}:{}", declared.module, declared.name);
        let specimen = Specimen::new(&project.composer, &declared.module, &Choice::default())
            .unwrap_or_else(|e| panic!("{e}"));
        let function = specimen.function(&declared.name).unwrap();
        let mut host = Host::default();
        for (index, above) in &WATERS[..2] {
            host.water(*index, *above);
            let kernel = Kernel::new(&specimen, &function, &host).unwrap_or_else(|e| panic!("{e}"));
            let domain = declared
                .domain(&all, &function, &host)
                .unwrap_or_else(|e| panic!("{e}"));
            let mut rng = fastrand::Rng::with_seed(7);
            let count = inputs();
            let mut tried = domain.special(count / 4, &mut rng);
            tried.extend((tried.len()..count).map(|_| domain.draw(&mut rng)));
            let arguments = domain.lanes(&function, &tried);
            let connected = specimen.connect(&function, &host).unwrap();
            let cpu = function
                .call(&arguments, count, &connected.resources())
                .unwrap_or_else(|trap| panic!("{}", specimen.explain(&trap)));
            let launch = gpu.launcher(&kernel).unwrap_or_else(|e| panic!("{e}"));
            let words = launch(&kernel.pack(&arguments, count), count).unwrap();
            let found = difference(&cpu, &kernel.unpack(&words, count));
            let inexact = inexact(&kernel);
            println!(
                "{name:44} {:7} of {:8} differ, by up to {:9.2e} ulp; {}",
                found.differ,
                found.numbers,
                found.largest,
                inexact.iter().cloned().collect::<Vec<_>>().join(" ")
            );
            for built_in in &inexact {
                let most = by_built_in.entry(built_in.clone()).or_default();
                *most = most.max(found.largest);
            }
            if inexact.is_empty() {
                plain += 1;
                alike += usize::from(found.first.is_none());
                if let Some((leaf, lane)) = found.first {
                    wrong.push(format!(
                        "{name}: {} of {} differ, number {leaf} first for {:?}: {} on the CPU",
                        found.differ,
                        found.numbers,
                        domain.numbers(&tried[lane]),
                        cpu.columns[leaf].as_f64(lane),
                    ));
                }
            }
        }
    }
    println!("largest distances with a built-in, ulp: {by_built_in:.2?}");
    println!(
        "{alike} of {plain} plain functions and waters agree; others:\n{}",
        wrong.join("\n")
    );
    assert!(plain > 40, "{plain}");
    if gpu.0.is_software() {
        assert!(
            10 * alike >= 9 * plain,
            "{alike} of {plain}: {}",
            wrong.join("\n")
        );
    }
}

/// One operation a number of the result.
const OPERATIONS: &str = "// Operations.
//
// domain: operations(a -1e30 to 1e30, b -1e30 to 1e30, c 0 to 1e30)

struct Operations {
    sum: f32,
    difference: f32,
    product: f32,
    quotient: f32,
    root: f32,
    least: f32,
    most: f32,
    floor: f32,
    nearest: f32,
    magnitude: f32,
    horner: f32,
}

fn operations(a: f32, b: f32, c: f32) -> Operations {
    return Operations(
        a + b,
        a - b,
        a * b,
        a / b,
        sqrt(c),
        min(a, b),
        max(a, b),
        floor(a),
        round(a),
        abs(a),
        1.0 + a * (0.5 + a * (0.25 + a * b)),
    );
}
";

#[test]
fn single_operations_agree_bit_for_bit_with_a_software_adapter_where_nothing_is_denormal() {
    let Some(gpu) = adapter() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir(folder.path().join("mine")).expect("a folder");
    std::fs::write(folder.path().join("mine/operations.wgsl"), OPERATIONS).expect("a file");
    let project = Project::open(&Sources {
        modules: vec![folder.path().to_owned()],
        ..Sources::default()
    })
    .unwrap_or_else(|e| panic!("{e}"));
    let (all, functions) = functions(&project);
    let declared = functions.iter().find(|d| d.name == "operations").unwrap();
    let specimen = Specimen::new(&project.composer, "mine/operations", &Choice::default()).unwrap();
    let function = specimen.function("operations").unwrap();
    let host = Host::default();
    let domain = declared.domain(&all, &function, &host).unwrap();
    let mut rng = fastrand::Rng::with_seed(3);
    let tried: Vec<_> = (0..100_000).map(|_| domain.draw(&mut rng)).collect();
    let arguments = domain.lanes(&function, &tried);
    let cpu = function.call(&arguments, tried.len(), &meniscus::stress::Resources::new());
    let cpu = cpu.unwrap();
    let kernel = Kernel::new(&specimen, &function, &host).unwrap();
    let launch = gpu.launcher(&kernel).unwrap_or_else(|e| panic!("{e}"));
    let words = launch(&kernel.pack(&arguments, tried.len()), tried.len()).unwrap();
    let found = kernel.unpack(&words, tried.len());
    let normal = |x: f64| x == 0.0 || x.abs() >= f64::from(f32::MIN_POSITIVE);
    let leaves = function.result().unwrap().leaves();
    let mut compared = 0;
    for (lane, input) in tried.iter().enumerate() {
        let result = cpu.lane(lane);
        // Adapters may take denormals for 0.
        if !domain
            .numbers(input)
            .into_iter()
            .chain(result.clone())
            .all(normal)
        {
            continue;
        }
        compared += 1;
        for (leaf, (ours, theirs)) in result.iter().zip(found.lane(lane)).enumerate() {
            if gpu.0.is_software() {
                let name = &leaves[leaf].0;
                let numbers = domain.numbers(input);
                assert_eq!(*ours, theirs, "{name} of {numbers:?}");
            }
        }
    }
    assert!(compared > 10_000, "{compared}");
}

#[test]
fn what_the_adapter_computes_errs_by_no_more_than_inputs_nearby_do() {
    let Some(gpu) = adapter() else { return };
    let project = project();
    let (all, functions) = functions(&project);
    let count = inputs();
    let effort = Effort {
        random: count / 20,
        special: count / 80,
        climb: 0,
        ..Effort::default()
    };
    let mut wrong = Vec::new();
    for declared in &functions {
        let (composer, host) = (&project.composer, Host::default());
        let assay = Assay::run_on(
            Some(&gpu),
            composer,
            &all,
            declared,
            &host,
            &WATERS[..1],
            &effort,
        )
        .unwrap_or_else(|e| panic!("{e}"));
        println!(
            "{:44} {:9.3e} ulp / (1 + condition), {:9.3e} ulp; {} not finite",
            format!("{}:{}", declared.module, declared.name),
            assay.scaled.max,
            assay.rounding.max,
            assay.non_finite
        );
        if assay.non_finite > 0 || assay.scaled.max > 64.0 {
            wrong.push(format!(
                "{}:{}: {} ulp / (1 + condition), {} not finite; worst {:?}",
                declared.module,
                declared.name,
                assay.scaled.max,
                assay.non_finite,
                assay.worst_numbers
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
