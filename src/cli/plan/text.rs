//! The report as aligned lines, for people.

use super::report::PlanReport;
use super::{changes, films};
use crate::base::units::{self, count, counted};
use crate::cli::forecast_text::{advice, error_range, short_time, time_range};
use crate::cli::headed::{self, Group};
use crate::cli::summary::reused_frames;
use crate::pipeline::plan::{EffectSource, FrameSpan, RayEstimate, Reason, SceneEffect, camera_rays};
use crate::pipeline::schedule::ViewObstacle;
use crate::sequence::quality::{Denoise, SampleReuse};
use crate::trace::PathObstacle;

/// Explains the word to readers who meet it here for the first time.
const FILM: &str = "a film is the light traced for a frame, in layers; frames in which lights only change their \
                    brightness share one";

/// Takes the place of the times if there was no pilot.
const NO_PILOT: &str = "no pilot was traced";

pub fn text(report: &PlanReport) -> String {
    let mut groups = vec![
        ("frames", vec![frames(report)]),
        ("films", vec![films(report), FILM.to_owned()]),
        ("why", vec![reasons(report)]),
    ];
    groups.extend(forecast(report));
    groups.push(("spans", report.outline.spans.iter().map(|of| span(report, of)).collect()));
    groups.push(("layers", layers(report)));
    groups.push(("effects", report.outline.effects.iter().map(|of| effect(report, of)).collect()));
    groups.push(("unused", vec![report.unused_effects().collect::<Vec<_>>().join(", ")]));
    groups.push(("BVH", vec![counted(report.plan.bvh_updates(), "update")]));
    groups.push(("rays", rays(report)));
    groups.extend(paths(report).map(|line| ("paths", vec![line])));
    groups.extend(zoom(report).map(|line| ("zoom", vec![line])));
    groups.push(("memory", memory(report)));
    groups.extend(report.farm.iter().map(|farm| ("farm", farm.lines())));
    headed::text(&groups)
}

fn frames(report: &PlanReport) -> String {
    let (frames, films) = (report.plan.film_of.len() as u64, report.plan.films.len() as u64);
    match frames - films {
        0 => count(frames),
        reused => format!("{}, {}", count(frames), reused_frames(reused)),
    }
}

/// The number of films, and whether more memory would make it smaller.
fn films(report: &PlanReport) -> String {
    let takes = &report.plan.films;
    let most = takes.iter().map(|take| take.lit.len()).max().unwrap_or(0) as u64;
    let films = counted(takes.len() as u64, "film");
    let mut text = format!("{films}, with up to {} of light", counted(most, "layer"));
    let neighbors = report.plan.states.neighbors_besides() as u64;
    if neighbors > 0 {
        text += &format!("; samples of {} beside these, for the denoiser", counted(neighbors, "frame"));
    }
    let unlimited = report.unlimited_films();
    if takes.len() > unlimited {
        text += &format!(
            "; {} would do with a larger --film-cache, which has no room for all films or all of their layers",
            count(unlimited as u64)
        );
    }
    text
}

/// Why each film is traced.
fn reasons(report: &PlanReport) -> String {
    let clause = |(reason, films): &(Reason, usize)| {
        let films = count(*films as u64);
        match reason {
            Reason::First => format!("{films} for the first frame"),
            Reason::Change(parts) => format!("{films} because {}", changes::sentence(report.sequence, parts)),
            Reason::Noise => format!("{films} because `vary_noise` gives each frame noise of its own"),
            Reason::Samples => format!("{films} because samples become random or stop being so"),
            Reason::Memory => format!("{films} again, because --film-cache is too small to keep them"),
        }
    };
    report.outline.reasons.iter().map(clause).collect::<Vec<_>>().join("; ")
}

/// Time and error of the run, and of each film.
fn forecast(report: &PlanReport) -> Vec<Group> {
    let Some((outlook, forecast)) = &report.outlook else { return vec![("time", vec![NO_PILOT.to_owned()])] };
    let mut time = format!("tracing takes {}", time_range(&forecast.wall));
    if let Some(cpu) = &forecast.cpu {
        time += &format!(", {} of processor time", time_range(cpu));
    }
    let advice = advice(&report.sequence.quality, forecast, outlook);
    let error = match &forecast.error {
        Some(error) => format!("{} of the brightness, in the worst frame", error_range(error)),
        None => "none, as nothing is random".to_owned(),
    };
    let films = films::lines(report, &forecast.films);
    vec![("time", [vec![time], advice].concat()), ("error", vec![error]), ("films", films)]
}

