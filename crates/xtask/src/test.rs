//! All checks of the project, in the order of how soon they can fail.

use std::process::Command;

use crate::command::{self, Failure};
use crate::python::Python;

/// Runs all checks and stops at the first that fails.
///
/// The lints and tests build in the same profile, so that they share what they build. Golden images
/// are only compared here; a task that renders them anew belongs beside this one.
pub(crate) fn test() -> Result<(), Failure> {
    need_components()?;
    let python = Python::find();
    let mut passed: Vec<&str> = Vec::new();
    for (name, mut step) in steps(python) {
        command::run(&mut step).map_err(|failure| failure.after(&tell(&passed, Some(name))))?;
        passed.push(name);
    }
    eprintln!();
    if let Some(lack) = python.lacks() {
        eprintln!("skipped: the check of the figures by another tracer: {lack}");
    }
    eprintln!("{}", tell(&passed, None));
    Ok(())
}

fn steps(python: Python) -> Vec<(&'static str, Command)> {
    let cargo = |arguments: &[&str]| {
        let mut command = command::cargo();
        command.args(arguments);
        command
    };
    let mut steps = vec![
        ("format", cargo(&["fmt", "--all", "--check"])),
        (
            "lints",
            cargo(&[
                "clippy",
                "--workspace",
                "--all-targets",
                "--locked",
                "--",
                "-D",
                "warnings",
            ]),
        ),
    ];
    // The tests have the script check a run; here it checks itself.
    if python == Python::WithNumpy {
        let mut laws = Command::new("python3");
        laws.current_dir(command::workspace())
            .args(["tests/recompute.py", "--laws"]);
        steps.push(("laws of the other tracer", laws));
    }
    steps.push(("tests", cargo(&["test", "--workspace", "--locked"])));
    steps
}

/// `rustfmt` and `clippy` are components of their own.
fn need_components() -> Result<(), Failure> {
    for (subcommand, component) in [("fmt", "rustfmt"), ("clippy", "clippy")] {
        let mut version = command::cargo();
        version.args([subcommand, "--version"]);
        let there = version.output().is_ok_and(|output| output.status.success());
        if !there {
            return Err(Failure::lacking(format!(
                "error: `cargo {subcommand}` is missing. Run this, then try again:\n\n    \
                 rustup component add {component}\n\n\
                 Without rustup, install {component} as you installed Rust."
            )));
        }
    }
    Ok(())
}

/// The line that says how far it went.
fn tell(passed: &[&str], failed: Option<&str>) -> String {
    let passed = if passed.is_empty() {
        "nothing".to_owned()
    } else {
        passed.join(", ")
    };
    match failed {
        None => format!("passed: {passed}"),
        Some(failed) => format!("\npassed: {passed}; failed: {failed}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_step_of_cargo_that_resolves_is_locked() {
        for (name, step) in steps(Python::Missing) {
            let words: Vec<_> = step.get_args().map(|word| word.to_string_lossy()).collect();
            let resolves = words[0] != "fmt";
            assert_eq!(
                words.iter().any(|word| word == "--locked"),
                resolves,
                "{name}"
            );
        }
    }

    #[test]
    fn python_is_asked_only_where_it_has_numpy() {
        let uses = |python| {
            let mut steps = steps(python).into_iter();
            steps.any(|(_, step)| step.get_program() == "python3")
        };
        assert!(uses(Python::WithNumpy));
        for python in [Python::WithoutNumpy, Python::Missing] {
            assert!(!uses(python));
            assert!(python.lacks().is_some());
        }
    }

    #[test]
    fn the_last_line_says_what_passed_and_what_did_not() {
        assert_eq!(tell(&["format", "lints"], None), "passed: format, lints");
        assert!(tell(&["format"], Some("lints")).ends_with("passed: format; failed: lints"));
        assert!(tell(&[], Some("format")).contains("passed: nothing"));
    }
}
