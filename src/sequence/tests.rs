//! A valid example of each feature.

mod damaged;
mod description;
mod former_names;

use super::*;
use crate::appearance::environment::SkyTracks;
use crate::appearance::light::{Attenuation, LightKind};
use crate::appearance::material::{Highlight, MaterialBinding, MaterialTracks, ScalarTextureTracks};
use crate::appearance::optics::Fresnel;
use crate::appearance::texture::TextureTracks;
use crate::base::math::{Angle, DQuat, DVec3};
use crate::base::time::{Rate, Time};
use crate::camera::path::{Focus, Lens, Step, ZoomBy};
use crate::encode::GifSettings;
use crate::encode::Output;
use crate::film::filter::{Filter, Kernel};
use crate::geometry::shape::{Cuboid, Sphere};
use crate::geometry::transform::Rotation;
use crate::sampling::SamplerKind;
use crate::sequence::quality::{Denoise, Integrator, NoiseTarget, PathSettings, SampleReuse};
use crate::track::{Ease, Repeat};

/// Every feature of the format, at least once.
const EVERYTHING: &str = include_str!("tests/everything.ron");

/// Everything that is expanded, except included files.
const LARGER: &str = include_str!("tests/larger.ron");

fn read(text: &str) -> Sequence {
    parse("dir/test.ron", text).unwrap_or_else(|faults| panic!("{faults}"))
}

fn object(object: &str) -> Object {
    read(&format!("(objects: {{ \"o\": ({object}) }})")).objects.remove(0).value
}

fn camera(camera: &str) -> CameraPath {
    read(&format!("(timeline: (frames: 2), camera: ({camera}))")).cameras.remove(0).value
}

fn seconds(num: i128, den: i128) -> Time {
    Time::new(num, den)
}

#[test]
fn larger_scenes_are_read() {
    let sequence = read(LARGER);
    assert_eq!((sequence.objects.len(), sequence.lights.len()), (6 + 3 * 8 + 4, 2));
}

#[test]
fn the_shortest_file_has_every_default() {
    let sequence = read("()");
    assert_eq!(sequence.name, "test");
    assert_eq!(sequence.timeline, Timeline::of_frames(1, Rate::new(24, 1).expect("a rate")));
    assert_eq!(sequence.output.size, (640, 360));
    assert_eq!(sequence.output.files, [Output::parse("output/test.png").expect("an output")]);
    assert_eq!((sequence.output.tonemap, sequence.output.exposure), (Tonemap::Srgb, 0.0.into()));
    assert_eq!(sequence.quality, Quality::default());
    assert_eq!(sequence.background, Rgb::ZERO.into());
    assert_eq!(sequence.ambient, Rgb::ONE.into());
    assert_eq!(sequence.cameras.len(), 1);
    assert_eq!(sequence.cameras[0].value.position, DVec3::new(0.0, 1.0, 5.0).into());
    assert!(sequence.objects.is_empty() && sequence.materials.is_empty() && sequence.lights.is_empty());
}

#[test]
fn everything_is_read() {
    let sequence = read(EVERYTHING);
    assert_eq!(sequence.timeline.frames, 48);
    let gif = GifSettings { loop_count: Some(3), colors: 16, dither: false, max_size: None };
    assert_eq!(sequence.output.formats.gif, gif);
    assert_eq!(sequence.output.tonemap, Tonemap::None);
    let path = PathSettings { roulette: None, refractive_shadows: true };
    let quality = Quality {
        integrator: Integrator::Path(path),
        bounces: 2,
        filter: Filter { kernel: Kernel::BlackmanHarris, width: 2.5 },
        antialias: 1,
        samples: 16,
        noise: Some(NoiseTarget { error: 0.02, most: 512 }),
        points: SamplerKind::Independent,
        threshold: 0.01,
        clamp: Some(10.0),
        shutter_steps: 8,
        smooth_terminator: false,
        seed: u32::MAX,
        vary_noise: true,
        reuse: SampleReuse::Zoom,
        denoise: Denoise::Auto,
    };
    assert_eq!(sequence.quality, quality);
    assert_eq!(sequence.output.exposure.at(seconds(1, 1)), -0.25);
    assert_eq!(sequence.active_camera.at(seconds(1, 1)), 1);
    assert_eq!(sequence.active_camera.at(seconds(3, 2)), 2);
    let names: Vec<_> = sequence.objects.iter().map(|object| object.name.as_str()).collect();
    assert_eq!(names, ["root", "ball", "glass", "floor", "sheet", "coin", "leaf", "crate"]);
    let materials: Vec<_> = sequence.materials.iter().map(|material| material.name.as_str()).collect();
    let named = ["red", "all", "chalk", "brass", "diamond", "paint"];
    assert_eq!(materials[..6], named);
    assert_eq!(
        materials[6..],
        ["default_material", "objects.\"glass\".material", "objects.\"floor\".material"]
    );
    let ball = &sequence.objects[1].value;
    assert_eq!((ball.parent, ball.made_of), (Some(0), MaterialBinding::One(0)));
    assert!(ball.visible.at(seconds(11, 24)) && !ball.visible.at(seconds(12, 24)));
    assert_eq!(ball.transform.scale.at(seconds(10, 24)), DVec3::new(2.0, 1.0, 1.0));
    let SkyTracks::Constant(Animated::Keyed(background)) = &sequence.background.sky else { panic!("keys") };
    assert_eq!(background.keys()[1].time, seconds(1, 1));
    assert_eq!(background.keys()[1].ease, Ease::Smooth);
    assert_eq!(background.keys()[0].ease, Ease::Linear);
}

