//! The remaining errors of frames with a target, or that were denoised.

use crate::base::{frame_set, units};
use crate::film::Noise;
use serde_json::{Map, Value, json};

/// At most this many frames have a line each. For more frames, read the files or the JSON summary.
const MAX_LISTED_FRAMES: usize = 12;

/// In place of an error that could not be measured.
const UNKNOWN: &str = "unknown: there are too few pixels or samples to measure it";

/// The remaining error if there was a target: of the worst frame, with its range.
pub fn lines(noise: &[(u32, Noise)]) -> Vec<String> {
    let worst = noise.iter().max_by(|a, b| a.1.error.total_cmp(&b.1.error));
    let Some((frame, worst)) = worst else { return Vec::new() };
    let range = stated(worst, [" of the brightness", " with 95 % confidence"]);
    let count = noise.len() as f64;
    let samples = noise.iter().map(|(_, noise)| noise.samples).sum::<f64>() / count;
    let mut lines = match noise.len() {
        1 => vec![range],
        _ if !worst.error.is_finite() => vec![format!("{range}, in frame {frame}")],
        _ => vec![format!("at most {range}, in frame {frame}")],
    };
    if (2..=MAX_LISTED_FRAMES).contains(&noise.len()) {
        let row = |(frame, noise): &(u32, Noise)| {
            format!("frame {frame}: {}, {:.0} samples", stated(noise, ["", ""]), noise.samples)
        };
        lines.extend(noise.iter().map(row));
    }
    lines.push(format!("{samples:.0} samples a pixel on average"));
    let capped = noise.iter().map(|(_, noise)| noise.capped).sum::<f64>() / count;
    if capped > 0.0 {
        lines.push(format!(
            "target missed: {} of the pixels reached the limit of samples (max_samples)",
            units::percent(capped)
        ));
    }
    lines.extend(denoised(noise));
    lines
}

/// An error with its range, in words: what it is relative to, and how sure the range is.
fn stated(noise: &Noise, [of, confidence]: [&str; 2]) -> String {
    let [error, low, high] =
        [noise.error, noise.low, noise.high].map(|error| format!("{:.2}", 100.0 * error));
    match [noise.error, noise.high].map(f64::is_finite) {
        [true, true] => format!("{error} %{of} ({low} to {high}{confidence})"),
        [true, false] => format!("{error} %{of} (at least {low}{confidence})"),
        [false, _] => UNKNOWN.to_owned(),
    }
}

/// Which frames were denoised, if some might have been. Those of earlier runs may not record it.
fn denoised(noise: &[(u32, Noise)]) -> Option<String> {
    let frames = |denoised: bool| {
        let like = noise.iter().filter(move |(_, noise)| noise.denoised == Some(denoised));
        like.map(|(frame, _)| *frame).collect::<Vec<_>>()
    };
    let (denoised, kept) = (frames(true).len(), frames(false));
    let [done, all] = [denoised, noise.len()].map(|frames| units::count(frames as u64));
    Some(match (denoised, kept.len(), noise.len()) {
        (0, 0, _) => return None,
        (1, 0, 1) => "denoised".to_owned(),
        (_, 0, frames) if denoised == frames => format!("denoised all {all} frames"),
        (_, 0, _) => format!("denoised {done} of {all} frames"),
        (_, 1, 1) => "not denoised: the frame kept its samples".to_owned(),
        (_, few, _) => {
            let (noun, its) = if few == 1 { ("frame", "its") } else { ("frames", "their") };
            format!("denoised {done} of {all} frames; {noun} {} kept {its} samples", frame_set::text(&kept))
        }
    })
}

/// The remaining error of each frame that has one.
pub fn json(frames: &[(u32, Noise)]) -> Map<String, Value> {
    let of = |(frame, noise): &(u32, Noise)| {
        let Noise { error, low, high, samples, capped, denoised } = noise;
        let mut value =
            json!({ "error": error, "low": low, "high": high, "samples": samples, "capped": capped });
        if let Some(denoised) = denoised {
            value["denoised"] = json!(denoised);
        }
        (frame.to_string(), value)
    };
    frames.iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frames that were denoised or not, or were never to be.
    fn errors(frames: &[Option<bool>]) -> Vec<(u32, Noise)> {
        let noise = |denoised: &Option<bool>| Noise { error: 0.5, denoised: *denoised, ..Noise::default() };
        (0..).zip(frames.iter().map(noise)).collect()
    }

    #[test]
    fn errors_that_are_unknown_are_no_numbers() {
        let noise = |error: f64, high: f64| Noise { error, high, samples: 16.0, ..Noise::default() };
        let infinity = f64::INFINITY;
        assert_eq!(lines(&[(3, noise(infinity, infinity))])[0], UNKNOWN);
        let both = lines(&[(3, noise(infinity, infinity)), (4, noise(0.5, infinity))]);
        let expected = [
            format!("{UNKNOWN}, in frame 3"),
            format!("frame 3: {UNKNOWN}, 16 samples"),
            "frame 4: 50.00 % (at least 0.00), 16 samples".to_owned(),
        ];
        assert_eq!(both[..3], expected);
        let range = "50.00 % of the brightness (at least 0.00 with 95 % confidence)";
        assert_eq!(lines(&[(4, noise(0.5, infinity))])[0], range);
    }

    #[test]
    fn frames_that_kept_their_samples_are_named() {
        let (yes, no) = (Some(true), Some(false));
        for (frames, wanted) in [
            (&[yes][..], "denoised"),
            (&[no], "not denoised: the frame kept its samples"),
            (&[yes; 24], "denoised all 24 frames"),
            (&[yes, None], "denoised 1 of 2 frames"),
            (&[yes, None, no], "denoised 1 of 3 frames; frame 2 kept its samples"),
            (&[yes, no], "denoised 1 of 2 frames; frame 1 kept its samples"),
            (&[no, yes, yes, no, no, no], "denoised 2 of 6 frames; frames 0,3-5 kept their samples"),
            (&[no, no], "denoised 0 of 2 frames; frames 0-1 kept their samples"),
        ] {
            assert_eq!(lines(&errors(frames)).pop().as_deref(), Some(wanted));
        }
        assert!(!lines(&errors(&[None; 3])).concat().contains("denoised"));
        let json = Value::Object(json(&errors(&[yes, no, None]))).to_string();
        let of = |denoised: &str| {
            format!(r#"{{"error":0.5,"low":0.0,"high":0.0,"samples":0.0,"capped":0.0{denoised}}}"#)
        };
        let [yes, no] = ["true", "false"].map(|denoised| of(&format!(r#","denoised":{denoised}"#)));
        assert_eq!(json, format!(r#"{{"0":{yes},"1":{no},"2":{}}}"#, of("")));
    }
}
