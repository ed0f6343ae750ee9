//! Tests of the world after a frame, and of errors that end a run.

use super::{FilmCollector, FilmSink, FrameError, FrameLoop, FrameStage, Preview, Stats};
use crate::appearance::light::{Light, LightTracks, Source};
use crate::appearance::material::{Material, MaterialTracks};
use crate::base::time::Rate;
use crate::encode::FilmsError;
use crate::film::Film;
use crate::geometry::prepared_transform::PreparedTransform;
use crate::geometry::shape::Shape;
use crate::scene::{Geometry, Shading};
use crate::sequence::{Sequence, parse};
use crate::testing::Random;
use crate::world::{Current, Hierarchy, Objects, Transform};
use std::sync::Arc;
use std::time::Duration;

/// A sink that records frame numbers and rejects one of them.
#[derive(Default)]
struct Numbers {
    taken: Vec<u32>,
    refuse: Option<u32>,
}

impl FilmSink for Numbers {
    fn push(&mut self, frame: u32, _film: Film) -> Result<(), crate::encode::EncodeError> {
        if self.refuse == Some(frame) {
            return Err(FilmsError::Missing { expected: 1, got: 0 }.into());
        }
        self.taken.push(frame);
        Ok(())
    }
}

fn sequence(text: &str) -> Sequence {
    parse("test.ron", text).unwrap_or_else(|faults| panic!("{faults}"))
}

fn frame_loop(sequence: &Sequence, refuse: Option<u32>) -> FrameLoop<Numbers> {
    FrameLoop::new(sequence, Numbers { refuse, ..Numbers::default() }, Arc::default())
}

/// Keyed and constant entries are in different archetypes, so queries return them in another order than the file.
#[test]
fn packed_data_keeps_the_order_of_the_file() {
    let text = r#"(
        timeline: (frames: 3, keys: Frames), output: (size: (4, 3)),
        lights: {
            "a": Point(position: (1, 0, 0), on: [(0, true), (1, false)]), "b": Point(position: (2, 0, 0)),
            "c": Point(position: (3, 0, 0), intensity: [(0, 1), (2, 0)]), "d": Point(position: (4, 0, 0)),
        },
        objects: {
            "child": (shape: Sphere(radius: 1), parent: "parent"), "hidden": (shape: Sphere(radius: 2), visible: false),
            "group": (shape: Group), "floor": (shape: Plane()),
            "now and then": (shape: Sphere(radius: 4), visible: [(0, true), (1, false), (2, true)]),
            "parent": (shape: Sphere(radius: 5)),
        },
    )"#;
    let mut frames = frame_loop(&sequence(text), None);
    for (frame, expected) in
        [(0, vec![1.0, 0.0, 4.0, 5.0]), (1, vec![1.0, 0.0, 5.0]), (2, vec![1.0, 0.0, 4.0, 5.0])]
    {
        frames.frame(frame).expect("a frame");
        let lights = &frames.world.resource::<Current<Shading>>().0.lights;
        let x = |source: &Source| if let Source::Point { position, .. } = source { position.x } else { 0.0 };
        assert_eq!(lights.iter().map(|light| x(&light.source)).collect::<Vec<_>>(), [1.0, 2.0, 3.0, 4.0]);
        assert_eq!(lights.iter().map(|light| light.layer.0).collect::<Vec<_>>(), [1, 0, 2, 0]);
        let primitives = frames.world.resource::<Current<Geometry>>().0.primitives.iter();
        let primitives = primitives.filter(|primitive| !primitive.is_empty());
        let radius = |shape: &Shape| if let Shape::Sphere(sphere) = shape { sphere.radius } else { 0.0 };
        assert_eq!(primitives.map(|p| radius(&p.shape)).collect::<Vec<_>>(), expected, "frame {frame}");
    }
}

