//! Running other programs, and saying which one failed.

use std::ffi::{OsStr, OsString};
use std::fmt;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// The machine lacks something that the task needs; the message says what to do.
const LACKING: u8 = 3;

/// Why a task ended early.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Failure {
    /// Exit status of the whole.
    pub(crate) status: u8,
    message: String,
}

impl Failure {
    pub(crate) fn usage(message: String) -> Self {
        Self { status: 2, message }
    }

    pub(crate) fn lacking(message: String) -> Self {
        Self {
            status: LACKING,
            message,
        }
    }

    /// Puts a line in front of the message.
    #[must_use]
    pub(crate) fn after(self, line: &str) -> Self {
        Self {
            message: format!("{line}\n{}", self.message),
            ..self
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

/// The directory of the workspace.
pub(crate) fn workspace() -> PathBuf {
    // Cargo says where the crate is now; where it was built serves a binary that is run by hand.
    let package = std::env::var_os("CARGO_MANIFEST_DIR")
        .unwrap_or_else(|| OsString::from(env!("CARGO_MANIFEST_DIR")));
    let package = PathBuf::from(package);
    match package.parent().and_then(|crates| crates.parent()) {
        Some(root) => root.to_owned(),
        None => PathBuf::from("."),
    }
}

/// The cargo that runs this program.
pub(crate) fn cargo() -> Command {
    let program = std::env::var_os("CARGO").unwrap_or_else(|| OsString::from("cargo"));
    let mut command = Command::new(program);
    command.current_dir(workspace());
    // Without a desktop, a layer of Mesa's that chooses devices prints errors that are none.
    command.env("NODEVICE_SELECT", "1");
    command
}

/// Prints the command and runs it to its end, its output being shown.
pub(crate) fn run(command: &mut Command) -> Result<(), Failure> {
    let line = written(command);
    eprintln!("\n$ {line}");
    let status = command.status().map_err(|problem| {
        Failure::lacking(format!("error: `{line}` could not be started: {problem}"))
    })?;
    if status.success() {
        return Ok(());
    }
    let code = status.code().and_then(|code| u8::try_from(code).ok());
    Err(Failure {
        // A program killed by a signal has no code of its own.
        status: code.filter(|code| *code != 0).unwrap_or(1),
        message: format!("error: `{line}` failed: {status}"),
    })
}

/// Whether a command runs and succeeds; nothing is shown.
pub(crate) fn succeeds(program: impl AsRef<OsStr>, arguments: &[&str]) -> bool {
    Command::new(program)
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success())
}

/// What a command prints; nothing if it fails.
pub(crate) fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program)
        .args(arguments)
        .stdin(Stdio::null())
        .output()
        .ok()?;
    output
        .status
        .success()
        .then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}

/// A command as one would type it; the program without its directory.
fn written(command: &Command) -> String {
    let program = PathBuf::from(command.get_program());
    let program = program.file_stem().unwrap_or_default().to_owned();
    std::iter::once(program.as_os_str())
        .chain(command.get_args())
        .map(|word| {
            let word = word.to_string_lossy();
            if word.is_empty() || word.contains(char::is_whitespace) {
                format!("'{word}'")
            } else {
                word.into_owned()
            }
        })
        .collect::<Vec<_>>()
        .join(" ")
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn the_status_of_a_failed_step_is_passed_on() {
        let failure = run(Command::new("sh").args(["-c", "exit 7"])).expect_err("it fails");
        assert_eq!(failure.status, 7);
        assert!(failure.to_string().contains("sh -c 'exit 7'"), "{failure}");
        assert_eq!(run(Command::new("sh").args(["-c", "exit 0"])), Ok(()));
    }

    #[test]
    fn a_killed_step_is_a_failure() {
        let failure = run(Command::new("sh").args(["-c", "kill -9 $$"])).expect_err("it fails");
        assert_eq!(failure.status, 1);
    }

    #[test]
    fn a_program_that_is_not_there_is_something_lacking() {
        let failure = run(&mut Command::new("no-such-program")).expect_err("it is not there");
        assert_eq!(failure.status, LACKING);
        assert!(!succeeds("no-such-program", &[]));
        assert_eq!(output("no-such-program", &[]), None);
    }

    #[test]
    fn the_workspace_is_where_the_lock_file_is() {
        assert!(workspace().join("Cargo.lock").is_file());
    }
}
