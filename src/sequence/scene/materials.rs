//! Translates the materials of a glTF file into Kinora's.

use crate::appearance::material::{ReliefTracks, ScalarTextureTracks};
use crate::appearance::optics::Fresnel;
use crate::appearance::texture::{
    ColorChannel, ColorEncoding, Image, ImageTextureTracks, SharedAsset, TextureMappingTracks, TextureTracks,
};
use crate::base::color::Rgb;
use crate::base::math::DVec3;
use crate::import::gltf::{AlphaMode, GltfMaterial, GltfScene, GltfTexture, ImageBytes, Volume};
use crate::sequence::fault::Fault;
use crate::sequence::material_description::{LobeDescription, MaterialDescription, MeshMaterials};
use crate::sequence::node::Node;
use crate::sequence::suggest::shortened;
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::path::PathBuf;
use std::rc::Rc;

/// The materials of a scene with their names, then the one of meshes without a material. Returns None if an image
/// cannot be read, and reports each of these at `place`.
pub fn materials(node: Node<'_>, place: &Range<usize>, scene: &GltfScene) -> Option<MeshMaterials> {
    let mut images = Images { node, place, scene, read: HashMap::new() };
    // Reads all of them, so that every wrong image is reported.
    let shown: HashSet<usize> =
        scene.meshes.iter().flatten().flat_map(|mesh| mesh.materials.iter().copied()).collect();
    let described = |(index, material): (usize, &GltfMaterial)| {
        // Nothing shows the others, so their images need not be read.
        let description = match shown.contains(&index) {
            true => described(material, &mut images)?,
            false => MaterialDescription::bare(),
        };
        Some((material.name.clone(), description))
    };
    let all: Vec<_> = scene.materials.iter().enumerate().map(described).collect();
    all.into_iter().collect::<Option<Vec<_>>>().map(Rc::from)
}

/// The images of a scene, each decoded once for each meaning of its numbers.
struct Images<'a> {
    node: Node<'a>,
    place: &'a Range<usize>,
    scene: &'a GltfScene,
    read: HashMap<(ImageKey, ColorEncoding), Option<SharedAsset<Image>>>,
}

/// What is the same for images of the same bytes.
#[derive(PartialEq, Eq, Hash)]
enum ImageKey {
    File(PathBuf),
    /// The address of bytes, which images share.
    Given(*const u8),
}

impl ImageKey {
    fn of(bytes: &ImageBytes) -> Self {
        match bytes {
            ImageBytes::File(path) => Self::File(path.clone()),
            ImageBytes::Given(bytes) => Self::Given(bytes.as_ptr()),
        }
    }
}

impl Images<'_> {
    fn image(&mut self, index: usize, encoding: ColorEncoding) -> Option<SharedAsset<Image>> {
        let key = (ImageKey::of(&self.scene.images[index].bytes), encoding);
        if let Some(known) = self.read.get(&key) {
            return known.clone();
        }
        let image = self.decoded(index, encoding);
        self.read.insert(key, image.clone());
        image
    }

    fn decoded(&self, index: usize, encoding: ColorEncoding) -> Option<SharedAsset<Image>> {
        let image = &self.scene.images[index];
        let decoded = match &image.bytes {
            ImageBytes::File(path) => {
                self.node.file.images.image(&path.to_string_lossy(), encoding).map_err(|why| why.to_string())
            }
            ImageBytes::Given(bytes) => {
                Image::decode(bytes, encoding).map(SharedAsset::new).map_err(|why| why.to_string())
            }
        };
        let report = |why: String| {
            let title = format!("cannot read the image {:?} of the scene", shortened(&image.name));
            self.node.fault(Fault::new(self.place.clone(), title, why));
        };
        decoded.map_err(report).ok()
    }

    /// A texture of linear numbers, or of colours. Its alpha has no meaning.
    fn texture(&mut self, given: &GltfTexture, encoding: ColorEncoding) -> Option<ImageTextureTracks> {
        Some(ImageTextureTracks {
            image: self.image(given.image, encoding)?,
            wrap: None,
            axis_wraps: Some(given.wrap),
            filter: given.filter,
            channel: None,
            tint: Rgb::ONE.into(),
            alpha: false,
            mapping: TextureMappingTracks { first: given.transform, ..TextureMappingTracks::default() },
        })
    }
}

fn described(given: &GltfMaterial, images: &mut Images<'_>) -> Option<MaterialDescription> {
    // All textures are read, so that every wrong image is reported.
    let (base, emission) = (base(given, images), emission(given, images));
    let relief = relief(given, images);
    let texture = &given.metallic_roughness_texture;
    let metallic = level(texture, given.metallic, ColorChannel::B, images);
    let roughness = level(texture, given.roughness, ColorChannel::G, images);
    let coat = level(&given.coat.share_texture, given.coat.share, ColorChannel::R, images);
    let coat_roughness = level(&given.coat.roughness_texture, given.coat.roughness, ColorChannel::G, images);
    let (base, emission, metallic, roughness) = (base?, emission?, metallic?, roughness?);
    let (coat, coat_roughness) = (coat?, coat_roughness?);
    let relief = relief?;
    let bare = MaterialDescription {
        color: Some(base.clone()),
        ior: Some(given.ior.into()),
        absorption: Some(Rgb::ZERO.into()),
        ..MaterialDescription::bare()
    };
    if given.unlit {
        return Some(MaterialDescription { emission: LobeDescription::of_strength(1.0), ..bare });
    }
    let surface = MaterialDescription {
        microfacet: Some(1.0.into()),
        metallic: Some(metallic),
        roughness: Some(roughness),
        coat: Some(coat),
        coat_roughness: Some(coat_roughness),
        emission,
        relief,
        ..bare
    };
    // Metals transmit nothing.
    let passing = given.transmission * (1.0 - given.metallic);
    Some(if passing > 0.0 { transmitting(surface, given, passing, base) } else { surface })
}

