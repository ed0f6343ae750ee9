//! What measurements say in plain words, and which settings they speak for.

use super::layering::Layering;
use super::measure::{Measured, Point};
use super::settings::Axis;
use super::statistics::slope;
use crate::humane;
use std::time::Duration;

/// A setting for someone who wants something.
#[derive(Clone, Debug, PartialEq)]
pub struct Advice {
    pub goal: String,
    /// To paste behind `kinora render FILE`.
    pub flags: String,
    /// What it does to the error and the time, in words.
    pub effect: String,
}

/// Codes of a display with 8 bits.
const CODES: f64 = 255.0;

impl Measured {
    /// The file's own setting.
    pub fn own(&self) -> &Point {
        &self.points[0]
    }

    /// The points of an axis, and the file's own if it lies on it, from the cheapest on.
    pub fn on(&self, axis: Axis) -> Vec<&Point> {
        let mut on: Vec<&Point> = self.points.iter().filter(|point| point.setting.axis == axis).collect();
        on.sort_by(|a, b| a.wall.median.total_cmp(&b.wall.median));
        on
    }

    /// Points that no other one beats in both time and error. Those that are short by intent are not compared.
    pub fn front(&self, error: impl Fn(&Point) -> f64) -> Vec<&Point> {
        let compared =
            |point: &&Point| matches!(point.setting.axis, Axis::Samples | Axis::Noise | Axis::Antialias);
        let mut all: Vec<&Point> = self.points.iter().filter(compared).collect();
        all.sort_by(|a, b| a.wall.median.total_cmp(&b.wall.median));
        let mut least = f64::INFINITY;
        all.retain(|point| {
            let better = error(point) < least;
            least = least.min(error(point));
            better
        });
        all
    }

    /// An error as a share of the mean brightness.
    pub fn share(&self, error: f64) -> f64 {
        error / self.brightness
    }

    /// By which factor time grows if the error is to be halved.
    pub fn price_of_half(&self) -> Option<f64> {
        let on = self.on(self.own().setting.axis);
        let logarithm = |point: &&Point| (libm::log(point.wall.median), libm::log(point.error()));
        // What costs little is mostly what every frame costs.
        let costly = on.iter().filter(|point| point.error() > 0.0 && point.samples > 2.0);
        let steepness = slope(&costly.map(logarithm).collect::<Vec<_>>())?;
        (steepness < 0.0).then(|| libm::exp2(-1.0 / steepness))
    }

