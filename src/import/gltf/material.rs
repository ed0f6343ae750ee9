//! Materials: the metallic-roughness model and the extensions that Kinora has a counterpart for.

use super::GltfResult;
use super::features::LeftOut;
use super::json::{Item, LARGEST};
use super::texture::{GltfTexture, texture};
use crate::base::math::DVec3;

/// A material as the file states it.
#[derive(Clone, Debug, PartialEq)]
pub struct GltfMaterial {
    /// Empty if it has none.
    pub name: String,
    /// Linear colour and alpha, and the image that multiplies both.
    pub base: [f64; 4],
    pub base_texture: Option<GltfTexture>,
    /// Factors of the image's blue and green channel.
    pub metallic: f64,
    pub roughness: f64,
    pub metallic_roughness_texture: Option<GltfTexture>,
    /// Emitted radiance.
    pub emissive: DVec3,
    pub emissive_texture: Option<GltfTexture>,
    /// A map of normals, and the factor of their components along the surface.
    pub normal_texture: Option<(GltfTexture, f64)>,
    pub alpha: AlphaMode,
    /// A clear coat over everything else.
    pub coat: Coat,
    /// It shows its base colour, whatever the light.
    pub unlit: bool,
    pub ior: f64,
    /// The share of the light that is not reflected diffusely but passes.
    pub transmission: f64,
    /// The inside of a closed body; none if it is a thin sheet.
    pub volume: Option<Volume>,
    /// Whether vertex colours multiply its base colour: whether any mesh that uses it has some.
    pub vertex_colors: bool,
}

/// A clear coat: how much of the surface it covers and its roughness, each with an image. Its red channel multiplies
/// the first, and the green channel of the other one the second.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Coat {
    pub share: f64,
    pub share_texture: Option<GltfTexture>,
    pub roughness: f64,
    pub roughness_texture: Option<GltfTexture>,
}

/// What alpha means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AlphaMode {
    /// Nothing.
    Opaque,
    /// The surface is where alpha is at least this.
    Mask(f64),
    /// The share of the surface that is there.
    Blend,
}

/// The inside of a body: of white light, `color` is left after `distance`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Volume {
    pub color: DVec3,
    /// Infinite if the inside is clear.
    pub distance: f64,
}

impl Default for GltfMaterial {
    fn default() -> Self {
        Self {
            name: String::new(),
            base: [1.0; 4],
            base_texture: None,
            metallic: 1.0,
            roughness: 1.0,
            metallic_roughness_texture: None,
            emissive: DVec3::ZERO,
            emissive_texture: None,
            normal_texture: None,
            alpha: AlphaMode::Opaque,
            coat: Coat::default(),
            unlit: false,
            ior: 1.5,
            transmission: 0.0,
            volume: None,
            vertex_colors: false,
        }
    }
}

impl GltfMaterial {
    /// All textures.
    pub fn textures(&self) -> impl Iterator<Item = &GltfTexture> {
        let normal = self.normal_texture.as_ref().map(|(texture, _)| texture);
        let all = [&self.base_texture, &self.metallic_roughness_texture, &self.emissive_texture];
        let coat = [&self.coat.share_texture, &self.coat.roughness_texture];
        all.into_iter().chain(coat).flatten().chain(normal)
    }

    /// The number of the texture coordinates that its meshes need.
    pub fn coordinates(&self) -> u64 {
        self.textures().next().map_or(0, |texture| texture.coordinates)
    }
}

/// The largest number of materials: triangles name theirs with 16 bits, and one number stands for none.
const MOST_MATERIALS: usize = u16::MAX as usize - 1;

/// Reads all materials, and adds the one of primitives that name none.
pub fn materials(root: &Item<'_>, left_out: &mut LeftOut) -> GltfResult<Vec<GltfMaterial>> {
    let items = root.list("materials")?;
    if items.len() > MOST_MATERIALS {
        return Err(root.error(format!("it has more than {MOST_MATERIALS} materials")));
    }
    let mut all = items.iter().map(|item| material(root, item, left_out)).collect::<GltfResult<Vec<_>>>()?;
    all.push(GltfMaterial::default());
    Ok(all)
}

