//! The sequence: what a file says, resolved and checked. No names to look up, no defaults left.

mod about;
mod assets;
mod camera;
mod check;
mod colors;
mod decimal;
mod document;
mod easing;
mod environment;
mod fault;
mod fields;
mod fog;
mod formats;
mod keys;
mod layers;
mod level;
mod light;
mod load;
mod material;
mod mesh;
mod mtl;
mod names;
mod node;
mod notes;
mod object;
mod output;
mod paint;
mod path;
pub mod quality;
mod quality_fields;
mod reach;
mod shape;
mod suggest;
mod symbols;
mod syntax;
#[cfg(test)]
mod tests;
mod timeline;
mod transform;
mod values;
mod words;

pub use fault::Faults;
pub use layers::LightLayers;
pub use load::{LoadError, load, load_watched, parse};
pub use quality_fields::ERRORS;

use crate::appearance::environment::EnvironmentTracks;
use crate::appearance::fog::FogTracks;
use crate::appearance::light::LightTracks;
use crate::appearance::material::{MadeOf, MaterialTracks};
use crate::base::color::Rgb;
use crate::base::time::Timeline;
use crate::camera::path::CameraPath;
use crate::encode::{Caption, Formats, Output, Tonemap};
use crate::geometry::shape::Shape;
use crate::geometry::transform::TransformTracks;
use crate::sequence::quality::Quality;
use crate::track::Animated;

/// A whole animation. Everything named keeps the file's order, and refers to the others by index.
#[derive(Clone, Debug, PartialEq)]
pub struct Sequence {
    /// The file's name without its extension.
    pub name: String,
    pub timeline: Timeline,
    pub output: OutputSettings,
    pub quality: Quality,
    /// What rays see that hit nothing.
    pub background: EnvironmentTracks,
    pub fog: Option<FogTracks>,
    /// Light from everywhere; a material reflects its `ambient` share of it.
    pub ambient: Animated<Rgb>,
    /// At least one.
    pub cameras: Vec<Named<CameraPath>>,
    /// Index of the camera that is looked through.
    pub active_camera: Animated<usize>,
    pub lights: Vec<Named<LightTracks>>,
    pub materials: Vec<Named<MaterialTracks>>,
    pub objects: Vec<Named<Object>>,
}

impl Sequence {
    /// Whether the shutter of any camera stays open.
    pub fn blurs_motion(&self) -> bool {
        self.cameras.iter().any(|camera| camera.value.shutter != Animated::Constant(0.0))
    }
}

/// A value with the name that the file gives it.
#[derive(Clone, Debug, PartialEq)]
pub struct Named<T> {
    pub name: String,
    pub value: T,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    pub shape: Shape,
    /// Of the sequence's materials.
    pub made_of: MadeOf,
    pub transform: TransformTracks,
    pub visible: Animated<bool>,
    /// Index of the object that this one moves (and hides) with. Never leads in a circle.
    pub parent: Option<usize>,
}

/// What is rendered into which files.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputSettings {
    /// Width and height in pixels, at least 1.
    pub size: (u32, u32),
    /// Where the frames go, relative to the working directory. At least one, all different.
    pub files: Vec<Output>,
    pub tonemap: Tonemap,
    /// Stops by which the displayed picture is brighter than the radiance, within
    /// ±[`MOST_STOPS`](crate::film::MOST_STOPS) at every key.
    pub exposure: Animated<f64>,
    /// Whether the background is left out where the camera sees it, so that pictures have alpha.
    pub transparent: bool,
    /// What stands in its place in formats without alpha.
    pub matte: Rgb,
    /// What is written into every picture.
    pub caption: Option<Caption>,
    pub formats: Formats,
}
