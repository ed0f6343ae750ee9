//! What to expect of a run, in words: how long it takes, how good it becomes, and what would fit better.

use super::json::Object;
use crate::accuracy::percent;
use crate::base::stats::Line;
use crate::base::units::counted;
use crate::pipeline::plan::{Outlook, Patience, Plan, Range, RunForecast};
use crate::pipeline::render::Notice;
use crate::sequence::Sequence;
use crate::sequence::quality::{NoiseTarget, Quality};

/// Seconds from which a run is long, so that it is told what would be shorter.
const LONG: f64 = 600.0;

/// Seconds below which nobody needs to know.
const SHORT: f64 = 5.0;

/// What is told of a notice, if anything.
pub fn line(sequence: &Sequence, notice: Notice) -> Option<Line> {
    match notice {
        Notice::Pilot { plan } => Some(Line { text: before(sequence, plan), json: begun(plan).finish() }),
        Notice::Outlook { outlook, .. } => {
            let forecast = outlook.forecast(&sequence.quality);
            let text = format!("expected: {}", sentence(&sequence.quality, &forecast, outlook));
            let json = seconds(Object::new().text("event", "forecast"), &forecast)
                .texts("advice", advice(&sequence.quality, &forecast, outlook).into_iter());
            (forecast.wall.mid >= SHORT || forecast.missed > 0).then(|| Line { text, json: json.finish() })
        }
    }
}

fn begun(plan: &Plan) -> Object {
    Object::new().text("event", "pilot").whole("films", plan.takes.len() as u64)
}

/// What is known before anything is traced.
fn before(sequence: &Sequence, plan: &Plan) -> String {
    let quality = &sequence.quality;
    let samples = match quality.noise {
        Some(target) => format!("up to {} a pixel", counted(target.most.into(), "sample")),
        None => format!("{} a pixel where something is random", counted(quality.samples.into(), "sample")),
    };
    let (width, height) = sequence.output.size;
    let films = counted(plan.takes.len() as u64, "film");
    format!(
        "{} from {films} of {width}x{height} pixels, {samples}; a pilot of {} s at most finds how long they take",
        counted(plan.of.len() as u64, "frame"),
        Patience::RUN.seconds
    )
}

/// `about 20 min, 3.0 % of the brightness as error in the worst frame; --noise 0.08 about 5 min`.
fn sentence(quality: &Quality, forecast: &RunForecast, outlook: &Outlook) -> String {
    let mut text = format!("tracing takes {}", about(&forecast.wall));
    if let Some(error) = &forecast.error {
        text += &format!(", and leaves an error of {} in the worst frame", share(error));
    }
    advice(quality, forecast, outlook).iter().for_each(|line| text += &format!("; {line}"));
    text
}

/// What fits better, where a run takes long or misses its error.
pub fn advice(quality: &Quality, forecast: &RunForecast, outlook: &Outlook) -> Vec<String> {
    match &quality.noise {
        Some(target) if outlook.is_random() => of_target(quality, target, forecast, outlook),
        _ if forecast.wall.mid > LONG => vec![limited(quality, outlook)],
        _ => Vec::new(),
    }
}

fn of_target(
    quality: &Quality,
    target: &NoiseTarget,
    forecast: &RunForecast,
    outlook: &Outlook,
) -> Vec<String> {
    let with = |target: NoiseTarget| outlook.forecast(&Quality { noise: Some(target), ..*quality });
    let mut lines = Vec::new();
    if forecast.missed > 0 {
        let films = counted(forecast.films.len() as u64, "film");
        lines.push(format!(
            "{} is missed in {} of {films}, as pixels may have {} at most",
            percent(target.error),
            forecast.missed,
            counted(target.most.into(), "sample")
        ));
        if let Some(most) = outlook.samples_for(quality, target) {
            let time = with(NoiseTarget { most, ..*target }).wall;
            lines.push(format!("--max-samples {most} reaches it in {}", about(&time)));
        }
    }
    let long = forecast.wall.mid > LONG;
    if long || forecast.missed > 0 {
        let within = if long { LONG } else { f64::INFINITY };
        if let Some(error) = outlook.error_within(quality, target, within) {
            lines.push(format!(
                "--noise {error} takes {}",
                about(&with(NoiseTarget { error, ..*target }).wall)
            ));
        }
    }
    if long {
        lines.push(limited(quality, outlook));
    }
    lines
}

/// What ten minutes give.
fn limited(quality: &Quality, outlook: &Outlook) -> String {
    let fitting = outlook.fitting(quality, LONG);
    match outlook.forecast(&fitting).error {
        Some(error) => format!("--time-limit 10min reaches about {}", percent(error.mid)),
        None => format!("--time-limit 10min has room for a grid of {0}x{0}", fitting.antialias),
    }
}

/// The numbers for programs.
pub fn seconds(object: Object, forecast: &RunForecast) -> Object {
    let object = object.object("time_s", range(&forecast.wall));
    let object = forecast.cpu.iter().fold(object, |object, cpu| object.object("cpu_s", range(cpu)));
    let object = forecast.error.iter().fold(object, |object, error| object.object("error", range(error)));
    object.whole("films_that_miss_the_error", forecast.missed as u64)
}

/// A range for programs.
pub fn range(range: &Range) -> Object {
    Object::new()
        .exact("low", Some(range.low))
        .exact("expected", Some(range.mid))
        .exact("high", Some(range.high))
}

/// `about 24 s`, or `18 s to 40 s` where it is not known well.
pub fn about(range: &Range) -> String {
    match range.is_narrow() || range.high < 0.1 {
        true if range.mid < 0.1 => rough(range.mid),
        true => format!("about {}", rough(range.mid)),
        false => format!("{} to {}", rough(range.low), rough(range.high)),
    }
}

/// The same of an error.
pub fn share(range: &Range) -> String {
    match range.is_narrow() {
        true => format!("about {}", percent(range.mid)),
        false => format!("{} to {}", percent(range.low), percent(range.high)),
    }
}

/// Seconds to two digits, in the unit in which people think of them.
pub fn rough(seconds: f64) -> String {
    let (value, unit) = match seconds {
        small if small < 0.1 => return "under 0.1 s".to_owned(),
        seconds if seconds < 99.5 => (seconds, "s"),
        minutes if minutes < 99.5 * 60.0 => (minutes / 60.0, "min"),
        hours if hours < 99.5 * 3600.0 => (hours / 3600.0, "h"),
        days => (days / 86_400.0, "days"),
    };
    match value {
        value if value < 9.95 => format!("{value:.1} {unit}"),
        value if value < 99.5 => format!("{value:.0} {unit}"),
        value => format!("{:.0} {unit}", 10.0 * (value / 10.0).round()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_two_digits() {
        let told = [0.04, 0.5, 4.04, 24.2, 99.6, 1234.0, 14_400.0, 1e6, 1e9].map(rough);
        let wanted =
            ["under 0.1 s", "0.5 s", "4.0 s", "24 s", "1.7 min", "21 min", "4.0 h", "12 days", "11570 days"];
        assert_eq!(told, wanted);
    }

    #[test]
    fn what_is_not_known_well_is_a_range() {
        assert_eq!(about(&Range::new(20.0, 24.0, 29.0)), "about 24 s");
        assert_eq!(about(&Range::new(12.0, 24.0, 40.0)), "12 s to 40 s");
        assert_eq!(share(&Range::new(0.01, 0.03, 0.04)), "1.0 % to 4.0 %");
    }
}
