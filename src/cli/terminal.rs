//! What is on the other end of stdout and stderr.

use super::failure::Failure;
use std::env;
use std::io::{ErrorKind, IsTerminal, Write, stderr, stdout};

/// Whether stderr is a terminal that can move its cursor.
pub fn interactive() -> bool {
    stderr().is_terminal() && env::var_os("TERM").is_none_or(|term| term != "dumb")
}

/// Whether messages may be coloured: on such a terminal, unless `NO_COLOR` is set to anything.
pub fn color() -> bool {
    interactive() && env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

/// Prints a line of results. A reader that went away (`kinora … | head`) does not make a run fail.
pub fn say(line: &str) -> Result<(), Failure> {
    match writeln!(stdout(), "{line}").and_then(|()| stdout().flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::Incomplete(format!("cannot write to the standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Prints a line of errors, or of results where the standard output is taken by them.
pub fn complain(line: &str) {
    let _ = writeln!(stderr(), "{line}");
}