/// Adds the light that passes: refracted by a body, or straight on by a thin sheet.
fn transmitting(
    surface: MaterialDescription,
    given: &GltfMaterial,
    passing: f64,
    base: TextureTracks,
) -> MaterialDescription {
    let lobe = |strength: f64| LobeDescription { strength: Some(strength.into()), tint: Some(base.clone()) };
    match given.volume {
        // Fresnel's equations share the light between refraction and reflection.
        Some(volume) => MaterialDescription {
            microfacet: Some((1.0 - passing).into()),
            refraction: lobe(passing),
            fresnel: Some(Fresnel::Exact),
            absorption: Some(absorption(volume).into()),
            ..surface
        },
        // The sheet reflects as before. What is not reflected from the front passes instead of being scattered.
        None => {
            let reflected = (given.ior - 1.0) / (given.ior + 1.0);
            let scattered = TextureTracks::from(Rgb::splat((1.0 - passing) as f32));
            MaterialDescription {
                transparency: lobe(passing * (1.0 - reflected * reflected)),
                color: Some(TextureTracks::Product(Box::new([base.clone(), scattered]))),
                ..surface
            }
        }
    }
}

/// The absorption after which the colour of the volume is left at its distance.
fn absorption(Volume { color, distance }: Volume) -> Rgb {
    let channel = |share: f64| (-libm::log(share.clamp(1e-30, 1.0)) / distance) as f32;
    // Clear volumes have an infinite distance.
    Rgb::new(channel(color.x), channel(color.y), channel(color.z))
}

/// The base colour: its factor, its image and the vertex colours, with alpha as far as it has a meaning.
fn base(given: &GltfMaterial, images: &mut Images<'_>) -> Option<TextureTracks> {
    let [r, g, b, alpha] = given.base;
    let factor = DVec3::new(r, g, b).as_vec3();
    let with_alpha = given.alpha != AlphaMode::Opaque;
    let mut color = match &given.base_texture {
        Some(texture) => {
            let texture = images.texture(texture, ColorEncoding::Srgb)?;
            let tinted = ImageTextureTracks { tint: factor.into(), alpha: with_alpha, ..texture };
            TextureTracks::Image(Box::new(tinted))
        }
        None => factor.into(),
    };
    if given.vertex_colors {
        color = TextureTracks::Product(Box::new([color, TextureTracks::VertexColor]));
    }
    if with_alpha && alpha < 1.0 {
        color = TextureTracks::Product(Box::new([color, veil(alpha)?]));
    }
    Some(match given.alpha {
        AlphaMode::Mask(cutoff) => TextureTracks::Cutout(Box::new(color), cutoff as f32),
        _ => color,
    })
}

/// A white texture with the same alpha everywhere.
fn veil(alpha: f64) -> Option<TextureTracks> {
    let image = Image::new(1, 1, vec![Rgb::ONE])?.with_alpha(vec![alpha as f32])?;
    Some(TextureTracks::Image(Box::new(ImageTextureTracks {
        image: SharedAsset::new(image),
        wrap: None,
        axis_wraps: None,
        filter: Default::default(),
        channel: None,
        tint: Rgb::ONE.into(),
        alpha: true,
        mapping: TextureMappingTracks::default(),
    })))
}

/// The map of normals, if there is one.
fn relief(given: &GltfMaterial, images: &mut Images<'_>) -> Option<Option<ReliefTracks>> {
    let Some((texture, scale)) = &given.normal_texture else { return Some(None) };
    let map = TextureTracks::Image(Box::new(images.texture(texture, ColorEncoding::Linear)?));
    Some(Some(ReliefTracks::NormalMap { map, strength: (*scale).into() }))
}

fn emission(given: &GltfMaterial, images: &mut Images<'_>) -> Option<LobeDescription> {
    let factor = given.emissive.as_vec3();
    let texture = given.emissive_texture.as_ref().filter(|_| given.emissive != DVec3::ZERO);
    let tint = match texture {
        Some(texture) => {
            let texture = images.texture(texture, ColorEncoding::Srgb)?;
            TextureTracks::Image(Box::new(ImageTextureTracks { tint: factor.into(), ..texture }))
        }
        None => factor.into(),
    };
    let strength = if given.emissive == DVec3::ZERO { 0.0 } else { 1.0 };
    Some(LobeDescription { strength: Some(strength.into()), tint: Some(tint) })
}

/// A number that a channel of an image multiplies.
fn level(
    texture: &Option<GltfTexture>,
    factor: f64,
    channel: ColorChannel,
    images: &mut Images<'_>,
) -> Option<ScalarTextureTracks> {
    let image = match texture {
        Some(texture) => Some(images.texture(texture, ColorEncoding::Linear)?),
        None => None,
    };
    let image = image.map(|image| ImageTextureTracks { channel: Some(channel), ..image });
    Some(ScalarTextureTracks::scaled(image, factor))
}
