//! Ctrl-C and being told to end: the first time, a run stops after the frame in hand; the second time, at once.

use super::shell::quoted;
use crate::base::cancel::Stop;
use crate::base::escape;
use crate::base::frame_set;
use std::ffi::OsString;
use std::path::PathBuf;

/// A stop that Ctrl-C (and SIGTERM) ask for. Where signals cannot be watched, they end the program as ever.
pub fn watched() -> Stop {
    use signal_hook::consts::{SIGINT, SIGTERM};
    use signal_hook::flag::{register_conditional_default, register_usize};
    let (stop, again) = (Stop::default(), std::sync::Arc::default());
    for signal in [SIGINT, SIGTERM] {
        // In this order: what is armed by the first signal works from the second on.
        let _ = register_conditional_default(signal, std::sync::Arc::clone(&again));
        let _ = signal_hook::flag::register(signal, std::sync::Arc::clone(&again));
        let _ = register_usize(signal, std::sync::Arc::clone(stop.flag()), signal as usize);
    }
    stop
}

/// Lets a file that would become larger than the process may make one (`ulimit -f`) fail as any other that cannot be
/// written, with a message and without temporaries that stay. By itself, the system ends the program.
pub fn survive_size_limits() {
    #[cfg(unix)]
    {
        use signal_hook::consts::SIGXFSZ;
        let _ = signal_hook::flag::register(SIGXFSZ, std::sync::Arc::default());
    }
}

/// What goes on with a run that was stopped.
#[derive(Clone, Copy, Debug)]
pub enum Next<'a> {
    /// The same command, which keeps the frames that are there.
    Same,
    /// The same for the frames that are missing.
    Frames(&'a [u32]),
    /// The same command, which starts anew.
    Anew,
}

/// What a stopped run has left, and how to go on.
pub fn told(
    done: usize,
    files: &[PathBuf],
    arguments: impl Iterator<Item = OsString>,
    next: Next<'_>,
) -> String {
    let mut lines = vec![format!("stopped after {}", crate::base::units::counted(done as u64, "frame"))];
    lines.extend(files.iter().map(|file| format!("wrote   {}", escape::path(file))));
    let command = command(arguments, next);
    lines.push(match next {
        Next::Same | Next::Frames(_) => format!("to go on: {command}"),
        Next::Anew => format!(
            "to start again: {command}\n(with frames as PNG too, -o f_####.png, those that are done are kept)"
        ),
    });
    lines.join("\n")
}

/// The command without what would start anew or refuse to go on; with its own frames replaced, if need be.
fn command(arguments: impl Iterator<Item = OsString>, next: Next<'_>) -> String {
    let replaced: &[&str] = match next {
        Next::Frames(_) => &["--frames", "--shard"],
        Next::Same | Next::Anew => &[],
    };
    let mut words = vec!["kinora".to_owned()];
    let mut arguments = arguments.skip(1);
    while let Some(word) = arguments.next() {
        let text = word.to_string_lossy();
        let name = text.split('=').next().unwrap_or_default();
        if replaced.contains(&name) {
            // Its value is the next word, unless it is a part of this one.
            if name == text {
                arguments.next();
            }
        } else if !["--overwrite", "--fail-if-exists"].contains(&name) {
            words.push(quoted(&word));
        }
    }
    if let Next::Frames(rest) = next {
        words.push(format!("--frames {}", frame_set::text(rest)));
    }
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_to_go_on_keeps_what_is_done() {
        let words =
            "/usr/bin/kinora render a.ron --shard 2/4 --frames 0-9 --overwrite -o f_##.png --frames=2";
        let command = |next| command(words.split(' ').map(OsString::from), next);
        let rest = command(Next::Frames(&[5, 6, 7, 8, 9]));
        assert_eq!(rest, "kinora render a.ron -o 'f_##.png' --frames 5-9");
        let same = "kinora render a.ron --shard 2/4 --frames 0-9 -o 'f_##.png' --frames=2";
        assert_eq!((command(Next::Same).as_str(), command(Next::Anew).as_str()), (same, same));
    }
}
