//! Readable numbers: counts, rates, times and sizes with their units.

use std::time::Duration;

/// A count with separators: `12,345,678`.
pub fn count(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A count and its noun: `1 light`, `3 lights`.
pub fn counted(number: u64, noun: &str) -> String {
    format!("{} {noun}{}", count(number), if number == 1 { "" } else { "s" })
}

/// Rays per second: `3.10 Mray/s`.
pub fn ray_rate(rays: u64, time: Duration) -> String {
    let seconds = time.as_secs_f64();
    let rate = if seconds > 0.0 { rays as f64 / seconds } else { 0.0 };
    scaled(rate, &["ray/s", "kray/s", "Mray/s", "Gray/s"])
}

/// A size in bytes: `12.3 GB`.
pub fn bytes(bytes: u64) -> String {
    scaled(bytes as f64, &["bytes", "kB", "MB", "GB", "TB", "PB", "EB"])
}

/// Parses a size such as `5 MB`, `800kB` or `2 MiB`, from 1000 bytes to 10^15 bytes.
pub fn parse_bytes(text: &str) -> Option<u64> {
    let text = text.trim();
    let end = text.find(|c: char| !c.is_ascii_digit() && c != '.')?;
    let (number, unit) = text.split_at(end);
    let factor = match unit.trim().to_ascii_lowercase().as_str() {
        "kb" | "k" => 1e3,
        "mb" | "m" => 1e6,
        "gb" | "g" => 1e9,
        "kib" => 1024.0,
        "mib" => 1024.0 * 1024.0,
        "gib" => 1024.0 * 1024.0 * 1024.0,
        _ => return None,
    };
    let bytes = number.parse::<f64>().ok()? * factor;
    (1e3..=1e15).contains(&bytes).then_some(bytes as u64)
}

/// A measured time, to three digits or whole seconds: `850 µs`, `12.3 ms`, `4.56 s`, `2 min 05 s`.
pub fn time(time: Duration) -> String {
    let seconds = time.as_secs_f64();
    // Times that round to a minute are written as minutes.
    if seconds >= 59.95 {
        return long_time(time);
    }
    scaled(seconds * 1e6, &["µs", "ms", "s"])
}

/// An estimated time, such as the time left, in whole seconds: `under 1 s`, `21 s`, `2 min 05 s`.
pub fn rough_time(time: Duration) -> String {
    match time.as_secs_f64().round() as u64 {
        0 => "under 1 s".to_owned(),
        seconds @ 1..60 => format!("{seconds} s"),
        _ => long_time(time),
    }
}

/// `2 min 05 s` or `3 h 07 min`, rounded.
fn long_time(time: Duration) -> String {
    let seconds = time.as_secs_f64().round() as u64;
    if seconds < 3600 {
        return format!("{} min {:02} s", seconds / 60, seconds % 60);
    }
    let minutes = (seconds + 30) / 60;
    format!("{} h {:02} min", count(minutes / 60), minutes % 60)
}

/// A value with three digits, in the largest unit in which it is at least 1. Units differ by factors of 1000.
fn scaled(mut value: f64, units: &[&str]) -> String {
    let mut unit = 0;
    // 999.5 would round to 1000.
    while value >= 999.5 && unit + 1 < units.len() {
        value /= 1000.0;
        unit += 1;
    }
    let decimals = match value {
        _ if unit == 0 => 0,
        v if v < 9.995 => 2,
        v if v < 99.95 => 1,
        _ => 0,
    };
    format!("{value:.decimals$} {}", units[unit])
}

/// A fraction in percent with about two significant digits.
pub fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    match percent.abs() {
        size if size >= 10.0 => format!("{percent:.0} %"),
        size if size >= 1.0 => format!("{percent:.1} %"),
        size if size >= 0.1 => format!("{percent:.2} %"),
        0.0 => "0 %".to_owned(),
        size if size >= 0.001 => format!("{percent:.3} %"),
        _ => "under 0.001 %".to_owned(),
    }
}

/// A factor with about two significant digits.
pub fn factor(factor: f64) -> String {
    match factor {
        large if large >= 9.95 => format!("{large:.0}"),
        middle if middle >= 0.995 => format!("{middle:.1}"),
        small if small >= 0.0995 => format!("{small:.2}"),
        tiny => format!("{tiny:.3}"),
    }
}

/// A time in seconds, as text with a suitable unit.
pub fn seconds(seconds: f64) -> String {
    time(Duration::try_from_secs_f64(seconds).unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_have_separators() {
        for (number, text) in [(0, "0"), (999, "999"), (1000, "1,000"), (12_345_678, "12,345,678")] {
            assert_eq!(count(number), text);
        }
        assert_eq!(counted(1, "light"), "1 light");
        assert_eq!(counted(0, "light"), "0 lights");
    }

    #[test]
    fn rates_and_sizes_find_their_unit() {
        let second = Duration::from_secs(1);
        assert_eq!(ray_rate(0, Duration::ZERO), "0 ray/s");
        assert_eq!(ray_rate(812, second), "812 ray/s");
        assert_eq!(ray_rate(999_600, second), "1.00 Mray/s");
        assert_eq!(ray_rate(31_000_000, 10 * second), "3.10 Mray/s");
        assert_eq!(bytes(512), "512 bytes");
        assert_eq!(bytes(12_345_678_901), "12.3 GB");
        assert_eq!(bytes(u64::MAX), "18.4 EB");
    }

    #[test]
    fn times_find_their_unit() {
        let cases = [
            (0.0, "0 µs"),
            (0.000_85, "850 µs"),
            (0.012_34, "12.3 ms"),
            (0.999_9, "1.00 s"),
            (4.56, "4.56 s"),
            (59.94, "59.9 s"),
            (59.97, "1 min 00 s"),
            (125.2, "2 min 05 s"),
            (3599.8, "1 h 00 min"),
            (11_220.0, "3 h 07 min"),
        ];
        for (seconds, text) in cases {
            assert_eq!(time(Duration::from_secs_f64(seconds)), text);
        }
        assert_eq!(rough_time(Duration::from_millis(400)), "under 1 s");
        assert_eq!(rough_time(Duration::from_millis(20_600)), "21 s");
        assert_eq!(rough_time(Duration::from_millis(59_600)), "1 min 00 s");
    }
}
