//! What is on the other end of stdout and stderr. All text goes through here, and none of it steers a terminal: control
//! and format characters are escaped, whoever they come from.

use super::failure::Failure;
use crate::base::escape;
use crate::encode::Output;
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
    match tell(&mut stdout(), line) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::Incomplete(format!("cannot write to the standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Refuses to write frames to a standard output that is closed, as it would be refused by one whose reader goes away.
pub fn check_stream(outputs: &[Output]) -> Result<(), Failure> {
    if !outputs.iter().any(Output::is_stream) || !stdout_may_be_closed() {
        return Ok(());
    }
    let message = "cannot write to the standard output: it is closed, or it is the null device opened for reading and \
                   writing, which looks the same; give it a reader, such as `-o - | ffmpeg -i - ...`, or discard the \
                   frames with `> /dev/null`, which opens that device for writing only";
    Err(Failure::Incomplete(message.to_owned()))
}

/// Whether the process may have been started without a standard output. Rust's runtime then opens the null device in its
/// place, for reading and writing, before any code of ours runs. Shells open it for writing alone (`> /dev/null`). Some
/// programs open it for both, such as Python for `subprocess.DEVNULL`: nothing distinguishes that from a closed output, and
/// to lose a run's frames in silence is worse than to ask for another output.
#[cfg(unix)]
fn stdout_may_be_closed() -> bool {
    use rustix::fs::{OFlags, fcntl_getfl};
    use std::fs::{File, metadata};
    use std::os::fd::AsFd;
    use std::os::unix::fs::MetadataExt;
    let device = |found: std::io::Result<std::fs::Metadata>| found.ok().map(|found| found.rdev());
    let Ok(file) = stdout().as_fd().try_clone_to_owned().map(File::from) else { return true };
    let null = device(metadata("/dev/null"));
    let both = fcntl_getfl(&file).is_ok_and(|flags| flags & OFlags::RWMODE == OFlags::RDWR);
    both && null.is_some() && device(file.metadata()) == null
}

#[cfg(not(unix))]
fn stdout_may_be_closed() -> bool {
    false
}

/// Prints a line of errors, or of results where the standard output is taken by them.
pub fn complain(line: &str) {
    let _ = tell(&mut stderr(), line);
}

/// Prints an error.
pub fn error(message: &str) {
    let label = if color() { "\x1b[1m\x1b[91merror\x1b[0m" } else { "error" };
    let _ = writeln!(stderr(), "{label}: {}", escape::lines(message));
}

/// Prints the faults of a file, which are laid out with colours and escaped already.
pub fn faults(text: &str) {
    let _ = writeln!(stderr(), "{}", text.trim_end());
}

/// Writes a line to whoever reads it.
pub fn tell(out: &mut dyn Write, line: &str) -> std::io::Result<()> {
    writeln!(out, "{}", escape::lines(line))?;
    out.flush()
}
