//! Parsers of option values. They are strict, have the limits of sequence files, and their errors say what would be
//! right.

use crate::base::color::{Rgb, hex_color};
use crate::base::time::{Rate, Time};
use crate::base::units::parse_bytes;
use crate::encode::{Output, StreamFormat, Template, Tonemap};
use crate::film::MAX_STOPS;
use crate::sequence::ERRORS;
use crate::sequence::quality::{Denoise, Integrator, MAX_SAMPLES, PathSettings, SampleReuse};
use clap::builder::{OsStringValueParser, TypedValueParser};
use std::num::NonZeroUsize;
use std::time::Duration;

/// The largest width or height, in pixels.
const MAX_SIDE: u32 = 65_536;
/// The highest rate, in frames per second.
const MAX_RATE: i128 = 1_000_000;
/// The largest number of bounces.
const MAX_BOUNCES: u32 = 1000;
/// The largest number of samples along each axis of a pixel.
const MAX_ANTIALIAS: u32 = 64;
/// The largest number of threads. More than any machine has processors only cost time.
const MAX_THREADS: u32 = 1024;
/// The largest number of workers. No farm has more for one sequence.
const MAX_WORKERS: u32 = 10_000;

/// A file to write. Its name need not be UTF-8.
pub fn output() -> impl TypedValueParser<Value = Output> {
    OsStringValueParser::new().try_map(Output::parse)
}

/// `1280x720`, in pixels.
pub fn size(text: &str) -> Result<(u32, u32), String> {
    let side = |digits| within(digits, 1, MAX_SIDE);
    text.split_once(['x', 'X'])
        .and_then(|(width, height)| Some((side(width)?, side(height)?)))
        .ok_or_else(|| format!("write width and height in pixels, each 1 to {MAX_SIDE}, such as 1280x720"))
}

/// `24`, `29.97` (exactly 2997/100) or `30000/1001` frames per second.
pub fn rate(text: &str) -> Result<Rate, String> {
    let fraction = match text.split_once('/') {
        Some((frames, seconds)) => whole(frames).zip(whole(seconds)),
        None => decimal(text),
    };
    fraction
        .and_then(|(frames, seconds)| Rate::new(frames.into(), seconds.into()))
        .filter(|rate| rate.per_second() <= MAX_RATE.into())
        .ok_or_else(|| {
            format!(
                "write frames per second, such as 24, 29.97 or 30000/1001, above 0 and at most {MAX_RATE}"
            )
        })
}

/// A number of threads, at least 1.
pub fn threads(text: &str) -> Result<NonZeroUsize, String> {
    let count = within(text, 1, MAX_THREADS).and_then(|count| NonZeroUsize::new(count as usize));
    count.ok_or_else(|| format!("write a number of threads, 1 to {MAX_THREADS}"))
}

/// A number of workers, at least 1.
pub fn workers(text: &str) -> Result<NonZeroUsize, String> {
    let count = within(text, 1, MAX_WORKERS).and_then(|count| NonZeroUsize::new(count as usize));
    count.ok_or_else(|| format!("write numbers of workers, 1 to {MAX_WORKERS}, such as 1,2,50"))
}

/// A number of bounces, possibly 0.
pub fn bounces(text: &str) -> Result<u32, String> {
    within(text, 0, MAX_BOUNCES)
        .ok_or_else(|| format!("write a whole number of bounces, 0 to {MAX_BOUNCES}, such as 8"))
}

/// Samples along each axis of a pixel.
pub fn antialias(text: &str) -> Result<u32, String> {
    within(text, 1, MAX_ANTIALIAS).ok_or_else(|| {
        format!("write a whole number from 1 (off) to {MAX_ANTIALIAS}, such as 3 for 3×3 samples")
    })
}

/// Samples per pixel where something is random.
pub fn samples(text: &str) -> Result<u32, String> {
    within(text, 1, MAX_SAMPLES)
        .ok_or_else(|| format!("write a whole number of samples, 1 to {MAX_SAMPLES}, such as 256"))
}

