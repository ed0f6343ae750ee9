//! The points of an axis, fractions of the brightness, and biases in words, which all findings use.

use crate::accuracy::measure::{Measured, Point};
use crate::accuracy::settings::SettingAxis;
use crate::accuracy::statistics::{Bias, ConfidenceInterval};
use crate::base::units::percent;

/// A share with its interval, if that is known: `4.2 % (3.5 % to 4.7 %)`.
pub fn with_interval(share: ConfidenceInterval) -> String {
    match share.high > share.low {
        true => format!("{} ({} to {})", percent(share.mean), percent(share.low), percent(share.high)),
        false => percent(share.mean),
    }
}

/// The largest code of a display with 8 bits.
pub const CODES: f64 = 255.0;

impl Measured {
    /// The file's own setting.
    pub fn own(&self) -> &Point {
        &self.points[0]
    }

    /// The points of an axis in ascending order of time, with the file's own setting if it is on that axis.
    pub fn on(&self, axis: SettingAxis) -> Vec<&Point> {
        let mut on: Vec<&Point> = self.points.iter().filter(|point| point.setting.axis == axis).collect();
        on.sort_by(|a, b| a.time().total_cmp(&b.time()));
        on
    }

    /// The point to compare a point with: the file's own setting with as many samples.
    pub fn baseline(&self, point: &Point) -> &Point {
        let axis = match point.setting.axis {
            axis if !axis.has_baseline() => return self.own(),
            SettingAxis::Remedies => SettingAxis::Remedies,
            _ => SettingAxis::Bounces,
        };
        let own = &self.own().setting;
        let same = |other: &&Point| other.setting.axis == axis && other.setting.is_plain(own);
        self.points.iter().find(same).unwrap_or(self.own())
    }

    /// An error as a fraction of the mean brightness.
    pub fn share(&self, error: f64) -> f64 {
        error / self.brightness
    }

    /// A bias in words: its fraction of the mean brightness or, if it is not significant, an upper bound.
    pub fn bias_text(&self, bias: Bias) -> String {
        match bias.root() {
            Some(root) => percent(self.share(root)),
            None if bias.most() == 0.0 => "none".to_owned(),
            None => format!("not measurable: under {}", percent(self.share(bias.most()))),
        }
    }

    /// The same for the middle of a sentence.
    pub fn bias_phrase(&self, bias: Bias) -> String {
        match bias.root() {
            Some(root) => percent(self.share(root)),
            None if bias.most() == 0.0 => "nothing".to_owned(),
            None => format!("less than can be measured (under {})", percent(self.share(bias.most()))),
        }
    }
}
