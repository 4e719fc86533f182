//! Functions of modules give on the graphics adapter what they give in the evaluator.
//!
//! On a software adapter (Mesa's llvmpipe) functions that use no built-in which drivers may round in
//! their own way agree bit for bit. Where such built-ins are used, and on hardware that contracts
//! products and sums, what is asked is that the adapter errs by no more than inputs a few ulps away do.
//!
//! `MENISCUS_FUNCTION_INPUTS` sets how many inputs are tried per function; 100,000 by default, of which
//! one in two hundred is judged.

use std::collections::BTreeMap;

use meniscus::gpu::{Gpu, GpuError};
use meniscus::stress::Effort;
use meniscus::stress::modules::{
    Agreement, Assay, Choice, Declared, Device as _, Host, Kernel, Specimen, WATERS, declared,
};
use meniscus::{FunctionsOnGpu, Project, Sources};

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
    said.and_then(|s| s.parse().ok()).unwrap_or(100_000)
}

fn project() -> Project {
    Project::open(&Sources::default()).unwrap_or_else(|e| panic!("{e}"))
}

/// Declared functions; domains of structures belong to whatever takes them.
fn functions(project: &Project) -> (Vec<Declared>, Vec<Declared>) {
    let (all, report) = declared(project.composer.library());
    assert!(report.0.is_empty(), "{report}");
    let library = project.composer.library();
    let functions = all.iter().filter(|d| d.is_function(library));
    let functions = functions.cloned().collect();
    (all, functions)
}

#[test]
fn functions_of_plain_arithmetic_agree_bit_for_bit_with_a_software_adapter() {
    let Some(gpu) = adapter() else { return };
    let project = project();
    let (all, functions) = functions(&project);
    let mut wrong = Vec::new();
    let (mut plain, mut alike) = (0, 0);
    let mut by_built_in: BTreeMap<String, f64> = BTreeMap::new();
    let host = Host::default();
    for declared in &functions {
        let (composer, inputs) = (&project.composer, inputs());
        let found = Agreement::run(&gpu, composer, &all, declared, &host, inputs, 7)
            .unwrap_or_else(|e| panic!("{e}"));
        assert!(found.inputs >= inputs && found.numbers > 0, "{found:?}");
        for built_in in &found.built_ins {
            let most = by_built_in.entry(built_in.clone()).or_default();
            *most = most.max(found.largest_ulp);
        }
        if found.is_plain() {
            plain += 1;
            alike += usize::from(found.differ == 0);
            if found.differ > 0 {
                wrong.push(format!("{found:?}"));
            }
        }
    }
    println!("largest distances with a built-in, ulp: {by_built_in:.2?}");
    println!(
        "{alike} of {plain} plain functions agree; others:\n{}",
        wrong.join("\n")
    );
    assert!(plain > 20, "{plain}");
    if gpu.0.is_software() {
        assert_eq!(alike, plain, "{}", wrong.join("\n"));
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
        random: count / 200,
        special: count / 800,
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
            assay.found.scaled.max,
            assay.found.rounding.max,
            assay.found.non_finite
        );
        if assay.found.non_finite > 0 || assay.found.scaled.max > 64.0 {
            wrong.push(format!(
                "{}:{}: {} ulp / (1 + condition), {} not finite; worst {:?}",
                declared.module,
                declared.name,
                assay.found.scaled.max,
                assay.found.non_finite,
                assay.worst_numbers
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
