//! How long each film takes, and what error it leaves.

use super::report::PlanReport;
use crate::cli::forecast_text::{error_range, time_range};
use crate::pipeline::plan::{FilmForecast, Range};
use serde_json::{Map, Value, json};

/// The forecast of some films for programs: their total time, and the worst error.
pub fn forecast_json(films: &[FilmForecast]) -> Map<String, Value> {
    let cpu: Option<f64> = films.iter().map(|film| film.took.cpu).sum();
    let worst = films.iter().filter_map(|film| film.error).reduce(f64::max);
    let mut forecast = Map::new();
    forecast.insert("time_s".to_owned(), films.iter().map(|film| film.took.wall).sum::<f64>().into());
    forecast.insert("cpu_s".to_owned(), cpu.into());
    if let [film] = films {
        forecast.insert("samples".to_owned(), json!(film.samples));
    }
    forecast.extend(worst.map(|error| ("error".to_owned(), error.into())));
    forecast
}

/// At most this many lines list the films; if there are more films, neighbours share a line.
const MAX_LINES: usize = 12;

/// A line for each film, or for each group of neighbours.
pub fn lines(report: &PlanReport, films: &[FilmForecast]) -> Vec<String> {
    let per_line = films.len().div_ceil(MAX_LINES).max(1);
    let frame = |film: usize| report.frame(report.plan.films[film].frames[0]);
    let line = |(line, group): (usize, &[FilmForecast])| {
        let first = line * per_line;
        let last = first + group.len() - 1;
        let mut text = match group.len() {
            1 => format!("film of frame {}", frame(first)),
            count => format!("{count} films of frames {} to {}", frame(first), frame(last)),
        };
        if let Some(time) = range(group, |film| Some(film.took.wall)) {
            text += &format!(": {}{}", time_range(&time), if group.len() > 1 { " each" } else { "" });
        }
        let samples = range(group, |film| Some(film.samples));
        if let (Some(samples), Some(error)) = (samples, range(group, |film| film.error)) {
            text += &format!(", {} with {:.0} samples a pixel", error_range(&error), samples.mid);
        }
        text
    };
    films.chunks(per_line).enumerate().map(line).collect()
}

/// The least, mean and largest value of some films.
fn range(films: &[FilmForecast], value: impl Fn(&FilmForecast) -> Option<f64>) -> Option<Range> {
    let values: Vec<f64> = films.iter().filter_map(value).collect();
    let low = values.iter().copied().reduce(f64::min)?;
    let high = values.iter().copied().reduce(f64::max)?;
    Some(Range::new(low, values.iter().sum::<f64>() / values.len() as f64, high))
}
