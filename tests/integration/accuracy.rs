//! The price of accuracy: what is measured of a sequence, and what the report says of it.

use kinora::accuracy::report::{Origin, page};
use kinora::accuracy::{Measured, MeasurementRequest, SceneChange, SettingAxis, measure};
use kinora::sequence::parse;
use std::time::Duration;

/// A glass ball below a small lamp; the second light is keyed, so that all frames are made of one picture.
const GLASS: &str = r#"(
    timeline: (frames: 10, fps: 10),
    output: (size: (48, 27)),
    quality: (integrator: Path(), bounces: 4, samples: 8),
    camera: (position: (0, 1.5, 5), target: (0, 0.7, 0)),
    lights: { "lamp": Sphere(center: (0.5, 2.6, 0), radius: 0.1, intensity: 40),
        "window": Rectangle(corner: (-2.9, 1, 0), u: (0, 1, 0), v: (0, 0, 1), intensity: [(0, 1), (1, 3)]) },
    default_material: (ambient: 0),
    materials: { "wall": Lambertian(color: 0.8), "glass": Dielectric() },
    objects: {
        "floor": (shape: Rectangle(corner: (-3, 0, 3), u: (6, 0, 0), v: (0, 0, -6)), material: "wall"),
        "back": (shape: Rectangle(corner: (-3, 0, -2), u: (6, 0, 0), v: (0, 3, 0)), material: "wall"),
        "ball": (shape: Sphere(center: (0, 0.6, 0), radius: 0.5), material: "glass"),
    },
)"#;

/// The same without anything that is random.
fn still() -> String {
    GLASS
        .replace("integrator: Path(), bounces: 4, samples: 8", "antialias: 2")
        .replace(
            "Sphere(center: (0.5, 2.6, 0), radius: 0.1, intensity: 40)",
            "Point(position: (0.5, 2.6, 0))",
        )
        .replace(
            "Rectangle(corner: (-2.9, 1, 0), u: (0, 1, 0), v: (0, 0, 1), ",
            "Point(position: (-2.9, 1.5, 0.5), ",
        )
}

fn measured(text: &str) -> Measured {
    let sequence = parse("glass.ron", text).expect("a sequence");
    let request = MeasurementRequest {
        frames: vec![5],
        time: Duration::from_secs(3),
        quick: true,
        size: Some((48, 27)),
        most_samples: None,
        threads: None,
    };
    measure(&sequence, &request, &mut |_| {}).expect("a measurement")
}

fn report(measured: &Measured) -> String {
    let text = |text: &str| text.to_owned();
    let origin = Origin { command: text("kinora"), machine: text("a machine"), file: text("glass.ron") };
    page(measured, &origin).expect("a page")
}

#[test]
fn reports_price_half_the_time_and_half_the_error() {
    let measured = measured(GLASS);
    let lines = measured.lines();
    assert!(lines.len() <= 12, "{lines:#?}");
    for begun in [
        "Error of this setting (8 samples",
        "Cost of the whole sequence: about",
        "Half the time: --",
        "Half the error: --",
    ] {
        assert!(lines.iter().any(|line| line.starts_with(begun)), "{begun}: {lines:#?}");
    }
    assert!(measured.total.films == 1 && measured.total.frames == 10, "{:?}", measured.total);
    assert!(measured.own().error() > 0.0 && measured.total.wall > 0.0);
    // The curve has a point at every factor of two, and the reference enough samples to judge all of them.
    let mut samples: Vec<f64> = measured.on(SettingAxis::Samples).iter().map(|point| point.samples).collect();
    samples.sort_by(f64::total_cmp);
    assert_eq!(samples, [1.0, 2.0, 4.0, 8.0, 16.0]);
    let curve = measured.points.iter().filter(|point| !point.setting.axis.has_baseline());
    let most = curve.map(|point| point.samples).fold(0.0, f64::max);
    assert!(f64::from(measured.reference) >= 16.0 * most, "{} {most}", measured.reference);
}

