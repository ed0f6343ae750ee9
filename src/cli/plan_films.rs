//! What `kinora plan` says of films: how long each takes, and what error it leaves.

use super::json::Object;
use super::outlook::{about, share};
use crate::pipeline::plan::{FilmForecast, Plan, Range};

/// A film's forecast for programs.
pub fn with_forecast(object: Object, film: &FilmForecast) -> Object {
    let object = object
        .exact("time_s", Some(film.took.wall))
        .exact("cpu_s", film.took.cpu)
        .exact("samples", Some(film.samples));
    film.error.iter().fold(object, |object, error| object.exact("error", Some(*error)))
}

/// That of several together: their time, and the worst error.
pub fn with_forecasts(object: Object, films: impl Iterator<Item = FilmForecast>) -> Object {
    let films: Vec<FilmForecast> = films.collect();
    let cpu = films.iter().map(|film| film.took.cpu).sum();
    let worst = films.iter().filter_map(|film| film.error).reduce(f64::max);
    let object =
        object.exact("time_s", Some(films.iter().map(|film| film.took.wall).sum())).exact("cpu_s", cpu);
    worst.iter().fold(object, |object, error| object.exact("error", Some(*error)))
}

/// Films of which each has a line of its own; if there are more, neighbours share one.
const LINES: usize = 12;

/// What each film takes, or each of some groups of neighbours.
pub fn each_film(plan: &Plan, films: &[FilmForecast]) -> Vec<String> {
    let per_line = films.len().div_ceil(LINES).max(1);
    let frame = |film: usize| plan.survey.frames[plan.takes[film].frames[0]].frame;
    let line = |(line, group): (usize, &[FilmForecast])| {
        let first = line * per_line;
        let last = first + group.len() - 1;
        let range = |part: &dyn Fn(&FilmForecast) -> Option<f64>| -> Option<Range> {
            let values: Vec<f64> = group.iter().filter_map(part).collect();
            let low = values.iter().copied().reduce(f64::min)?;
            let high = values.iter().copied().reduce(f64::max)?;
            Some(Range::new(low, values.iter().sum::<f64>() / values.len() as f64, high))
        };
        let mut text = match group.len() {
            1 => format!("film of frame {}", frame(first)),
            count => format!("{count} films of frames {} to {}", frame(first), frame(last)),
        };
        if let Some(time) = range(&|film| Some(film.took.wall)) {
            text += &format!(": {}{}", about(&time), if group.len() > 1 { " each" } else { "" });
        }
        if let (Some(samples), Some(error)) = (range(&|film| Some(film.samples)), range(&|film| film.error)) {
            text += &format!(", {} with {:.0} samples a pixel", share(&error), samples.mid);
        }
        text
    };
    films.chunks(per_line).enumerate().map(line).collect()
}
