//! The summary of a run, for people and for programs.

mod error;

use super::forecast_text;
use super::headed;
use super::json::{line, object, rounded};
use crate::base::escape;
use crate::base::stats::{Counts, SharedSamples};
use crate::base::units;
use crate::base::units::seconds;
use crate::pipeline::render::{Forecast, Summary};
use serde_json::{Map, Value, json};
use std::path::Path;

/// The forecast of the run. Empty if there was no plan.
fn expected(forecast: Option<&Forecast>) -> Map<String, Value> {
    let Some(forecast) = forecast else { return Map::new() };
    let mut expected = object(json!({
        "reused": forecast.reused,
        "camera_rays": forecast.camera_rays,
        "exact": forecast.exact && !forecast.shares_paths,
        "bound": match (forecast.shares_paths, forecast.exact) {
            (true, _) => "most",
            (false, true) => "exact",
            (false, false) => "least",
        },
        "bvh_updates": forecast.bvh_updates,
    }));
    expected.extend(forecast.rays.map(|rays| ("rays".to_owned(), rays.into())));
    let ranges = [("time_s", forecast.wall), ("cpu_s", forecast.cpu), ("error", forecast.error)];
    let known = ranges
        .into_iter()
        .filter_map(|(name, range)| Some((name.to_owned(), forecast_text::range_json(&range?))));
    expected.extend(known);
    expected
}

/// Aligned lines in groups, each with a heading in front.
pub fn text(summary: &Summary) -> String {
    let stages = summary.stages.iter().map(|&(name, time)| (name, units::time(time))).collect::<Vec<_>>();
    let groups = [
        ("wrote", summary.files.iter().map(|file| file_name(file)).collect()),
        ("frames", vec![frames(summary)]),
        ("time", vec![time(summary)]),
        ("rays", rays(summary)),
        ("paths", paths(summary)),
        ("zoom", zoom(summary)),
        ("dropped", dropped(summary)),
        ("error", error::lines(&summary.noise)),
        ("BVH", vec![bvh(summary)]),
        ("planned", summary.expected.iter().map(planned).collect()),
        ("stages", aligned(&stages)),
        ("note", summary.notes.clone()),
    ];
    headed::text(&groups)
}

/// The name of a written file.
pub fn file_name(file: &Path) -> String {
    if file == Path::new("-") { "standard output".to_owned() } else { escape::path(file) }
}

/// One line of JSON.
pub fn json(summary: &Summary) -> String {
    let Counts { rays, evaluations, dropped, paths, samples } = summary.counts;
    let stages = summary.stages.iter().map(|(name, time)| ((*name).to_owned(), rounded(time.as_secs_f64())));
    line(json!({
        "event": "summary",
        "files": summary.files.iter().map(|file| file.to_string_lossy()).collect::<Vec<_>>(),
        "frames": summary.frames,
        "kept": summary.kept,
        "reused": summary.reused,
        "elapsed_s": rounded(summary.elapsed.as_secs_f64()),
        "tracing_cpu_s": summary.cpu.map(rounded),
        "rays": {
            "camera": rays.camera,
            "mirror": rays.mirror,
            "transmitted": rays.transmitted,
            "scattered": rays.scattered,
            "shadow": rays.shadow,
            "total": rays.total(),
        },
        "paths": {
            "all": paths.all,
            "traced": paths.traced(),
            "reused": paths.reused(),
            "retraced": paths.retraced,
            "frame_by_frame": paths.whole,
        },
        "zoom": {
            "films": samples.films,
            "samples_alone": samples.alone,
            "samples": samples.traced,
            "own_samples": samples.own,
        },
        "evaluations": {
            "fog": evaluations.fog,
            "paint": evaluations.paint,
            "light_samples": evaluations.light_samples,
            "lens_samples": evaluations.lens_samples,
        },
        "dropped_samples": {
            "undefined": dropped.undefined,
            "infinite": dropped.infinite,
            "negative": dropped.negative,
        },
        "noise": error::json(&summary.noise),
        "bvh_builds": summary.bvh_builds,
        "bvh_refits": summary.bvh_refits,
        "bvh_updates": summary.bvh_builds + summary.bvh_refits,
        "expected": expected(summary.expected.as_ref()),
        "stages_s": stages.collect::<Map<_, _>>(),
        "notes": summary.notes,
    }))
}

