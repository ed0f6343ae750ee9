//! Limits of time: how many samples a run has is settled once, and kept by whoever goes on with it.

use crate::command::{contents, folder, kinora, run, stderr};
use kinora::base::clock::TimeSource;
use kinora::base::stats::ProgressMeter;
use kinora::encode::{Existing, Output, frame_texts};
use kinora::pipeline::render::{Request, Reuse, render};
use kinora::pipeline::time_limit::{Settled, settled};
use kinora::sequence::quality::NoiseTarget;
use kinora::sequence::{Sequence, load};
use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

/// A ball that moves through soft light; nothing that takes long.
const SOFT: &str = r#"(
    timeline: (frames: 6, fps: 24, keys: Frames),
    output: (size: (24, 16)),
    background: 0.1,
    camera: (position: (0, 3, 7), target: (0, 0.5, 0)),
    lights: { "panel": Rectangle(corner: (-3, 5, -2), u: (2, 0, 0), v: (0, 0, 2), intensity: 12) },
    objects: { "floor": (shape: Plane()),
        "ball": (shape: Sphere(radius: 1), translation: [(0, (-1, 1, 0)), (6, (1, 1, 0))]) },
)"#;

const LIMIT: Duration = Duration::from_secs(3);

/// Machines by what a ray takes them, in seconds.
const FAST: TimeSource = TimeSource::Rays(1e-5);
const SLOW: TimeSource = TimeSource::Rays(3e-5);

fn soft(folder: &Path, text: &str) -> Sequence {
    let path = folder.join("soft.ron");
    fs::write(&path, text).expect("the folder is writable");
    load(&path).expect("a sequence")
}

fn request(folder: &Path, extension: &str, frames: &[u32]) -> Request {
    let output = Output::parse(folder.join(format!("f_#.{extension}"))).expect("an output");
    Request {
        frames: frames.to_vec(),
        outputs: vec![output],
        confined: false,
        existing: Existing::Keep,
        threads: None,
        reuse: Reuse::Share,
        time_limit: Some(LIMIT),
    }
}

/// Renders with as many samples as fit; returns their number, whether existing frames determined it, and how many of
/// these were kept.
fn limited(sequence: &Sequence, request: &Request, clock: TimeSource) -> (u32, bool, u32) {
    let chosen = settled(sequence, request, LIMIT, clock).expect("samples");
    let quality = chosen.quality();
    let sequence = Sequence { quality, ..sequence.clone() };
    let summary = render(&sequence, request, &Arc::new(ProgressMeter::default())).expect("frames");
    (quality.samples, matches!(chosen, Settled::Before(_)), summary.kept)
}

const ALL: [u32; 6] = [0, 1, 2, 3, 4, 5];

/// On another machine, or with something else at work, a pilot would choose otherwise.
#[test]
fn continued_runs_keep_the_number_of_samples() {
    for extension in ["png", "exr"] {
        let (whole, parts) = (folder(), folder());
        let sequence = soft(whole.path(), SOFT);
        let (samples, before, _) = limited(&sequence, &request(whole.path(), extension, &ALL), FAST);
        assert!(!before && samples > 30, "{samples}");
        // What a killed run leaves.
        for frame in [0, 1, 4] {
            let name = format!("f_{frame}.{extension}");
            fs::copy(whole.path().join(&name), parts.path().join(&name)).expect("a copy");
        }
        let going_on = limited(&sequence, &request(parts.path(), extension, &ALL), SLOW);
        assert_eq!(going_on, (samples, true, 3), "{extension}");
        for frame in ALL {
            let name = format!("f_{frame}.{extension}");
            let bytes = [&whole, &parts].map(|folder| fs::read(folder.path().join(&name)).expect("a frame"));
            assert!(bytes[0] == bytes[1], "{name}");
        }
        // All are there now.
        assert_eq!(limited(&sequence, &request(parts.path(), extension, &ALL), SLOW), (samples, true, 6));
    }
}

#[test]
fn only_frames_of_the_same_limit_and_picture_settle_samples() {
    let folder = folder();
    let sequence = soft(folder.path(), SOFT);
    let all = request(folder.path(), "png", &ALL);
    let (samples, ..) = limited(&sequence, &all, FAST);
    let chosen = |sequence: &Sequence, request: &Request, limit: Duration| {
        settled(sequence, request, limit, SLOW).expect("samples")
    };
    assert!(matches!(chosen(&sequence, &all, LIMIT), Settled::Before(quality) if quality.samples == samples));
    // Fewer frames in the same time, or more time, make better ones.
    let some = request(folder.path(), "png", &[0, 1]);
    assert!(matches!(chosen(&sequence, &some, LIMIT), Settled::Now(_)));
    assert!(matches!(chosen(&sequence, &all, 2 * LIMIT), Settled::Now(_)));
    let anew = Request { existing: Existing::Replace, ..all.clone() };
    assert!(matches!(chosen(&sequence, &anew, LIMIT), Settled::Now(_)));
    // Another scene in all frames.
    let other = soft(folder.path(), &SOFT.replace("intensity: 12", "intensity: 13"));
    assert!(matches!(chosen(&other, &all, LIMIT), Settled::Now(_)));
    // The same scene in some of them.
    let other = soft(folder.path(), &SOFT.replace("(6, (1, 1, 0))", "(3, (0, 1, 0)), (6, (1, 2, 0))"));
    assert!(matches!(chosen(&other, &all, LIMIT), Settled::Before(quality) if quality.samples == samples));
}