#[test]
fn a_frame_without_a_camera_says_so_and_makes_no_film() {
    // The camera passes through its target between two frames, which is a frame at twice the rate.
    let text = r#"(timeline: (frames: 4, fps: 24, keys: Frames), output: (size: (4, 3)),
        camera: (position: [(0, (0, 0, 1)), (1, (0, 0, -1))]))"#;
    let mut sequence = sequence(text);
    let twice = Rate::new(48, 1).expect("above zero");
    sequence.timeline = sequence.timeline.resampled(twice).expect("a timeline");
    let mut frames = frame_loop(&sequence, None);
    frames.frame(0).expect("a frame");
    assert!(matches!(frames.frame(1), Err(FrameError::Camera { frame: 1, .. })));
    assert_eq!(frames.stats().counts.rays.camera, 4 * 3 * 4, "the frame without a camera was traced");
    assert_eq!(frames.into_sink().expect("the sink").taken, [0]);
}

#[test]
fn an_error_of_the_sink_comes_back() {
    let text = "(timeline: (frames: 4), output: (size: (4, 3)))";
    let mut frames = frame_loop(&sequence(text), Some(2));
    let results: Vec<bool> = (0..3).map(|frame| frames.frame(frame).is_ok()).collect();
    assert_eq!(results, [true, true, false]);
    assert_eq!(frames.into_sink().expect("the sink").taken, [0, 1]);
}

#[test]
fn films_arrive_in_the_order_asked_for_and_time_is_booked() {
    let text = r#"(timeline: (frames: 9), output: (size: (64, 48)), objects: { "b": (shape: Sphere()) })"#;
    let mut frames = frame_loop(&sequence(text), None);
    for frame in [5, 0, 8, 0] {
        frames.frame(frame).expect("a frame");
    }
    let spent = frames.stats().stages;
    assert!(spent[FrameStage::Trace as usize] > Duration::ZERO, "{spent:?}");
    assert_eq!(frames.into_sink().expect("the sink").taken, [5, 0, 8, 0]);
}

/// Objects without keys, below objects without keys, are placed once; the others follow their parents.
#[test]
fn only_objects_that_may_move_are_animated() {
    let text = r#"(
        timeline: (frames: 3, keys: Frames), output: (size: (4, 3)),
        objects: {
            "finger": (shape: Sphere(), parent: "hand", translation: (1, 0, 0)),
            "hand": (shape: Group, parent: "arm", translation: [(0, (0, 1, 0)), (2, (0, 3, 0))]),
            "arm": (shape: Group, translation: (0, 0, 5)),
            "ring": (shape: Sphere(), parent: "arm", translation: (7, 0, 0)),
            "lamp": (shape: Sphere(), visible: [(0, true), (1, false)]),
        },
    )"#;
    let mut frames = frame_loop(&sequence(text), None);
    frames.frame(1).expect("a frame");
    let world = &frames.world;
    let objects = &world.resource::<Objects>().0;
    let moves = |index: &usize| world.get::<PreparedTransform>(objects[*index]).is_some();
    assert_eq!((0..5).filter(moves).collect::<Vec<_>>(), [0, 1, 4]);
    assert_eq!(world.resource::<Hierarchy>().0, [objects[1], objects[0]]);
    let place = |index: usize| world.get::<Transform>(objects[index]).map(|at| at.0.translation.to_array());
    assert_eq!(place(0), Some([1.0, 2.0, 5.0]));
    assert_eq!(place(3), Some([7.0, 0.0, 5.0]));
}

