//! The metadata of a frame's file: text chunks in PNG, lines of one attribute in EXR.
//!
//! Most entries are known before the frame is rendered, and they are part of its [identity](super::identity). The noise
//! that sampling reached is not part of it, because it follows from the other entries, as the pixels do.

use super::frame_key::FrameKey;
use super::info::{FrameInfo, TimeBudget};
use crate::film::Noise;

/// A keyword and its value.
pub type TextEntry = (&'static str, String);

/// A keyword and its value, read from a file.
pub type StoredTextEntry = (String, String);

/// The keyword of the sequence's name.
pub const TITLE: &str = "Title";
/// The keyword of the sequence's number of frames.
pub const FRAMES: &str = "kinora:frames";
/// The keyword of the frame's number.
pub const FRAME: &str = "kinora:frame";
/// The keyword of the frame's start time in seconds, as a fraction.
pub const TIME: &str = "kinora:time";
/// The keyword of the time limit and of the numbers of samples that it led to.
pub const TIME_LIMIT: &str = "kinora:time-limit";
/// The keyword of the noise that sampling reached.
const ERROR: &str = "kinora:error";

/// The entries that are known before a frame is rendered. They contain no date, so that equal frames are equal files.
/// If the frame's key is known, they contain the sampling settings that affect the frame.
pub fn frame_entries(info: &FrameInfo, key: Option<&FrameKey>) -> Vec<TextEntry> {
    let sequence = info.sequence;
    let mut entries = vec![
        ("Software", format!("Kinora {}", env!("CARGO_PKG_VERSION"))),
        (TITLE, sequence.name.clone()),
        (FRAME, info.frame.to_string()),
        (FRAMES, sequence.frames.to_string()),
        (TIME, info.time().to_string()),
    ];
    match key.map(|key| key.random) {
        Some(true) => {
            entries.push(("kinora:seed", sequence.seed.to_string()));
            entries.extend(sequence.vary_noise.then(|| ("kinora:vary_noise", "true".to_owned())));
            entries.push(match sequence.noise {
                Some(error) => ("kinora:noise", error.to_string()),
                None => ("kinora:samples", sequence.samples.to_string()),
            });
            entries.extend(sequence.denoised.then(|| ("kinora:denoise", "Auto".to_owned())));
        }
        Some(false) => entries.push(("kinora:antialias", sequence.antialias.to_string())),
        None => {}
    }
    let settled = |limit| format!("{limit}, samples={} antialias={}", sequence.samples, sequence.antialias);
    entries.extend(sequence.time_limit.map(|limit: TimeBudget| (TIME_LIMIT, settled(limit))));
    entries
}

/// The noise that sampling reached, the number of samples, and whether the frame was denoised, if it might have been.
/// Numbers are written so that they read back exactly.
pub fn noise_entry(noise: &Noise) -> TextEntry {
    let Noise { error, low, high, samples, capped, denoised } = noise;
    let mut text = format!("{error} low={low} high={high} samples={samples} capped={capped}");
    text.extend(denoised.map(|denoised| format!(" denoised={denoised}")));
    (ERROR, text)
}

/// Reads the [`noise_entry`].
pub fn find_noise(entries: &[StoredTextEntry]) -> Option<Noise> {
    let mut words = find(entries, ERROR)?.split(' ');
    let error = words.next()?.parse().ok()?;
    let mut named = |name: &str| -> Option<&str> { words.next()?.strip_prefix(name)?.strip_prefix('=') };
    let mut number = |name: &str| -> Option<f64> { named(name)?.parse().ok() };
    let [low, high, samples, capped] = ["low", "high", "samples", "capped"].map(&mut number);
    let denoised = named("denoised").and_then(|word| word.parse().ok());
    Some(Noise { error, low: low?, high: high?, samples: samples?, capped: capped?, denoised })
}

/// The numbers of samples that this time limit led to: random samples per pixel, and samples along each side of a
/// pixel's grid.
pub fn find_sample_counts(entries: &[StoredTextEntry], limit: &TimeBudget) -> Option<(u32, u32)> {
    let counts = find(entries, TIME_LIMIT)?.strip_prefix(&limit.to_string())?.strip_prefix(", samples=")?;
    let (samples, antialias) = counts.split_once(" antialias=")?;
    Some((samples.parse().ok()?, antialias.parse().ok()?))
}

/// The value of a keyword.
pub fn find<'a>(entries: &'a [StoredTextEntry], keyword: &str) -> Option<&'a str> {
    entries.iter().find(|(found, _)| found == keyword).map(|(_, text)| text.as_str())
}

/// Joins entries into one text, a line each. Characters outside Latin-1 and control characters are escaped.
pub fn to_lines(entries: &[TextEntry]) -> String {
    let plain = |c: char| c <= '\u{ff}' && !c.is_control();
    let escaped = |text: &str| -> String {
        let each =
            text.chars().map(|c| if plain(c) { c.to_string() } else { c.escape_unicode().to_string() });
        each.collect()
    };
    entries.iter().map(|(keyword, text)| format!("{keyword}: {}\n", escaped(text))).collect()
}

/// Reads the text of [`to_lines`]. Escapes stay as they are.
pub fn from_lines(text: &str) -> Vec<StoredTextEntry> {
    let line =
        |line: &str| line.split_once(": ").map(|(keyword, text)| (keyword.to_owned(), text.to_owned()));
    text.lines().filter_map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::time::Rate;
    use crate::encode::SequenceInfo;
    use std::time::Duration;

    fn stored(texts: &[TextEntry]) -> Vec<StoredTextEntry> {
        texts.iter().map(|(keyword, text)| ((*keyword).to_owned(), text.clone())).collect()
    }

    #[test]
    fn errors_are_read_back_to_the_last_bit() {
        for denoised in [None, Some(false), Some(true)] {
            let (error, low, high) = (1.0 / 3.0, 1e-300, f64::INFINITY);
            let noise = Noise { error, low, high, samples: 88.1, capped: 0.0, denoised };
            assert_eq!(find_noise(&stored(&[noise_entry(&noise)])), Some(noise));
            assert_eq!(find_noise(&from_lines(&to_lines(&[noise_entry(&noise)]))), Some(noise));
        }
        assert_eq!(find_noise(&[(ERROR.to_owned(), "0.1 low=x".to_owned())]), None);
        assert_eq!(find_noise(&[]), None);
    }

    #[test]
    fn counts_are_those_of_the_same_limit() {
        let limit = |seconds, frames| TimeBudget { time: Duration::from_millis(seconds), frames };
        let sequence = SequenceInfo {
            samples: 37,
            antialias: 2,
            time_limit: Some(limit(1500, 9)),
            ..SequenceInfo::default()
        };
        let rate = Rate::new(24, 1).expect("a rate");
        let entries = stored(&frame_entries(&FrameInfo { sequence: &sequence, frame: 3, rate }, None));
        assert_eq!(find_sample_counts(&entries, &limit(1500, 9)), Some((37, 2)));
        assert_eq!(find_sample_counts(&entries, &limit(1500, 8)), None);
        assert_eq!(find_sample_counts(&entries, &limit(1501, 9)), None);
    }

    #[test]
    fn lines_hold_any_name() {
        let texts = [("Title", "a→b\nkinora:error: 0".to_owned()), ("kinora:frame", "7".to_owned())];
        let lines = to_lines(&texts);
        assert!(lines.chars().all(|c| c <= '\u{ff}'), "{lines}");
        let read = from_lines(&lines);
        assert_eq!(read.len(), 2);
        assert_eq!(read[1], ("kinora:frame".to_owned(), "7".to_owned()));
    }
}
