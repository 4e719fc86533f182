//! What fills one slot, side by side: how long an evaluation takes, and how far it is from an
//! independent truth.

use std::hint::black_box;
use std::time::{Duration, Instant};

use meniscus_source::{Diagnostic, Report};
use meniscus_stress::modules::{Choice, Declared, Device, Host, Kernel, Specimen, declared, truth};
use meniscus_stress::{Effort, Function, Lanes, Subject};
use serde::{Deserialize, Serialize};

use crate::project::Project;

/// Inputs that the evaluator is timed on, and that are judged.
const SAMPLES: usize = 1 << 16;
/// Inputs that a device is timed on: the fewer show what does not depend on their number.
const CALLS: [usize; 2] = [1 << 17, 1 << 20];
/// How often each is timed, in turn with the others; the fastest counts.
const ROUNDS: usize = 7;

/// A function on a domain.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Solver {
    /// The module's path.
    pub module: String,
    /// The function's name.
    pub function: String,
    /// The domain on which it is tried, as a header says it.
    pub domain: String,
    /// Nanoseconds of an evaluation with the evaluator in `f32`, on one core.
    pub cpu_ns: f64,
    /// Nanoseconds of an evaluation on an adapter, with the copies of its inputs and results.
    pub gpu_ns: Option<f64>,
    /// `f32` against the truth, ulp: the 99th percentile of random inputs, and the worst found.
    pub p99_ulp: f64,
    /// See `p99_ulp`.
    pub max_ulp: f64,
}

/// A function that is timed.
struct Timed {
    declared: Declared,
    specimen: Specimen,
    function: Function,
}

/// All that fill a slot and declare an independent truth, and the slot's own body; each on every
/// domain that one of them declares.
///
/// # Errors
/// When there is no such slot, when nothing that fills it declares a truth, and when something does
/// not run.
pub fn solvers(
    project: &Project,
    slot: &str,
    device: Option<&dyn Device>,
    seed: u64,
) -> Result<Vec<Solver>, Report> {
    let library = project.composer.library();
    let Some(of_slot) = library.slot(slot) else {
        return Err(Diagnostic::error(format!("there is no slot `{slot}`"))
            .with_suggestion(slot, library.slot_names())
            .into());
    };
    let (all, report) = declared(library);
    report.into_result(())?;
    let fills = |declared: &&Declared| {
        let module = library.get(&declared.module);
        let provides = module.and_then(|m| m.header.provides.as_ref());
        let needed = of_slot.header.needs.iter();
        let is_body = needed.into_iter().any(|need| need.text == declared.module);
        declared.against.is_some() && (is_body || provides.is_some_and(|p| p.text == slot))
    };
    let mut timed = Vec::new();
    for declared in all.iter().filter(fills) {
        let specimen = Specimen::new(&project.composer, &declared.module, &Choice::default())?;
        timed.push(Timed {
            declared: declared.clone(),
            function: specimen.function(&declared.name)?,
            specimen,
        });
    }
    if timed.is_empty() {
        let message = format!("nothing that fills `{slot}` declares an independent truth");
        return Err(Diagnostic::error(message)
            .with_help("declare one in a module's header: `// domain: FUNCTION(…) against TRUTH`")
            .into());
    }
    let mut found = Vec::new();
    let mut domains: Vec<(String, &Declared)> = Vec::new();
    for timed in &timed {
        let said = said(&timed.declared);
        if domains.iter().all(|(known, _)| *known != said) {
            domains.push((said, &timed.declared));
        }
    }
    for (said, domain) in domains {
        found.extend(on_domain(&timed, domain, &said, &all, device, seed)?);
    }
    Ok(found)
}

/// A domain without the name of the function that declares it.
fn said(declared: &Declared) -> String {
    let text = declared.to_string();
    let inner = text.split_once('(').map_or(text.as_str(), |(_, rest)| rest);
    match inner.rsplit_once(')') {
        Some((inner, _)) => inner.to_owned(),
        None => inner.to_owned(),
    }
}

