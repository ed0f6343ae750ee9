//! What a run forecasts before it begins: how long it takes, how good it becomes, and why there are as many films.

use crate::command::{contents, folder, kinora};
use kinora::base::clock::TimeSource;
use kinora::base::stats::ProgressMeter;
use kinora::film::AovSet;
use kinora::pipeline::plan::{NullSink, Outlook, PilotTime, Plan, run, run_pilot};
use kinora::pipeline::schedule::FrameLoop;
use kinora::sequence::quality::{NoiseTarget, Quality};
use kinora::sequence::{Sequence, parse};
use std::sync::Arc;

/// A ball that moves through soft light by paths, in front of a lamp that fades.
const SOFT: &str = r#"(
    timeline: (frames: 6, fps: 24, keys: Frames),
    output: (size: (96, 64)),
    quality: (integrator: Path(), samples: 64, bounces: 2),
    background: 0.1,
    camera: (position: (0, 3, 7), target: (0, 0.5, 0)),
    lights: { "panel": Rectangle(corner: (-3, 5, -2), u: (2, 0, 0), v: (0, 0, 2), intensity: [(0, 12), (5, 3)]) },
    objects: { "floor": (shape: Plane()),
        "ball": (shape: Sphere(radius: 1), translation: [(0, (-1, 1, 0)), (3, (1, 1, 0))]) },
)"#;

/// A machine on which rays alone take time.
const RAY: f64 = 1e-6;

fn soft() -> Sequence {
    parse("soft.ron", SOFT).unwrap_or_else(|faults| panic!("{faults}"))
}

fn planned(sequence: &Sequence) -> (Plan, Outlook) {
    // How many paths films share is a rougher estimate.
    let plan = Plan::new(sequence, &[0, 1, 2, 3, 4, 5], AovSet::default(), u64::MAX).without_shared_paths();
    let outlook = run_pilot(sequence, &plan, AovSet::default(), PilotTime::PLAN, TimeSource::Rays(RAY));
    (plan, outlook)
}

/// Seconds that the run takes on that machine.
fn took(sequence: &Sequence, plan: &Plan) -> f64 {
    let mut frames = FrameLoop::new(sequence, NullSink, Arc::new(ProgressMeter::default()));
    run(plan, &mut frames, || true).expect("films");
    RAY * frames.stats().counts.rays.total() as f64
}

#[test]
fn sample_counts_take_the_forecast_time() {
    let sequence = soft();
    let (plan, outlook) = planned(&sequence);
    let printed = outlook.forecast(&sequence.quality);
    let took = took(&sequence, &plan);
    assert!((printed.wall.mid / took - 1.0).abs() < 0.03, "{:?} for {took}", printed.wall);
    assert!(printed.wall.low <= took && took <= printed.wall.high);
    let error = printed.error.expect("paths are random");
    assert!(error.low > 0.0 && error.high < 0.5, "{error:?}");
    assert_eq!((printed.films.len(), printed.missed), (4, 0), "the lamp alone changes in the last frames");
}

#[test]
fn target_errors_take_about_the_forecast_time() {
    let mut sequence = soft();
    sequence.quality.noise = Some(NoiseTarget { error: 0.02, most: 1 << 16 });
    let (plan, outlook) = planned(&sequence);
    let printed = outlook.forecast(&sequence.quality).wall;
    let took = took(&sequence, &plan);
    assert!(printed.mid / took < 1.5 && took / printed.mid < 1.5, "{printed:?} for {took}");
}

#[test]
fn missed_target_errors_are_forecast() {
    let mut sequence = soft();
    let target = NoiseTarget { error: 0.001, most: 64 };
    sequence.quality.noise = Some(target);
    let (plan, outlook) = planned(&sequence);
    let printed = outlook.forecast(&sequence.quality);
    assert_eq!(printed.missed, plan.films.len());
    let most = outlook.samples_for(&sequence.quality, &target).expect("samples");
    let enough = Quality { noise: Some(NoiseTarget { most, ..target }), ..sequence.quality };
    assert_eq!(outlook.forecast(&enough).missed, 0);
    let error = outlook.error_within(&sequence.quality, &target, f64::INFINITY).expect("an error");
    let eased = Quality { noise: Some(NoiseTarget { error, ..target }), ..sequence.quality };
    assert!(error > target.error && outlook.forecast(&eased).missed == 0);
}

#[test]
fn plans_report_times_errors_and_reasons_of_films() {
    let folder = folder();
    std::fs::write(folder.path().join("soft.ron"), SOFT).expect("the folder is writable");
    let printed = kinora(folder.path(), &["plan", "soft.ron"]);
    for part in [
        "why     1 for the first frame; 3 because object \"ball\" moves\n",
        "time    tracing takes ",
        " of the brightness, in the worst frame\n",
        "film of frame 3: ",
        "area lights: light \"panel\" (4 films, ",
    ] {
        assert!(printed.contains(part), "`{part}` in {printed}");
    }
    let missed = kinora(folder.path(), &["plan", "soft.ron", "--noise", "0.0001", "--max-samples", "32"]);
    assert!(missed.contains(" because pixels may have 32 samples at most"), "{missed}");
    assert!(missed.contains("--max-samples ") && missed.contains("--noise "), "{missed}");
    let json = kinora(folder.path(), &["plan", "soft.ron", "--json"]);
    for part in [
        r#""why_films":[{"films":1,"why":"first"},{"films":3,"why":"change","changes":["object \"ball\" moves"]}]"#,
        r#""time_s":{"low":"#,
        r#""error":{"low":"#,
        r#""effect_films":{"perspective":{"films":4,"time_s":"#,
    ] {
        assert!(json.contains(part), "`{part}` in {json}");
    }
    let counts = kinora(folder.path(), &["plan", "soft.ron", "--no-pilot"]);
    assert!(
        counts.contains("time    no pilot was traced\n") && !counts.contains("film of frame"),
        "{counts}"
    );
    assert_eq!(contents(folder.path()).len(), 2, "a plan writes nothing");
}