fn material(root: &Item<'_>, item: &Item<'_>, left_out: &mut LeftOut) -> GltfResult<GltfMaterial> {
    let mut given = GltfMaterial { name: item.name()?, ..Default::default() };
    if let Some(pbr) = item.object("pbrMetallicRoughness")? {
        given.base = pbr.color("baseColorFactor", [1.0; 4])?;
        given.base_texture = texture((root, &pbr), "baseColorTexture", left_out)?;
        given.metallic = pbr.share("metallicFactor", 1.0)?;
        given.roughness = pbr.share("roughnessFactor", 1.0)?;
        given.metallic_roughness_texture = texture((root, &pbr), "metallicRoughnessTexture", left_out)?;
    }
    given.emissive = DVec3::from_array(item.color("emissiveFactor", [0.0; 3])?);
    given.emissive_texture = texture((root, item), "emissiveTexture", left_out)?;
    if let Some(normal) = texture((root, item), "normalTexture", left_out)? {
        let info = item.object("normalTexture")?;
        let scale = info.map_or(Ok(1.0), |info| info.number("scale", 1.0))?;
        given.normal_texture = Some((normal, scale));
    }
    given.alpha = match item.text("alphaMode")? {
        None | Some("OPAQUE") => AlphaMode::Opaque,
        Some("MASK") => AlphaMode::Mask(item.not_negative("alphaCutoff", 0.5)?),
        Some("BLEND") => AlphaMode::Blend,
        Some(_) => return Err(item.error("its `alphaMode` is none of OPAQUE, MASK and BLEND")),
    };
    if let Some(strength) = item.extension("KHR_materials_emissive_strength")? {
        given.emissive *= strength.not_negative("emissiveStrength", 1.0)?;
        if given.emissive.max_element() > LARGEST {
            return Err(item.error("its `emissiveFactor` times its `emissiveStrength` is above 1e30"));
        }
    }
    given.unlit = item.extension("KHR_materials_unlit")?.is_some();
    if let Some(ior) = item.extension("KHR_materials_ior")? {
        given.ior = ior.not_negative("ior", 1.5)?;
        // 0 stands for a surface that reflects everything at grazing angles only.
        if given.ior < 1.0 {
            left_out.note("an index of refraction below 1", "material");
            given.ior = 1.5;
        }
    }
    transmission(item, &mut given, left_out)?;
    given.coat = coat(root, item, left_out)?;
    note_what_is_left(item, &given, left_out)?;
    Ok(given)
}

fn coat(root: &Item<'_>, item: &Item<'_>, left_out: &mut LeftOut) -> GltfResult<Coat> {
    let Some(given) = item.extension("KHR_materials_clearcoat")? else { return Ok(Coat::default()) };
    let share = given.share("clearcoatFactor", 0.0)?;
    if share == 0.0 {
        return Ok(Coat::default());
    }
    if given.has("clearcoatNormalTexture") {
        left_out.note("normal maps of clear coats", "material");
    }
    Ok(Coat {
        share,
        share_texture: texture((root, &given), "clearcoatTexture", left_out)?,
        roughness: given.share("clearcoatRoughnessFactor", 0.0)?,
        roughness_texture: texture((root, &given), "clearcoatRoughnessTexture", left_out)?,
    })
}

fn transmission(item: &Item<'_>, given: &mut GltfMaterial, left_out: &mut LeftOut) -> GltfResult<()> {
    if let Some(passing) = item.extension("KHR_materials_transmission")? {
        given.transmission = passing.share("transmissionFactor", 0.0)?;
        if passing.has("transmissionTexture") && given.transmission > 0.0 {
            left_out.note("transmission textures", "material");
        }
        if given.transmission > 0.0 && given.roughness > 0.0 {
            left_out.note("the blur of rough transmission", "material");
        }
        // Metal passes no light, but the image may say that only some of the surface is metal.
        if given.transmission > 0.0 && given.metallic > 0.0 && given.metallic_roughness_texture.is_some() {
            left_out.note("transmission where an image says what is metal", "material");
        }
    }
    if let Some(volume) = item.extension("KHR_materials_volume")? {
        let color = DVec3::from_array(volume.color("attenuationColor", [1.0; 3])?);
        let distance = volume.not_negative("attenuationDistance", f64::INFINITY)?;
        let distance = if distance > 0.0 { distance } else { f64::INFINITY };
        let is_solid = volume.not_negative("thicknessFactor", 0.0)? > 0.0;
        given.volume = is_solid.then_some(Volume { color, distance });
    }
    Ok(())
}

fn note_what_is_left(item: &Item<'_>, given: &GltfMaterial, left_out: &mut LeftOut) -> GltfResult<()> {
    let wanted = given.coordinates();
    if given.textures().any(|texture| texture.coordinates != wanted) {
        left_out.note("second texture coordinates", "material");
    }
    left_out.note_material(item)
}
