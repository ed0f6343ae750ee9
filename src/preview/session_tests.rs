use super::session::{Session, SessionOptions, Step};
use crate::base::cancel::Stop;
use crate::base::stats::ProgressMeter;
use crate::film::Film;
use crate::pipeline::schedule::{FilmCollector, FrameLoop};
use std::fs;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::Ordering::Relaxed;
use std::time::Duration;
use tempfile::TempDir;

const OBJECTS: &str = "objects: {
    \"floor\": (shape: Plane(), material: (color: 0.7, mirror: 0.3)),
    \"ball\": (shape: Sphere(center: (0, 1, 0)), material: (color: 0.4, specular: 0.5)),
}";

/// Two lights and two objects, seen by a camera with these fields, with these settings.
fn text(camera: &str, quality: &str) -> String {
    format!(
        "(timeline: (frames: 4, fps: 4, keys: Frames), output: (size: (67, 35)), quality: ({quality}),
        camera: ({camera}),
        lights: {{ \"a\": Point(position: (3, 5, 4)), \"b\": Sphere(center: (-3, 5, 4), radius: 0.5) }},
        {OBJECTS})"
    )
}

fn session(text: &str) -> (TempDir, Session) {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a.ron");
    fs::write(&file, text).expect("a disk");
    let mut session = Session::new(SessionOptions { file, allow_outside: false, edit: false, size: None });
    session.reload();
    assert_eq!(session.diagnostics(), None);
    (folder, session)
}

fn finish(session: &mut Session) {
    while session.step(&Stop::default()) == Step::Refined {}
}

/// The film as it is.
fn film(session: &mut Session) -> Film {
    let (state, _) = session.current().expect("a frame");
    let weights = session.weights(&state);
    session.film.as_ref().and_then(|(_, film)| film.film(&weights)).expect("a film")
}

/// The film that the frame loop gives the session's scene.
fn rendered(session: &mut Session) -> Film {
    let frame = session.frame;
    let sequence = &session.scene().expect("a scene").sequence;
    let mut frames = FrameLoop::new(sequence, FilmCollector::default(), Arc::new(ProgressMeter::default()));
    frames.frame(frame).expect("a film");
    frames.into_sink().expect("films").0.remove(0)
}

#[test]
fn finished_films_are_those_of_the_frame_loop() {
    for (camera, quality) in [
        ("position: [(0, (0, 2, 6)), (3, (1, 2, 6))], target: (0, 1, 0)", "antialias: 3"),
        ("position: (0, 2, 6), target: (0, 1, 0), aperture: 0.2", "samples: 11"),
        ("position: (0, 2, 6), target: (0, 1, 0)", "integrator: Path(), samples: 6, bounces: 2"),
    ] {
        let (_folder, mut session) = session(&text(camera, quality));
        for frame in [0, 2] {
            session.go_to(frame);
            finish(&mut session);
            assert_eq!(film(&mut session).data, rendered(&mut session).data, "{camera} {quality}");
        }
    }
}

/// Stopped again and again, at any place, a film becomes the same.
#[test]
fn stopped_films_continue() {
    let text = text("position: (0, 2, 6), target: (0, 1, 0)", "integrator: Path(), samples: 24, bounces: 3");
    let (_folder, mut whole) = session(&text);
    finish(&mut whole);
    let (_folder, mut session) = session(&text);
    let (stop, is_done) = (Stop::default(), AtomicBool::new(false));
    let mut stops = 0;
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !is_done.load(Relaxed) {
                std::thread::sleep(Duration::from_micros(700));
                stop.flag().store(1, Relaxed);
            }
        });
        loop {
            match session.step(&stop) {
                Step::Refined => {}
                Step::Stopped => {
                    stops += 1;
                    stop.flag().store(0, Relaxed);
                }
                Step::Done => break,
            }
        }
        is_done.store(true, Relaxed);
    });
    assert!(stops > 0);
    assert_eq!(film(&mut session).data, film(&mut whole).data);
}

#[test]
fn a_stop_before_a_step_traces_nothing() {
    let (_folder, mut session) = session(&text("position: (0, 2, 6)", ""));
    let stop = Stop::default();
    stop.flag().store(1, Relaxed);
    assert_eq!(session.step(&stop), Step::Stopped);
    assert_eq!(session.counts.rays.total(), 0);
    assert!(session.picture().is_none());
}

#[test]
fn what_leaves_the_scene_unchanged_traces_nothing() {
    let text = text("position: (0, 2, 6), target: (0, 1, 0)", "samples: 4");
    let (folder, mut session) = session(&text);
    finish(&mut session);
    let rays = session.counts.rays.total();
    for changed in [
        text.replace("(timeline", "// A comment.\n(timeline"),
        text.replace("(3, 5, 4)", "(3, 5, 4), intensity: 0.3"),
        text.replace("(3, 5, 4)", "(3, 5, 4), color: \"#f80\""),
        text.replace("(3, 5, 4)", "(3, 5, 4), on: false"),
        text.replace("quality", "annotations: { \"a\": Label(at: (0, 1, 0), text: \"ball\") }, quality"),
        text.replace("size: (67, 35)", "size: (67, 35), exposure: 1, tonemap: Filmic"),
    ] {
        fs::write(folder.path().join("a.ron"), &changed).expect("a disk");
        session.reload();
        assert_eq!(session.diagnostics(), None);
        finish(&mut session);
        assert!(session.picture().is_some());
        assert_eq!(session.counts.rays.total(), rays, "{changed}");
    }
    // A place of a light is more than a weight.
    fs::write(folder.path().join("a.ron"), text.replace("(3, 5, 4)", "(3, 5, 5)")).expect("a disk");
    session.reload();
    finish(&mut session);
    assert!(session.counts.rays.total() > rays);
}

#[test]
fn random_samples_have_an_error_that_falls() {
    let (_folder, mut session) = session(&text("position: (0, 2, 6), target: (0, 1, 0)", "samples: 64"));
    let mut errors = Vec::new();
    while session.step(&Stop::default()) == Step::Refined {
        let state = session.state();
        errors.extend(state["error"].as_f64().map(|error| (state["samples"].as_u64(), error)));
    }
    let at = |samples: u64| errors.iter().find(|(count, _)| *count == Some(samples)).map(|(_, error)| *error);
    let (few, many) = (at(4).expect("an error"), at(64).expect("an error"));
    assert!(many > 0.0 && few / many > 2.0, "{few} {many}");
}

/// Frames with motion blur have all their moments, also after stops.
#[test]
fn moments_are_whole_after_a_stop() {
    let camera = "position: [(0, (0, 2, 6)), (3, (1, 2, 6))], target: (0, 1, 0), shutter: 0.5";
    let (_folder, mut session) = session(&text(camera, "samples: 4, shutter_steps: 4"));
    let stop = Stop::default();
    for _ in 0..3 {
        stop.flag().store(1, Relaxed);
        assert_eq!(session.step(&stop), Step::Stopped);
        stop.flag().store(0, Relaxed);
        assert_eq!(session.step(&stop), Step::Refined);
    }
    finish(&mut session);
    let (ours, expected) = (film(&mut session), rendered(&mut session));
    for (ours, expected) in ours.data.iter().zip(expected.data.iter()) {
        // The same samples in another order of sums.
        let scale = expected.max_element().max(1.0);
        assert!((*ours - *expected).abs().max_element() <= 1e-6 * scale, "{ours} {expected}");
    }
}
