//! `meniscus stress --page` and `--solvers`: the page about numerical stability, and its data.

use std::path::{Path, PathBuf};

use clap::Args;
use meniscus::gpu::{Gpu, GpuError};
use meniscus::measure::write_atomically;
use meniscus::source::SourceFile;
use meniscus::stress::modules::Device;
use meniscus::{FunctionsOnGpu, Project, StabilityData, solvers, solvers_figures, stability_page};

use super::arguments::Stress;
use super::say::say;
use super::{Failure, outputs};

/// What the page about numerical stability is made of.
#[derive(Debug, Args)]
#[command(next_help_heading = "The page about numerical stability")]
pub(crate) struct Stability {
    /// Time what fills this slot and hold it to an independent truth; with --json to a file.
    #[arg(long, value_name = "SLOT")]
    solvers: Option<String>,
    /// Write the page from functions.json (`stress --json`), agreement.json (`stress --agreement
    /// --json`), exhaustive.json (`stress --exhaustive --json`), scenes.json (`stress --scenes …
    /// --json`), solvers.json (`stress --solvers … --json`) and told.md, which stand in the folder of
    /// the page's name without its ending.
    #[arg(long, value_name = "FILE.md")]
    page: Option<PathBuf>,
}

impl Stability {
    /// Whether this is asked for, and no functions or scenes.
    pub fn is_asked(&self) -> bool {
        self.page.is_some() || self.solvers.is_some()
    }
}

pub(crate) fn run(project: &Project, stress: &Stress) -> Result<(), Failure> {
    let asked = &stress.stability;
    outputs::check(asked.page.iter().chain(&stress.json), None)?;
    if let Some(slot) = &asked.solvers {
        let gpu = match Gpu::open(None) {
            Err(GpuError::NoAdapter { wanted: None, .. }) => None,
            opened => Some(FunctionsOnGpu(opened?)),
        };
        let device = gpu.as_ref().map(|gpu| gpu as &dyn Device);
        let found = solvers(project, slot, device, stress.seed)?;
        for one in &found {
            let gpu = one.gpu_ns.map_or("—".to_owned(), |ns| format!("{ns:.0}"));
            say(&format!(
                "{}:{} on ({}): {:.0} ns on a core, {gpu} ns on the adapter; ulp: p99 {:.2}, max {:.1}\n",
                one.module, one.function, one.domain, one.cpu_ns, one.p99_ulp, one.max_ulp
            ))?;
        }
        if let Some(path) = &stress.json {
            let text = serde_json::to_string_pretty(&found)
                .map_err(|error| Failure::Machine(format!("error: {error}")))?;
            write_atomically(path, (text + "\n").as_bytes())?;
        }
    }
    if let Some(page) = &asked.page {
        let folder = page.with_extension("");
        let data = data(&folder)?;
        write_atomically(page, stability_page(project, &data)?.as_bytes())?;
        for (index, svg) in solvers_figures(&data)?.iter().enumerate() {
            let name = format!("solvers-{}.svg", index + 1);
            write_atomically(&folder.join(name), svg.as_bytes())?;
        }
        say(&format!("{}\n", page.display()))?;
    }
    Ok(())
}

/// What lies in the folder.
fn data(folder: &Path) -> Result<StabilityData, Failure> {
    let text = |name: &str| -> Result<String, Failure> {
        let file = SourceFile::read(&folder.join(name))?;
        Ok(file.text.clone())
    };
    let wrong = |name: &str, error: serde_json::Error| {
        Failure::Written(format!("error: {}: {error}", folder.join(name).display()))
    };
    let json = |name: &str| -> Result<serde_json::Value, Failure> {
        serde_json::from_str(&text(name)?).map_err(|error| wrong(name, error))
    };
    Ok(StabilityData {
        functions: json("functions.json")?,
        agreement: json("agreement.json")?,
        exhaustive: json("exhaustive.json")?,
        scenes: json("scenes.json")?,
        solvers: serde_json::from_str(&text("solvers.json")?)
            .map_err(|error| wrong("solvers.json", error))?,
        told: text("told.md")?,
    })
}
