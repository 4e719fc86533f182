//! `cargo xtask`: sets a machine up, runs the demo, runs the tests.
//!
//! It depends on nothing but the standard library, so that it builds anywhere and at once; in
//! particular it looks for Vulkan adapters without linking wgpu.

mod command;
mod demo;
mod python;
mod setup;
mod test;
mod vulkan;

use std::process::ExitCode;

use command::Failure;

const HELP: &str = "\
Sets the machine up, runs the demo, runs the tests.

Usage: cargo xtask <COMMAND> [--no-setup]

Commands:
  demo   Renders the pool with several pipelines, compares them with ray-traced truth, and says
         where the pictures and the table are
  test   Checks the format, lints, and runs all tests
  setup  Only makes sure that there is a Vulkan adapter, as the others do first
  help   Prints this

Options:
  --no-setup  Takes the machine as it is, for adapters that the search does not know of

Set-up: on Linux, a Vulkan loader and a driver that has a device to drive. On Debian and Ubuntu
without them, mesa-vulkan-drivers and libvulkan1 (a software adapter) are installed by apt-get, as root
or where `sudo -n` works; elsewhere the command to run is printed. macOS and Windows need nothing.

Exit status: 0 done; 2 wrong usage; 3 the machine lacks something, and what to do is printed; else
that of the step that failed.
";

/// What was asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Task {
    Demo,
    Test,
    Setup,
    Help,
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args_os()
        .skip(1)
        .map(|argument| argument.to_string_lossy().into_owned())
        .collect();
    match read(&arguments).and_then(|(task, set_up)| run(task, set_up)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("{failure}");
            ExitCode::from(failure.status)
        }
    }
}

/// The task, and whether to set the machine up for it.
fn read(arguments: &[String]) -> Result<(Task, bool), Failure> {
    let mut task = None;
    let mut set_up = true;
    for argument in arguments {
        let found = match argument.as_str() {
            "--no-setup" => {
                set_up = false;
                continue;
            }
            "demo" => Task::Demo,
            "test" => Task::Test,
            "setup" => Task::Setup,
            "help" | "--help" | "-h" => Task::Help,
            other => {
                return Err(Failure::usage(format!(
                    "error: there is no command or option `{other}`; see `cargo xtask help`"
                )));
            }
        };
        if task.is_some_and(|task| task != found) {
            return Err(Failure::usage(
                "error: one command at a time; see `cargo xtask help`".into(),
            ));
        }
        task = Some(found);
    }
    let task = task.ok_or_else(|| Failure::usage(HELP.into()))?;
    Ok((task, set_up))
}

fn run(task: Task, set_up: bool) -> Result<(), Failure> {
    if task == Task::Help {
        print!("{HELP}");
        return Ok(());
    }
    if set_up || task == Task::Setup {
        setup::set_up()?;
    }
    match task {
        Task::Demo => demo::demo(),
        Task::Test => test::test(),
        Task::Setup | Task::Help => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_words(words: &str) -> Result<(Task, bool), Failure> {
        let words: Vec<String> = words.split_whitespace().map(str::to_owned).collect();
        read(&words)
    }

    #[test]
    fn a_command_and_its_option_may_stand_in_either_order() {
        assert_eq!(read_words("demo").ok(), Some((Task::Demo, true)));
        assert_eq!(read_words("test --no-setup"), read_words("--no-setup test"));
        assert_eq!(
            read_words("test --no-setup").ok(),
            Some((Task::Test, false))
        );
    }

    #[test]
    fn wrong_usage_is_told_apart_from_failed_steps() {
        for (words, says) in [
            ("", "Usage:"),
            ("--no-setup", "Usage:"),
            ("tset", "`tset`"),
            ("demo --fast", "`--fast`"),
            ("demo test", "one command"),
        ] {
            let failure = read_words(words).expect_err(words);
            assert_eq!(failure.status, 2);
            assert!(failure.to_string().contains(says), "{words}: {failure}");
        }
    }
}
