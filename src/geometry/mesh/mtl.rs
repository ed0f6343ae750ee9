//! The materials of OBJ files, as they are written.

use crate::base::color::Rgb;
use crate::base::math::DVec2;

/// A material of an OBJ file: the raw values of its MTL file, and nothing where the file says nothing.
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
    /// `d`, or 1 - `Tr`: 1 is opaque, 0 is not there.
    pub opacity: Option<f32>,
    /// `illum`: the number of a model of illumination.
    pub model: Option<u32>,
    /// `map_Kd`: the image that the diffuse reflectance is multiplied with. Its alpha says how much of the surface is there.
    pub diffuse_map: Option<Map>,
    /// `map_d`, as it is written, until it is known whether that is the same image.
    pub(crate) opacity_map: Option<String>,
    /// What the file says besides that has a meaning but is not read, each once.
    pub left_out: Vec<&'static str>,
    /// That a library which its mesh names is not there. All materials of the mesh have it then, and there is one
    /// without a name if there would be none.
    pub missing: Option<String>,
}

/// An image of a material, and where it lies: at (u, v) it shows what it has at `scale` · (u, v) + `offset`.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// As the file names it, with `/` between folders; [`load`](crate::import::load) puts the folder of the mesh before it.
    pub file: String,
    /// `-s`: how often the image is seen along u and v; finite and not 0.
    pub scale: DVec2,
    /// `-o`
    pub offset: DVec2,
    /// `-clamp on`: beyond its edges the image is not repeated.
    pub clamps: bool,
}
