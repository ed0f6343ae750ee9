//! The sequence: a file's contents, resolved and checked.
//!
//! In: a RON file, and the images and meshes that it names.
//! Out: a [`Sequence`] without names to look up or defaults to fill in, or all faults with their places.
//! Uses the parts of a scene, `import`, and the output settings of `encode`.

mod about;
mod annotations;
mod boolean;
mod camera;
mod carriers;
mod clip;
mod check;
mod colors;
mod data;
mod data_ranges;
#[cfg(test)]
mod data_tests;
mod decimal;
mod deformations;
mod document;
mod easing;
mod environment;
mod expand;
#[cfg(test)]
mod expand_tests;
#[cfg(test)]
mod expand_value_tests;
mod explode;
mod fault;
mod faults;
mod fields;
mod file_cache;
mod fmt;
mod fog;
mod font_files;
mod formats;
mod frame;
mod framing;
mod image;
mod image_files;
mod group_instances;
mod instances;
mod convert;
mod json;
mod key_clock;
mod keys;
mod layers;
mod raw_value;
mod light;
mod load;
mod material;
mod material_description;
mod material_table;
mod mesh;
mod mesh_files;
mod mesh_series;
mod motion;
mod mtl;
mod mtl_images;
mod names;
mod node;
mod notes;
mod object;
mod objects;
mod outline;
mod output;
mod paint;
mod particles;
mod path;
mod placement;
mod pose_columns;
mod pose_tracks;
mod poses;
pub mod quality;
mod quality_fields;
mod scene;
mod scene_files;
mod schema;
mod transform_limits;
mod shape;
mod shape_tracks;
mod source_file;
mod suggest;
mod table_columns;
mod symbols;
mod syntax;
mod table_files;
#[cfg(test)]
mod tests;
mod text_shape;
mod timeline;
mod transform;
mod values;
mod version;
mod words;

pub use convert::{converted, converted_text};
pub use expand::source::quoted_value;
pub use faults::{FaultPlace, Faults};
pub use fmt::{Formatted, formatted, formatted_text};
pub use json::is_json;
pub use layers::LightLayers;
pub use load::{LoadError, expanded, load, load_text, load_watched, parse};
pub use motion::UnknownObject;
pub use quality_fields::ERRORS;
pub use scene::LightUnit;
pub use schema::schema;
pub use shape_tracks::ShapeTracks;
#[cfg(feature = "cli")]
pub(crate) use suggest::{listed, nearest};

use crate::annotate::Annotation;
use crate::appearance::environment::EnvironmentTracks;
use crate::appearance::fog::FogTracks;
use crate::appearance::light::LightTracks;
use crate::appearance::material::{MaterialBinding, MaterialTracks};
use crate::base::color::Rgb;
use crate::base::math::UpAxis;
use crate::base::time::Timeline;
use crate::camera::CameraCuts;
use crate::camera::path::CameraPath;
use crate::encode::{Formats, Output, Tonemap};
use crate::geometry::clip::ClipPlane;
use crate::geometry::ray_kinds::RayVisibility;
use crate::geometry::shape::Shape;
use crate::geometry::table_rows::RowTrack;
use crate::geometry::transform::TransformTracks;
use crate::sequence::quality::Quality;
use crate::track::Animated;

/// A whole animation. Named entries keep the file's order and refer to each other by index.
#[derive(Clone, Debug, PartialEq)]
#[warn(missing_docs)]
pub struct Sequence {
    /// The file's name without its extension.
    pub name: String,
    /// The upward axis of the objects' coordinates. Everything else is in axes with y up.
    pub up: UpAxis,
    /// The frames and their rate.
    pub timeline: Timeline,
    /// Size, files and formats.
    pub output: OutputSettings,
    /// The work per pixel.
    pub quality: Quality,
    /// The environment that rays see if they hit nothing.
    pub background: EnvironmentTracks,
    /// What absorbs and scatters light everywhere.
    pub fog: Option<FogTracks>,
    /// Light from all directions. A material reflects its `ambient` share.
    pub ambient: Animated<Rgb>,
    /// At least one.
    pub cameras: Vec<Named<CameraPath>>,
    /// The active camera, and how long cuts take.
    pub active_camera: CameraCuts,
    /// The lights over time.
    pub lights: Vec<Named<LightTracks>>,
    /// The materials over time. Objects refer to them by index.
    pub materials: Vec<Named<MaterialTracks>>,
    /// The objects over time.
    pub objects: Vec<Named<Object>>,
    /// What is drawn over the pictures, in its order.
    pub annotations: Vec<Named<Annotation>>,
    /// Warnings about outdated notation in the file, as `file:line: warning`.
    pub warnings: Vec<String>,
}

#[warn(missing_docs)]
impl Sequence {
    /// Whether any camera's shutter is ever open.
    pub fn blurs_motion(&self) -> bool {
        self.cameras.iter().any(|camera| camera.value.shutter != Animated::Constant(0.0))
    }
}

/// A value with its name in the file.
#[derive(Clone, Debug, PartialEq)]
#[warn(missing_docs)]
pub struct Named<T> {
    /// The name.
    pub name: String,
    /// What it names.
    pub value: T,
}

/// An object over time.
#[derive(Clone, Debug, PartialEq)]
#[warn(missing_docs)]
pub struct Object {
    /// The shape at the start.
    pub shape: Shape,
    /// The shape over time, if it changes.
    pub tracks: Option<ShapeTracks>,
    /// Binding to the sequence's materials.
    pub made_of: MaterialBinding,
    /// Its place in the space of its parent, or in the world.
    pub transform: TransformTracks,
    /// Whether it is visible. A hidden object hides those of which it is the parent.
    pub visible: Animated<bool>,
    /// Which rays see the object while it is visible.
    pub rays: RayVisibility,
    /// Index of the object whose transform and visibility this one inherits. Parents never form a cycle.
    pub parent: Option<usize>,
    /// Index of the node whose mesh this is, if joints place the mesh, not the node. It is visible only with the node,
    /// and the name of the node stands for it.
    pub skin_of: Option<usize>,
    /// Planes in its space that cut it open, and all objects below it.
    pub clip: Vec<ClipPlane>,
    /// Its row of a table over time, if a texture of its materials may read numbers of it.
    pub row: Option<RowTrack>,
}

#[warn(missing_docs)]
impl Object {
    /// A visible shape at the origin, with the sequence's material of this index.
    pub fn new(shape: Shape, material: u32) -> Self {
        Self {
            shape,
            tracks: None,
            made_of: MaterialBinding::One(material),
            transform: TransformTracks::default(),
            visible: true.into(),
            rays: RayVisibility::default(),
            parent: None,
            skin_of: None,
            clip: Vec::new(),
            row: None,
        }
    }
}

/// The size, files and formats of the output.
#[derive(Clone, Debug, PartialEq)]
#[warn(missing_docs)]
pub struct OutputSettings {
    /// Width and height in pixels, at least 1.
    pub size: (u32, u32),
    /// Output files relative to the working directory; at least one, all different.
    pub files: Vec<Output>,
    /// The curve from radiance to displayed values.
    pub tonemap: Tonemap,
    /// Exposure of the displayed picture in stops, within ±[`MAX_STOPS`](crate::film::MAX_STOPS) at every key.
    pub exposure: Animated<f64>,
    /// Whether the background is transparent where the camera sees it.
    pub transparent: bool,
    /// Background colour in formats without alpha.
    pub background_color: Rgb,
    /// The caption of every picture, over all other annotations.
    pub caption: Option<Annotation>,
    /// Settings of the formats.
    pub formats: Formats,
}
