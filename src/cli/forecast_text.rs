//! The forecast of a run in words: its time, its error, and options that would suit better.

use super::json::{line, object};
use crate::base::stats::StatusLine;
use crate::base::units::counted;
use crate::base::units::percent;
use crate::pipeline::plan::{Outlook, PilotTime, Plan, Range, RunForecast};
use crate::pipeline::render::Notice;
use crate::sequence::Sequence;
use crate::sequence::quality::{NoiseTarget, Quality};
use serde_json::{Map, Value, json};

/// Runs that take longer, in seconds, get advice on how to shorten them.
const LONG_RUN: f64 = 600.0;

/// For runs that take less time, in seconds, no forecast is printed.
const SHORT_RUN: f64 = 5.0;

/// The text and the JSON of a notice. `None` if it is not worth a line.
pub fn notice_line(sequence: &Sequence, notice: Notice) -> Option<StatusLine> {
    match notice {
        Notice::Pilot { plan } => {
            Some(StatusLine { text: pilot_text(sequence, plan), json: pilot_json(plan) })
        }
        Notice::Outlook { outlook, .. } => {
            let forecast = outlook.forecast(&sequence.quality);
            let text = format!("expected: {}", sentence(&sequence.quality, &forecast, outlook));
            let mut json = object(json!({ "event": "forecast" }));
            json.extend(forecast_json(&forecast));
            json.insert("advice".to_owned(), advice(&sequence.quality, &forecast, outlook).into());
            (forecast.wall.mid >= SHORT_RUN || forecast.missed > 0)
                .then(|| StatusLine { text, json: line(json) })
        }
    }
}

fn pilot_json(plan: &Plan) -> String {
    line(json!({ "event": "pilot", "films": plan.films.len() }))
}

/// The plan, before anything is traced.
fn pilot_text(sequence: &Sequence, plan: &Plan) -> String {
    let quality = &sequence.quality;
    let samples = match quality.noise {
        Some(target) => format!("up to {} a pixel", counted(target.most.into(), "sample")),
        None => format!("{} a pixel where something is random", counted(quality.samples.into(), "sample")),
    };
    let (width, height) = sequence.output.size;
    let films = counted(plan.films.len() as u64, "film");
    format!(
        "{} from {films} of {width}x{height} pixels, {samples}; a pilot of at most {} s predicts the time",
        counted(plan.film_of.len() as u64, "frame"),
        PilotTime::RUN.seconds
    )
}

/// `tracing takes about 20 min, and leaves an error of about 3.0 % in the worst frame; --noise 0.08 takes about 5 min`.
fn sentence(quality: &Quality, forecast: &RunForecast, outlook: &Outlook) -> String {
    let mut text = format!("tracing takes {}", time_range(&forecast.wall));
    if let Some(error) = &forecast.error {
        text += &format!(", and leaves an error of {} in the worst frame", error_range(error));
    }
    advice(quality, forecast, outlook).iter().for_each(|line| text += &format!("; {line}"));
    text
}

/// Options that suit better, if a run takes long or misses its target error.
pub fn advice(quality: &Quality, forecast: &RunForecast, outlook: &Outlook) -> Vec<String> {
    match &quality.noise {
        Some(target) if outlook.is_random() => target_advice(quality, target, forecast, outlook),
        _ if forecast.wall.mid > LONG_RUN => vec![limit_advice(quality, outlook)],
        _ => Vec::new(),
    }
}

fn target_advice(
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
            "the target error of {} is missed in {} of {films}, because pixels may have {} at most",
            percent(target.error),
            forecast.missed,
            counted(target.most.into(), "sample")
        ));
        if let Some(most) = outlook.samples_for(quality, target) {
            let time = with(NoiseTarget { most, ..*target }).wall;
            lines.push(format!("--max-samples {most} reaches it in {}", time_range(&time)));
        }
    }
    let long = forecast.wall.mid > LONG_RUN;
    if long || forecast.missed > 0 {
        let within = if long { LONG_RUN } else { f64::INFINITY };
        if let Some(error) = outlook.error_within(quality, target, within) {
            lines.push(format!(
                "--noise {error} takes {}",
                time_range(&with(NoiseTarget { error, ..*target }).wall)
            ));
        }
    }
    if long {
        lines.push(limit_advice(quality, outlook));
    }
    lines
}

/// The result of a time limit of ten minutes.
fn limit_advice(quality: &Quality, outlook: &Outlook) -> String {
    let fitting = outlook.fitting(quality, LONG_RUN);
    match outlook.forecast(&fitting).error {
        Some(error) => format!("--time-limit 10min reaches about {}", percent(error.mid)),
        None => format!("--time-limit 10min has room for a grid of {0}x{0}", fitting.antialias),
    }
}

/// The forecast for programs.
pub fn forecast_json(forecast: &RunForecast) -> Map<String, Value> {
    let ranges = [("time_s", Some(forecast.wall)), ("cpu_s", forecast.cpu), ("error", forecast.error)];
    let known = ranges.into_iter().filter_map(|(name, of)| Some((name.to_owned(), range_json(&of?))));
    known.chain([("films_that_miss_the_error".to_owned(), forecast.missed.into())]).collect()
}

/// A range for programs.
pub fn range_json(range: &Range) -> Value {
    json!({ "low": range.low, "expected": range.mid, "high": range.high })
}

/// `about 24 s`, or `18 s to 40 s` if the range is wide.
pub fn time_range(range: &Range) -> String {
    match range.is_narrow() || range.high < 0.1 {
        true if range.mid < 0.1 => short_time(range.mid),
        true => format!("about {}", short_time(range.mid)),
        false => format!("{} to {}", short_time(range.low), short_time(range.high)),
    }
}

/// `about 2.4 %`, or `1.8 % to 4.0 %` if the range is wide.
pub fn error_range(range: &Range) -> String {
    match range.is_narrow() {
        true => format!("about {}", percent(range.mid)),
        false => format!("{} to {}", percent(range.low), percent(range.high)),
    }
}

/// A time in seconds, with two digits and a fitting unit.
pub fn short_time(seconds: f64) -> String {
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
        let texts = [0.04, 0.5, 4.04, 24.2, 99.6, 1234.0, 14_400.0, 1e6, 1e9].map(short_time);
        let wanted =
            ["under 0.1 s", "0.5 s", "4.0 s", "24 s", "1.7 min", "21 min", "4.0 h", "12 days", "11570 days"];
        assert_eq!(texts, wanted);
    }

    #[test]
    fn wide_ranges_show_both_ends() {
        assert_eq!(time_range(&Range::new(20.0, 24.0, 29.0)), "about 24 s");
        assert_eq!(time_range(&Range::new(12.0, 24.0, 40.0)), "12 s to 40 s");
        assert_eq!(error_range(&Range::new(0.01, 0.03, 0.04)), "1.0 % to 4.0 %");
    }
}
