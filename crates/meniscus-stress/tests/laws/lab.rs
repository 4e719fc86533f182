//! Modules of `shader-modules/`, called with many inputs at once.

use std::path::Path;
use std::sync::Arc;

use fastrand::Rng;
use glam::DVec3;
use meniscus_shader::{Composer, Filling, Library};
use meniscus_source::SourceFile;
use meniscus_source::ron::Spanned;
use meniscus_stress::modules::{Choice, Host, Specimen};
use meniscus_stress::{Lanes, Scalar};

/// The built-in modules and stubs.
pub fn composer(stubs: &[(&str, &str)]) -> Composer {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shader-modules");
    let mut files = meniscus_source::read_tree(&folder, "wgsl").expect("the modules read");
    for (path, text) in stubs {
        files.push((
            (*path).to_owned(),
            SourceFile::new(format!("{path}.wgsl"), *text),
        ));
    }
    let named = files
        .iter()
        .map(|(path, file)| (path.as_str(), Arc::clone(file)));
    Composer::new(Library::new(named).0)
}

/// A filling without numbers or slots of its own.
pub fn plain(module: &str) -> Filling {
    Filling::plain(Spanned::unplaced(module.to_owned()))
}

/// A choice of fillings.
pub fn choice(slots: &[(&str, &str)]) -> Choice {
    let slots = slots
        .iter()
        .map(|(slot, module)| ((*slot).to_owned(), plain(module)));
    Choice {
        slots: slots.collect(),
        ..Choice::default()
    }
}

/// A module and what its host gives it.
pub struct Lab {
    pub specimen: Specimen,
    pub host: Host,
}

impl Lab {
    pub fn of(path: &str) -> Self {
        Self::with(&composer(&[]), path, &Choice::default())
    }

    #[track_caller]
    pub fn with(composer: &Composer, path: &str, choice: &Choice) -> Self {
        match Specimen::new(composer, path, choice) {
            Ok(specimen) => Self {
                specimen,
                host: Host::default(),
            },
            Err(report) => panic!("{report}"),
        }
    }

    /// With other water.
    pub fn water(mut self, index: f64, eye_above: bool) -> Self {
        self.host.water(index, eye_above);
        self
    }

    /// Which number of a function's result has a path such as `.position.x`.
    #[track_caller]
    pub fn leaf(&self, name: &str, path: &str) -> usize {
        let function = self
            .specimen
            .function(name)
            .unwrap_or_else(|e| panic!("{e}"));
        let leaves = function.result().expect("a result").leaves();
        let found = leaves.iter().position(|(leaf, _)| leaf == path);
        found.unwrap_or_else(|| panic!("no {path} in {leaves:?}"))
    }

    /// Calls a function, in as many lanes as its arguments have.
    #[track_caller]
    pub fn call<S: Scalar>(&self, name: &str, arguments: &[Lanes<S>]) -> Lanes<S> {
        let function = self
            .specimen
            .function(name)
            .unwrap_or_else(|e| panic!("{e}"));
        let connected = self
            .specimen
            .connect(&function, &self.host)
            .unwrap_or_else(|e| panic!("{e}"));
        let lanes = arguments[0].columns[0].len();
        function
            .call(arguments, lanes, &connected.resources())
            .unwrap_or_else(|trap| panic!("{}", self.specimen.explain(&trap)))
    }
}

/// A structure of what its members are.
pub fn structure<S: Scalar>(members: &[Lanes<S>]) -> Lanes<S> {
    let columns = members.iter().flat_map(|m| m.columns.clone()).collect();
    Lanes { columns }
}

pub fn vectors<S: Scalar>(values: &[DVec3]) -> Lanes<S> {
    let values: Vec<[f32; 3]> = values.iter().map(|v| v.as_vec3().to_array()).collect();
    Lanes::vectors(&values)
}

pub fn scalars<S: Scalar>(values: &[f64]) -> Lanes<S> {
    let values: Vec<f32> = values.iter().map(|&v| v as f32).collect();
    Lanes::scalars(&values)
}

/// Three numbers of a lane, from a number on.
pub fn vec3<S: Scalar>(lanes: &Lanes<S>, first: usize, lane: usize) -> DVec3 {
    let at = |i: usize| lanes.columns[first + i].as_f64(lane);
    DVec3::new(at(0), at(1), at(2))
}

/// One number of a lane; 1 for true.
pub fn number<S: Scalar>(lanes: &Lanes<S>, leaf: usize, lane: usize) -> f64 {
    lanes.columns[leaf].as_f64(lane)
}

pub fn rng() -> Rng {
    Rng::with_seed(20_200_911)
}

/// A direction, all equally likely, rounded as a shader gets it.
pub fn unit(rng: &mut Rng) -> DVec3 {
    loop {
        let mut within = || 2.0 * rng.f64() - 1.0;
        let v = DVec3::new(within(), within(), within());
        if (1e-4..=1.0).contains(&v.length_squared()) {
            return v.normalize().as_vec3().as_dvec3();
        }
    }
}

pub fn units(rng: &mut Rng, count: usize) -> Vec<DVec3> {
    (0..count).map(|_| unit(rng)).collect()
}

/// Floats that lie anywhere in a range.
pub fn within(rng: &mut Rng, low: f64, high: f64, count: usize) -> Vec<f64> {
    (0..count)
        .map(|_| f64::from((low + (high - low) * rng.f64()) as f32))
        .collect()
}

/// Floats of any size between two, as likely in each decade.
pub fn decades(rng: &mut Rng, low: f64, high: f64, count: usize) -> Vec<f64> {
    let (a, b) = (low.ln(), high.ln());
    (0..count)
        .map(|_| f64::from((a + (b - a) * rng.f64()).exp() as f32))
        .collect()
}

/// Points of a box around the origin.
pub fn points(rng: &mut Rng, reach: f64, count: usize) -> Vec<DVec3> {
    let mut at = || f64::from((reach * (2.0 * rng.f64() - 1.0)) as f32);
    (0..count).map(|_| DVec3::new(at(), at(), at())).collect()
}
