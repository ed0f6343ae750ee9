//! A valid example of each feature, and texts that must not crash the parser.

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
use crate::sequence::quality::{Integrator, NoiseTarget, PathSettings};
use crate::track::{Ease, Repeat};
use proptest::prelude::*;

/// Every feature of the format, at least once.
const EVERYTHING: &str = r##"
// A comment before, /* and one inside */
(
    timeline: (frames: 48, fps: "24", keys: Frames,),
    output: (size: (64, 36), files: ["out/f_####.png", "out/a.gif"], tonemap: None,
             exposure: [(0, -2), (48, 1.5, Smooth)],
             gif: (loop_count: 3, colors: 16, dither: false)),
    quality: (integrator: Path(roulette: Off, refractive_shadows: true), bounces: 2, antialias: 1, samples: 16,
              noise: 0.02, max_samples: 512, sampler: Independent,
              filter: BlackmanHarris(width: 2.5), threshold: 0.01, clamp: 10, shutter_steps: 8,
              smooth_terminator: false, seed: 4294967295),
    background: [(0, "#102030"), (24, Srgb(0, 0, 255), Smooth), (48, 0)],
    ambient: Linear8(255, 255, 255),
    fog: (color: [(0, 0.5), (24, "#abc")], density: [(0, 0), (48, 0.1)], falloff: (base: -1, height: [(0, 2), (48, 3)])),
    cameras: {
        "front": (position: (0, 1, 9), roll: [(0, 0), (48, 360)], path: [
            Orbit(turns: 1, elevation: 20, radius: 8),
            Zoom(fov: [(0, 60), (24, 20, InOutQuad), (47, 60)]),
            Dolly(forward: 1, right: 0.5, upward: -0.5),
        ], aperture: [(0, 0), (24, 0.2)], focus: "ball", shutter: [(0, 0), (24, 0.5)]),
        "side": (position: (9, 1, 0), focus: [(0, 4), (24, 9, Smooth)], aperture: 0.1, shutter: 1, projection: Orthographic(height: 4), path: Keys(target: (0, 1, 0))),
        "fly": (path: Spline(points: [(1, 1, 5), (5, 2, 1), (1, 3, -5)], closed: true, look_ahead: true)),
    },
    active_camera: [(0, "front"), (24, "side"), (36, "fly")],
    lights: {
        "key": Point(position: (3, 4, 5), color: (1, 0.9, 0.8), intensity: 0.7, on: [(0, true), (12, false)]),
        "fill": Point(position: Track(keys: [(0, (0, 0, 0)), (10, (1, 1, 1)), (20, (0, 0, 0))],
                                      ease: CatmullRom, repeat: Loop, closed: true),
                      attenuation: (constant: 0, linear: 0.1, quadratic: 0.01)),
        "stage": Spot(position: (0, 5, 0), target: [(0, (0, 0, 0)), (48, (1, 0, 0))], angle: [(0, 40), (48, 60)],
                      inner_angle: 20, attenuation: (quadratic: 1)),
        "sun": Directional(direction: (-1, -2, -1), intensity: [(0, 0), (48, 2)]),
        "bulb": Sphere(center: (0, 3, 0), radius: [(0, 0.1), (48, 0.2)], color: "#fe8"),
        "window": Rectangle(corner: (0, 0, -5), u: (2, 0, 0), v: [(0, (0, 1, 0)), (48, (0, 2, 0))], one_sided: true),
    },
    default_material: (specular: 0.5, shininess: 32),
    materials: {
        "red": (color: (1, 0, 0), mirror: 0.2, highlight: BlinnPhong),
        "all": (color: Checker(a: 0.1, b: Noise()), emission: [(0, 0), (24, 2)], emission_color: "#fa0", ambient_color: 1,
                diffuse_color: 1, specular_color: 1, mirror: 0.1, mirror_color: VertexColor, fuzz: [(0, 0), (24, 0.5)],
                transparency: 0.2, transparency_color: (1, 0.9, 0.9), refraction: [(0, 0.5), (9, 0.7)], refraction_color: 1,
                fresnel: Schlick, ior: [(0, 1.3), (48, 1.5)], absorption: [(0, 0), (48, (1, 0, 0))], priority: -1),
        "chalk": Lambertian(color: Stripes()),
        "brass": Metal(color: [(0, (0.8, 0.6, 0.2)), (24, 1)], fuzz: Noise(a: 0, b: 0.4)),
        "diamond": Dielectric(color: 1, ior: 2.417, fresnel: Exact, absorption: 0.1, priority: 3),
        "paint": MetallicRoughness(color: Dots(), metallic: 0.5, roughness: Checker(a: 0.2, b: 0.6), ambient: 0.1,
                                   ambient_color: 1, emission: 1, emission_color: 0.1, ior: 1.4),
    },
    objects: {
        "root": (shape: Group, rotation: Euler(y: 90)),
        "ball": (shape: Sphere(center: (0, 1, 0), radius: 1.5), material: "red", parent: "root",
                 visible: [(0, true, Step), (12, false)], scale: [(t: 0, v: 1), (t: 10, v: (2, 1, 1), ease: Bezier(0.4, 0, 0.2, 1)), (t: 20, v: 0)]),
        "glass": (shape: Sphere(), material: Dielectric()),
        "floor": (shape: Plane(), material: (color: "#888", diffuse: [(0, 0), (10, 1)])),
        "sheet": (shape: Rectangle(corner: (0, 0, 0), u: (1, 0, 0), v: (0, 1, 0)), translation: (1, 2, 3)),
        "coin": (shape: Disk(radius: 0.5), rotation: AxisAngle(axis: (0, 1, 0), angle: [(0, 0), (48, 720)])),
        "leaf": (shape: Triangle(a: (0, 0, 0), b: (1, 0, 0), c: (0, 1, 0)), rotation: Quaternion((0, 0, 2, 0))),
        "crate": (shape: Box(min: (-1, -1, -1), max: (1, 1, 1)), pivot: (0, 1, 0),
                  rotation: Quaternion([(0, (0, 0, 0, 1)), (48, (0, 1, 0, 0), Smooth)])),
    },
) // the end, without a line break"##;

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

