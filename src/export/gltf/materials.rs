//! Materials as metallic-roughness surfaces.
//!
//! Metallic-roughness materials keep their parameters. Of others, glTF has the closest: diffuse reflection is exact but
//! for reflections at grazing angles, mirrors become metals or dielectrics, and highlights rough reflections.

use super::Exporter;
use super::keys::Keys;
use crate::appearance::light::LightTracks;
use crate::appearance::light_groups::GroupWeight;
use crate::appearance::material::{
    Coat, Exponent, Lobes, Material, MaterialTracks, ReliefTracks, ScalarTextureTracks,
};
use crate::appearance::texture::{ColorChannel, TextureTracks};
use crate::base::color::Rgb;
use crate::base::math::DVec3;
use crate::base::time::Time;
use crate::film::LayerId;
use crate::sequence::Named;
use serde_json::{Value, json};

/// The entries of the sequence's materials in the file.
pub struct MaterialIndices {
    entries: Vec<usize>,
    colored: Vec<bool>,
}

impl MaterialIndices {
    /// One material.
    pub fn only(entry: usize) -> Self {
        Self { entries: vec![entry], colored: vec![false] }
    }

    /// The index of a material of the sequence in the file.
    pub fn of(&self, material: u32) -> usize {
        self.entries[material as usize]
    }

    /// Whether the colours of vertices multiply a material.
    pub fn shows_colors(&self, material: u32) -> bool {
        self.colored[material as usize]
    }
}

/// The parameters of a metallic-roughness surface.
struct Surface {
    base: Rgb,
    metallic: f32,
    roughness: f32,
    ior: f64,
    transmission: f32,
    is_solid: bool,
}

