//! `meniscus list`

use clap::{Args, ValueEnum};
use meniscus::Project;
use meniscus::scene::keys;
use meniscus::shader::Role;

use super::Failure;
use super::say::say;

#[derive(Debug, Args)]
pub(crate) struct List {
    /// What to list; all but settings if nothing is said.
    pub what: Vec<Listed>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Listed {
    /// What modules can fill in a pass.
    Slots,
    /// WGSL files.
    Modules,
    /// What can be rendered.
    Pipelines,
    /// What can be looked at.
    Scenes,
    /// What `--set` can change, with units and ranges.
    Settings,
}

pub(crate) fn run(project: &Project, list: &List) -> Result<(), Failure> {
    let wanted = |what: Listed| match list.what.is_empty() {
        true => what != Listed::Settings,
        false => list.what.contains(&what),
    };
    if wanted(Listed::Slots) {
        print(
            "slots",
            modules(
                project,
                |role| role == Role::Slot,
                |path| path.trim_start_matches("slots/"),
            ),
        )?;
    }
    if wanted(Listed::Modules) {
        print(
            "modules",
            modules(project, |role| role != Role::Slot, |path| path),
        )?;
    }
    if wanted(Listed::Pipelines) {
        let names = project.pipelines.names();
        print(
            "pipelines",
            names
                .map(|name| {
                    (
                        name.to_owned(),
                        about(project.pipeline(name).map(|p| p.about)),
                    )
                })
                .collect(),
        )?;
    }
    if wanted(Listed::Scenes) {
        print(
            "scenes",
            project
                .scenes
                .iter()
                .map(|scene| (scene.name.clone(), about(scene.about())))
                .collect(),
        )?;
    }
    if wanted(Listed::Settings) {
        print(
            "settings",
            keys()
                .map(|key| {
                    (
                        key.name.to_owned(),
                        format!("{} ({})", key.meaning, key.values),
                    )
                })
                .collect(),
        )?;
    }
    Ok(())
}

/// A line about it; what is wrong with a file is `check`'s to tell in full.
fn about(said: Result<String, meniscus::source::Report>) -> String {
    said.unwrap_or_else(|_| "(does not read: see `meniscus check`)".to_owned())
}

fn modules(
    project: &Project,
    role: impl Fn(Role) -> bool,
    name: impl Fn(&str) -> &str,
) -> Vec<(String, String)> {
    project
        .composer
        .library()
        .modules()
        .filter(|module| role(module.role()))
        .map(|module| (name(&module.path).to_owned(), module.header.purpose.clone()))
        .collect()
}

fn print(title: &str, lines: Vec<(String, String)>) -> Result<(), Failure> {
    let mut text = format!("{title}\n");
    let width = lines.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    for (name, purpose) in lines {
        text += &format!("  {name:width$}  {purpose}\n");
    }
    text.push('\n');
    say(&text)
}