/// The number of frames, and how many of them were kept or reuse films.
fn frames(summary: &Summary) -> String {
    let mut text = units::count(summary.frames.into());
    if summary.kept > 0 {
        text += &format!(", {} of them kept", units::count(summary.kept.into()));
    }
    if summary.reused > 0 {
        text += &format!(", {}", reused_frames(summary.reused.into()));
    }
    text
}

/// How often the BVH over the scene was built, and how often refitted.
fn bvh(summary: &Summary) -> String {
    let builds = units::counted(summary.bvh_builds, "build");
    match summary.bvh_refits {
        0 => builds,
        refits => format!("{builds}, {}", units::counted(refits, "refit")),
    }
}

/// `2 reuse another frame's film`: the number of frames that need no film of their own.
pub fn reused_frames(frames: u64) -> String {
    let verb = if frames == 1 { "reuses" } else { "reuse" };
    format!("{} {verb} another frame's film", units::count(frames))
}

/// The forecast, to compare it with the result.
fn planned(expected: &Forecast) -> String {
    let rays = match expected.rays {
        Some(rays) => format!("about {} rays", units::count(rays)),
        None if expected.shares_paths => {
            let rays = units::counted(expected.camera_rays, "ray");
            format!("at most the {rays} from the camera that films take alone, as they may share paths")
        }
        None if expected.exact => format!("{} from the camera", units::counted(expected.camera_rays, "ray")),
        None => format!("{} or more from the camera", units::counted(expected.camera_rays, "ray")),
    };
    let updates = units::counted(expected.bvh_updates, "BVH update");
    let mut text = format!("{rays}, {updates}");
    if expected.reused > 0 {
        text += &format!(", {}", reused_frames(expected.reused.into()));
    }
    if let Some(wall) = &expected.wall {
        text += &format!(", tracing in {}", forecast_text::time_range(wall));
    }
    if let Some(cpu) = &expected.cpu {
        text += &format!(", {} of processor time", forecast_text::time_range(cpu));
    }
    text
}

fn time(summary: &Summary) -> String {
    let mut text = units::time(summary.elapsed);
    let rendered = summary.frames.saturating_sub(summary.kept);
    if let Some(each) = summary.elapsed.checked_div(rendered).filter(|_| rendered > 1) {
        text += &format!(", {} per frame", units::time(each));
    }
    if let Some(cpu) = summary.cpu {
        text += &format!("; tracing took {} of processor time", seconds(cpu));
    }
    text
}

/// How many of the paths of films that share paths were traced, and why. Empty if no films share paths.
fn paths(summary: &Summary) -> Vec<String> {
    let paths = summary.counts.paths;
    if paths.all == 0 {
        return Vec::new();
    }
    let [all, once, again] = [paths.all, paths.once, paths.retraced].map(units::count);
    let mut text = format!(
        "{:.1} % traced of {all}: {once} once for several frames, {again} again where something moved",
        100.0 * paths.share()
    );
    if paths.whole > 0 {
        text += &format!(
            ", {} frame by frame in tiles where sharing gains too little",
            units::count(paths.whole)
        );
    }
    vec![text]
}

/// Films that share samples because their cameras are at one point. Empty if there are none.
fn zoom(summary: &Summary) -> Vec<String> {
    let SharedSamples { films, alone, own, traced } = summary.counts.samples;
    if films == 0 {
        return Vec::new();
    }
    let (films, shared) = (units::counted(films, "film"), units::count(traced));
    let mut text =
        format!("{films} shared {shared} samples, instead of {} of their own", units::count(alone));
    if own > 0 {
        text += &format!("; {} more for pixels that lacked some", units::count(own));
    }
    let mut lines = vec![text];
    if traced + own > alone {
        lines.push(
            "these are more, because samples of other frames of the zoom were needed: render these together, or take \
             a larger --film-cache"
                .to_owned(),
        );
    }
    lines
}