impl Exporter<'_> {
    /// Adds all materials.
    pub fn materials(&mut self) -> MaterialIndices {
        let all = &self.sequence.materials;
        let entries = all.iter().map(|material| self.material(material)).collect();
        let colored = all.iter().map(|material| shows_colors(base_texture(&material.value))).collect();
        MaterialIndices { entries, colored }
    }

    fn material(&mut self, Named { name, value: tracks }: &Named<MaterialTracks>) -> usize {
        let start = self.sequence.timeline.clock(0).time;
        let material = tracks.at(start, LayerId::CONSTANT);
        let surface = self.surface(&material);
        self.note_keys(tracks);
        let shine = Shine::of(tracks);
        let glow = shine.at(start);
        let mut entry = json!({ "name": name, "doubleSided": true });
        let mut extensions = serde_json::Map::new();
        let dark = glow == DVec3::ZERO && !shine.is_keyed();
        let unlit = surface.is_none() && !dark && !shine.is_keyed() && glow.max_element() <= 1.0;
        let surface = surface.unwrap_or(Surface {
            base: if unlit { glow.as_vec3() } else { Rgb::ZERO },
            metallic: 0.0,
            roughness: 1.0,
            ior: 1.0,
            transmission: 0.0,
            is_solid: false,
        });
        let texture = if unlit { &tracks.emission.tint } else { base_texture(tracks) };
        let mut pbr = json!({ "metallicFactor": surface.metallic, "roughnessFactor": surface.roughness });
        let base = self.base(&mut entry, &mut pbr, texture, surface.base);
        pbr["baseColorFactor"] = base;
        self.metallic_roughness(&mut pbr, tracks);
        entry["pbrMetallicRoughness"] = pbr;
        match &tracks.relief {
            Some(ReliefTracks::NormalMap { map: TextureTracks::Image(map), strength }) => {
                if let Some(mut texture) = self.image_texture(map, false) {
                    texture["scale"] = json!(strength.at(start));
                    entry["normalTexture"] = texture;
                }
            }
            Some(_) => self.left_out.note_of("the bump map", "material"),
            None => {}
        }
        if unlit {
            extensions.insert(self.document.uses("KHR_materials_unlit").into(), json!({}));
        } else {
            self.reflection(&mut extensions, &surface, &material);
            self.coat(&mut extensions, tracks, &material);
            if !dark {
                self.emission(&mut entry, &mut extensions, tracks, shine.peak(&self.sequence.timeline));
            }
        }
        if !extensions.is_empty() {
            entry["extensions"] = Value::Object(extensions);
        }
        let index = self.document.push("materials", entry);
        if shine.is_keyed() && !unlit {
            self.animate_emission(&shine, index);
        }
        index
    }

    /// The extension of a clear coat.
    fn coat(
        &mut self,
        to: &mut serde_json::Map<String, Value>,
        tracks: &MaterialTracks,
        material: &Material,
    ) {
        let Coat { share, roughness, .. } = material.lobes.coat;
        if share == 0.0 {
            return;
        }
        let levels = [&tracks.coat, &tracks.coat_roughness];
        if levels.iter().any(|level| matches!(level, ScalarTextureTracks::Textured(_))) {
            self.left_out.note_of("the textures of the coat", "material");
        }
        let entry = json!({ "clearcoatFactor": share, "clearcoatRoughnessFactor": roughness });
        to.insert(self.document.uses("KHR_materials_clearcoat").into(), entry);
    }

    /// The extensions of the boundary and of the inside.
    fn reflection(
        &mut self,
        to: &mut serde_json::Map<String, Value>,
        surface: &Surface,
        material: &Material,
    ) {
        if surface.ior != 1.5 {
            to.insert(self.document.uses("KHR_materials_ior").into(), json!({ "ior": surface.ior }));
        }
        if surface.transmission == 0.0 {
            return;
        }
        let name = self.document.uses("KHR_materials_transmission");
        to.insert(name.into(), json!({ "transmissionFactor": surface.transmission }));
        if surface.is_solid {
            // The distance at which the strongest absorption leaves 1/e.
            let absorption = material.medium.absorption.as_dvec3();
            let mut volume = json!({ "thicknessFactor": 1.0 });
            if absorption.max_element() > 0.0 {
                let distance = 1.0 / absorption.max_element();
                let left = (absorption * distance).to_array().map(|exponent| libm::exp(-exponent));
                volume["attenuationDistance"] = json!(distance);
                volume["attenuationColor"] = json!(left);
            }
            to.insert(self.document.uses("KHR_materials_volume").into(), volume);
        }
    }

    /// Emission: a factor of at most 1, and its strength beyond.
    fn emission(
        &mut self,
        entry: &mut Value,
        extensions: &mut serde_json::Map<String, Value>,
        tracks: &MaterialTracks,
        glow: DVec3,
    ) {
        let strength = if glow.max_element() > 0.0 { glow.max_element() } else { 1.0 };
        entry["emissiveFactor"] = json!((glow / strength).to_array());
        let name = self.document.uses("KHR_materials_emissive_strength");
        let now = Shine::of(tracks).at(self.sequence.timeline.clock(0).time);
        extensions.insert(name.into(), json!({ "emissiveStrength": now.max_element() }));
        if let Some(texture) = self.picture_of(&tracks.emission.tint) {
            entry["emissiveTexture"] = texture;
        }
    }

    /// Adds a black material that emits the light of an area light.
    pub fn emitter(&mut self, name: &str, light: &LightTracks) -> usize {
        let (factor, weight) = (light.constant_radiance(), light.group_weight());
        let shine = Shine { factor, weight, tint: &TextureTracks::Color(Rgb::ONE.into()) };
        let peak = shine.peak(&self.sequence.timeline);
        let (strength, now) = (peak.max_element().max(1e-30), shine.at(self.sequence.timeline.clock(0).time));
        let key = self.document.uses("KHR_materials_emissive_strength");
        let entry = json!({
            "name": name,
            "pbrMetallicRoughness": { "baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0 },
            "emissiveFactor": (peak / strength).to_array(),
            "extensions": { key: { "emissiveStrength": now.max_element() } },
        });
        let index = self.document.push("materials", entry);
        if shine.is_keyed() {
            self.animate_emission(&shine, index);
        }
        index
    }

    fn animate_emission(&mut self, shine: &Shine<'_>, index: usize) {
        let at = |time: Time| vec![shine.at(time).max_element()];
        let steps = shine.weight.on.is_some();
        if let Some(keys) = Keys::sampled(&self.sequence.timeline, steps, false, at) {
            let sampler = keys.sampler(&mut self.document);
            let property = "extensions/KHR_materials_emissive_strength/emissiveStrength";
            self.document.animate_pointer(&format!("/materials/{index}/{property}"), sampler);
        }
        if shine.weight.color.is_some() {
            self.left_out.note_of("the keyed colour of emission", "material");
        }
    }

    /// The base colour: its factor, its image, and what alpha means.
    fn base(&mut self, entry: &mut Value, pbr: &mut Value, texture: &TextureTracks, factor: Rgb) -> Value {
        let flat = self.flattened(texture);
        let color = (factor * flat.factor).as_dvec3();
        if let Some(image) = flat.image {
            pbr["baseColorTexture"] = image;
        }
        if flat.has_alpha {
            match flat.cutoff {
                Some(cutoff) => {
                    entry["alphaMode"] = json!("MASK");
                    entry["alphaCutoff"] = json!(cutoff);
                }
                None => entry["alphaMode"] = json!("BLEND"),
            }
        }
        // Readers ask for colours in 0..=1.
        let DVec3 { x, y, z } = color.clamp(DVec3::ZERO, DVec3::ONE);
        json!([x, y, z, flat.alpha])
    }

    /// The image of metallic and roughness, if both are channels of one as in glTF.
    fn metallic_roughness(&mut self, pbr: &mut Value, tracks: &MaterialTracks) {
        let image = |level: &ScalarTextureTracks, channel: ColorChannel| match level {
            ScalarTextureTracks::Textured(TextureTracks::Image(tracks))
                if tracks.channel == Some(channel) =>
            {
                Some((**tracks).clone())
            }
            _ => None,
        };
        let textured = |level: &ScalarTextureTracks| matches!(level, ScalarTextureTracks::Textured(_));
        if !textured(&tracks.metallic) && !textured(&tracks.roughness) {
            return;
        }
        let (metallic, roughness) =
            (image(&tracks.metallic, ColorChannel::B), image(&tracks.roughness, ColorChannel::G));
        match (metallic, roughness) {
            (Some(metallic), Some(roughness)) if metallic.image == roughness.image => {
                let start = self.sequence.timeline.clock(0).time;
                pbr["metallicFactor"] = json!(metallic.tint.at(start).x);
                pbr["roughnessFactor"] = json!(roughness.tint.at(start).x);
                if let Some(texture) = self.image_texture(&metallic, false) {
                    pbr["metallicRoughnessTexture"] = texture;
                }
            }
            _ => self.left_out.note_of("the textures of metallic and roughness", "material"),
        }
    }

    /// The closest metallic-roughness surface; none if the material only emits.
    fn surface(&mut self, material: &Material) -> Option<Surface> {
        let lobes = &material.lobes;
        let plain = Surface {
            base: lobes.diffuse,
            metallic: 0.0,
            roughness: 1.0,
            ior: 1.0,
            transmission: 0.0,
            is_solid: false,
        };
        let scatters = lobes.microfacet > 0.0
            || lobes.coat.share > 0.0
            || [lobes.diffuse, lobes.specular, lobes.mirror, lobes.transparency, lobes.refraction]
                .iter()
                .any(|lobe| *lobe != Rgb::ZERO);
        if !scatters {
            return None;
        }
        if lobes.microfacet > 0.0 {
            return Some(microfacet(material));
        }
        if lobes.specular != Rgb::ZERO || lobes.mirror != Rgb::ZERO {
            self.left_out.note_of("the exact highlights and mirrors", "material");
        }
        if lobes.refraction != Rgb::ZERO {
            let ior = material.medium.ior.max(1.0);
            return Some(Surface {
                base: lobes.refraction,
                roughness: 0.0,
                ior,
                transmission: 1.0,
                is_solid: true,
                ..plain
            });
        }
        if lobes.transparency != Rgb::ZERO {
            self.left_out.note_of("the exact transparency", "material");
            let passing = mean(lobes.transparency).min(1.0);
            return Some(Surface {
                base: lobes.diffuse + lobes.transparency,
                transmission: passing,
                ..plain
            });
        }
        Some(reflecting(lobes, material.shininess, plain))
    }

    fn note_keys(&mut self, tracks: &MaterialTracks) {
        // Emission has keys of its own.
        let emission =
            crate::appearance::material::LobeTracks { strength: 0.0.into(), tint: Rgb::ONE.into() };
        if (MaterialTracks { emission, ..tracks.clone() }).is_keyed() {
            self.left_out.note_of("keys besides those of emission", "material");
        }
    }
}