/// An error, relative to the brightness.
pub fn noise(text: &str) -> Result<f64, String> {
    let error = text.parse().ok().filter(|error| ERRORS.contains(error));
    let (least, most) = (ERRORS.start(), ERRORS.end());
    error.ok_or_else(|| format!("write an error from {least} to {most}, such as 0.01 for 1 %"))
}

/// A whole number of a range.
pub fn between<T: TryFrom<u32> + Into<u32> + Copy + Send + Sync + 'static>(
    least: T,
    most: T,
) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync {
    move |text| {
        let (least, most) = (least.into(), most.into());
        let number = within(text, least, most).and_then(|number| T::try_from(number).ok());
        number.ok_or_else(|| format!("write {least} to {most}"))
    }
}

/// The name of an integrator, in upper or lower case.
pub fn integrator(text: &str) -> Result<Integrator, String> {
    match text.to_ascii_lowercase().as_str() {
        "whitted" => Ok(Integrator::Whitted),
        "path" => Ok(Integrator::Path(PathSettings::default())),
        _ => Err("write whitted or path".to_owned()),
    }
}

/// Which frames share samples, in upper or lower case.
pub fn reuse(text: &str) -> Result<SampleReuse, String> {
    match text.to_ascii_lowercase().as_str() {
        "zoom" => Ok(SampleReuse::Zoom),
        "off" => Ok(SampleReuse::Off),
        _ => Err("write zoom or off".to_owned()),
    }
}

/// With whose samples frames are denoised.
pub fn denoise(text: &str) -> Result<Denoise, String> {
    match text.to_ascii_lowercase().as_str() {
        "auto" => Ok(Denoise::Auto),
        "alone" => Ok(Denoise::Alone),
        _ => Err("write auto or alone".to_owned()),
    }
}

/// A seed: any whole number of 32 bits.
pub fn seed(text: &str) -> Result<u32, String> {
    let plain = (1..=10).contains(&text.len()) && text.bytes().all(|b| b.is_ascii_digit());
    let seed = plain.then(|| text.parse().ok()).flatten();
    seed.ok_or_else(|| format!("write a whole number, 0 to {}", u32::MAX))
}

/// A colour in the notation of CSS.
pub fn background_color(text: &str) -> Result<Rgb, String> {
    hex_color(text).ok_or_else(|| "write a colour such as \"#ff8800\" or \"#f80\"".to_owned())
}

/// The name of a tone map, in upper or lower case.
pub fn tonemap(text: &str) -> Result<Tonemap, String> {
    let found = Tonemap::NAMED.into_iter().find(|(name, _)| name.eq_ignore_ascii_case(text));
    found.map(|(_, tonemap)| tonemap).ok_or_else(|| "write srgb, none, reinhard or filmic".to_owned())
}

/// A format for the standard output.
pub fn streamed(text: &str) -> Result<StreamFormat, String> {
    let found = StreamFormat::NAMED.into_iter().find(|(name, _)| name.eq_ignore_ascii_case(text));
    found.map(|(_, streamed)| streamed).ok_or_else(|| "write y4m, ppm, ppm-ascii or png".to_owned())
}

/// An exposure in stops.
pub fn exposure(text: &str) -> Result<f64, String> {
    let stops = text.parse().ok().filter(|stops| (-MAX_STOPS..=MAX_STOPS).contains(stops));
    stops.ok_or_else(|| format!("write a number of stops from -{MAX_STOPS} to {MAX_STOPS}, such as -1.5"))
}

/// Text with placeholders such as `{frame}`.
pub fn caption(text: &str) -> Result<Template, String> {
    Template::parse(text).map_err(|error| error.to_string())
}

/// A time in seconds, 0 or more.
pub fn seconds(text: &str) -> Result<Time, String> {
    let time = decimal(text).map(|(part, whole)| Time::new(part.into(), whole.into()));
    time.ok_or_else(|| "write seconds such as 1.5, 0 or more".to_owned())
}