/// Files with former names of fields are read as before, and a note gives the file, the line and the new name.
#[test]
fn former_names_of_fields_are_read_with_a_warning() {
    let fields = |background: &str, loops: &str, samples: &str| {
        format!(
            "(\n output: ({background}: \"#f00\",\n  gif: ({loops}: 3),\n  apng: ({loops}: 4), webp: ({loops}: 5)),
              quality: (noise: 0.1, {samples}: 7),\n)"
        )
    };
    let (old, new) =
        (fields("matte", "plays", "most_samples"), fields("background_color", "loop_count", "max_samples"));
    let (old, new) = (read(&old), read(&new));
    assert_eq!((&old.output, old.quality), (&new.output, new.quality));
    assert_eq!((old.output.background_color, old.output.formats.gif.loop_count), (Rgb::X, Some(3)));
    assert_eq!(old.quality.noise, Some(NoiseTarget { error: 0.1, most: 7 }));
    assert_eq!(new.notes(), [""; 0]);
    let warning = |line: u32, what: &str, former: &str, name: &str| {
        format!(
            "dir/test.ron:{line}: {what}: the field `{former}` is now called `{name}`; the old name still works"
        )
    };
    let expected = [
        warning(2, "the output", "matte", "background_color"),
        warning(3, "`gif`", "plays", "loop_count"),
        warning(4, "`apng`", "plays", "loop_count"),
        warning(4, "`webp`", "plays", "loop_count"),
        warning(5, "the quality", "most_samples", "max_samples"),
    ];
    assert_eq!(old.notes(), expected);
}

#[test]
fn a_field_and_its_former_name_together_are_a_fault() {
    let faults = |text: &str| parse("dir/test.ron", text).expect_err("a fault").to_string();
    let both = faults("(output: (gif: (plays: 3, loop_count: 3)))");
    assert!(both.contains("`plays` is the former name of `loop_count`"), "{both}");
    assert_eq!(both.matches("error:").count(), 1, "{both}");
    let wrong = faults("(quality: (most_samples: 0))");
    assert!(wrong.contains("`most_samples`: expected a whole number from 1 to"), "{wrong}");
    let listed = faults("(quality: (most: 1))");
    assert!(listed.contains("`max_samples`") && !listed.contains("most_samples"), "{listed}");
}