#[test]
fn reuse_without_effect_is_noted() {
    let notes = |quality: &str| read(&format!("(quality: ({quality}))")).notes();
    for (quality, why) in [
        ("reuse: Zoom, noise: 0.1", "(`noise`)"),
        ("reuse: Zoom, denoise: Auto", "(`denoise`)"),
        ("reuse: Zoom, filter: Box(width: 0.5)", "narrower"),
    ] {
        assert!(matches!(&notes(quality)[..], [note] if note.contains(why)), "{:?}", notes(quality));
    }
    assert!(notes("reuse: Zoom").is_empty() && notes("noise: 0.1").is_empty());
}

#[test]
fn lengths_and_rates_are_exact() {
    let timeline = |text: &str| read(&format!("(timeline: ({text}))")).timeline;
    assert_eq!(timeline("duration: 2.5, fps: 29.97").rate.per_second(), seconds(2997, 100));
    assert_eq!(timeline("duration: 2.5, fps: 29.97").duration, seconds(5, 2));
    assert_eq!(timeline("duration: 2.5, fps: 29.97").frames, 75);
    for ntsc in ["(30000, 1001)", "\"30000/1001\""] {
        assert_eq!(timeline(&format!("frames: 3, fps: {ntsc}")).duration, seconds(3003, 30000));
    }
}

#[test]
fn more_than_one_frame_makes_a_gif_as_well() {
    let files = |text: &str| read(text).output.files.iter().map(ToString::to_string).collect::<Vec<_>>();
    assert_eq!(files("(timeline: (frames: 2))"), ["output/test/frame_####.png", "output/test.gif"]);
    assert_eq!(files("(output: (files: \"still.png\"))"), ["still.png"]);
}

#[test]
fn filters_have_their_usual_widths() {
    let filter = |text: &str| read(&format!("(quality: (filter: {text}))")).quality.filter;
    for (text, kernel, width) in [
        ("Box", Kernel::Box, 1.0),
        ("Tent()", Kernel::Tent, 2.0),
        ("Gaussian", Kernel::Gaussian, 3.0),
        ("BlackmanHarris", Kernel::BlackmanHarris, 3.0),
        ("Gaussian(width: 2)", Kernel::Gaussian, 2.0),
    ] {
        assert_eq!(filter(text), Filter { kernel, width }, "{text}");
    }
}

#[test]
fn shapes_and_their_defaults() {
    assert_eq!(object("shape: Sphere()").shape, Shape::Sphere(Sphere { center: DVec3::ZERO, radius: 1.0 }));
    assert_eq!(object("shape: Group()").shape, Shape::Group);
    assert_eq!(object("shape: Group /* none */").shape, Shape::Group);
    let cuboid = Cuboid { min: DVec3::ZERO, max: DVec3::ONE };
    assert_eq!(
        object("shape: Box /* a */ ( /* b */ min : (0,0,0,) , max:(1,1,1) , )").shape,
        Shape::Cuboid(cuboid)
    );
    let Shape::Plane(plane) = object("shape: Plane(normal: (0, 0, 1e-20))").shape else { panic!("a plane") };
    assert_eq!(plane.normal, DVec3::Z);
}

#[test]
fn rotations() {
    let rotation = |text: &str| object(&format!("shape: Sphere(), rotation: {text}")).transform.rotation;
    assert_eq!(rotation("Quaternion((0, 0, 0, 5))"), Rotation::Quaternion(DQuat::IDENTITY.into()));
    let Rotation::Euler { x, y, .. } = rotation("Euler(y: 90)") else { panic!("Euler angles") };
    assert_eq!((x, y), (Angle(0.0).into(), Angle(90.0).into()));
    let Rotation::Quaternion(Animated::Keyed(_)) = rotation("Quaternion([(0, (0, 0, 0, 1))])") else {
        panic!("keys")
    };
}

