//! Recommended settings for common goals, each with its effect.

use super::text::describe;
use crate::accuracy::measure::{Measured, Point};
use crate::accuracy::settings::SettingAxis;
use crate::base::units::{factor, percent};

/// A recommended setting for a goal.
#[derive(Clone, Debug, PartialEq)]
pub struct Advice {
    pub goal: String,
    /// Options to paste after `kinora render FILE`; empty if no setting fits.
    pub flags: String,
    /// The effect on error and time, in words.
    pub effect: String,
}

impl Advice {
    fn new(goal: &str, flags: String, effect: String) -> Self {
        Self { goal: goal.to_owned(), flags, effect }
    }

    /// The advice in one line.
    pub fn line(&self) -> String {
        let flags = if self.flags.is_empty() { String::new() } else { format!("{}: ", self.flags) };
        format!("{}: {flags}{}", self.goal, self.effect)
    }
}

/// The fractions of the time that count as half.
const HALF: std::ops::RangeInclusive<f64> = 0.35..=0.65;

impl Measured {
    /// All advice: half the time and half the error first.
    pub fn advice(&self) -> Vec<Advice> {
        let mut all = vec![self.half_the_time(), self.half_the_error()];
        all.extend(self.as_good());
        all.extend(self.shallower());
        all
    }

    fn time_share(&self, point: &Point) -> f64 {
        point.time() / self.own().time()
    }

    /// Settings that have options of their own and are compared with the reference.
    fn choices(&self) -> impl Iterator<Item = &Point> {
        let own = self.own();
        let choice =
            |axis| matches!(axis, SettingAxis::Samples | SettingAxis::Noise | SettingAxis::Antialias);
        self.points.iter().filter(move |point| choice(point.setting.axis) && !std::ptr::eq(*point, own))
    }

    fn measured(&self, goal: &str, point: &Point) -> Advice {
        let error = factor(point.error() / self.own().error());
        let effect =
            format!("{error} times the error in {} of the time (measured)", percent(self.time_share(point)));
        Advice::new(goal, point.setting.flags.clone(), effect)
    }

    fn half_the_time(&self) -> Advice {
        const GOAL: &str = "Half the time";
        let quality = &self.own().setting.quality;
        let near = self.choices().filter(|point| HALF.contains(&self.time_share(point)));
        if let Some(point) = near.min_by(|a, b| a.error().total_cmp(&b.error())) {
            return self.measured(GOAL, point);
        }
        if let (true, None, Some(curve)) = (self.random, quality.noise, self.curve())
            && quality.samples > 1
        {
            let (samples, error) = curve.to_time(0.5);
            let samples = (f64::from(quality.samples) * samples).round().max(1.0);
            let effect = format!("{} times the error (by the curve)", factor(error));
            return Advice::new(GOAL, format!("--samples {samples}"), effect);
        }
        let below = self.choices().filter(|point| self.time_share(point) < *HALF.start());
        let below = below.max_by(|a, b| a.time().total_cmp(&b.time()));
        Advice::new(
            GOAL,
            String::new(),
            match below {
                Some(point) => format!(
                    "no setting takes about half; the next one, {}, takes {} of the time and has {} times the error",
                    point.setting.flags,
                    percent(self.time_share(point)),
                    factor(point.error() / self.own().error())
                ),
                None => {
                    format!("{} is the cheapest setting; a smaller --size saves more", describe(self.own()))
                }
            },
        )
    }

    fn half_the_error(&self) -> Advice {
        const GOAL: &str = "Half the error";
        let own = self.own();
        if own.error() <= 0.0 {
            return Advice::new(GOAL, String::new(), "there is no error left to halve".to_owned());
        }
        // Grids have few steps, so one that leaves far less error is accepted too.
        let half = if self.random { 0.4..=0.56 } else { 0.2..=0.56 };
        let near = self.choices().filter(|point| half.contains(&(point.error() / own.error())));
        if let Some(point) = near.min_by(|a, b| a.time().total_cmp(&b.time())) {
            let error = factor(point.error() / own.error());
            let effect = format!(
                "{} times the time, {error} times the error (measured)",
                factor(self.time_share(point))
            );
            return Advice::new(GOAL, point.setting.flags.clone(), effect);
        }
        let Some(curve) = self.curve() else {
            return Advice::new(GOAL, String::new(), "no measured setting reaches it".to_owned());
        };
        let (samples, time) = curve.to_error(0.5);
        let quality = &own.setting.quality;
        let flags = match quality.noise {
            _ if !self.random => {
                let grid = f64::from(quality.antialias) * samples.sqrt();
                if grid > 64.0 {
                    return Advice::new(GOAL, String::new(), "no grid is fine enough".to_owned());
                }
                format!("--antialias {}", grid.ceil())
            }
            Some(target) => format!("--noise {}", target.error / 2.0),
            None => format!("--samples {}", (f64::from(quality.samples) * samples).ceil()),
        };
        Advice::new(GOAL, flags, format!("{} times the time (by the curve)", factor(time)))
    }

    fn as_good(&self) -> Option<Advice> {
        let own = self.own();
        let cheapest =
            self.pareto_front(Point::error).into_iter().find(|point| point.error() <= own.error())?;
        let saved = 1.0 - self.time_share(cheapest);
        (saved > 0.1 && !cheapest.setting.flags.is_empty()).then(|| {
            let effect = format!("saves {} of the time (measured)", percent(saved));
            Advice::new("As good in less time", cheapest.setting.flags.clone(), effect)
        })
    }

    fn shallower(&self) -> Option<Advice> {
        let (least, own) = self.enough_bounces()?;
        let saved = 1.0 - least.time() / own.time();
        (saved > 0.02).then(|| {
            let effect = format!(
                "saves {} of the time, changes no pixel by more than 1/255 (measured)",
                percent(saved)
            );
            Advice::new("No invisible bounces", least.setting.flags.clone(), effect)
        })
    }
}
