//! Texts for settings and numbers.

use crate::accuracy::measure::Point;
use crate::accuracy::settings::SettingAxis;

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