/// What moves, hides, flattens and turns in all ways, with and without textures.
const RESTLESS: &str = r#"
        "a": (shape: Sphere(), translation: [(0, (0, 0, 0)), (5, (3, 0, 0)), (9, (0, 0, 0))]),
        "b": (shape: Box(min: (0, 0, 0), max: (1, 1, 1)), visible: [(0, true), (3, false), (6, true)], material: "checks"),
        "c": (shape: Torus(), scale: [(0, 1), (4, 0, Step), (6, 0, Step), (7, 1)], material: "shiny"),
        "d": (shape: Sphere(), rotation: AxisAngle(axis: (0, 1, 0), angle: [(0, 0), (9, 90)]), material: "checks"),
        "e": (shape: Group, visible: [(0, false), (2, true), (8, false)]),
        "f": (shape: Sphere(center: (0, 3, 0)), parent: "e"), "g": (shape: Plane(), translation: [(0, (0, 0, 0)), (9, (0, -1, 0))]),
        "h": (shape: Sphere(center: (5, 3, 0)), translation: [(0, (0, 0, 0), Step), (5, (300, 0, 0), Step), (6, (0, 0, 0))]),
        "i": (shape: Cylinder(), material: "late", visible: [(0, false), (7, true)]),
"#;

fn restless(more: &str) -> Sequence {
    let text = format!(
        r#"(timeline: (frames: 10, keys: Frames), output: (size: (12, 9)), quality: (antialias: 1),
        camera: (position: (1, 3, 12), shutter: [(0, 0, Step), (8, 1)]),
        lights: {{ "p": Point(position: (3, 9, 5), intensity: [(0, 1), (9, 0)]),
            "s": Sphere(center: [(0, (-3, 6, 0)), (9, (-3, 7, 0))], radius: 0.5, on: [(0, true), (4, false)]) }},
        materials: {{ "late": (color: (1, 0, 0)), "checks": (color: Checker(a: 0.2, b: [(0, 0.4), (3, 0.9)])),
            "shiny": (mirror: 0.5) }},
        objects: {{ {more} {RESTLESS} }})"#
    );
    sequence(&text)
}

/// The films and states of frames do not depend on the frames before.
#[test]
fn frames_have_no_memory() {
    let sequence = restless("");
    let state = |preview: &mut Preview, frame| preview.state(frame);
    let (mut random, mut preview) = (Random(4), Preview::new(&sequence));
    let mut frames = FrameLoop::new(&sequence, FilmCollector::default(), Arc::default());
    let mut order = Vec::new();
    for _ in 0..25 {
        let frame = (10.0 * random.unit()) as u32;
        assert_eq!(state(&mut preview, frame), state(&mut Preview::new(&sequence), frame), "{frame}");
        frames.frame(frame).expect("a frame");
        order.push(frame);
    }
    let stats = frames.stats();
    assert!(stats.bvh_refits > 20, "{stats:?}");
    let films = frames.into_sink().expect("the sink").0;
    for (frame, film) in order.into_iter().zip(films) {
        let mut alone = FrameLoop::new(&sequence, FilmCollector::default(), Arc::default());
        alone.frame(frame).expect("a frame");
        assert!(alone.into_sink().expect("the sink").0[0] == film, "{frame}");
    }
}

/// Materials and lights without keys are evaluated once. All others are animated, whatever part of them has keys.
#[test]
fn only_keyed_materials_and_lights_are_animated() {
    let sequence = sequence(
        r#"(timeline: (frames: 3, keys: Frames), output: (size: (4, 3)),
        lights: { "still": Point(position: (1, 0, 0), intensity: [(0, 1), (2, 2)]),
            "moving": Spot(position: (1, 0, 0), angle: [(0, 10), (2, 20)]) },
        materials: { "still": (color: Checker(a: 0.1, b: 0.2)), "lobe": (mirror: [(0, 0), (2, 1)]),
            "part": (color: Checker(a: 0.1, b: [(0, 0), (2, 1)])), "place": (color: Checker(a: 0.1, b: 0.2, scale: [(0, 1), (2, 2)])),
            "number": (specular: 0.5, shininess: [(0, 5), (2, 9)]) },
        objects: { "a": (shape: Sphere(), material: "still"), "b": (shape: Sphere(), material: (ambient: [(0, 0), (2, 1)])) })"#,
    );
    let mut frames = frame_loop(&sequence, None);
    frames.frame(2).expect("a frame");
    let world = &mut frames.world;
    let materials = world.query::<&Material>().iter(world).count();
    let keyed = world.query::<&MaterialTracks>().iter(world).count();
    assert_eq!((materials, keyed), (sequence.materials.len(), sequence.materials.len() - 1));
    let lights = world.query::<&Light>().iter(world).count();
    let moving = world.query::<&LightTracks>().iter(world).count();
    assert_eq!((lights, moving), (2, 1));
    let now = sequence.timeline.clock(2).time;
    let shading = &world.resource::<Current<Shading>>().0;
    for (material, tracks) in shading.materials.iter().zip(&sequence.materials) {
        assert_eq!(*material, tracks.value.at(now, material.emission_layer), "{}", tracks.name);
    }
}

