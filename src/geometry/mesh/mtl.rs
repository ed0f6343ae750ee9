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
    /// `Pr` and `Pm`: roughness and how metallic it is, 0..=1, of the model with microfacets.
    pub roughness: Option<f32>,
    pub metallic: Option<f32>,
    /// `Pc` and `Pcr`: how much a clear coat covers, and its roughness, 0..=1.
    pub coat: Option<f32>,
    pub coat_roughness: Option<f32>,
    /// Images, each with its use, at most one for each.
    pub maps: Vec<(MapUse, Map)>,
    /// Statements of the file that Kinora does not support, each once.
    pub left_out: Vec<&'static str>,
    /// Set if a library that the mesh names is missing. All materials of the mesh then have it. If there would be no
    /// material, there is one without a name.
    pub missing: Option<String>,
}

impl MtlMaterial {
    /// The image for a use.
    pub fn map(&self, wanted: MapUse) -> Option<&Map> {
        self.maps.iter().find(|(usage, _)| *usage == wanted).map(|(_, map)| map)
    }
}

/// What an image of a material is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapUse {
    /// `map_Ka`, `map_Kd`, `map_Ks` and `map_Ke` multiply their colours. The alpha of `map_Kd` is opacity.
    Ambient,
    Diffuse,
    Specular,
    Emission,
    /// `map_d`
    Opacity,
    /// `map_Bump`: heights or normals.
    Bump,
    /// `norm`: normals.
    Normal,
    /// `map_Pr` and `map_Pm` multiply their numbers.
    Roughness,
    Metallic,
}

/// The channel of an image that holds a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MapChannel {
    Red,
    Green,
    Blue,
    Alpha,
    /// The mean of red, green and blue.
    Grey,
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
    /// `-bm`: a factor of the relief.
    pub strength: f64,
    /// `-imfchan`
    pub channel: Option<MapChannel>,
}
