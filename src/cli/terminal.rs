//! All text on stdout and stderr. Control and format characters are escaped, so that no text can steer a terminal.

use super::failure::Failure;
use crate::base::escape;
use crate::encode::Output;
use std::env;
use std::io::{ErrorKind, IsTerminal, Write, stderr, stdout};

/// Whether stderr is a terminal that can move its cursor.
pub fn interactive() -> bool {
    stderr().is_terminal() && env::var_os("TERM").is_none_or(|term| term != "dumb")
}

/// Whether messages may have colours: on such a terminal, unless `NO_COLOR` is set and not empty.
pub fn color() -> bool {
    interactive() && env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

/// Prints a line of results. If the reader went away (`kinora … | head`), that is no error.
pub fn print_line(line: &str) -> Result<(), Failure> {
    written(write_line(&mut stdout(), line))
}

fn written(result: std::io::Result<()>) -> Result<(), Failure> {
    match result {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::Incomplete(format!("cannot write to the standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Prints a file: unchanged, unless a terminal displays it.
pub fn print_text(text: &str) -> Result<(), Failure> {
    if stdout().is_terminal() {
        // Terminals would obey control characters, except that tabs are harmless.
        return print_line(&text.replace('\t', "    "));
    }
    let mut out = stdout();
    written(writeln!(out, "{text}").and_then(|()| out.flush()))
}

/// Fails if frames would go to a closed standard output. Without this check, they would be lost in silence.
pub fn check_stream(outputs: &[Output]) -> Result<(), Failure> {
    if !outputs.iter().any(Output::is_stream) || !stdout_may_be_closed() {
        return Ok(());
    }
    let message = "cannot write to the standard output: it is closed, or it is the null device opened for reading and \
                   writing, which looks the same; connect it to a program, such as `-o - | ffmpeg -i - ...`, or \
                   discard the frames with `> /dev/null`, which opens that device for writing only";
    Err(Failure::Incomplete(message.to_owned()))
}

/// Whether the process may have been started without a standard output. Rust's runtime then opens the null device in
/// its place, for reading and writing, before any code of ours runs. Shells open it for writing alone (`> /dev/null`).
/// Some programs open it for both, such as Python for `subprocess.DEVNULL`, which looks the same as a closed output. An
/// error for these is better than a run that loses its frames in silence.
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

/// Prints a line on stderr: an error, or results if frames go to stdout.
pub fn eprint_line(line: &str) {
    let _ = write_line(&mut stderr(), line);
}

/// Prints an error.
pub fn error(message: &str) {
    let label = if color() { "\x1b[1m\x1b[91merror\x1b[0m" } else { "error" };
    let _ = writeln!(stderr(), "{label}: {}", escape::lines(message));
}

/// Prints why a command failed.
pub fn failure(failure: &Failure) {
    match failure {
        Failure::Bad(message) | Failure::Incomplete(message) => error(message),
        Failure::Stopped { message, .. } if message.is_empty() => {}
        Failure::Stopped { message, .. } => eprint_line(message),
        // These have their colours, and are escaped already.
        Failure::Faults(text) => {
            let _ = writeln!(stderr(), "{}", text.trim_end());
        }
    }
}

/// Writes a line, escaped.
pub fn write_line(out: &mut dyn Write, line: &str) -> std::io::Result<()> {
    writeln!(out, "{}", escape::lines(line))?;
    out.flush()
}