fn span(report: &PlanReport, span: &FrameSpan) -> String {
    let range = match (report.frame(span.first), report.frame(span.last)) {
        (first, last) if first == last => first.to_string(),
        (first, last) => format!("{first}-{last}"),
    };
    let films = counted(span.traced as u64, "film");
    let changes = match span.changes.is_empty() {
        true => "nothing changes".to_owned(),
        false => changes::sentence(report.sequence, &span.changes),
    };
    format!("{range}: {changes} ({films})")
}

/// Every layer of light by its sources, and how many films hold it.
fn layers(report: &PlanReport) -> Vec<String> {
    let line = |(layer, name): (usize, String)| match report.films_with_layer(layer) {
        0 => format!("{name}: dark, not traced"),
        films => format!("{name}: in {}", counted(films as u64, "film")),
    };
    report.sequence.about().layers.into_iter().enumerate().map(line).collect()
}

/// An effect, the part that calls for it, and the time of the films that need it.
fn effect(report: &PlanReport, (effect, caller): (&SceneEffect, &EffectSource)) -> String {
    let line = format!("{}: {}", effect.name(), changes::caller(report.sequence, *caller));
    let (Some((_, forecast)), Some(films)) = (&report.outlook, report.outline.calls.get(effect)) else {
        return line;
    };
    let wall: f64 = films.iter().map(|&film| forecast.films[film].took.wall).sum();
    format!("{line} ({}, {})", counted(films.len() as u64, "film"), short_time(wall))
}

/// The rays without reuse of films, and with it.
fn rays(report: &PlanReport) -> Vec<String> {
    let expected = &report.expected;
    let (alone, planned) = (expected.rays_alone, expected.rays);
    let fewer = match (alone, planned) {
        (Some(alone), Some(planned)) if planned > 0 && alone > planned => {
            format!("; {:.1} times fewer", alone as f64 / planned as f64)
        }
        _ => String::new(),
    };
    vec![
        format!("frame by frame  {}", ray_count(expected.camera_alone, expected.exact_alone, alone)),
        format!("with this plan  {}{fewer}", planned_rays(report)),
    ]
}

/// The rays with the plan. Without a pilot, films that may share paths have an upper bound.
fn planned_rays(report: &PlanReport) -> String {
    let RayEstimate { camera, exact, shares_paths, rays, .. } = report.expected;
    match (shares_paths, rays) {
        (true, None) => format!("at most {} from the camera", count(camera)),
        _ => ray_count(camera, exact && !shares_paths, rays),
    }
}

/// How many of the paths of films are traced, if films share paths.
fn paths(report: &PlanReport) -> Option<String> {
    let expected = &report.expected;
    if !expected.shares_paths {
        return None;
    }
    let films: u64 = RayEstimate::of(report.sequence, &report.plan).camera;
    let text = "films that differ in objects and materials only share paths; a path is traced again where something \
                has moved";
    let why = expected.path_obstacle.map(path_obstacle);
    Some(match (&report.outlook, why) {
        (Some(_), Some(why)) if expected.camera >= films => format!("no films share paths, because {why}"),
        (Some(_), why) if films > 0 => {
            let share = 100.0 * expected.camera as f64 / films as f64;
            let some = why.map(|why| format!("; some share none, because {why}")).unwrap_or_default();
            format!("{text}; about {share:.1} % of the paths of all films are traced{some}")
        }
        _ => text.to_owned(),
    })
}

/// Why films do not share paths.
fn path_obstacle(obstacle: PathObstacle) -> &'static str {
    match obstacle {
        PathObstacle::MovingSource => "a light or an object that emits light moves or changes",
        PathObstacle::Extent => "the extent of the scene differs, on which error bounds depend",
        PathObstacle::Sampling => "samples differ in kind or in the number of their moments",
        PathObstacle::ShapeData => "meshes or particles that change would take too much memory",
        PathObstacle::Memory => "--film-cache has no room for copies of their scenes",
        PathObstacle::Changes => "most paths change, or finding those that do is too much work",
    }
}