/// A duration such as `90s`, `10min` or `2h`, at least 1 s.
pub fn duration(text: &str) -> Result<Duration, String> {
    let digits = text.find(|c: char| c != '.' && !c.is_ascii_digit()).unwrap_or(text.len());
    let (number, unit) = text.split_at(digits);
    let unit = match unit.trim() {
        "ms" => Some(1e-3),
        "s" => Some(1.0),
        "min" => Some(60.0),
        "h" => Some(3600.0),
        _ => None,
    };
    let seconds = decimal(number).zip(unit).map(|((part, whole), unit)| part as f64 / whole as f64 * unit);
    let duration =
        seconds.filter(|seconds| *seconds >= 1.0).and_then(|s| Duration::try_from_secs_f64(s).ok());
    duration.ok_or_else(|| "write a time such as 90s, 10min or 2h, at least 1s".to_owned())
}

/// A size in bytes, such as `5MB`.
pub fn file_size(text: &str) -> Result<u64, String> {
    parse_bytes(text)
        .ok_or_else(|| "write a size such as 5MB, 800kB or 2MiB, from 1kB to 1000000GB".to_owned())
}

/// The size of a cache in bytes, such as `5MB`, or `0` for none.
pub fn cache_size(text: &str) -> Result<u64, String> {
    if text == "0" {
        return Ok(0);
    }
    file_size(text).map_err(|why| format!("{why}, or 0"))
}

/// The quality of formats with loss.
pub fn encode_quality(text: &str) -> Result<u8, String> {
    let quality = within(text, 1, 100).map(|quality| quality as u8);
    quality.ok_or_else(|| "write a whole number from 1 (small) to 100 (good)".to_owned())
}

/// Bits per channel of a PNG. True means 16.
pub fn bits(text: &str) -> Result<bool, String> {
    match text {
        "8" => Ok(false),
        "16" => Ok(true),
        _ => Err("write 8 or 16".to_owned()),
    }
}

fn within(text: &str, least: u32, most: u32) -> Option<u32> {
    whole(text).and_then(|n| u32::try_from(n).ok()).filter(|n| (least..=most).contains(n))
}

/// A decimal number as an exact fraction.
fn decimal(text: &str) -> Option<(u64, u64)> {
    let (units, tail) = text.split_once('.').unwrap_or((text, ""));
    if tail.is_empty() {
        // A point needs digits behind it. Without a point, the number is whole.
        return if text.ends_with('.') { None } else { Some((whole(units)?, 1)) };
    }
    let denominator = 10_u64.pow(u32::try_from(tail.len()).ok().filter(|&digits| digits <= 9)?);
    Some((whole(units)? * denominator + whole(tail)?, denominator))
}

