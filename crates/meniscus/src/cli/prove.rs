//! `meniscus prove`

use std::fmt::Write as _;

use clap::Args;
use meniscus::{Case, Project, Proof, Proved, Sources};

use super::Failure;
use super::arguments::{Changes, Look};
use super::progress::Bar;
use super::say::say;

#[derive(Debug, Args)]
pub(crate) struct Prove {
    /// The pipeline, by name or file.
    pub pipeline: String,
    #[command(flatten)]
    pub look: Look,
    #[command(flatten)]
    pub changes: Changes,
    /// How many configurations are drawn at random, beside the scene as it stands: cameras, waves,
    /// times. What `--set` says stays as it says.
    #[arg(long, value_name = "NUMBER", default_value_t = 40, value_parser = clap::value_parser!(u32).range(0..=1_000_000))]
    pub cases: u32,
    /// Equal seeds draw equal configurations.
    #[arg(long, value_name = "NUMBER", default_value_t = 1)]
    pub seed: u64,
}

pub(crate) fn run(project: &Project, prove: &Prove, sources: &Sources) -> Result<(), Failure> {
    let mut pipelines = [project.pipeline(&prove.pipeline)?];
    prove.changes.apply(&mut pipelines)?;
    let settings = prove.look.settings()?;
    let proof = Proof {
        pipeline: &pipelines[0],
        scene: prove.look.scene_name(),
        settings: &settings,
        size: prove.look.size,
        cases: prove.cases,
        seed: prove.seed,
    };
    let gpu = prove.look.gpu()?;
    let bar = Bar::new();
    let proved = proof.run(project, &gpu, &|what, part| bar.tell(what, part));
    bar.finish();
    let proved = proved?;
    let summary = summary(prove, &proved);
    if proved.differences.is_empty() {
        return say(&format!("{summary}on {}\n", gpu.facts()));
    }
    let mut text = String::new();
    for difference in &proved.differences {
        let _ = writeln!(text, "{difference}");
    }
    if let Some(first) = proved.differences.first() {
        let command = command(prove, sources, &first.case);
        let _ = writeln!(text, "\nthe first one again:\n  {command}\n");
    }
    Err(Failure::Beyond(format!("{text}{}", summary.trim_end())))
}

fn summary(prove: &Prove, proved: &Proved) -> String {
    let differences = match proved.differences.len() {
        0 => "no difference".to_owned(),
        1 => "1 difference".to_owned(),
        many => format!("{many} differences"),
    };
    let [ran, all] = proved.passes;
    let mut text = format!(
        "{}: {differences} in {} pictures of {} configurations; {ran} passes ran with all pruning, \
         {all} with none\n",
        prove.pipeline, proved.pictures, proved.cases
    );
    if proved.approximate > 0 {
        let _ = writeln!(
            text,
            "in {} of them, what is left out beyond that moves what is shown by at most {:.3} px",
            proved.approximate, proved.largest_px
        );
    }
    text
}

/// The command that tries one case alone.
fn command(prove: &Prove, sources: &Sources, case: &Case) -> String {
    let mut words = vec!["meniscus".to_owned()];
    let folders = [
        ("--modules", &sources.modules),
        ("--pipelines", &sources.pipelines),
        ("--scenes", &sources.scenes),
    ];
    for (option, folders) in folders {
        for folder in folders {
            words.extend([option.to_owned(), folder.display().to_string()]);
        }
    }
    let [width, height] = prove.look.size;
    let scene = prove.look.scene_name();
    for word in ["prove", &prove.pipeline, "--scene", scene, "--cases", "0"] {
        words.push(word.to_owned());
    }
    words.extend(["--size".to_owned(), format!("{width}x{height}")]);
    let options = [("--with", &prove.changes.with), ("--set", &prove.look.set)];
    for (option, values) in options {
        for value in values {
            words.extend([option.to_owned(), value.clone()]);
        }
    }
    for (key, value) in &case.settings {
        words.extend(["--set".to_owned(), format!("{key}={value}")]);
    }
    if let Some(adapter) = &prove.look.adapter {
        words.extend(["--adapter".to_owned(), adapter.clone()]);
    }
    let quoted: Vec<String> = words.iter().map(|word| quoted(word)).collect();
    quoted.join(" ")
}

/// A word as shells take it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_=./,:".contains(c);
    match word.chars().all(plain) && !word.is_empty() {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', "'\\''")),
    }
}
