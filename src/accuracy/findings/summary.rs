//! The summary of a measurement, one line per finding.

use super::base::{CODES, with_interval};
use super::text::describe;
use crate::accuracy::measure::Measured;
use crate::accuracy::precision::wrong_answers;
use crate::base::units;
use crate::base::units::{factor, percent, seconds};

impl Measured {
    /// The summary, one line per finding.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = vec![self.heading(), self.now(), self.film()];
        lines.extend(self.advice().into_iter().take(2).map(|advice| advice.line()));
        lines.extend(self.flicker());
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
        let error = own.squared.root().map(|error| self.share(error));
        let missed = match own.setting.quality.noise {
            Some(target) if own.capped > 0.0 => format!(
                ". Target missed: {} of pixels hit the limit of {} samples",
                percent(own.capped),
                target.most
            ),
            _ => String::new(),
        };
        format!(
            "Error of this setting ({}): {} of the mean brightness, {:.1}/255 on the display{missed}",
            describe(own),
            with_interval(error),
            CODES * own.displayed().mean,
        )
    }

    /// The cost of the whole sequence.
    fn film(&self) -> String {
        let whole = &self.total;
        let (width, height) = self.full_size;
        let films = match whole.films as u64 {
            films if films == u64::from(whole.frames) => "each traced separately".to_owned(),
            films => format!("from {}", units::counted(films, "traced picture")),
        };
        let threads = units::counted(self.threads as u64, "thread");
        let cpu = whole.cpu.map_or_else(String::new, |cpu| format!("{} of processor time, ", seconds(cpu)));
        format!(
            "Cost of the whole sequence: about {cpu}{} on {threads}, for {} at {width}x{height}, {films}",
            seconds(whole.wall),
            units::counted(whole.frames.into(), "frame"),
        )
    }

    /// Wrong answers in the hard cases: textbook formulas in f32, stable formulas in f32, and Kinora's in f64.
    pub fn hard_cases(&self) -> Option<String> {
        wrong_answers(&self.precision)
    }

    fn precise(&self) -> Option<String> {
        let ours = self.precision.iter().find(|way| way.method == "ours, f64")?;
        let times = factor(ours.time);
        Some(format!("Hard cases of numerics: {}, in {times} times the time", lower(&self.hard_cases()?)))
    }
}

/// A sentence with a lower-case first letter, for the middle of another.
fn lower(text: &str) -> String {
    let mut letters = text.chars();
    letters
        .next()
        .map_or_else(String::new, |first| first.to_lowercase().collect::<String>() + letters.as_str())
}