/// A call of a function on inputs, and how many.
type Call<'a> = Box<dyn Fn(usize) -> Result<(), Report> + 'a>;

fn on_domain(
    timed: &[Timed],
    domain: &Declared,
    said: &str,
    all: &[Declared],
    device: Option<&dyn Device>,
    seed: u64,
) -> Result<Vec<Solver>, Report> {
    let host = Host::default();
    let mut found = Vec::new();
    let mut on_cpu: Vec<Call<'_>> = Vec::new();
    let mut on_gpu: Vec<Call<'_>> = Vec::new();
    for one in timed {
        let (function, specimen) = (&one.function, &one.specimen);
        let ranges = domain.domain(all, function, &host)?;
        let connected = specimen.connect(function, &host)?;
        let truth = one.declared.against.as_ref();
        let truth = truth.and_then(|name| truth_of(name, &host));
        let subject = Subject {
            function,
            domain: &ranges,
            resources: &connected.resources(),
            nearby: &[],
            truth: truth.as_deref(),
            elsewhere: None,
        };
        let effort = Effort {
            random: SAMPLES,
            special: 0,
            climb: SAMPLES / 16,
            time: Duration::ZERO,
            seed,
        };
        let findings = subject
            .hunt(&effort)
            .map_err(|trap| specimen.explain(&trap))?;
        found.push(Solver {
            module: one.declared.module.clone(),
            function: one.declared.name.clone(),
            domain: said.to_owned(),
            cpu_ns: 0.0,
            gpu_ns: None,
            p99_ulp: findings.total.p99,
            max_ulp: findings.total.max,
        });
        let mut random = fastrand::Rng::with_seed(seed);
        let inputs: Vec<_> = (0..SAMPLES).map(|_| ranges.draw(&mut random)).collect();
        let lanes = ranges.lanes(function, &inputs);
        if let Some(device) = device {
            let kernel = Kernel::new(specimen, function, &host)?;
            let words = kernel.pack(&lanes, SAMPLES);
            let words = words.repeat(CALLS[1] / SAMPLES);
            let launch = device.launcher(&kernel)?;
            let inputs = kernel.input_words;
            on_gpu.push(Box::new(move |calls| {
                let found = launch(words.get(..calls * inputs).unwrap_or(&words), calls);
                black_box(found.map_err(Diagnostic::error)?);
                Ok(())
            }));
        }
        on_cpu.push(Box::new(move |_| evaluated(one, &lanes, &connected)));
    }
    let cpu = fastest(&on_cpu, SAMPLES)?;
    for (solver, seconds) in found.iter_mut().zip(cpu) {
        solver.cpu_ns = 1e9 * seconds / SAMPLES as f64;
    }
    let [few, many] = [fastest(&on_gpu, CALLS[0])?, fastest(&on_gpu, CALLS[1])?];
    for (solver, (few, many)) in found.iter_mut().zip(few.iter().zip(many)) {
        solver.gpu_ns = Some(1e9 * (many - few).max(0.0) / (CALLS[1] - CALLS[0]) as f64);
    }
    Ok(found)
}

fn evaluated(
    one: &Timed,
    lanes: &[Lanes<f32>],
    connected: &meniscus_stress::modules::Connected,
) -> Result<(), Report> {
    let found = one
        .function
        .call::<f32>(lanes, SAMPLES, &connected.resources());
    black_box(found.map_err(|trap| one.specimen.explain(&trap))?);
    Ok(())
}

fn truth_of(name: &str, host: &Host) -> Option<Box<meniscus_stress::Truth<'static>>> {
    truth(name, host)
}

/// The least seconds that each call takes, of some rounds in turn.
fn fastest(calls: &[Call<'_>], inputs: usize) -> Result<Vec<f64>, Report> {
    let mut least = vec![f64::INFINITY; calls.len()];
    for _ in 0..ROUNDS {
        for (least, call) in least.iter_mut().zip(calls) {
            let start = Instant::now();
            call(inputs)?;
            *least = least.min(start.elapsed().as_secs_f64());
        }
    }
    Ok(least)
}