/// One to nine digits and nothing else. With nine digits, exact times stay far from the limits of their integers.
fn whole(digits: &str) -> Option<u64> {
    let plain = (1..=9).contains(&digits.len()) && digits.bytes().all(|b| b.is_ascii_digit());
    plain.then(|| digits.parse().ok()).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(size("1280x720"), Ok((1280, 720)));
        assert_eq!(size("1X1"), Ok((1, 1)));
        for bad in [
            "", "1280", "x", "1280x", "x720", "0x720", "1280x0", "-1x5", "1e3x5", "1x2x3", "4 x 3", "65537x1",
        ] {
            assert!(size(bad).is_err(), "`{bad}`");
        }
    }

    #[test]
    fn rates_are_exact() {
        for (text, frames, seconds) in [
            ("24", 24, 1),
            ("29.97", 2997, 100),
            ("23.976", 23976, 1000),
            ("30000/1001", 30000, 1001),
            ("0.5", 1, 2),
        ] {
            assert_eq!(rate(text).ok(), Rate::new(frames, seconds), "`{text}`");
        }
        for bad in [
            "", "0", "0.0", "-24", "24.", ".5", "1e3", "inf", "nan", "30/0", "0/1", "1/2/3", "1.5/2",
            "1000001",
        ] {
            assert!(rate(bad).is_err(), "`{bad}`");
        }
        assert!(rate("1234567890").is_err() && rate("1.0123456789").is_err());
    }

    #[test]
    fn counts_have_their_limits() {
        assert_eq!(threads("8").map(NonZeroUsize::get), Ok(8));
        assert_eq!((bounces("0"), antialias("64")), (Ok(0), Ok(64)));
        for bad in ["", "-1", "1.5", "4294967296", "many"] {
            assert!(bounces(bad).is_err() && antialias(bad).is_err(), "`{bad}`");
        }
        assert!(antialias("0").is_err() && antialias("65").is_err());
        assert_eq!((samples("1"), samples("16777216")), (Ok(1), Ok(1 << 24)));
        assert_eq!((seed("0"), seed("4294967295")), (Ok(0), Ok(u32::MAX)));
        for bad in ["", "-1", "+1", "1.5", "4294967296", "00000000001"] {
            assert!(samples(bad).is_err() && seed(bad).is_err(), "`{bad}`");
        }
        assert!(samples("0").is_err() && samples("16777217").is_err());
        assert_eq!(workers("10000").map(NonZeroUsize::get), Ok(10_000));
        assert!(workers("0").is_err() && workers("10001").is_err() && workers("").is_err());
        assert!(threads("0").is_err() && threads("-1").is_err() && threads("many").is_err());
    }

    #[test]
    fn errors_are_relative() {
        assert_eq!((noise("0.01"), noise("1")), (Ok(0.01), Ok(1.0)));
        for bad in ["", "0", "1%", "-0.1", "2", "nan", "1e-9"] {
            assert!(noise(bad).is_err(), "`{bad}`");
        }
    }

    #[test]
    fn tone_maps_are_known_by_name() {
        assert_eq!((tonemap("none"), tonemap("Filmic")), (Ok(Tonemap::None), Ok(Tonemap::Filmic)));
        let message = tonemap("aces").expect_err("an unknown tone map");
        assert!(Tonemap::NAMED.iter().all(|(name, _)| message.contains(&name.to_lowercase())), "{message}");
    }

    #[test]
    fn integrators_and_reuse_are_known_by_name() {
        assert_eq!(integrator("Whitted"), Ok(Integrator::Whitted));
        assert_eq!(integrator("path"), Ok(Integrator::Path(PathSettings::default())));
        assert!(integrator("paths").is_err() && integrator("").is_err());
        assert_eq!([reuse("Zoom"), reuse("off")], [Ok(SampleReuse::Zoom), Ok(SampleReuse::Off)]);
        assert!(reuse("pan").is_err());
    }

    #[test]
    fn durations_have_units() {
        let seconds = |text| duration(text).map(|duration| duration.as_secs_f64());
        assert_eq!((seconds("90s"), seconds("1.5min"), seconds("2 h")), (Ok(90.0), Ok(90.0), Ok(7200.0)));
        for bad in ["", "90", "s", "0s", "-5s", "1d", "1e3s", "1..5s", "nan s"] {
            assert!(duration(bad).is_err(), "`{bad}`");
        }
    }

    #[test]
    fn settings_of_formats() {
        assert_eq!((file_size("5MB"), file_size("1.5 MiB")), (Ok(5_000_000), Ok(1_572_864)));
        assert_eq!((cache_size("5MB"), cache_size("0")), (Ok(5_000_000), Ok(0)));
        for bad in ["", "5", "MB", "-5MB", "5 TB of it", "0.5kB", "1.2.3MB"] {
            assert!(file_size(bad).is_err(), "`{bad}`");
            assert!(cache_size(bad).is_err(), "`{bad}`");
        }
        assert_eq!((encode_quality("1"), encode_quality("100")), (Ok(1), Ok(100)));
        assert!(encode_quality("0").is_err() && encode_quality("101").is_err());
        assert_eq!((bits("8"), bits("16")), (Ok(false), Ok(true)));
        assert!(bits("12").is_err() && caption("{when}").is_err() && caption("{time} s").is_ok());
    }

    #[test]
    fn exposures_are_finite() {
        assert_eq!((exposure("-1.5"), exposure("+40")), (Ok(-1.5), Ok(40.0)));
        for bad in ["", "40.1", "-41", "nan", "-inf", "1/2", "1 stop"] {
            assert!(exposure(bad).is_err(), "`{bad}`");
        }
    }
}
