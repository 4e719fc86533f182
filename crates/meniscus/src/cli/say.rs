//! What is printed. Rust's own printing panics where nobody reads any longer.

use std::io::{ErrorKind, Write};

use super::Failure;

/// Prints to standard output. A reader who has gone (`meniscus list | head`) has seen enough; any
/// other refusal, such as that of a full disk, is an error.
pub(crate) fn say(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    let written = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    match written {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Failure::Machine(format!(
            "error: cannot write to standard output: {error}"
        ))),
        _ => Ok(()),
    }
}

/// Prints a line to standard error, if anybody reads it.
pub(crate) fn tell(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}
