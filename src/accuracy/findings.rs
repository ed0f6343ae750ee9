//! What measurements say in plain words, and which settings they speak for.

mod advice;
mod curve;
mod fireflies;
mod parts;
mod robust;
mod words;

pub use advice::Advice;
pub use words::{described, factor, percent, seconds};

use super::measure::{Measured, Point};
use super::precision::wrong_answers;
use super::settings::Axis;
use super::statistics::Bias;
use crate::base::units;

/// Codes of a display with 8 bits.
pub const CODES: f64 = 255.0;

impl Measured {
    /// The file's own setting.
    pub fn own(&self) -> &Point {
        &self.points[0]
    }

    /// The points of an axis, and the file's own if it lies on it, from the cheapest on.
    pub fn on(&self, axis: Axis) -> Vec<&Point> {
        let mut on: Vec<&Point> = self.points.iter().filter(|point| point.setting.axis == axis).collect();
        on.sort_by(|a, b| a.time().total_cmp(&b.time()));
        on
    }

    /// The file's own setting with as few samples as what is compared with it along an axis.
    pub fn twin(&self, point: &Point) -> &Point {
        let axis = match point.setting.axis {
            axis if !axis.is_short() => return self.own(),
            Axis::Remedies => Axis::Remedies,
            _ => Axis::Bounces,
        };
        let own = &self.own().setting;
        let same = |other: &&Point| other.setting.axis == axis && other.setting.is_plain(own);
        self.points.iter().find(same).unwrap_or(self.own())
    }

    /// An error as a share of the mean brightness.
    pub fn share(&self, error: f64) -> f64 {
        error / self.brightness
    }

    /// A bias in words: a share of the mean brightness, or how large it is at most where it cannot be told from none.
    pub fn told(&self, bias: Bias) -> String {
        match bias.root() {
            Some(root) => percent(self.share(root)),
            None if bias.most() == 0.0 => "none".to_owned(),
            None => format!("smaller than can be told: under {}", percent(self.share(bias.most()))),
        }
    }

    /// The same in the middle of a sentence.
    pub fn amount(&self, bias: Bias) -> String {
        match bias.root() {
            Some(root) => percent(self.share(root)),
            None if bias.most() == 0.0 => "nothing".to_owned(),
            None => format!("less than can be told (under {})", percent(self.share(bias.most()))),
        }
    }

    /// The answer, a line for each thing.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = vec![self.heading(), self.now(), self.film()];
        lines.extend(self.advice().into_iter().take(2).map(|advice| advice.line()));
        lines.extend(self.sobol());
        lines.extend(self.adaptive());
        lines.extend(self.dearest());
        lines.extend(self.depth());
        lines.extend(self.fireflies());
        lines.extend(self.robust().or_else(|| self.precise()));
        lines
    }

    fn heading(&self) -> String {
        let frames = match self.frames.as_slice() {
            [frame] => format!("frame {frame}"),
            frames => units::counted(frames.len() as u64, "frame"),
        };
        let (width, height) = self.size;
        let threads = units::counted(self.threads as u64, "thread");
        let took = units::rough_time(self.took);
        format!("{}, {frames}, measured at {width}x{height} on {threads} in {took}", self.name)
    }

    /// The error of the file's own setting.
    fn now(&self) -> String {
        let own = self.own();
        let error = own.squared.root();
        let range = match own.runs.len() {
            0 | 1 => String::new(),
            _ => format!(" ({} to {})", percent(self.share(error.low)), percent(self.share(error.high))),
        };
        let missed = match own.setting.quality.noise {
            Some(target) if own.capped > 0.0 => format!(
                ". Target missed: {} of pixels hit the limit of {} samples",
                percent(own.capped),
                target.most
            ),
            _ => String::new(),
        };
        format!(
            "Error of this setting ({}): {}{range} of the mean brightness, {:.1}/255 on the display{missed}",
            described(own),
            percent(self.share(error.mean)),
            CODES * own.displayed().mean,
        )
    }

    /// The cost of the whole film.
    fn film(&self) -> String {
        let whole = &self.whole;
        let (width, height) = self.full_size;
        let films = match whole.films as u64 {
            films if films == u64::from(whole.frames) => "each traced by itself".to_owned(),
            films => format!("made of {}", units::counted(films, "traced picture")),
        };
        let threads = units::counted(self.threads as u64, "thread");
        let cpu = whole.cpu.map_or_else(String::new, |cpu| format!("{} of processor time, ", seconds(cpu)));
        format!(
            "Cost of the whole film: about {cpu}{} on {threads}, for {} at {width}x{height}, {films}",
            seconds(whole.wall),
            units::counted(whole.frames.into(), "frame"),
        )
    }

    /// What precision spares and costs on the hard cases: textbooks in f32, stable formulas in it, and ours.
    pub fn hard_cases(&self) -> Option<String> {
        wrong_answers(&self.precision)
    }

    fn precise(&self) -> Option<String> {
        let ours = self.precision.iter().find(|way| way.way == "ours, f64")?;
        let times = factor(ours.time);
        Some(format!("Hard cases of numerics: {}, for {times} times the time", lower(&self.hard_cases()?)))
    }
}

/// A sentence in the middle of another.
fn lower(text: &str) -> String {
    let mut letters = text.chars();
    letters
        .next()
        .map_or_else(String::new, |first| first.to_lowercase().collect::<String>() + letters.as_str())
}