/// An object has no effect on the digests of frames in which it is hidden.
#[test]
fn hidden_objects_leave_digests_alone() {
    let hidden = r#""z": (shape: Sphere(), visible: [(0, true), (2, false)], material: "late"),"#;
    let (mut with, mut without) = (Preview::new(&restless(hidden)), Preview::new(&restless("")));
    for frame in [0, 5, 1, 2, 9, 0, 3] {
        let (a, b) = (with.state(frame), without.state(frame));
        assert_eq!(a.scene_hash == b.scene_hash, frame >= 2, "{frame}");
        assert_eq!(a.image_hash == b.image_hash, frame >= 2, "{frame}");
    }
}

/// Textures of emission that is dark have no effect on the digest of the image.
#[test]
fn dark_textures_leave_the_image_alone() {
    let with = |rotation: &str| {
        sequence(&format!(
            r#"(timeline: (frames: 6, keys: Frames), output: (size: (4, 3)), ambient: 0.1,
            materials: {{ "lamp": (emission_color: Checker(scale: 0.3), emission: [(4, 0), (5, 1)]) }},
            objects: {{ "a": (shape: Sphere(), material: "lamp", rotation: AxisAngle(axis: (0, 1, 0), angle: {rotation})) }})"#
        ))
    };
    let (turning, still) = (with("[(0, 0), (5, 450)]"), with("0"));
    let (mut turning, mut still) = (Preview::new(&turning), Preview::new(&still));
    let states: Vec<_> = (0..6).map(|frame| (turning.state(frame), still.state(frame))).collect();
    for (frame, (turning, still)) in states.iter().enumerate() {
        assert_eq!(turning.image_hash == still.image_hash, frame <= 4, "{frame}");
        assert_eq!(turning.image_hash == states[0].0.image_hash, frame <= 4, "{frame}");
    }
    // Quarter turns are exact: the sphere itself stays the same. Frames that turn differently cannot share a film, which has all layers.
    assert_ne!(states[0].0.scene_hash, states[1].0.scene_hash);
}

/// Equal geometry in another slot changes the tree.
#[test]
fn updates_of_the_tree_are_forecast() {
    let sequence = sequence(
        r#"(timeline: (frames: 6, keys: Frames), output: (size: (4, 3)), camera: (position: [(0, (0, 0, 5)), (5, (1, 0, 5))]),
        objects: { "a": (shape: Sphere(), visible: [(0, true), (1, false), (2, true), (3, false), (4, true), (5, false)]),
            "b": (shape: Sphere(), visible: [(0, false), (1, true), (2, false), (3, true), (4, false), (5, true)]) })"#,
    );
    let mut frames = frame_loop(&sequence, None);
    (0..6).for_each(|frame| frames.frame(frame).expect("a frame"));
    let stats = frames.world.resource::<Stats>();
    let mut preview = Preview::new(&sequence);
    let states: Vec<_> = (0..6).map(|frame| preview.state(frame).geometry.0).collect();
    let changes = states.windows(2).filter(|pair| pair[0] != pair[1]).count() as u64;
    assert_eq!(stats.bvh_builds + stats.bvh_refits, 1 + changes);
}
