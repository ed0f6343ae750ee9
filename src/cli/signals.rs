//! Ctrl-C and SIGTERM. The first one stops a run after the current frame, the second one at once.

use super::shell::quote;
use super::summary::file_name;
use crate::base::cancel::Stop;
use crate::base::frame_set;
use crate::base::units::counted;
use std::ffi::OsString;
use std::path::PathBuf;

/// A stop that Ctrl-C and SIGTERM request. If a signal cannot be watched, it ends the program as usual.
pub fn stop_on_signals() -> Stop {
    use signal_hook::consts::{SIGINT, SIGTERM};
    use signal_hook::flag::{register_conditional_default, register_usize};
    let (stop, again) = (Stop::default(), std::sync::Arc::default());
    for signal in [SIGINT, SIGTERM] {
        // The order matters: the first signal arms the default action for the second one.
        let _ = register_conditional_default(signal, std::sync::Arc::clone(&again));
        let _ = signal_hook::flag::register(signal, std::sync::Arc::clone(&again));
        let _ = register_usize(signal, std::sync::Arc::clone(stop.flag()), signal as usize);
    }
    stop
}

/// Ignores SIGXFSZ. Then a file that exceeds the size limit of the process (`ulimit -f`) fails like any other write,
/// with a message and without leftovers. By default, the system would end the program.
pub fn survive_size_limits() {
    #[cfg(unix)]
    {
        use signal_hook::consts::SIGXFSZ;
        let _ = signal_hook::flag::register(SIGXFSZ, std::sync::Arc::default());
    }
}

/// The command that continues a stopped run.
#[derive(Clone, Copy, Debug)]
pub enum Continuation<'a> {
    /// The same command, which keeps finished frames.
    Same,
    /// The same command for the missing frames.
    MissingFrames(&'a [u32]),
    /// The same command, which starts again.
    StartOver,
}

/// The message of a stopped run: the files that it has written, and how to continue.
pub fn stop_message(
    done: usize,
    files: &[PathBuf],
    arguments: impl Iterator<Item = OsString>,
    continuation: Continuation<'_>,
) -> String {
    let mut lines = vec![format!("stopped after {}", counted(done as u64, "frame"))];
    lines.extend(files.iter().map(|file| format!("wrote   {}", file_name(file))));
    let command = command(arguments, continuation);
    lines.push(match continuation {
        Continuation::Same | Continuation::MissingFrames(_) => format!("to continue: {command}"),
        Continuation::StartOver => format!(
            "to start again: {command}\n(add PNG frames with -o f_####.png, and finished frames are kept next time)"
        ),
    });
    lines.join("\n")
}

/// The command without options that would start again or refuse to continue.
fn command(arguments: impl Iterator<Item = OsString>, continuation: Continuation<'_>) -> String {
    let replaced: &[&str] = match continuation {
        Continuation::MissingFrames(_) => &["--frames", "--shard"],
        Continuation::Same | Continuation::StartOver => &[],
    };
    let mut words = vec!["kinora".to_owned()];
    let mut arguments = arguments.skip(1);
    while let Some(word) = arguments.next() {
        let text = word.to_string_lossy();
        let name = text.split('=').next().unwrap_or_default();
        if replaced.contains(&name) {
            // The value is the next word, unless it is a part of this one.
            if name == text {
                arguments.next();
            }
        } else if !["--overwrite", "--fail-if-exists"].contains(&name) {
            words.push(quote(&word));
        }
    }
    if let Continuation::MissingFrames(rest) = continuation {
        words.push(format!("--frames {}", frame_set::text(rest)));
    }
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_to_continue_keeps_finished_frames() {
        let words =
            "/usr/bin/kinora render a.ron --shard 2/4 --frames 0-9 --overwrite -o f_##.png --frames=2";
        let command = |continuation| command(words.split(' ').map(OsString::from), continuation);
        let rest = command(Continuation::MissingFrames(&[5, 6, 7, 8, 9]));
        assert_eq!(rest, "kinora render a.ron -o 'f_##.png' --frames 5-9");
        let same = "kinora render a.ron --shard 2/4 --frames 0-9 -o 'f_##.png' '--frames=2'";
        let commands = [command(Continuation::Same), command(Continuation::StartOver)];
        assert_eq!(commands, [same, same]);
    }
}
