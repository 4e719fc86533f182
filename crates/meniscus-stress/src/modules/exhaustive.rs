//! Functions of one `f32`, tried on all of them.

use meniscus_shader::Composer;
use meniscus_source::{Diagnostic, Report};

use super::{Choice, Declared, Host, Specimen, truth};
use crate::ulp::{at_rank, rank};
use crate::{Exhausted, Function, Kind, Shape, Subject};

/// What trying a function of one `f32` on all of them shows.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Exhaustive {
    /// The module's path.
    pub module: String,
    /// The function's name.
    pub function: String,
    /// The independent truth, if one is declared; errors are against `f64` where none is.
    pub against: Option<String>,
    /// The bounds of its domain.
    pub domain: (f32, f32),
    /// On every float between these.
    pub inside: Exhausted,
    /// On all other floats but NaN and infinity.
    pub outside: Exhausted,
}

impl Exhaustive {
    /// Whether a declared function takes one `f32`, so that it can be tried.
    ///
    /// # Errors
    /// Where its module is wrong.
    pub fn suits(composer: &Composer, declared: &Declared) -> Result<bool, Report> {
        let specimen = Specimen::new(composer, &declared.module, &Choice::of_waves())?;
        Ok(takes_one(&specimen.function(&declared.name)?))
    }

    /// Tries a declared function of one `f32` on every finite one; `progress` is told of each part
    /// of the way, from 0 to 1. It takes minutes.
    ///
    /// # Errors
    /// Where the module or its domain is wrong, the function takes something else than one `f32`, or
    /// a run stops.
    pub fn run(
        composer: &Composer,
        all: &[Declared],
        declared: &Declared,
        host: &Host,
        progress: &dyn Fn(f64),
    ) -> Result<Self, Report> {
        /// Floats between two words of progress.
        const PART: i64 = 1 << 24;
        let specimen = Specimen::new(composer, &declared.module, &Choice::of_waves())?;
        let function = specimen.function(&declared.name)?;
        if !takes_one(&function) {
            let message = format!(
                "`{}:{}` does not take one `f32`: it has more inputs than can all be tried",
                declared.module, declared.name
            );
            return Err(Diagnostic::error(message).into());
        }
        let domain = declared.domain(all, &function, host)?;
        let (low, high) = domain.bounds(0).unwrap_or((f32::MIN, f32::MAX));
        let connected = specimen.connect(&function, host)?;
        let truth = declared.against.as_ref().and_then(|name| truth(name, host));
        let subject = Subject {
            function: &function,
            domain: &domain,
            resources: &connected.resources(),
            nearby: &[],
            truth: truth.as_deref(),
            elsewhere: None,
        };
        let (first, last) = (rank(f32::MIN), rank(f32::MAX));
        let (start, end) = (rank(low), rank(high));
        let between = |from: i64, to: i64| {
            let mut found = Exhausted::NOTHING;
            for part in (from..=to).step_by(PART as usize) {
                let ends = (part + PART - 1).min(to);
                let more = subject.exhaust(at_rank(part), at_rank(ends));
                found = found.and(more.map_err(|trap| specimen.explain(&trap))?);
                progress((ends - first) as f64 / (last - first) as f64);
            }
            Ok::<_, Report>(found)
        };
        let below = between(first, start - 1)?;
        let inside = between(start, end)?;
        let outside = below.and(between(end + 1, last)?);
        Ok(Self {
            module: declared.module.clone(),
            function: declared.name.clone(),
            against: declared.against.clone(),
            domain: (low, high),
            inside,
            outside,
        })
    }
}

fn takes_one(function: &Function) -> bool {
    let takes = function.arguments().map(|(_, shape)| shape);
    takes.eq([&Shape::Scalar(Kind::Float)])
}
