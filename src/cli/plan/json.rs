//! The report as one JSON object, for programs.

use super::report::PlanReport;
use super::{changes, films};
use crate::cli::forecast_text;
use crate::cli::json::{line, object};
use crate::pipeline::plan::{FrameSpan, Reason, SharedFilm, ViewGroup};
use serde_json::{Map, Value, json};

pub fn json(report: &PlanReport) -> String {
    let PlanReport { sequence, plan, outline, expected, .. } = report;
    let layers = sequence.about().layers;
    let callers = outline.effects.iter();
    let callers =
        callers.map(|(effect, caller)| (effect.name().to_owned(), changes::caller(sequence, *caller).into()));
    let mut all = object(json!({
        "event": "plan",
        "frames": plan.film_of.len(),
        "reused": plan.reused(),
        "spans": outline.spans.iter().map(|of| span(report, of)).collect::<Vec<_>>(),
        "films": plan.films.iter().enumerate().map(|film_of| film(report, &layers, film_of)).collect::<Vec<_>>(),
        "why_films": outline.reasons.iter().map(|of| reason(report, of)).collect::<Vec<_>>(),
        "layers": layers,
        "effects": callers.collect::<Map<_, _>>(),
        "effect_films": effect_films(report),
        "unused_effects": report.unused_effects().collect::<Vec<_>>(),
        "bvh_updates": plan.bvh_updates(),
        "rays_frame_by_frame": rays(expected.camera_alone, expected.exact_alone, expected.rays_alone),
        "rays": rays(expected.camera, expected.exact && !expected.shares_paths, expected.rays),
        "zoom": plan.view_groups.iter().map(view_group).collect::<Vec<_>>(),
        "kept_bytes": plan.kept_bytes(),
        "budget_bytes": report.cache_budget,
    }));
    if let Some((outlook, forecast)) = &report.outlook {
        all.extend(forecast_text::forecast_json(forecast));
        let advice = forecast_text::advice(&sequence.quality, forecast, outlook);
        all.insert("advice".to_owned(), advice.into());
    }
    all.extend(report.farm.iter().map(|farm| ("farm".to_owned(), farm.json())));
    line(all)
}

/// Films whose views share samples.
fn view_group(group: &ViewGroup) -> Value {
    json!({ "films": group.films.len(), "camera_rays": group.camera_rays, "bytes": group.bytes })
}

/// Frames in a row between which the same parts change.
fn span(report: &PlanReport, span: &FrameSpan) -> Value {
    json!({
        "first": report.frame(span.first),
        "last": report.frame(span.last),
        "changes": changes::list(report.sequence, &span.changes),
        "films": span.traced,
    })
}

fn film(report: &PlanReport, layers: &[String], (index, take): (usize, &SharedFilm)) -> Map<String, Value> {
    let mut film = object(json!({
        "traced_for": report.frame(take.frames[0]),
        "frames": take.frames.len(),
        "layers": take.lit.iter().map(|layer| &layers[layer.index()]).collect::<Vec<_>>(),
    }));
    if let Some((_, forecast)) = &report.outlook {
        film.extend(films::forecast_json(&forecast.films[index..=index]));
    }
    film
}

/// Why films are traced, and how many for each reason.
fn reason(report: &PlanReport, (reason, films): &(Reason, usize)) -> Value {
    match reason {
        Reason::First => json!({ "films": films, "why": "first" }),
        Reason::Noise => json!({ "films": films, "why": "vary_noise" }),
        Reason::Samples => json!({ "films": films, "why": "samples" }),
        Reason::Memory => json!({ "films": films, "why": "memory" }),
        Reason::Change(parts) => {
            json!({ "films": films, "why": "change", "changes": changes::list(report.sequence, parts) })
        }
    }
}

/// The films that call for each effect, with their forecast.
fn effect_films(report: &PlanReport) -> Map<String, Value> {
    let films = report.outline.calls.iter().map(|(effect, films)| {
        let mut of = object(json!({ "films": films.len() }));
        if let Some((_, forecast)) = &report.outlook {
            let forecasts: Vec<_> = films.iter().map(|&film| forecast.films[film]).collect();
            let mut sum = films::forecast_json(&forecasts);
            sum.shift_remove("samples");
            of.extend(sum);
        }
        (effect.name().to_owned(), of.into())
    });
    films.collect()
}

fn rays(camera: u64, exact: bool, all: Option<u64>) -> Map<String, Value> {
    let mut rays = object(json!({ "camera": camera, "exact": exact }));
    rays.extend(all.map(|all| ("all".to_owned(), all.into())));
    rays
}