    /// The answer, a line for each thing.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = vec![self.heading(), self.now()];
        lines.extend(self.half());
        lines.extend(self.steps());
        lines.extend(self.spreading());
        lines.extend(self.adaptive());
        lines.extend(self.depth());
        lines.extend(self.roulette());
        lines.extend(self.layering());
        lines.extend(self.precise());
        lines
    }

    fn heading(&self) -> String {
        let frames = match self.frames.as_slice() {
            [frame] => format!("frame {frame}"),
            frames => humane::counted(frames.len() as u64, "frame"),
        };
        let (width, height) = self.size;
        let threads = humane::counted(self.threads as u64, "thread");
        let took = humane::rough_time(self.took);
        format!("{}, {frames}, measured at {width}x{height} on {threads} in {took}", self.name)
    }

    fn now(&self) -> String {
        let own = self.own();
        let error = own.squared.root();
        let range = match own.runs.len() {
            0 | 1 => String::new(),
            _ => format!(" ({} to {})", percent(self.share(error.low)), percent(self.share(error.high))),
        };
        let mut line = format!(
            "as the file says ({}): a pixel is off by {:.1}/255 on the display and by {}{range} of the mean brightness \
             in light, {} a frame",
            described(own),
            CODES * own.displayed().mean,
            percent(self.share(error.mean)),
            seconds(own.wall.median)
        );
        if self.size != self.full_size {
            let pixels = |(width, height): (u32, u32)| f64::from(width) * f64::from(height);
            let whole = own.wall.median * pixels(self.full_size) / pixels(self.size);
            line += &format!(", about {} at {}x{}", seconds(whole), self.full_size.0, self.full_size.1);
        }
        line
    }

    fn half(&self) -> Option<String> {
        Some(format!("half the error costs {} times the time", factor(self.price_of_half()?)))
    }

    /// From the cheapest setting of the file's axis to its own, and on to the next.
    fn steps(&self) -> Vec<String> {
        let own = self.own();
        let on = self.on(own.setting.axis);
        let at = on.iter().position(|point| std::ptr::eq(*point, own));
        let mut steps = Vec::new();
        if let Some(first) = on.first().filter(|first| !std::ptr::eq(**first, own)) {
            steps.push(self.step(first, own));
        }
        steps.extend(at.and_then(|at| on.get(at + 1)).map(|next| self.step(own, next)));
        steps
    }

    fn step(&self, from: &Point, to: &Point) -> String {
        let time = to.wall.median / from.wall.median;
        let change = match from.error() / to.error() {
            ratio if ratio > 1.05 => format!("divide the error by {}", factor(ratio)),
            _ => "change the error little".to_owned(),
        };
        let what = |point: &Point| described(point);
        // Samples are many, the others one.
        let (cost, s) = if to.setting.axis == Axis::Samples { ("cost", "") } else { ("costs", "s") };
        let change = change.replacen(' ', &format!("{s} "), 1);
        format!("{} {cost} {} times the time of {} and {change}", what(to), factor(time), what(from))
    }

    fn spreading(&self) -> Option<String> {
        let own = self.points.iter().filter(|point| point.setting.axis == Axis::Samples);
        let pairs = own.filter_map(|point| {
            let twin = self
                .points
                .iter()
                .find(|other| other.setting.axis == Axis::Independent && other.samples == point.samples)?;
            Some((point, twin.squared.mean / point.squared.mean))
        });
        let (point, gain) = pairs.max_by(|a, b| a.0.samples.total_cmp(&b.0.samples))?;
        Some(format!(
            "spreading samples evenly saves {} of the error's square at {}: independent ones would have to be {} \
             times as many",
            percent(1.0 - 1.0 / gain),
            described(point),
            factor(gain)
        ))
    }

    /// Against as many samples everywhere, at the same error relative to each pixel.
    fn adaptive(&self) -> Option<String> {
        let uniform = self.on(Axis::Samples);
        let error = |point: &Point| point.relative.mean.max(0.0).sqrt();
        let logarithm = |point: &&Point| (libm::log(error(point)), libm::log(point.wall.median));
        let good: Vec<_> =
            uniform.iter().filter(|point| error(point) > 0.0 && point.samples > 2.0).map(logarithm).collect();
        let steepness = slope(&good)?;
        let count = good.len() as f64;
        let mean = good.iter().fold((0.0, 0.0), |sum, at| (sum.0 + at.0 / count, sum.1 + at.1 / count));
        let noisy = self.on(Axis::Noise);
        let best = noisy.iter().filter(|point| error(point) > 0.0).map(|point| {
            let same = libm::exp(mean.1 + steepness * (libm::log(error(point)) - mean.0));
            (point, point.wall.median / same)
        });
        let (point, ratio) = best.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let verdict = if ratio < 0.95 {
            "pays"
        } else if ratio > 1.05 {
            "does not pay here"
        } else {
            "comes out even"
        };
        Some(format!(
            "sampling until an error of {} is reached {verdict}: it takes {} times the time of samples everywhere \
             that are as good",
            point.setting.value,
            factor(ratio)
        ))
    }

    /// The least depth whose pictures display as those of the greatest.
    fn depth(&self) -> Vec<String> {
        let mut on: Vec<&Point> =
            self.points.iter().filter(|point| point.setting.axis == Axis::Bounces).collect();
        on.sort_by_key(|point| point.setting.quality.bounces);
        let Some(deepest) = on.last() else { return Vec::new() };
        let own =
            on.iter().position(|point| point.setting.quality.bounces == self.own().setting.quality.bounces);
        let Some(own) = own else { return Vec::new() };
        let change = |point: &Point| self.largest_change(point, deepest);
        let enough = on.iter().position(|point| change(point) <= 1.0).unwrap_or(on.len() - 1);
        let cost = |from: usize, to: usize| {
            let share = on[to].wall.median / on[from].wall.median - 1.0;
            if share < 0.02 { "hardly any time".to_owned() } else { format!("{} more time", percent(share)) }
        };
        let bounces = |index: usize| on[index].setting.quality.bounces;
        if enough < own {
            let (least, own_bounces) = (bounces(enough), bounces(own));
            return vec![format!(
                "depth {least} to {own_bounces} costs {} and changes nothing above 1/255",
                cost(enough, own)
            )];
        }
        if enough == own {
            return vec![format!("depth {} is the least that leaves nothing out above 1/255", bounces(own))];
        }
        vec![format!(
            "depth {} to {} costs {} and changes pixels by up to {:.0}/255",
            bounces(own),
            bounces(enough),
            cost(own, enough),
            change(on[own])
        )]
    }

    /// Between what two settings display, over all runs: in codes of 8 bits. With the same seeds, what is random is the
    /// same in both.
    fn largest_change(&self, a: &Point, b: &Point) -> f64 {
        let largest =
            a.settled.iter().zip(&b.settled).flat_map(|(a, b)| (0..3).map(move |i| (a[i] - b[i]).abs()));
        f64::from(largest.fold(0.0, f32::max)) * CODES
    }

    fn roulette(&self) -> Option<String> {
        let on = || self.points.iter().filter(|point| point.setting.axis == Axis::Roulette);
        let own = on().next()?;
        let best = on().max_by(|a, b| a.efficiency().total_cmp(&b.efficiency()))?;
        let gain = best.efficiency() / own.efficiency();
        Some(if gain < 1.05 {
            format!("roulette {} is as good as any other", own.setting.value)
        } else {
            format!(
                "roulette {} would be {} times as efficient as {}",
                best.setting.value,
                factor(gain),
                own.setting.value
            )
        })
    }

    /// What keeping light apart costs in a frame.
    fn layering(&self) -> Option<String> {
        let on: Vec<&Point> = self.points.iter().filter(|point| point.setting.axis == Axis::Layers).collect();
        let (few, many) = (on.first()?, on.last()?);
        let own = on.iter().find(|point| point.setting.layering == Layering::Own)?;
        let cost = |from: &Point, to: &Point| factor(to.wall.median / from.wall.median);
        Some(format!(
            "light is kept in {} ({} without keys): {} take {} times the time of {}",
            layers(own),
            few.setting.value,
            layers(many),
            cost(few, many),
            few.setting.value
        ))
    }

    /// What precision spares and costs: a textbook in f32, stable formulas in it, and ours.
    fn precise(&self) -> Option<String> {
        let of = |name: &str| self.precision.iter().find(|way| way.way == name);
        let (textbook, stable, ours) = (of("textbook f32")?, of("stable f32")?, of("ours, f64")?);
        Some(format!(
            "precision: of {} hard cases textbooks get {} wrong in f32; of {} stable formulas get {}; ours get {}, for {} \
             times the time of a textbook in f32",
            textbook.cases,
            textbook.failing,
            stable.cases,
            stable.failing,
            ours.failing,
            factor(ours.time)
        ))
    }

    /// Settings for usual wishes, each with what speaks for it.
    pub fn advice(&self) -> Vec<Advice> {
        let mut all = Vec::new();
        all.extend(self.as_good());
        all.extend(self.better());
        all.extend(self.faster());
        all.extend(self.shallower());
        all
    }

    fn as_good(&self) -> Option<Advice> {
        let own = self.own();
        let front = self.front(Point::error);
        let cheapest = front
            .into_iter()
            .find(|point| point.error() <= own.error() && !point.setting.flags.is_empty())?;
        let saved = 1.0 - cheapest.wall.median / own.wall.median;
        (saved > 0.05).then(|| Advice {
            goal: "as good, in less time".to_owned(),
            flags: cheapest.setting.flags.clone(),
            effect: format!("measured: saves {} of the time", percent(saved)),
        })
    }

    fn better(&self) -> Option<Advice> {
        let own = self.own();
        let goal = "half the error".to_owned();
        let quality = own.setting.quality;
        if !self.random {
            let on = self.on(Axis::Antialias);
            let found = on.iter().find(|point| point.error() <= own.error() / 2.0)?;
            let effect = format!("measured: {} times the time", factor(found.wall.median / own.wall.median));
            return Some(Advice { goal, flags: found.setting.flags.clone(), effect });
        }
        let price = self.price_of_half()?;
        let effect = format!("by the curve: {} times the time", factor(price));
        let flags = match quality.noise {
            Some(target) => format!("--noise {}", target.error / 2.0),
            None => {
                let steepness = self.slopes.iter().find(|(axis, _)| *axis == Axis::Samples)?.1.mean;
                let samples = f64::from(quality.samples) * libm::exp2(-1.0 / steepness);
                format!("--samples {:.0}", samples.ceil())
            }
        };
        Some(Advice { goal, flags, effect })
    }

    fn faster(&self) -> Option<Advice> {
        let own = self.own();
        let goal = "the best in half the time".to_owned();
        let front = self.front(Point::error);
        let share = |point: &Point| point.wall.median / own.wall.median;
        let fast = front.into_iter().rfind(|point| share(point) <= 0.55 && !point.setting.flags.is_empty());
        // Where nothing was measured near half the time, the curve says more.
        if fast.is_none_or(|point| share(point) < 0.35)
            && let Some((samples, error)) = self.half_the_samples()
        {
            let effect = format!("by the curve: {} times the error", factor(error));
            return Some(Advice { goal, flags: format!("--samples {samples}"), effect });
        }
        let fast = fast?;
        Some(Advice {
            goal,
            flags: fast.setting.flags.clone(),
            effect: format!(
                "measured: {} times the error in {} of the time",
                factor(fast.error() / own.error()),
                percent(share(fast))
            ),
        })
    }

    /// Half of a pixel's samples, and how many times the error they give by the curve; none where samples are not counted.
    fn half_the_samples(&self) -> Option<(u32, f64)> {
        let quality = self.own().setting.quality;
        let counted = self.random && quality.noise.is_none() && quality.samples > 1;
        let steepness = self.slopes.iter().find(|(axis, _)| *axis == Axis::Samples)?.1.mean;
        counted.then(|| (quality.samples / 2, libm::exp2(-steepness)))
    }

    fn shallower(&self) -> Option<Advice> {
        let mut on: Vec<&Point> =
            self.points.iter().filter(|point| point.setting.axis == Axis::Bounces).collect();
        on.sort_by_key(|point| point.setting.quality.bounces);
        let deepest = on.last()?;
        let own =
            on.iter().find(|point| point.setting.quality.bounces == self.own().setting.quality.bounces)?;
        let enough = on.iter().find(|point| self.largest_change(point, deepest) <= 1.0)?;
        let saved = 1.0 - enough.wall.median / own.wall.median;
        (saved > 0.02 && enough.setting.quality.bounces < own.setting.quality.bounces).then(|| Advice {
            goal: "no reflections that nobody sees".to_owned(),
            flags: enough.setting.flags.clone(),
            effect: format!("measured: saves {} of the time, changes nothing above 1/255", percent(saved)),
        })
    }
}