#[test]
fn materials_fall_back_to_the_default_material() {
    let text = "(default_material: (color: (1, 0, 0), specular: 0.5, mirror_color: 0.5),
        materials: { \"m\": (diffuse: 0.4, color: [(0, 1), (1, 0)], highlight: BlinnPhong) })";
    let material = read(text).materials.remove(0).value;
    assert_eq!(material.diffuse.strength, 0.4.into());
    assert_eq!(material.ambient.strength, 0.1.into());
    assert_eq!(material.specular.strength, 0.5.into());
    assert_eq!(material.specular.tint, Rgb::ONE.into());
    assert_eq!(material.mirror.tint, Rgb::splat(0.5).into());
    assert_eq!(material.diffuse.tint, material.ambient.tint);
    assert!(matches!(material.diffuse.tint, TextureTracks::Color(Animated::Keyed(_))));
    assert_eq!(material.highlight, Highlight::BlinnPhong);
    assert_eq!(material.shininess, 32.0.into());
}

#[test]
fn kinds_of_materials_have_no_other_lobes() {
    let material = |text: &str| {
        // Lobes of the default material must not apply.
        let text = format!(
            "(default_material: (specular: 0.5, mirror: 0.5, emission: 1, fuzz: 0.3), materials: {{ \"m\": {text} }})"
        );
        read(&text).materials.remove(0).value
    };
    let lobes = |m: &MaterialTracks| {
        [&m.emission, &m.ambient, &m.diffuse, &m.specular, &m.mirror, &m.transparency, &m.refraction]
            .map(|lobe| lobe.strength.clone())
    };
    let only = |place: usize| [0, 1, 2, 3, 4, 5, 6].map(|k| if k == place { 1.0.into() } else { 0.0.into() });
    let matt = material("Lambertian()");
    assert_eq!((lobes(&matt), matt.diffuse.tint), (only(2), Rgb::splat(0.5).into()));
    let metal = material("Metal(color: 0.9)");
    assert_eq!((lobes(&metal), &metal.fuzz), (only(4), &ScalarTextureTracks::Constant(0.0.into())));
    assert_eq!(metal.mirror.tint, Rgb::splat(0.9).into());
    let glass = material("Dielectric(priority: 2)");
    assert_eq!((lobes(&glass), glass.fresnel), (only(6), Fresnel::Exact));
    assert_eq!((glass.ior, glass.priority), (1.5.into(), 2));
    let rough = material("MetallicRoughness(emission: 3)");
    assert_eq!((rough.microfacet, rough.emission.strength), (1.0.into(), 3.0.into()));
    assert_eq!(
        (rough.metallic, rough.roughness),
        (ScalarTextureTracks::Constant(1.0.into()), ScalarTextureTracks::Constant(1.0.into()))
    );
    assert_eq!(rough.ambient.strength, 0.0.into());
    let plain = material("(refraction: 1)");
    assert_eq!((plain.fresnel, plain.microfacet), (Fresnel::Off, 0.0.into()));
}

#[test]
fn lights_of_every_kind() {
    let light = |text: &str| read(&format!("(lights: {{ \"l\": {text} }})")).lights.remove(0).value.kind;
    let LightKind::Point { attenuation, .. } = light("Point(position: (1, 2, 3))") else { panic!("a point") };
    assert_eq!(attenuation, Attenuation::default());
    let LightKind::Spot { target, angle, inner_angle, attenuation, .. } =
        light("Spot(position: (1, 2, 3), attenuation: (quadratic: 2))")
    else {
        panic!("a spot")
    };
    assert_eq!((target, angle, inner_angle), (DVec3::ZERO.into(), Angle(45.0).into(), None));
    assert_eq!(attenuation, Attenuation { constant: 1.0, linear: 0.0, quadratic: 2.0 });
    let LightKind::Sphere { radius, .. } = light("Sphere(center: (1, 2, 3))") else { panic!("a sphere") };
    assert_eq!(radius, 1.0.into());
    let rectangle = light("Rectangle(corner: (0, 0, 0), u: (1, 0, 0), v: (0, 1, 0))");
    assert!(matches!(rectangle, LightKind::Rectangle { one_sided: false, .. }));
}

#[test]
fn lenses_focus_on_their_target_a_distance_or_an_object() {
    assert_eq!(camera("").focus, Focus::Target);
    assert_eq!(camera("focus: 3").focus, Focus::Distance(3.0.into()));
    let text = r#"(camera: (focus: "b"), objects: { "a": (shape: Group), "b": (shape: Sphere()) })"#;
    assert_eq!(read(text).cameras[0].value.focus, Focus::Object(1));
}

#[test]
fn integrators_with_and_without_settings() {
    let integrator = |text: &str| read(&format!("(quality: (integrator: {text}))")).quality.integrator;
    let roulette = |after| Integrator::Path(PathSettings { roulette: after, refractive_shadows: false });
    for (text, expected) in [
        ("Whitted", Integrator::Whitted),
        ("Whitted()", Integrator::Whitted),
        ("Path", roulette(Some(3))),
        ("Path()", roulette(Some(3))),
        ("Path(roulette: 0)", roulette(Some(0))),
        ("Path(roulette: Off)", roulette(None)),
    ] {
        assert_eq!(integrator(text), expected, "{text}");
    }
}

#[test]
fn colors_in_every_way() {
    let color = |text: &str| match read(&format!("(background: {text})")).background.sky {
        SkyTracks::Constant(color) => color.at(seconds(0, 1)),
        sky => panic!("{sky:?}"),
    };
    assert_eq!(color("(1, 0.5, 2)"), Rgb::new(1.0, 0.5, 2.0));
    assert_eq!(color("0.25"), Rgb::splat(0.25));
    assert_eq!(color("\"#fff\""), Rgb::ONE);
    assert_eq!(color("\"#808080\""), color("Srgb(128, 128, 128)"));
    assert_eq!(color("Linear8(51, 0, 255)"), Rgb::new(0.2, 0.0, 1.0));
    assert!((color("\"#808080\"").x - 0.215_860_5).abs() < 1e-6);
}

#[test]
fn camera_steps() {
    let step = |text: &str| camera(&format!("path: {text}")).path.remove(0);
    let Step::Orbit(orbit) = step("Orbit()") else { panic!("an orbit") };
    assert_eq!((orbit.turns, orbit.axis), (1.0, DVec3::Y));
    let Step::Orbit(orbit) = step("Orbit(azimuth: [(0, 0), (1, 90)])") else { panic!("an orbit") };
    assert_eq!(orbit.turns, 0.0);
    let Step::Zoom(zoom) = step("Zoom(fov: 90)") else { panic!("a zoom") };
    let ZoomBy::HalfTangent(tangent) = zoom.by else { panic!("a field of view") };
    assert!((tangent.at(seconds(0, 1)).0 - 1.0).abs() < 1e-15);
    let Step::Keys(keys) = step("Keys(position: (1, 2, 3), up: (0, 0, 1))") else { panic!("keys") };
    assert!(keys.position.is_some() && keys.aim.up.is_some() && keys.aim.target.is_none());
    let steps = camera("path: [Orbit(), Dolly(forward: 1), Zoom(factor: 2)]").path;
    assert_eq!(steps.len(), 3);
    let Lens::Orthographic { height } = camera("projection: Orthographic()").lens else { panic!("a height") };
    assert_eq!(height, 2.0.into());
}

#[test]
fn tracks_repeat_and_close() {
    let text =
        "(lights: { \"l\": Point(position: Track(keys: [(0, (0, 0, 0)), (1, (1, 0, 0)), (2, (0, 0, 0))],
        repeat: PingPong, closed: true, ease: CatmullRom)) })";
    let light = read(text).lights.remove(0).value;
    let LightKind::Point { position: Animated::Keyed(position), .. } = light.kind else { panic!("keys") };
    assert!(position.keys().iter().all(|key| key.ease == Ease::CatmullRom));
    let keys = position.keys().to_vec();
    assert_eq!(crate::track::Track::new(keys, Repeat::PingPong, true).as_ref(), Ok(&position));
    assert_eq!(position.at(seconds(5, 1)), DVec3::X);
}

#[test]
fn key_times_may_be_fractions_of_frames() {
    let text = "(timeline: (frames: 9, fps: (24000, 1001), keys: Frames), ambient: [(0.5, 0), (4, 1)])";
    let Animated::Keyed(ambient) = read(text).ambient else { panic!("keys") };
    assert_eq!(ambient.keys()[0].time, seconds(1001, 48000));
}

#[test]
fn places_of_faults_are_for_programs() {
    let text = "(\n    quality: (samples: 0),\n    lights: { \"\u{e4}\": Point(positon: (0, 1, 2)) },\n)";
    let places = crate::sequence::parse("dir/test.ron", text).expect_err("faults").places();
    let found: Vec<_> =
        places.iter().map(|place| (&*place.file, place.line, place.column, place.field.as_deref())).collect();
    let at = |line, column| ("dir/test.ron", line, column, None);
    assert_eq!(found, [("dir/test.ron", 2, 24, Some("samples")), at(3, 20), at(3, 26)]);
    assert!(places[0].message.contains("expected") && places[2].message.contains("positon"), "{places:?}");
}
