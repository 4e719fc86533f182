//! Commands, their arguments, and how they end: 0 done, 1 the machine could not do it or pictures
//! differ by more than they may, 2 something that was written is wrong.

mod ablate;
mod arguments;
mod attempts;
mod check;
mod compare;
mod compose;
mod diff;
mod eval;
mod explain;
mod graph;
mod list;
mod moment;
mod new_module;
mod outputs;
mod progress;
mod prove;
mod render;
mod run;
mod say;
mod schema;
mod stability;
mod stress;
mod stress_scenes;
mod sweep;

use std::process::ExitCode;

use clap::Parser;
use meniscus::gpu::{Gpu, GpuError};
use meniscus::source::Report;
use meniscus::{AblationError, Project};

use arguments::{Arguments, Command};

/// Why a command did not do what was asked.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Something that was written is wrong.
    Written(String),
    /// The machine could not do it.
    Machine(String),
    /// It was done, and what was found is beyond a limit that was given.
    Beyond(String),
}

impl From<Report> for Failure {
    fn from(report: Report) -> Self {
        Self::Written(report.to_string().trim_end().to_owned())
    }
}

impl From<meniscus::source::Diagnostic> for Failure {
    fn from(diagnostic: meniscus::source::Diagnostic) -> Self {
        Report::from(diagnostic).into()
    }
}

impl From<GpuError> for Failure {
    fn from(error: GpuError) -> Self {
        match &error {
            GpuError::Size(_) => Self::Written(format!("error: {error}")),
            // The name is wrong, where there are adapters of other names.
            GpuError::NoAdapter {
                wanted: Some(_),
                found,
            } if !found.is_empty() => Self::Written(format!("error: {error}")),
            _ => Self::Machine(format!("error: {error}")),
        }
    }
}

impl From<meniscus::measure::MeasureError> for Failure {
    fn from(error: meniscus::measure::MeasureError) -> Self {
        Self::Machine(format!("error: {error}"))
    }
}

impl From<AblationError> for Failure {
    fn from(error: AblationError) -> Self {
        match error {
            AblationError::Source(report) => report.into(),
            AblationError::Gpu(error) => error.into(),
            AblationError::Measure(error) => error.into(),
        }
    }
}

/// Runs the command of this process's arguments.
pub(crate) fn run() -> ExitCode {
    let arguments = Arguments::parse();
    match execute(arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Written(message)) => {
            say::tell(&message);
            ExitCode::from(2)
        }
        Err(Failure::Machine(message) | Failure::Beyond(message)) => {
            say::tell(&message);
            ExitCode::from(1)
        }
    }
}

fn execute(arguments: Arguments) -> Result<(), Failure> {
    let sources = arguments.sources();
    let project = Project::open(&sources)?;
    match arguments.command {
        Command::List(list) => list::run(&project, &list),
        Command::Check(check) => check::check(&project, &check),
        Command::Compose(compose) => compose::run(&project, &compose),
        Command::Diff(diff) => diff::run(&project, &diff),
        Command::Explain(explain) => explain::run(&project, &explain),
        Command::Prove(prove) => prove::run(&project, &prove, &sources),
        Command::Graph(graph) => graph::run(&project, &graph),
        Command::New(new) => new_module::run(&project, &new),
        Command::Render(render) => render::run(&project, &render),
        Command::Run(asked) => run::run(&project, &asked),
        Command::Ablate(ablate) => ablate::run(&project, &ablate),
        Command::Merge(merge) => sweep::merge(&merge),
        Command::Compare(compare) => compare::run(&compare),
        Command::Eval(eval) => eval::run(&project, &eval),
        Command::Schema(asked) => schema::run(&asked),
        Command::Stress(stress) if stress.stability.is_asked() => stability::run(&project, &stress),
        Command::Stress(stress) if stress.random.is_asked() => {
            stress_scenes::run(&project, &stress)
        }
        Command::Stress(stress) => stress::run(&project, &stress),
        Command::Adapters => adapters(),
    }
}

fn adapters() -> Result<(), Failure> {
    let found = meniscus::gpu::adapters();
    for adapter in &found {
        say::say(&format!("{adapter}\n"))?;
    }
    if found.is_empty() {
        Gpu::open(None)?;
    }
    Ok(())
}
