//! All declared functions put under stress: what `meniscus stress` and the regression files are
//! made of.

use meniscus_shader::Composer;
use meniscus_source::Report;
use serde::{Deserialize, Serialize};

use super::{Choice, Connected, Declared, Device, Host, Kernel, Specimen, truth};
use crate::{
    Case, Domain, Effort, Elsewhere, Findings, Function, NEARBY, Subject, Trap, WORST_KEPT,
};

/// Waters between which a function that reads them is tried: refractive index, and whether the eye
/// is above.
pub const WATERS: [(f64, bool); 4] = [(1.333, true), (1.333, false), (2.5, true), (0.4, true)];

/// Hosts with every number moved a little, for second looks.
const NEARBY_HOSTS: u64 = 7;

/// Inputs of a function that were found to be the worst, as kept in a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Worst {
    /// The module's path.
    pub module: String,
    /// The function's name.
    pub function: String,
    /// The inputs, worst first.
    pub cases: Vec<WorstCase>,
}

/// One of them, with the water it belongs to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WorstCase {
    /// The water's refractive index.
    pub refractive_index: f64,
    /// Whether the eye is above the water.
    pub eye_above: bool,
    /// The input and its error.
    pub case: Case,
}

/// What was found out about a function: the worst over all waters.
#[derive(Debug, Clone, Serialize)]
pub struct Assay {
    /// The module's path.
    pub module: String,
    /// The function's name.
    pub function: String,
    /// The device whose results were judged; none for the evaluator's.
    pub device: Option<String>,
    /// The domain, as written.
    pub domain: String,
    /// The independent truth, if one is declared.
    pub against: Option<String>,
    /// The worst over all waters.
    #[serde(flatten)]
    pub found: Findings,
    /// Where `f32` and `f64` part for the worst input, `FILE:LINE`.
    pub parts_at: Option<String>,
    /// The worst input's numbers, by their names.
    pub worst_numbers: Vec<(String, f64)>,
    /// The inputs to keep.
    #[serde(skip)]
    pub worst: Worst,
}

/// A function ready for stress, with one water.
struct Prepared {
    host: Host,
    domain: Domain,
    connected: Connected,
    nearby: Vec<Connected>,
}

fn prepare(
    specimen: &Specimen,
    function: &Function,
    declared: &Declared,
    all: &[Declared],
    host: &Host,
    water: (f64, bool),
) -> Result<Prepared, Report> {
    let mut host = host.clone();
    host.water(water.0, water.1);
    let domain = declared.domain(all, function, &host)?;
    let connected = specimen.connect(function, &host)?;
    let nearby = (1..=NEARBY_HOSTS)
        .map(|seed| specimen.connect_nearby(function, &host, NEARBY, seed))
        .collect::<Result<_, Report>>()?;
    Ok(Prepared {
        host,
        domain,
        connected,
        nearby,
    })
}

/// A function as a device calls it.
fn elsewhere<'a>(
    device: &'a dyn Device,
    specimen: &Specimen,
    function: &Function,
    host: &Host,
) -> Result<Box<Elsewhere<'a>>, Report> {
    let kernel = Kernel::new(specimen, function, host)?;
    let launch = device.launcher(&kernel)?;
    Ok(Box::new(move |arguments, lanes| {
        let found = launch(&kernel.pack(arguments, lanes), lanes).map_err(Trap::Device)?;
        Ok(kernel.unpack(&found, lanes))
    }))
}

impl Prepared {
    fn run(
        &self,
        specimen: &Specimen,
        function: &Function,
        declared: &Declared,
        device: Option<&dyn Device>,
        with: impl Fn(&Subject) -> Result<Findings, crate::Trap>,
    ) -> Result<Findings, Report> {
        let truth = declared
            .against
            .as_ref()
            .and_then(|name| truth(name, &self.host));
        let resources = self.connected.resources();
        let nearby: Vec<_> = self.nearby.iter().map(Connected::resources).collect();
        let elsewhere = match device {
            Some(device) => Some(elsewhere(device, specimen, function, &self.host)?),
            None => None,
        };
        let subject = Subject {
            function,
            domain: &self.domain,
            resources: &resources,
            nearby: &nearby,
            truth: truth.as_deref(),
            elsewhere: elsewhere.as_deref(),
        };
        with(&subject).map_err(|trap| specimen.explain(&trap))
    }
}

impl Assay {
    /// Hunts the worst inputs of a declared function. `host`: what it reads; the waters are those
    /// given, or [`WATERS`] where none is, if it reads the water. The effort is shared between them.
    ///
    /// # Errors
    /// Where the module or its domain is wrong, or a run stops.
    pub fn run(
        composer: &Composer,
        all: &[Declared],
        declared: &Declared,
        host: &Host,
        waters: &[(f64, bool)],
        effort: &Effort,
    ) -> Result<Self, Report> {
        Self::run_on(None, composer, all, declared, host, waters, effort)
    }

