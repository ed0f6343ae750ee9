//! Objects that only some rays see: `casts_shadow` and `seen_by`.

use crate::support::{radiance_at_target, sequence, shoot, shoot_film};
use kinora::base::color::Rgb;
use kinora::base::stats::ProgressMeter;
use kinora::encode::EncodeError;
use kinora::film::{AovSet, Film};
use kinora::pipeline::plan::{self, Plan};
use kinora::pipeline::schedule::{FilmSink, FrameLoop, Stats};
use kinora::sequence::Sequence;
use std::sync::Arc;

/// A floor that a ball above the line of sight shades, seen from the side.
fn floor(fields: &str) -> Rgb {
    radiance_at_target(&format!(
        "camera: (position: (0, 1, 9), target: (0, 0, 0)), background: 0, ambient: 0,
        lights: {{ \"lamp\": Point(position: (0, 9, 0)) }}, materials: {{ \"matt\": (color: 1, diffuse: 1, ambient: 0) }},
        objects: {{ \"floor\": (shape: Plane(), material: \"matt\"),
            \"ball\": (shape: Sphere(center: (0, 4, 0)), material: \"matt\"{fields}) }}"
    ))
}

#[test]
fn objects_without_shadows_leave_the_light() {
    let bare = radiance_at_target(
        "camera: (position: (0, 1, 9), target: (0, 0, 0)), background: 0, ambient: 0,
        lights: { \"lamp\": Point(position: (0, 9, 0)) },
        objects: { \"floor\": (shape: Plane(), material: (color: 1, diffuse: 1, ambient: 0)) }",
    );
    assert!(bare.x > 0.9);
    assert_eq!(floor(""), Rgb::ZERO);
    assert_eq!(floor(", casts_shadow: false"), bare);
    assert_eq!(floor(", casts_shadow: true, seen_by: (camera: false, reflections: false)"), Rgb::ZERO);
}

/// The light of lights without shadows reaches a floor below a ball as if there were no ball, with both integrators, and
/// alone or among more lights than a surface samples at once.
#[test]
fn lights_without_shadows_pass_objects() {
    let lights = |count: usize, fields: &str| -> String {
        let kinds = [
            "Point(position: (0, 9, 0)",
            "Spot(position: (0, 9, 0), angle: 90",
            "Directional(direction: (0, -1, 0)",
        ];
        (0..count)
            .map(|i| format!("\"{i}\": {}, intensity: {}{fields}),", kinds[i % 3], 1.0 / count as f64))
            .collect()
    };
    let film = |quality: &str, lights: &str, ball: &str| {
        shoot_film(&format!(
            "(output: (size: (8, 8)), quality: ({quality}), background: 0, ambient: 0,
            camera: (position: (0, 1, 9), target: (0, 0, 0), projection: Perspective(fov: 1)), lights: {{ {lights} }},
            materials: {{ \"matt\": (color: 1, diffuse: 1, ambient: 0) }},
            objects: {{ \"floor\": (shape: Plane(), material: \"matt\"), {ball} }})"
        ))
        .radiance()
        .collect::<Vec<_>>()
    };
    let ball = "\"ball\": (shape: Sphere(center: (0, 4, 0), radius: 3), material: \"matt\", seen_by: (reflections: false))";
    for quality in ["antialias: 2", "integrator: Path, samples: 16, bounces: 1"] {
        for count in [1, 2, 3, 24] {
            let unblocked = film(quality, &lights(count, ", shadows: false"), "");
            assert!(unblocked.iter().all(|radiance| radiance.x > 0.0));
            assert_eq!(film(quality, &lights(count, ""), ""), unblocked, "{quality}, {count}");
            assert_eq!(
                film(quality, &lights(count, ", shadows: false"), ball),
                unblocked,
                "{quality}, {count}"
            );
            assert!(
                film(quality, &lights(count, ""), ball).iter().all(|dark| *dark == Rgb::ZERO),
                "{quality}, {count}"
            );
        }
    }
    // Of two lights, one passes.
    let (key, fill) =
        ("\"key\": Point(position: (0, 9, 0)),", "\"fill\": Point(position: (0, 9, 1), shadows: false),");
    assert_eq!(film("", &format!("{key}{fill}"), ball), film("", fill, ""));
}

/// A red wall in front of a mirror that faces the camera; the camera looks past its edge, or at it.
fn room(target: &str, fields: &str) -> Rgb {
    radiance_at_target(&format!(
        "camera: (position: (0, 0, 10), target: {target}), background: (0, 0, 1), ambient: 0,
        objects: {{ \"mirror\": (shape: Rectangle(corner: (-9, -9, 0), u: (18, 0, 0), v: (0, 18, 0)),
                material: (diffuse: 0, ambient: 0, mirror: 1)),
            \"wall\": (shape: Rectangle(corner: (2, -9, 8), u: (7, 0, 0), v: (0, 18, 0)),
                material: (diffuse: 0, ambient: 0, emission: 1, emission_color: (1, 0, 0)){fields}) }}"
    ))
}

#[test]
fn the_camera_and_reflections_see_different_objects() {
    // The line of sight to (1.5, 0, 0) meets the mirror; its reflection meets the wall at x = 2.7.
    let (direct, mirrored) = ("(4, 0, 8)", "(1.5, 0, 0)");
    let red = Rgb::X;
    assert_eq!([room(direct, ""), room(mirrored, "")], [red, red]);
    let unseen = ", seen_by: (camera: false)";
    // Past the wall, the camera sees it in the mirror or the sky.
    assert_eq!(room(mirrored, unseen), red);
    assert_ne!(room("(2.2, 0, 8)", unseen), red);
    let unmirrored = ", seen_by: (reflections: false)";
    assert_eq!([room(direct, unmirrored), room(mirrored, unmirrored)], [red, Rgb::Z]);
}

#[test]
fn glass_that_the_camera_passes_straight_keeps_its_kind() {
    // A veil that lets half of the light pass: what is behind it is still seen by the camera, not by a reflection.
    let of = |fields: &str| {
        radiance_at_target(&format!(
            "camera: (position: (0, 0, 10), target: (0, 0, 0)), background: 0, ambient: 0,
            objects: {{ \"veil\": (shape: Rectangle(corner: (-9, -9, 5), u: (18, 0, 0), v: (0, 18, 0)),
                    material: (diffuse: 0, ambient: 0, transparency: 0.5)),
                \"lamp\": (shape: Sphere(), material: (diffuse: 0, ambient: 0, emission: 1, color: 1){fields}) }}"
        ))
    };
    assert_eq!(of(", seen_by: (reflections: false)"), Rgb::splat(0.5));
    assert_eq!(of(", seen_by: (camera: false)"), Rgb::ZERO);
}

#[test]
fn children_inherit_what_does_not_see_them() {
    let film = |fields: &str| {
        shoot_film(&format!(
            "(output: (size: (24, 16)), quality: (antialias: 1), background: 0.25,
            camera: (position: (0, 3, 9), target: (0, 0.5, 0)), lights: {{ \"lamp\": Point(position: (2, 9, 3)) }},
            objects: {{ \"floor\": (shape: Plane()), \"group\": (shape: Group{fields}),
                \"ball\": (shape: Sphere(center: (0, 1, 0)), parent: \"group\"),
                \"mesh\": (shape: Torus(center: (2, 1, 0)), parent: \"group\", scale: (1, 2, 1)) }})"
        ))
        .data
    };
    assert_ne!(film(""), film(", casts_shadow: false"));
    assert_ne!(film(", casts_shadow: false"), film(", visible: false"));
    assert_eq!(
        film(", casts_shadow: false, seen_by: (camera: false, reflections: false)"),
        film(", visible: false")
    );
}

#[test]
fn paths_do_not_find_the_light_of_emitters_that_reflections_do_not_see() {
    let film = |fields: &str| {
        let film = shoot_film(&format!(
            "(output: (size: (16, 16)), quality: (integrator: Path, samples: 16, bounces: 2), background: 0, ambient: 0,
            camera: (position: (0, 3, 6), target: (0, 0, 0)),
            objects: {{ \"floor\": (shape: Plane()),
                \"lamp\": (shape: Sphere(center: (0, 9, 0)), material: (diffuse: 0, emission: 50){fields}) }})"
        ));
        film.radiance().map(|radiance| f64::from(radiance.element_sum())).sum::<f64>()
    };
    let (lit, unseen) = (film(""), film(", seen_by: (camera: false)"));
    assert!(lit > 1.0);
    assert_eq!(lit, unseen);
    assert_eq!(film(", seen_by: (reflections: false)"), 0.0);
}

/// What frames show, to the bit.
#[derive(Default)]
struct Shown(Vec<(u32, Vec<[u32; 3]>)>);

impl FilmSink for Shown {
    fn push(&mut self, frame: u32, film: Film) -> Result<(), EncodeError> {
        let pixels = film.radiance().map(|radiance| radiance.to_array().map(f32::to_bits)).collect();
        self.0.push((frame, pixels));
        Ok(())
    }
}

fn frame_loop(sequence: &Sequence) -> FrameLoop<Shown> {
    FrameLoop::new(sequence, Shown::default(), Arc::new(ProgressMeter::default()))
}

/// All frames by a plan, and one by one.
fn both_ways(text: &str) -> (Stats, usize) {
    let sequence = sequence(text);
    let frames: Vec<u32> = (0..sequence.timeline.frames).collect();
    let plan = Plan::new(&sequence, &frames, AovSet::default(), u64::MAX);
    let mut planned = frame_loop(&sequence);
    plan::run(&plan, &mut planned, || true).unwrap_or_else(|fault| panic!("{fault:?}"));
    let stats = planned.stats().clone();
    let mut together = planned.into_sink().expect("the sink").0;
    together.sort_by_key(|(frame, _)| *frame);
    let mut alone = Vec::new();
    for frame in frames {
        let mut one = frame_loop(&sequence);
        one.frame(frame).unwrap_or_else(|fault| panic!("{fault:?}"));
        alone.extend(one.into_sink().expect("the sink").0);
    }
    let same = together.iter().zip(&alone).take_while(|(a, b)| a == b).count();
    assert_eq!(same, alone.len(), "frame {same} differs");
    let mut different: Vec<_> = alone.into_iter().map(|(_, pixels)| pixels).collect();
    different.sort();
    different.dedup();
    (stats, different.len())
}

const KEYED: &str = "timeline: (frames: 6, fps: 6), output: (size: (24, 16)), background: (0.2, 0.3, 0.4),
    camera: (position: (0, 3, 9), target: (0, 0.5, 0)), lights: { \"lamp\": Point(position: (2, 9, 3)) }";

#[test]
fn keys_change_the_frames_that_they_change() {
    let (stats, different) = both_ways(&format!(
        "({KEYED}, quality: (antialias: 1), objects: {{ \"floor\": (shape: Plane(), material: (mirror: 0.5)),
            \"ball\": (shape: Sphere(center: (0, 1, 0)), casts_shadow: [(0, true), (0.5, false)],
            seen_by: (reflections: [(0, true), (0.5, false)])) }})"
    ));
    assert_eq!(different, 2);
    // Three frames before the key share a film, and three behind it.
    assert_eq!((stats.traced, stats.reused), (2, 4));
}

#[test]
fn shared_paths_know_the_kinds_of_rays() {
    for integrator in ["Whitted", "Path"] {
        for fields in ["casts_shadow: false", "seen_by: (camera: false)", "seen_by: (reflections: false)"] {
            let (_, different) = both_ways(&format!(
                "({KEYED}, quality: (integrator: {integrator}, samples: 4, antialias: 2, bounces: 3),
                objects: {{ \"floor\": (shape: Plane(), material: (mirror: 0.5, transparency: 0.1)),
                    \"still\": (shape: Box(min: (2, 0, -1), max: (3, 1, 1)), {fields}),
                    \"ball\": (shape: Sphere(center: (0, 1, 0)), material: (mirror: 0.3), {fields},
                        translation: [(0, (-2, 0, 0)), (1, (2, 0, 0))]) }})"
            ));
            assert_eq!(different, 6, "{integrator} {fields}");
        }
    }
}

/// Objects that all rays see need no trees besides the one of all.
#[test]
fn scenes_without_it_do_no_more_work() {
    let work = |fields: &str| {
        let text = format!(
            "({KEYED}, objects: {{ \"floor\": (shape: Plane()),
            \"ball\": (shape: Sphere(center: (0, 1, 0)){fields}) }})"
        );
        shoot(&sequence(&text), [0]).remove(0)
    };
    let (plain, stated) = (work(""), work(", casts_shadow: true, seen_by: (camera: true)"));
    assert_eq!(plain.work, stated.work);
    assert_eq!(plain.film.data, stated.film.data);
}
