//! A sequence for the tests of the command line.

use crate::appearance::light::{Attenuation, LightKind, LightTracks};
use crate::base::color::Rgb;
use crate::base::math::{Angle, DVec3};
use crate::base::time::{Rate, Timeline};
use crate::camera::path::{CameraPath, Focus, Lens};
use crate::encode::{DEFAULT_BACKGROUND_COLOR, Formats, Output, Tonemap};
use crate::sequence::quality::Quality;
use crate::sequence::{Named, OutputSettings, Sequence};
use crate::track::Animated::Constant;

/// Three seconds of an empty scene with a camera and a light.
pub fn sequence() -> Sequence {
    let camera = CameraPath {
        position: Constant(DVec3::Z),
        target: Constant(DVec3::ZERO),
        up: Constant(DVec3::Y),
        roll: Constant(Angle::default()),
        lens: Lens::Orthographic { height: Constant(1.0) },
        aperture: Constant(0.0),
        focus: Focus::Target,
        shutter: Constant(0.0),
        frame: None,
        path: Vec::new(),
    };
    let light = LightTracks {
        kind: LightKind::Point { position: Constant(DVec3::Z), attenuation: Attenuation::default() },
        color: Constant(Rgb::ONE),
        intensity: Constant(1.0),
        on: true.into(),
        shadows: true,
    };
    Sequence {
        name: "nothing".into(),
        up: Default::default(),
        timeline: Timeline::of_frames(72, Rate::new(24, 1).expect("a positive rate")),
        output: OutputSettings {
            size: (641, 361),
            files: ["output/nothing_####.png", "output/nothing.gif"].map(output).to_vec(),
            tonemap: Tonemap::Srgb,
            exposure: Constant(0.0),
            transparent: false,
            background_color: DEFAULT_BACKGROUND_COLOR,
            caption: None,
            formats: Formats::default(),
        },
        quality: Quality::default(),
        background: Rgb::ZERO.into(),
        fog: None,
        ambient: Constant(Rgb::ZERO),
        cameras: vec![Named { name: "camera".into(), value: camera }],
        active_camera: 0.into(),
        lights: vec![Named { name: "light".into(), value: light }],
        materials: Vec::new(),
        objects: Vec::new(),
        annotations: Vec::new(),
        warnings: Vec::new(),
    }
}

/// The output of this name.
pub fn output(name: &str) -> Output {
    Output::parse(name).expect("a name of a known format")
}
