//! What a frame's file tells of it in words: as texts of a PNG, as lines of an attribute of an EXR file.
//!
//! Most of it is known before the frame is made, and is part of its [identity](super::identity). The error that was
//! reached is not: it follows from all that is, as the pixels do.

use super::about::{Shown, TimeLimit};
use super::identity::Seen;
use crate::film::Noise;

/// A keyword and what it says.
pub type Text = (&'static str, String);

/// The same, read back.
pub type Told = (String, String);

/// The keyword of the sequence's name.
pub const TITLE: &str = "Title";
/// That of the number of frames that the sequence has.
pub const FRAMES: &str = "kinora:frames";
/// Those of the frame's number and of when it starts.
pub const FRAME: &str = "kinora:frame";
pub const TIME: &str = "kinora:time";
pub const TIME_LIMIT: &str = "kinora:time-limit";
const ERROR: &str = "kinora:error";

/// What is known about a frame before it is made. No time of day: equal frames are equal files. Of the settings of samples,
/// it tells those that the frame calls for, as far as that is known.
pub fn facts(shown: &Shown, seen: Option<&Seen>) -> Vec<Text> {
    let about = shown.about;
    let mut facts = vec![
        ("Software", format!("Kinora {}", env!("CARGO_PKG_VERSION"))),
        (TITLE, about.name.clone()),
        (FRAME, shown.frame.to_string()),
        (FRAMES, about.frames.to_string()),
        (TIME, shown.time().to_string()),
    ];
    match seen.map(|seen| seen.random) {
        Some(true) => {
            facts.push(("kinora:seed", about.seed.to_string()));
            facts.push(match about.noise {
                Some(error) => ("kinora:noise", error.to_string()),
                None => ("kinora:samples", about.samples.to_string()),
            });
        }
        Some(false) => facts.push(("kinora:antialias", about.antialias.to_string())),
        None => {}
    }
    let settled = |limit| format!("{limit}, samples={} antialias={}", about.samples, about.antialias);
    facts.extend(about.time_limit.map(|limit: TimeLimit| (TIME_LIMIT, settled(limit))));
    facts
}

/// The error that a frame was sampled down to, and with how many samples. All digits, so that nothing is lost.
pub fn error(noise: &Noise) -> Text {
    let Noise { error, low, high, samples, capped } = noise;
    (ERROR, format!("{error} low={low} high={high} samples={samples} capped={capped}"))
}

/// [`error`] read back.
pub fn told_error(told: &[Told]) -> Option<Noise> {
    let mut words = find(told, ERROR)?.split(' ');
    let error = words.next()?.parse().ok()?;
    let mut named =
        |name: &str| -> Option<f64> { words.next()?.strip_prefix(name)?.strip_prefix('=')?.parse().ok() };
    let (low, high) = (named("low")?, named("high")?);
    Some(Noise { error, low, high, samples: named("samples")?, capped: named("capped")? })
}

/// Samples of a pixel, where they are random and along each side of a grid, that this limit has settled.
pub fn told_counts(told: &[Told], limit: &TimeLimit) -> Option<(u32, u32)> {
    let counts = find(told, TIME_LIMIT)?.strip_prefix(&limit.to_string())?.strip_prefix(", samples=")?;
    let (samples, antialias) = counts.split_once(" antialias=")?;
    Some((samples.parse().ok()?, antialias.parse().ok()?))
}

/// What a keyword says.
pub fn find<'a>(told: &'a [Told], keyword: &str) -> Option<&'a str> {
    told.iter().find(|(found, _)| found == keyword).map(|(_, text)| text.as_str())
}

/// One text of several, a line for each. Letters beyond those of Latin-1 are written as escapes.
pub fn lines(texts: &[Text]) -> String {
    let plain = |c: char| c <= '\u{ff}' && !c.is_control();
    let told = |text: &str| -> String {
        let each =
            text.chars().map(|c| if plain(c) { c.to_string() } else { c.escape_unicode().to_string() });
        each.collect()
    };
    texts.iter().map(|(keyword, text)| format!("{keyword}: {}\n", told(text))).collect()
}

/// [`lines`] read back; escapes stay what they are.
pub fn of_lines(text: &str) -> Vec<Told> {
    let line =
        |line: &str| line.split_once(": ").map(|(keyword, text)| (keyword.to_owned(), text.to_owned()));
    text.lines().filter_map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::time::Rate;
    use crate::encode::About;
    use std::time::Duration;

    fn told(texts: &[Text]) -> Vec<Told> {
        texts.iter().map(|(keyword, text)| ((*keyword).to_owned(), text.clone())).collect()
    }

    #[test]
    fn errors_are_read_back_to_the_last_bit() {
        let noise = Noise { error: 1.0 / 3.0, low: 1e-300, high: f64::INFINITY, samples: 88.1, capped: 0.0 };
        assert_eq!(told_error(&told(&[error(&noise)])), Some(noise));
        assert_eq!(told_error(&of_lines(&lines(&[error(&noise)]))), Some(noise));
        assert_eq!(told_error(&[(ERROR.to_owned(), "0.1 low=x".to_owned())]), None);
        assert_eq!(told_error(&[]), None);
    }

    #[test]
    fn counts_are_those_of_the_same_limit() {
        let limit = |seconds, frames| TimeLimit { time: Duration::from_millis(seconds), frames };
        let about = About { samples: 37, antialias: 2, time_limit: Some(limit(1500, 9)), ..About::default() };
        let rate = Rate::new(24, 1).expect("a rate");
        let told = told(&facts(&Shown { about: &about, frame: 3, rate }, None));
        assert_eq!(told_counts(&told, &limit(1500, 9)), Some((37, 2)));
        assert_eq!(told_counts(&told, &limit(1500, 8)), None);
        assert_eq!(told_counts(&told, &limit(1501, 9)), None);
    }

    #[test]
    fn lines_hold_any_name() {
        let texts = [("Title", "a→b\nkinora:error: 0".to_owned()), ("kinora:frame", "7".to_owned())];
        let lines = lines(&texts);
        assert!(lines.chars().all(|c| c <= '\u{ff}'), "{lines}");
        let read = of_lines(&lines);
        assert_eq!(read.len(), 2);
        assert_eq!(read[1], ("kinora:frame".to_owned(), "7".to_owned()));
    }
}
