//! The materials of OBJ files, as the MTL file states them.

use crate::base::color::Rgb;
use crate::base::math::DVec2;

/// A material of an OBJ file: the raw values of its MTL file, or none if the file does not state one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MtlMaterial {
    pub name: String,
    /// `Ka`, `Kd`, `Ks` and `Ke`: ambient, diffuse and specular reflectance, and emitted radiance.
    pub ambient: Option<Rgb>,
    pub diffuse: Option<Rgb>,
    pub specular: Option<Rgb>,
    pub emission: Option<Rgb>,
    /// `Ns`: the exponent of highlights.
    pub shininess: Option<f32>,
    /// `Ni`: the index of refraction.
    pub ior: Option<f32>,
    /// `d`, or 1 - `Tr`: 1 is opaque, 0 is invisible.
    pub opacity: Option<f32>,
    /// `illum`: the number of an illumination model.
    pub model: Option<u32>,
    /// `map_Kd`: the image that multiplies the diffuse reflectance. Its alpha is the opacity.
    pub diffuse_map: Option<Map>,
    /// `map_d` as written, until the reader knows whether it is the same image as `map_Kd`.
    pub(crate) opacity_map: Option<String>,
    /// Statements of the file that Kinora does not support, each once.
    pub left_out: Vec<&'static str>,
    /// Set if a library that the mesh names is missing. All materials of the mesh then have it. If there would be no
    /// material, there is one without a name.
    pub missing: Option<String>,
}

/// An image of a material and its mapping: (u, v) shows the image at `scale` · (u, v) + `offset`.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// The name in the file, with `/` between folders. [`load`](crate::import::load) prepends the folder of the mesh.
    pub file: String,
    /// `-s`: number of repetitions along u and v; finite and not 0.
    pub scale: DVec2,
    /// `-o`
    pub offset: DVec2,
    /// `-clamp on`: the image does not repeat beyond its edges.
    pub clamps: bool,
}