#[test]
fn misspelt_former_names_and_misplaced_fields_lead_to_current_ones() {
    let faults = |text: &str| parse("dir/test.ron", text).expect_err("a fault").to_string();
    let misspelt = faults("(quality: (most_sample: 1))");
    assert!(misspelt.contains("did you mean `max_samples`?"), "{misspelt}");
    let moved = faults("(output: (plays: 2))");
    assert!(moved.contains("`plays` is now `loop_count`, a field of `gif`, `apng` and `webp`"), "{moved}");
    let misplaced = faults("(output: (loop_count: 2, sise: 1))");
    assert!(misplaced.contains("`loop_count` is a field of `gif`, `apng` and `webp`"), "{misplaced}");
    assert!(!misplaced.contains("has no field `loop_count`"), "{misplaced}");
    let empty = faults(r#"(objects: { "ball": (shape: Sphere(), material: "red") })"#);
    assert!(empty.contains("the section `materials` has no entries"), "{empty}");
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
    let background_color = material("Lambertian()");
    assert_eq!((lobes(&background_color), background_color.diffuse.tint), (only(2), Rgb::splat(0.5).into()));
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
fn unreadable_files_are_faults_with_a_reason() {
    let directory = tempfile::tempdir().expect("a directory");
    let missing = directory.path().join("missing.ron");
    let message = load(&missing).expect_err("no file").to_string();
    assert!(message.contains("missing.ron") && message.contains("there is no such file"), "{message}");
    let latin = directory.path().join("latin.ron");
    std::fs::write(&latin, b"(\n// caf\xe9\n)").expect("a file");
    let message = load(&latin).expect_err("no text").to_string();
    assert!(message.contains("not UTF-8") && message.contains("line 2"), "{message}");
    assert!(load(directory.path()).is_err());
    std::fs::write(&latin, "\u{feff}(camera: (position: (3, 0, 0)))").expect("a file");
    assert_eq!(load(&latin).expect("a sequence").name, "latin");
}

#[test]
fn odd_texts_are_refused_calmly() {
    let many = format!("(objects: {{{}}})", "\"a\": (shape: Spher),".repeat(3000));
    let long_line = format!("(background: \"{}\")", "x".repeat(50_000));
    for text in [
        "",
        "(",
        ")",
        "\"",
        "é",
        "(é: é)",
        "(a: \"é",
        "/*",
        "//",
        "r#\"",
        "(a: 'é')",
        "(objects: {é: 1})",
        "Some(())",
        "(r#timeline: ())",
        "(camera: (position: (1, 2, 3)é))",
        "(background: b\"ab\")",
        "(camera: r\"x\")",
        "(timeline: (frames: 1..2))",
        "(timeline: (frames: 0x10))",
        "(background: 1.2.3)",
        "(\u{1b}[31m: 1)",
        "(objects: {\"\": (shape: Group), (): ()})",
        "{}",
        "[]",
        "3",
        "Sequence(objects: {})",
        "(timeline: inf)",
        "(camera: (path: [[[Orbit()]]]))",
        "(timeline: (duration: 1e-9, fps: 1e-6, keys: Frames))",
        "true",
        many.as_str(),
        long_line.as_str(),
    ] {
        if let Err(faults) = parse("odd.ron", text) {
            assert!(faults.len() > 0);
            let plain = faults.render(false);
            assert!(!plain.is_empty() && !plain.contains('\u{1b}'), "{plain}");
            assert!(faults.render(true).contains("\u{1b}["));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 600, ..ProptestConfig::default() })]

    #[test]
    fn mutations_never_panic(edits in prop::collection::vec((0usize..4000, 0usize..12, 0usize..4000, 0u8..4), 1..6)) {
        let mut text: Vec<char> = EVERYTHING.chars().collect();
        for (at, len, other, kind) in edits {
            let (at, other) = (at % text.len(), other % text.len());
            let end = (at + len).min(text.len());
            match kind {
                0 => drop(text.drain(at..end)),
                1 => {
                    let piece = text[at..end].to_vec();
                    text.splice(other..other, piece);
                }
                2 => text.swap(at, other),
                _ => text[at] = ['(', ']', '"', 'é', '-', '9', ',', '\\'][len % 8],
            }
        }
        let text: String = text.into_iter().collect();
        if let Err(faults) = parse("mutated.ron", &text) {
            prop_assert!(!faults.render(true).is_empty());
        }
    }
}

/// Checks that a text has no faults except missing files.
fn check_example(text: &str) {
    let faults = parse("example.ron", text).err().map(|faults| faults.to_string()).unwrap_or_default();
    let missing = ["image", "mesh", "series", "table"]
        .map(|what| faults.matches(&format!("cannot read the {what}")).count());
    assert_eq!(faults.matches("error:").count(), missing.into_iter().sum::<usize>(), "{faults}");
}

/// All examples of the format's description are valid.
#[test]
fn examples_of_the_description_are_valid() {
    let description = include_str!("../../sequences/README.md");
    let blocks: Vec<&str> =
        description.split("```ron\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    assert!(blocks.len() >= 8, "{} examples", blocks.len());
    for block in blocks {
        if block.starts_with("intensity") {
            // One field in several notations.
            let ways = block.replace("intensity:", "}, \"x\": {intensity:");
            let lights = ways.split("}, \"x\": {").skip(1);
            for light in lights {
                check_example(&format!("(lights: {{ \"l\": Point(position: (1, 2, 3), {light}) }})"));
            }
        } else if block.starts_with('(') {
            check_example(block);
        } else if block.starts_with(char::is_uppercase) {
            // A paint.
            check_example(&format!("(default_material: (color: {block}))"));
        } else {
            check_example(&format!("({block})"));
        }
    }
}