/// All rays with their rate, then each kind. Rare kinds are listed only if there are any.
fn rays(summary: &Summary) -> Vec<String> {
    let rays = summary.counts.rays;
    let mut rows = vec![("all", units::count(rays.total())), ("camera", units::count(rays.camera))];
    rows.push(("mirror", units::count(rays.mirror)));
    rows.extend(above_zero([("transmitted", rays.transmitted), ("scattered", rays.scattered)]));
    rows.push(("shadow", units::count(rays.shadow)));
    let mut lines = aligned(&rows);
    lines[0] += &format!("  {}", units::ray_rate(rays.total(), summary.elapsed));
    lines
}

/// Samples that were dropped, by cause. There should be none.
fn dropped(summary: &Summary) -> Vec<String> {
    let dropped = summary.counts.dropped;
    let causes =
        [("undefined", dropped.undefined), ("infinite", dropped.infinite), ("negative", dropped.negative)];
    aligned(&above_zero(causes).collect::<Vec<_>>())
}

fn above_zero<const N: usize>(
    counts: [(&'static str, u64); N],
) -> impl Iterator<Item = (&'static str, String)> {
    counts.into_iter().filter(|(_, count)| *count > 0).map(|(name, count)| (name, units::count(count)))
}

/// Names aligned to the left, values to the right.
fn aligned(rows: &[(&str, String)]) -> Vec<String> {
    let names = rows.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    let values = rows.iter().map(|(_, value)| value.chars().count()).max().unwrap_or(0);
    rows.iter().map(|(name, value)| format!("{name:<names$}  {value:>values$}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::stats::{Dropped, RayCounts, SharedPaths};
    use crate::pipeline::plan::Range;
    use std::time::Duration;

    fn summary() -> Summary {
        Summary {
            frames: 72,
            kept: 0,
            reused: 0,
            expected: None,
            counts: Counts {
                rays: RayCounts { camera: 66_355_200, mirror: 20_481, shadow: 9, ..RayCounts::default() },
                ..Counts::default()
            },
            bvh_builds: 1,
            bvh_refits: 0,
            noise: Vec::new(),
            cpu: Some(19.84),
            stages: vec![("animate", Duration::from_micros(840)), ("trace", Duration::from_millis(9870))],
            elapsed: Duration::from_millis(10_440),
            files: vec!["out/orbit_####.png".into(), "out/\"orbit\".gif".into()],
            notes: vec!["a draft".into()],
        }
    }

    #[test]
    fn the_text_has_aligned_lines() {
        let wanted = "\
wrote   out/orbit_####.png
        out/\"orbit\".gif
frames  72
time    10.4 s, 145 ms per frame; tracing took 19.8 s of processor time
rays    all     66,375,690  6.36 Mray/s
        camera  66,355,200
        mirror      20,481
        shadow           9
BVH     1 build
stages  animate  840 µs
        trace    9.87 s
note    a draft";
        assert_eq!(text(&summary()), wanted);
    }

    #[test]
    fn the_forecast_is_listed_beside_the_result() {
        let expected = Forecast {
            reused: 70,
            camera_rays: 66_355_200,
            exact: true,
            shares_paths: false,
            rays: Some(66_400_000),
            bvh_updates: 1,
            wall: Some(Range::new(10.0, 12.0, 14.0)),
            cpu: None,
            pilot: 0.0,
            error: None,
        };
        let summary = Summary { reused: 70, expected: Some(expected), ..summary() };
        let found = text(&summary);
        assert!(found.contains("\nframes  72, 70 reuse another frame's film\n"), "{found}");
        assert!(
            found.contains("\nplanned about 66,400,000 rays, 1 BVH update, 70 reuse another frame's film, tracing in about 12 s\n"),
            "{found}"
        );
        let wanted = r#""expected":{"reused":70,"camera_rays":66355200,"exact":true,"bound":"exact","bvh_updates":1,"rays":66400000,"time_s":{"low":10.0,"expected":12.0,"high":14.0}}"#;
        assert!(json(&summary).contains(wanted), "{}", json(&summary));
    }

    #[test]
    fn rare_rays_and_dropped_samples_are_listed_if_there_are_any() {
        let mut summary = summary();
        summary.counts.rays.scattered = 1_000;
        summary.counts.dropped = Dropped { undefined: 2, infinite: 0, negative: 11 };
        let wanted = "\
rays    all        66,376,690  6.36 Mray/s
        camera     66,355,200
        mirror         20,481
        scattered       1,000
        shadow              9
dropped undefined   2
        negative   11
";
        assert!(text(&summary).contains(wanted), "{}", text(&summary));
    }

    #[test]
    fn all_paths_that_were_traced_are_counted() {
        let mut summary = summary();
        summary.counts.paths =
            SharedPaths { all: 31_104, once: 5_184, retraced: 284, whole: 0, ..SharedPaths::default() };
        let line =
            "paths   17.6 % traced of 31,104: 5,184 once for several frames, 284 again where something moved";
        assert!(text(&summary).contains(&format!("{line}\n")), "{}", text(&summary));
        let counts =
            r#""paths":{"all":31104,"traced":5468,"reused":25636,"retraced":284,"frame_by_frame":0}"#;
        assert!(json(&summary).contains(counts), "{}", json(&summary));
        summary.counts.paths =
            SharedPaths { all: 40_000, once: 5_184, retraced: 284, whole: 8_896, ..SharedPaths::default() };
        let rest = ", 8,896 frame by frame in tiles where sharing gains too little\n";
        assert!(text(&summary).contains(rest), "{}", text(&summary));
    }

    #[test]
    fn kept_frames_are_listed_and_take_no_time() {
        let text = text(&Summary { kept: 62, ..summary() });
        assert!(text.contains("frames  72, 62 of them kept\ntime    10.4 s, 1.04 s per frame; tracing took 19.8 s of processor time\n"), "{text}");
        assert!(super::text(&Summary { kept: 72, ..summary() }).contains("time    10.4 s; "));
    }

    #[test]
    fn the_standard_output_has_a_name() {
        assert_eq!(file_name(Path::new("-")), "standard output");
        assert_eq!(file_name(Path::new("./-")), "./-");
    }

    #[test]
    fn refits_are_listed_if_there_are_any() {
        let text = text(&Summary { bvh_refits: 71, ..summary() });
        assert!(text.contains("\nBVH     1 build, 71 refits\n"), "{text}");
    }

    #[test]
    fn an_empty_run_has_a_summary() {
        let text = text(&Summary::default());
        assert!(text.starts_with("frames  0\ntime    0 µs\n"), "{text}");
        assert!(text.ends_with("BVH     0 builds"), "{text}");
    }

    #[test]
    fn the_json_is_one_line() {
        let wanted = concat!(
            r#"{"event":"summary","files":["out/orbit_####.png","out/\"orbit\".gif"],"frames":72,"kept":0,"reused":0,"#,
            r#""elapsed_s":10.44,"tracing_cpu_s":19.84,"rays":{"camera":66355200,"mirror":20481,"transmitted":0,"scattered":0,"shadow":9,"#,
            r#""total":66375690},"paths":{"all":0,"traced":0,"reused":0,"retraced":0,"frame_by_frame":0},"zoom":{"films":0,"samples_alone":0,"samples":0,"own_samples":0},"evaluations":{"fog":0,"paint":0,"light_samples":0,"lens_samples":0},"#,
            r#""dropped_samples":{"undefined":0,"infinite":0,"negative":0},"noise":{},"#,
            r#""bvh_builds":1,"bvh_refits":0,"bvh_updates":1,"expected":{},"stages_s":{"animate":0.001,"trace":9.87},"notes":["a draft"]}"#,
        );
        assert_eq!(json(&summary()), wanted);
    }
}
