//! Texts for settings and numbers.

use crate::accuracy::measure::Point;
use crate::accuracy::settings::SettingAxis;
use crate::base::units;
use std::time::Duration;

/// A setting in a few words.
pub fn describe(point: &Point) -> String {
    let value = &point.setting.value;
    match point.setting.axis {
        SettingAxis::Samples if value == "1" => "1 sample a pixel".to_owned(),
        SettingAxis::Samples => format!("{value} samples a pixel"),
        SettingAxis::Independent => format!("{value} independent samples"),
        SettingAxis::Noise => format!("noise target {value}"),
        SettingAxis::Antialias => format!("a grid of {value}"),
        SettingAxis::Bounces => format!("bounces {value}"),
        SettingAxis::Roulette => format!("roulette {value}"),
        SettingAxis::Layers => format!("{value} layer{}", if value == "1" { "" } else { "s" }),
        SettingAxis::Integrator => format!("integrator {value}"),
        SettingAxis::Parts => format!("without {value}"),
        SettingAxis::Remedies => value.clone(),
    }
}

/// A share in percent with about two significant digits.
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
    units::time(Duration::try_from_secs_f64(seconds).unwrap_or_default())
}
