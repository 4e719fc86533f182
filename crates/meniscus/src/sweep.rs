//! Points of a sweep: every combination of some settings' values.

use std::io::Write as _;
use std::str::FromStr;

use meniscus_gpu::Gpu;
use meniscus_pipeline::Plan;
use meniscus_source::{Diagnostic, Report};

use crate::ablation::Ablation;
use crate::facts::facts_of;
use crate::project::Project;
use crate::provenance::provenance;

/// The most points of a sweep.
const MAX_POINTS: usize = 10_000;

/// A setting and the values it takes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Axis {
    /// The setting.
    pub key: String,
    /// Its values as they are written on the command line.
    pub values: Vec<String>,
}

impl FromStr for Axis {
    type Err = Diagnostic;

    /// Reads `KEY=VALUE,VALUE,…`.
    fn from_str(text: &str) -> Result<Self, Diagnostic> {
        let wrong = |what: &str| {
            Diagnostic::error(format!("`{text}`: {what}"))
                .with_help("write KEY=VALUE,VALUE,… such as water.rms_slope=0,0.05,0.1")
        };
        let (key, values) = text
            .split_once('=')
            .ok_or_else(|| wrong("there is no `=`"))?;
        let values: Vec<String> = values.split(',').map(|v| v.trim().to_owned()).collect();
        if key.trim().is_empty() || values.iter().any(String::is_empty) {
            return Err(wrong("the key or a value is missing"));
        }
        if let Some(twice) = (1..values.len()).find(|i| values[..*i].contains(&values[*i])) {
            return Err(wrong(&format!("`{}` stands there twice", values[twice])));
        }
        Ok(Self {
            key: key.trim().to_owned(),
            values,
        })
    }
}

/// Every combination of the axes' values, the last axis changing fastest.
///
/// # Errors
/// When a key stands twice, or there are more than ten thousand points.
pub fn points(axes: &[Axis]) -> Result<Vec<Vec<(String, String)>>, Diagnostic> {
    if let Some(twice) = (1..axes.len()).find(|i| axes[..*i].iter().any(|a| a.key == axes[*i].key))
    {
        let message = format!("`{}` is swept twice", axes[twice].key);
        return Err(Diagnostic::error(message).with_help("give all its values at once"));
    }
    let mut all = vec![Vec::new()];
    for axis in axes {
        if all.len() * axis.values.len() > MAX_POINTS {
            return Err(Diagnostic::error(format!(
                "the sweep has more than {MAX_POINTS} points"
            )));
        }
        let longer = |point: &Vec<(String, String)>, value: &String| {
            let mut point = point.clone();
            point.push((axis.key.clone(), value.clone()));
            point
        };
        all = all
            .iter()
            .flat_map(|point| axis.values.iter().map(move |value| longer(point, value)))
            .collect();
    }
    Ok(all)
}

/// One of several parts that a sweep is divided into.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Partition {
    part: usize,
    of: usize,
}

impl Partition {
    /// Whether this part runs the point of an index.
    pub fn holds(self, index: usize) -> bool {
        index % self.of == self.part - 1
    }
}

impl FromStr for Partition {
    type Err = String;

    /// Reads `K/N`: the K-th of N parts.
    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("`{text}` is no part; write K/N with K from 1 to N, such as 2/5");
        let (part, of) = text.split_once('/').ok_or_else(wrong)?;
        let number = |text: &str| text.trim().parse::<usize>().map_err(|_| wrong());
        let (part, of) = (number(part)?, number(of)?);
        match (1..=of).contains(&part) {
            true => Ok(Self { part, of }),
            false => Err(wrong()),
        }
    }
}

/// What an ablation's results depend on, hashed: the program, the adapter, the scene, the composed
/// shaders and what they are given, the size and the rounds. Equal hashes promise equal results,
/// times aside.
///
/// # Errors
/// When a pipeline does not compose.
pub fn fingerprint(ablation: &Ablation, project: &Project, gpu: &Gpu) -> Result<String, Report> {
    let mut hasher = blake3::Hasher::new();
    // Writing into a hasher cannot fail. Debug shows floats with all their digits.
    let _ = write!(
        hasher,
        "{:?}\n{:?}\n{:?}\n{:?}\n{:?}\n",
        provenance(gpu, ablation.pruning),
        ablation.scene,
        ablation.truth,
        ablation.size,
        ablation.rounds,
    );
    let _ = writeln!(hasher, "{:?} {:?}", ablation.settings, ablation.baseline);
    let _ = writeln!(hasher, "{:?} {:?}", ablation.moments, ablation.rivalry);
    for pipeline in &ablation.pipelines {
        let facts = facts_of(&ablation.scene, ablation.size);
        let plan = Plan::pruned(pipeline, &project.composer, &facts, ablation.pruning, true)?;
        let _ = writeln!(hasher, "{} {:?}", pipeline.name, plan.textures);
        for pass in &plan.passes {
            let _ = writeln!(
                hasher,
                "{} {:?} {} {:?}",
                pass.name, pass.kind, pass.shader.hash, pass.numbers
            );
        }
    }
    Ok(hasher.finalize().to_hex().to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(text: &str) -> Axis {
        text.parse().unwrap()
    }

    #[test]
    fn a_sweep_has_every_combination_once() {
        let all = points(&[axis("a=1,2,3"), axis("b=x,y")]).unwrap();
        assert_eq!(all.len(), 6);
        let different: std::collections::HashSet<_> = all.iter().collect();
        assert_eq!(different.len(), 6);
        assert!(all.iter().all(|p| p[0].0 == "a" && p[1].0 == "b"));
    }

    #[test]
    fn parts_hold_every_point_once() {
        let parts: Vec<Partition> = (1..=3).map(|k| format!("{k}/3").parse().unwrap()).collect();
        for index in 0..20 {
            assert_eq!(parts.iter().filter(|part| part.holds(index)).count(), 1);
        }
        for wrong in ["0/3", "4/3", "1", "1/0", "a/b", "-1/3", ""] {
            assert!(wrong.parse::<Partition>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn axes_that_mean_nothing_are_refused() {
        for wrong in ["", "a", "=1", "a=", "a=1,,2", "a=1,1"] {
            assert!(wrong.parse::<Axis>().is_err(), "{wrong}");
        }
        assert!(points(&[axis("a=1"), axis("a=2")]).is_err());
        let many = (0..200)
            .map(|i| i.to_string())
            .collect::<Vec<_>>()
            .join(",");
        let [a, b] = ["a", "b"].map(|key| axis(&format!("{key}={many}")));
        assert!(points(&[a, b]).is_err());
    }
}