#[test]
fn a_report_has_the_price_list_of_its_scene() {
    let measured = measured(GLASS);
    let off: Vec<SceneChange> = measured.parts().iter().map(|point| point.setting.change).collect();
    let wanted = [SceneChange::LightOff(0), SceneChange::LightOff(1), SceneChange::ObjectHidden(2)];
    assert!(wanted.iter().all(|change| off.contains(change)), "{off:?}");
    let floor =
        measured.parts().into_iter().find(|point| point.setting.change == SceneChange::ObjectHidden(0));
    assert!(floor.expect("the floor").bias.is_certain());
    // Roulette changes noise, but not what is shown: the text mentions nothing that does not exist.
    let own = measured.on(SettingAxis::Bounces).into_iter().find(|point| point.setting.quality.bounces == 4);
    assert_eq!(measured.bias_text(own.expect("the file's own").bias), "none");
    let robustness = measured.robustness.as_ref().expect("a camera");
    assert!(robustness.hits.last().is_some_and(|ours| ours.wrong == 0 && ours.rays > 1000), "{robustness:?}");
    assert!(
        measured.chains.iter().any(|chain| chain.path.contains("glass (refracted)")),
        "{:?}",
        measured.chains
    );
    // The window brightens, so the noise of its light changes a little, and the squared errors of frames with numbers of
    // their own add up.
    let temporal = measured.temporal.as_ref().expect("several frames");
    let varied = temporal.varied.expect("random samples").mean;
    assert_eq!(temporal.frames, [5, 6]);
    assert!(temporal.change > 0.0 && temporal.same.mean > 0.0, "{temporal:?}");
    assert!(temporal.same.mean < 0.1 * varied, "{temporal:?}");
    assert!((0.6..1.6).contains(&(temporal.picture.mean / measured.own().squared.mean)), "{temporal:?}");
    assert!((temporal.brightness / measured.brightness - 1.0).abs() < 0.2, "{temporal:?}");
    let page = report(&measured);
    for wanted in [
        "From frame 5 to 6",
        "What robustness costs in this scene",
        "without light &quot;lamp&quot;",
        "data:image/png;base64,",
        "clamp: ",
    ] {
        assert!(page.contains(wanted), "{wanted}");
    }
    assert!(!page.contains("NaN") && !page.contains("inf "), "{page}");
}

#[test]
fn a_picture_without_chance_has_grids_to_choose_from() {
    let measured = measured(&still());
    let lines = measured.lines();
    assert!(!measured.random && lines.len() <= 12, "{lines:#?}");
    assert!(lines.iter().any(|line| line.starts_with("Half the error: --antialias ")), "{lines:#?}");
    // A grid of 1 x 1 takes about a quarter of the time, and says so rather than passing for half.
    assert!(lines.iter().any(|line| line.starts_with("Half the time: ")), "{lines:#?}");
    assert!(f64::from(measured.reference) >= 16.0 * 16.0, "{}", measured.reference);
    assert!(report(&measured).contains("Price list of this scene"));
    // Edges are equally wrong in both frames, but what they separate has another brightness.
    let temporal = measured.temporal.expect("several frames");
    assert!(temporal.varied.is_none() && temporal.same.mean > 0.0, "{temporal:?}");
    assert!(temporal.same.mean < 0.1 * temporal.change, "{temporal:?}");
}

#[test]
fn changes_are_measured_where_both_frames_are_alike() {
    let of = |text: &str, frames: Vec<u32>| {
        let sequence = parse("a.ron", text).expect("a sequence");
        let request = MeasurementRequest {
            frames,
            time: Duration::from_secs(1),
            quick: true,
            size: Some((16, 9)),
            most_samples: Some(4),
            threads: None,
        };
        measure(&sequence, &request, &mut |_| {}).expect("a measurement").temporal
    };
    let scene = |timeline: &str, on: &str| {
        format!(
            "(timeline: {timeline}, output: (size: (16, 9)), quality: (samples: 4),
            camera: (position: (0, 4, 7), target: (0, 0.4, 0)), objects: {{ \"floor\": (shape: Plane()) }},
            lights: {{ \"sun\": Directional(direction: (0, -1, 0)),
                \"panel\": Rectangle(corner: (-4, 5, -2), u: (2, 0, 0), v: (0, 0, 2), intensity: 12, on: {on}) }})"
        )
    };
    let two = "(frames: 2, keys: Frames)";
    let switched = scene(two, "[(0, false), (1, true)]");
    assert_eq!([of(&switched, vec![0]), of(&switched, vec![1])], [None, None], "one of two frames is random");
    assert_eq!(of(&scene("(frames: 1)", "true"), vec![0]), None, "there is one frame");
    for frames in [vec![0], vec![1], vec![0, 1]] {
        let still = of(&scene(two, "true"), frames).expect("two frames");
        assert_eq!((still.frames, still.same.mean, still.change), ([0, 1], 0.0, 0.0));
        assert!(still.varied.is_some_and(|varied| varied.mean > 0.0));
    }
}