    /// The same with results that a device computes; the evaluator's where none is given.
    ///
    /// # Errors
    /// As [`Self::run`], and where the device cannot run the function.
    pub fn run_on(
        device: Option<&dyn Device>,
        composer: &Composer,
        all: &[Declared],
        declared: &Declared,
        host: &Host,
        waters: &[(f64, bool)],
        effort: &Effort,
    ) -> Result<Self, Report> {
        let specimen = Specimen::new(composer, &declared.module, &Choice::of_waves())?;
        let function = specimen.function(&declared.name)?;
        let reads_water = function.resources().any(|name| name == "water");
        let waters = match (waters, reads_water) {
            ([], true) => &WATERS[..],
            ([], false) => &WATERS[..1],
            (given, true) => given,
            (given, false) => &given[..1],
        };
        let share = waters.len();
        let effort = Effort {
            random: effort.random / share,
            special: effort.special / share,
            climb: effort.climb / share,
            time: effort.time / share as u32,
            seed: effort.seed,
        };
        let mut assay: Option<Self> = None;
        for &water in waters {
            let prepared = prepare(&specimen, &function, declared, all, host, water)?;
            let findings =
                prepared.run(&specimen, &function, declared, device, |s| s.hunt(&effort))?;
            assay
                .get_or_insert_with(|| Self::empty(declared, device))
                .add(&findings, water);
        }
        let mut assay = assay.unwrap_or_else(|| Self::empty(declared, device));
        assay.blame(&specimen, &function, declared, all, host)?;
        Ok(assay)
    }

    fn empty(declared: &Declared, device: Option<&dyn Device>) -> Self {
        Self {
            module: declared.module.clone(),
            function: declared.name.clone(),
            device: device.map(Device::name),
            domain: declared.to_string(),
            against: declared.against.clone(),
            found: Findings::NOTHING,
            parts_at: None,
            worst_numbers: Vec::new(),
            worst: Worst {
                module: declared.module.clone(),
                function: declared.name.clone(),
                cases: Vec::new(),
            },
        }
    }

    fn add(&mut self, findings: &Findings, water: (f64, bool)) {
        self.found.absorb(findings);
        let cases = &mut self.worst.cases;
        cases.extend(findings.worst.iter().map(|case| WorstCase {
            refractive_index: water.0,
            eye_above: water.1,
            case: case.clone(),
        }));
        // What is not finite is worst of all.
        let badness = |c: &WorstCase| c.case.scaled.unwrap_or(f64::INFINITY);
        cases.sort_by(|a, b| badness(b).total_cmp(&badness(a)));
        cases.truncate(WORST_KEPT);
    }

    /// Finds the line at which the worst input's `f32` and `f64` part.
    fn blame(
        &mut self,
        specimen: &Specimen,
        function: &Function,
        declared: &Declared,
        all: &[Declared],
        host: &Host,
    ) -> Result<(), Report> {
        let Some(worst) = self.worst.cases.first() else {
            return Ok(());
        };
        let water = (worst.refractive_index, worst.eye_above);
        let prepared = prepare(specimen, function, declared, all, host, water)?;
        let input = &worst.case.input;
        let names = function.numbers().map(|(name, _)| name);
        self.worst_numbers = names.zip(prepared.domain.numbers(input)).collect();
        let lanes = prepared.domain.lanes(function, std::slice::from_ref(input));
        let trace = function
            .trace(&lanes, 0, &prepared.connected.resources(), 4.0)
            .map_err(|trap| specimen.explain(&trap))?;
        let site = trace.not_finite.or(trace.worst.map(|parting| parting.site));
        self.parts_at = site.and_then(|site| specimen.place(&site)).map(|place| {
            let (line, _) = place.file.line_column(place.range.start);
            format!("{}.wgsl:{line}", Self::module_of(&place, specimen))
        });
        Ok(())
    }

    /// The path of the module that a place is in.
    fn module_of(place: &meniscus_source::Place, specimen: &Specimen) -> String {
        let name = place.file.name.replace('\\', "/");
        let start = name
            .rfind("shader-modules/")
            .map(|at| at + "shader-modules/".len());
        let path = &name[start.unwrap_or(0)..];
        match path.strip_suffix(".wgsl") {
            Some(path) => path.to_owned(),
            None => specimen.path().to_owned(),
        }
    }
}

impl Worst {
    /// Judges the kept inputs again; one [`Findings`] for each, in their order.
    ///
    /// # Errors
    /// Where the function or its domain is gone or wrong, or a run stops.
    pub fn again(
        &self,
        composer: &Composer,
        all: &[Declared],
        host: &Host,
    ) -> Result<Vec<Findings>, Report> {
        let specimen = Specimen::new(composer, &self.module, &Choice::of_waves())?;
        let function = specimen.function(&self.function)?;
        let own = |d: &&Declared| d.module == self.module && d.name == self.function;
        let Some(declared) = all.iter().find(own) else {
            let message = format!("`{}:{}` declares no domain", self.module, self.function);
            return Err(meniscus_source::Diagnostic::error(message).into());
        };
        // Hosts hold large textures: one for each water, not for each case.
        let mut ready: Vec<((f64, bool), Prepared)> = Vec::new();
        let mut found = Vec::new();
        for kept in &self.cases {
            let water = (kept.refractive_index, kept.eye_above);
            let known = ready.iter().position(|(known, _)| *known == water);
            let index = match known {
                Some(index) => index,
                None => {
                    let prepared = prepare(&specimen, &function, declared, all, host, water)?;
                    ready.push((water, prepared));
                    ready.len() - 1
                }
            };
            let cases = std::slice::from_ref(&kept.case);
            let (_, prepared) = &ready[index];
            found.push(prepared.run(&specimen, &function, declared, None, |s| s.again(cases))?);
        }
        Ok(found)
    }
}