/// A setting in a few words.
pub fn described(point: &Point) -> String {
    let value = &point.setting.value;
    match point.setting.axis {
        Axis::Samples if value == "1" => "1 sample a pixel".to_owned(),
        Axis::Samples => format!("{value} samples a pixel"),
        Axis::Independent => format!("{value} independent samples"),
        Axis::Noise => format!("until {value}"),
        Axis::Antialias => format!("a grid of {value}"),
        Axis::Bounces => format!("depth {value}"),
        Axis::Roulette => format!("roulette {value}"),
        Axis::Layers => layers(point),
    }
}

fn layers(point: &Point) -> String {
    format!("{} layer{}", point.setting.value, if point.setting.value == "1" { "" } else { "s" })
}

/// A share with two digits that mean something.
pub fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    match percent.abs() {
        size if size >= 10.0 => format!("{percent:.0} %"),
        size if size >= 1.0 => format!("{percent:.1} %"),
        size if size >= 0.1 => format!("{percent:.2} %"),
        0.0 => "0 %".to_owned(),
        _ => format!("{percent:.3} %"),
    }
}

/// A factor with two digits that mean something.
pub fn factor(factor: f64) -> String {
    match factor {
        large if large >= 9.95 => format!("{large:.0}"),
        middle if middle >= 0.995 => format!("{middle:.1}"),
        small if small >= 0.0995 => format!("{small:.2}"),
        tiny => format!("{tiny:.3}"),
    }
}

/// A time in its unit.
pub fn seconds(seconds: f64) -> String {
    humane::time(Duration::try_from_secs_f64(seconds).unwrap_or_default())
}
