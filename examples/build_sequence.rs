// Builds a sequence in Rust: a row of balls that jump one after the other. A text gives what is easier to write as text.

use kinora::{
    Animated, DVec3, Ease, Key, Named, Object, Output, Plane, Rate, Repeat, Request, Shape, Sphere, Time,
    Timeline, Track, parse, render,
};
use std::error::Error;

const SCENE: &str = r##"(
    background: "#9cc0e0",
    camera: (position: (0, 3, 9), target: (0, 1, 0)),
    lights: { "sun": Directional(direction: (-1, -3, -2)) },
    materials: { "floor": (color: 0.8), "clay": (color: "#c8503a") },
)"##;

/// Up and down again within a second, later by `delay` tenths.
fn jumps(x: f64, delay: i128) -> Result<Animated<DVec3>, Box<dyn Error>> {
    let key = |tenth: i128, y: f64| {
        // Times are exact fractions, so that loops close.
        Key { time: Time::new(delay + tenth, 10), value: DVec3::new(x, y, 0.0), ease: Ease::Smooth }
    };
    Ok(Animated::Keyed(Track::new(vec![key(0, 0.5), key(5, 2.0), key(10, 0.5)], Repeat::Loop, false)?))
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut sequence = parse("row.ron", SCENE)?;
    sequence.timeline = Timeline::of_frames(48, Rate::default());
    sequence.output.size = (64, 36);

    // Materials are numbered in the order of the file.
    let plane = Shape::Plane(Plane { point: DVec3::ZERO, normal: DVec3::Y });
    sequence.objects.push(Named { name: "floor".to_owned(), value: Object::new(plane, 0) });
    for i in -2..=2 {
        let ball = Shape::Sphere(Sphere { center: DVec3::ZERO, radius: 0.5 });
        let mut ball = Object::new(ball, 1);
        ball.transform.translation = jumps(1.5 * f64::from(i), i.into())?;
        sequence.objects.push(Named { name: format!("ball {i}"), value: ball });
    }

    let folder = tempfile::tempdir()?;
    let request = Request::new(&sequence, vec![Output::parse(folder.path().join("row.gif"))?]);
    let summary = render(&sequence, &request, &Default::default())?;
    // All balls jump once a second, so the second 24 frames are the first ones again.
    assert_eq!((summary.frames, summary.reused), (48, 24));
    Ok(())
}