/// With an error to reach, the limit settles the most samples of a pixel, unless the error is reached before.
#[test]
fn the_error_or_the_time_ends_a_run() {
    let folder = folder();
    let with = |error: f64| {
        let mut sequence = soft(folder.path(), SOFT);
        sequence.quality.noise = Some(NoiseTarget { error, most: 1 << 20 });
        sequence
    };
    let all = request(folder.path(), "png", &ALL);
    let samples =
        limited(&soft(folder.path(), SOFT), &Request { existing: Existing::Replace, ..all.clone() }, FAST).0;
    let Settled::Now(hard) = settled(&with(1e-4), &all, LIMIT, FAST).expect("samples") else { panic!("now") };
    let most = hard.quality.noise.expect("an error").most;
    assert!(!hard.reached && most == samples, "{most} for {samples}");
    let Settled::Now(easy) = settled(&with(0.2), &all, LIMIT, FAST).expect("samples") else { panic!("now") };
    assert!(easy.reached && easy.wall < LIMIT.as_secs_f64() && easy.quality.noise == with(0.2).quality.noise);
    // What was settled is kept, as it is without an error.
    let anew = Request { existing: Existing::Replace, ..all.clone() };
    assert_eq!(limited(&with(1e-4), &anew, FAST), (most, false, 0));
    assert_eq!(limited(&with(1e-4), &all, SLOW), (most, true, 6));
}

/// Twice the time is twice the samples, less what frames cost without any; the clock counts rays alone.
#[test]
fn samples_fit_into_the_time() {
    let folder = folder();
    let sequence = soft(folder.path(), SOFT);
    let anew = Request { existing: Existing::Replace, ..request(folder.path(), "png", &ALL) };
    for (limit, clock) in [(LIMIT, FAST), (2 * LIMIT, FAST), (LIMIT, SLOW)] {
        let Settled::Now(budget) = settled(&sequence, &anew, limit, clock).expect("samples") else {
            panic!("nothing is there")
        };
        let TimeSource::Rays(each) = clock else { panic!("a clock of rays") };
        let sequence = Sequence { quality: budget.quality, ..sequence.clone() };
        let limited = Request { time_limit: Some(limit), ..anew.clone() };
        let rays = render(&sequence, &limited, &Arc::new(ProgressMeter::default()))
            .expect("frames")
            .counts
            .rays
            .total();
        let took = each * rays as f64;
        let predicted = budget.cpu.expect("a clock of rays");
        assert!((predicted / took - 1.0).abs() < 0.02, "{predicted} was predicted, {took} was needed");
        let whole = took + budget.spent;
        let limit = limit.as_secs_f64();
        // A sample more would not fit.
        assert!(whole <= 1.02 * limit && whole >= 0.9 * limit, "{whole} of {limit}");
    }
}

/// Films that several frames share are paid for once.
#[test]
fn frames_of_one_film_get_its_samples() {
    let folder = folder();
    let still = SOFT.replace("[(0, (-1, 1, 0)), (6, (1, 1, 0))]", "(0, 1, 0)");
    let (moving, still) = (soft(folder.path(), SOFT), soft(folder.path(), &still));
    let all = request(folder.path(), "png", &ALL);
    let samples =
        |sequence: &Sequence| settled(sequence, &all, LIMIT, FAST).expect("samples").quality().samples;
    assert!(samples(&still) > 5 * samples(&moving));
}

#[test]
fn the_command_keeps_the_number_of_samples() {
    let folder = folder();
    soft(folder.path(), SOFT);
    let arguments = ["render", "soft.ron", "--time-limit", "1s", "-o", "f_#.png"];
    let first = kinora(folder.path(), &arguments);
    assert!(first.contains("the time limit allows"), "{first}");
    let before = contents(folder.path());
    for frame in [2, 3] {
        fs::remove_file(folder.path().join(format!("f_{frame}.png"))).expect("a frame");
    }
    let again = kinora(folder.path(), &arguments);
    assert!(again.contains("an earlier run with this time limit used"), "{again}");
    assert!(again.contains("4 of them kept"), "{again}");
    assert!(contents(folder.path()) == before);
    let texts = frame_texts(&folder.path().join("f_2.png"));
    let metadata = |keyword: &str| texts.iter().find(|(k, _)| k == keyword).map(|(_, text)| text.as_str());
    assert!(
        metadata("kinora:time-limit").is_some_and(|text| text.starts_with("1 s for 6 frames, samples=")),
        "{texts:?}"
    );
    let other = run(folder.path(), &["render", "soft.ron", "--time-limit", "2s", "-o", "f_#.png"]);
    assert!(stderr(&other).contains("the time limit allows"), "{}", stderr(&other));
}

#[test]
fn limits_and_errors_go_together_and_posters_have_them_too() {
    let folder = folder();
    soft(folder.path(), SOFT);
    let both = ["render", "soft.ron", "--noise", "0.0001", "--time-limit", "1s", "-o", "f_#.png"];
    let printed = kinora(folder.path(), &both);
    assert!(printed.contains("samples a pixel at most") && printed.contains("--max-samples"), "{printed}");
    let poster = ["poster", "soft.ron", "--time-limit", "1s", "-o", "p.png"];
    let printed = kinora(folder.path(), &poster);
    assert!(printed.contains("the time limit allows"), "{printed}");
    let refused = run(folder.path(), &["render", "soft.ron", "--max-samples", "9", "-o", "f_#.png"]);
    assert!(stderr(&refused).contains("--max-samples needs a target error"), "{}", stderr(&refused));
}