/// A diffuse surface that also mirrors or shines.
fn reflecting(lobes: &Lobes, shininess: Exponent, plain: Surface) -> Surface {
    let mirror = mean(lobes.mirror);
    if mirror == 0.0 && lobes.specular == Rgb::ZERO {
        return plain;
    }
    let roughness = match mirror > 0.0 {
        true => lobes.fuzz.sqrt(),
        false => highlight_roughness(shininess),
    };
    // A boundary reflects little at normal incidence. Stronger mirrors are metals.
    const MOST_OF_A_BOUNDARY: f32 = 0.17;
    if mirror <= MOST_OF_A_BOUNDARY {
        let share = f64::from(if mirror > 0.0 { mirror } else { 0.04 }).sqrt();
        return Surface { roughness, ior: (1.0 + share) / (1.0 - share), ..plain };
    }
    let base = lobes.diffuse + lobes.mirror;
    Surface { base, metallic: mirror / (mirror + mean(lobes.diffuse)), roughness, ior: 1.5, ..plain }
}

/// The parameters of a metallic-roughness material, and the share of light that passes instead.
fn microfacet(material: &Material) -> Surface {
    let (lobes, ior) = (&material.lobes, material.medium.ior.max(1.0));
    let Lobes { base, metallic, roughness, microfacet, .. } = *lobes;
    let surface = Surface { base, metallic, roughness, ior, transmission: 0.0, is_solid: false };
    let refracted = mean(lobes.refraction);
    if refracted > 0.0 {
        // Both parts have the tint of the base colour.
        let strongest = lobes.refraction.max_element();
        return Surface { transmission: strongest / (strongest + microfacet), is_solid: true, ..surface };
    }
    let passed = mean(lobes.transparency);
    if passed == 0.0 {
        return surface;
    }
    let reflected = ((ior - 1.0) / (ior + 1.0)) as f32;
    let passing = (lobes.transparency.max_element() / (1.0 - reflected * reflected)).min(1.0);
    let base = if passing < 1.0 { base / (1.0 - passing) } else { lobes.transparency };
    Surface { base, transmission: passing, ..surface }
}

