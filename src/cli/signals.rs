//! Ctrl-C and being told to end: the first time, a run stops after the frame in hand; the second time, at once.

use crate::stop::Stop;
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

/// What a stopped run has left, and how to go on with `rest`, the frames that are missing.
pub fn told(
    done: usize,
    files: &[PathBuf],
    arguments: impl Iterator<Item = OsString>,
    rest: &[u32],
) -> String {
    let mut lines = vec![format!("stopped after {}", crate::humane::counted(done as u64, "frame"))];
    lines.extend(files.iter().map(|file| format!("wrote   {}", file.display())));
    lines.push(format!("to go on: {}", command(arguments, rest)));
    lines.join("\n")
}

/// The command with its own frames replaced.
fn command(arguments: impl Iterator<Item = OsString>, rest: &[u32]) -> String {
    let mut words = vec!["kinora".to_owned()];
    let mut arguments = arguments.skip(1).map(|word| word.to_string_lossy().into_owned());
    while let Some(word) = arguments.next() {
        if word == "--frames" {
            arguments.next();
        } else if !word.starts_with("--frames=") {
            words.push(quoted(word));
        }
    }
    words.push(format!("--frames {}", set(rest)));
    words.join(" ")
}

fn quoted(word: String) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=%:,+@".contains(c);
    if word.chars().all(plain) { word } else { format!("'{}'", word.replace('\'', r"'\''")) }
}

/// Frames as ranges with steps.
fn set(frames: &[u32]) -> String {
    let mut parts = Vec::new();
    let mut rest = frames;
    while let [first, after @ ..] = rest {
        let step = after.first().map_or(1, |second| second - first);
        let count = 1 + rest.windows(2).take_while(|pair| pair[1] - pair[0] == step).count();
        let last = rest[count - 1];
        parts.push(match (count, step) {
            (1, _) => first.to_string(),
            (_, 1) => format!("{first}-{last}"),
            _ => format!("{first}-{last}:{step}"),
        });
        rest = &rest[count..];
    }
    parts.join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_to_go_on_names_the_frames_that_are_missing() {
        let words =
            ["/usr/bin/kinora", "render", "a b.ron", "--frames", "0-9", "-o", "f_##.png", "--frames=2"];
        let command = command(words.iter().map(OsString::from), &[5, 6, 7, 8, 9]);
        assert_eq!(command, "kinora render 'a b.ron' -o 'f_##.png' --frames 5-9");
    }

    #[test]
    fn sets_are_short() {
        assert_eq!(set(&[3]), "3");
        assert_eq!(set(&[0, 1, 2, 10, 12, 14, 20]), "0-2,10-14:2,20");
        for frames in [vec![1, 5, 6, 7, 9], vec![0, 2, 3]] {
            let parsed: crate::frame_set::FrameSet = set(&frames).parse().expect("a set");
            assert_eq!(parsed.frames(10), Ok(frames));
        }
    }
}