/// How many films share samples because their cameras are at one point.
fn zoom(report: &PlanReport) -> Option<String> {
    let groups = &report.plan.view_groups;
    if groups.is_empty() && report.sequence.quality.reuse == SampleReuse::Zoom {
        let quality = &report.sequence.quality;
        let why = match quality.noise {
            Some(_) => view_obstacle(ViewObstacle::Target),
            None if quality.denoise != Denoise::Off => view_obstacle(ViewObstacle::Denoise),
            None => view_obstacle(report.plan.view_obstacle().unwrap_or_default()),
        };
        return Some(format!("no films share samples, because {why}"));
    }
    let films: usize = groups.iter().map(|group| group.films.len()).sum();
    let camera: u64 = groups.iter().map(|group| group.camera_rays).sum();
    let grouped = groups.iter().flat_map(|group| group.films.clone());
    let alone: u64 = grouped.map(|film| camera_rays(report.sequence, report.plan.state_of(film))).sum();
    (films > 0).then(|| {
        let compared = match camera <= alone {
            true => format!("{:.1} times fewer", alone as f64 / camera.max(1) as f64),
            false => {
                let more = camera as f64 / alone.max(1) as f64;
                let why = match report.plan.splits_views() {
                    true => "--film-cache has room for a part of the films at a time, and each group traces samples of \
                             the others again",
                    false => "samples of frames that are not rendered are needed",
                };
                format!("{more:.1} times as many, because {why}")
            }
        };
        let (films, times) = (counted(films as u64, "film"), counted(groups.len() as u64, "group"));
        format!(
            "{films} in {times} share samples, because the camera stays in its place: about {} camera rays instead of \
             {}, {compared}",
            count(camera),
            count(alone)
        )
    })
}

/// Why frames do not share samples of views.
fn view_obstacle(obstacle: ViewObstacle) -> &'static str {
    match obstacle {
        ViewObstacle::Target => "frames are sampled until they reach a target error",
        ViewObstacle::Denoise => "frames are denoised",
        ViewObstacle::Noise => "`vary_noise` gives each frame noise of its own",
        ViewObstacle::Lens => "the camera has a lens",
        ViewObstacle::Parallel => "the camera is orthographic",
        ViewObstacle::Shutter => "something moves while the shutter is open",
        ViewObstacle::CrossFade => "two cameras show a frame in a cross-fade",
        ViewObstacle::Pattern => "a pattern is shown, which fades by the size of pixels",
        ViewObstacle::Filter => "the filter is narrower than a pixel",
        ViewObstacle::Gain => "hardly any directions are in several pictures",
        ViewObstacle::Neighbors => {
            "no frames next to each other show one scene from one place in different views"
        }
    }
}

/// `about 12,000 rays, 3,000 of them from the camera`.
fn ray_count(camera: u64, exact: bool, all: Option<u64>) -> String {
    let camera = format!("{}{} ", if exact { "" } else { "about " }, count(camera));
    match all {
        Some(all) => format!("about {}, {camera}of them from the camera", count(all)),
        None => format!("{camera}from the camera"),
    }
}

fn memory(report: &PlanReport) -> Vec<String> {
    let (kept, shared) = (units::bytes(report.plan.kept_bytes()), report.plan.shared_bytes());
    let mut lines = vec![format!(
        "{kept} for films that later frames reuse, of at most {}",
        units::bytes(report.cache_budget)
    )];
    if shared > 0 {
        let (shared, scenes) = (units::bytes(shared), units::bytes(report.plan.scenes_budget()));
        lines.push(format!(
            "{shared} for films that share paths, at most {scenes} for copies of their scenes"
        ));
    }
    if let Some(bytes) = report.plan.view_groups.iter().map(|group| group.bytes).max() {
        lines.push(format!("{} for films that share samples", units::bytes(bytes)));
    }
    lines.push(format!("{} for pictures that wait for the encoder", units::bytes(report.pending_bytes)));
    lines
}