/// The roughness of microfacets with about the highlight of an exponent n: their slope α is sqrt(2 / (n + 2)) (Walter et
/// al. 2007, *Microfacet models for refraction through rough surfaces*), and the roughness is its root.
fn highlight_roughness(shininess: Exponent) -> f32 {
    let n = match shininess {
        Exponent::Whole(n) => f64::from(n),
        Exponent::Real(n) => n,
    };
    (2.0 / (n + 2.0)).sqrt().sqrt() as f32
}

fn mean(color: Rgb) -> f32 {
    color.element_sum() / 3.0
}

/// The texture of the base colour.
fn base_texture(tracks: &MaterialTracks) -> &TextureTracks {
    let strong =
        |lobe: &crate::appearance::material::LobeTracks| lobe.strength.values().any(|value| *value > 0.0);
    if tracks.microfacet.values().any(|value| *value > 0.0) {
        &tracks.base
    } else if strong(&tracks.refraction) {
        &tracks.refraction.tint
    } else if strong(&tracks.diffuse) || !strong(&tracks.mirror) {
        &tracks.diffuse.tint
    } else {
        &tracks.mirror.tint
    }
}

/// Whether the colours of vertices multiply a texture.
fn shows_colors(texture: &TextureTracks) -> bool {
    match texture {
        TextureTracks::VertexColor => true,
        TextureTracks::Product(factors) => factors.iter().any(shows_colors),
        TextureTracks::Cutout(texture, _) => shows_colors(texture),
        TextureTracks::Color(_)
        | TextureTracks::Data(_)
        | TextureTracks::Image(_)
        | TextureTracks::Pattern(_) => false,
    }
}

/// The emission of a material over time.
struct Shine<'a> {
    factor: Rgb,
    weight: GroupWeight,
    tint: &'a TextureTracks,
}

impl<'a> Shine<'a> {
    fn of(tracks: &'a MaterialTracks) -> Self {
        let (factor, weight) = tracks.emission_split();
        Self { factor, weight, tint: &tracks.emission.tint }
    }

    /// The factor of emission at a time, without its image.
    fn at(&self, time: Time) -> DVec3 {
        let tint = match self.tint {
            TextureTracks::Color(_) => Rgb::ONE,
            texture => texture.at(time).constant().unwrap_or(Rgb::ONE),
        };
        (self.factor * self.weight.at(time) * tint).as_dvec3()
    }

    fn is_keyed(&self) -> bool {
        !self.weight.is_constant()
    }

    /// The strongest emission of all frames.
    fn peak(&self, timeline: &crate::base::time::Timeline) -> DVec3 {
        let frames = if self.is_keyed() { timeline.frames } else { 1 };
        let all = (0..frames).map(|frame| self.at(timeline.clock(frame).time));
        all.fold(DVec3::ZERO, |most, next| if next.max_element() > most.max_element() { next } else { most })
    }
}
