//! The images that the materials of a mesh's file name.

use super::fault::Fault;
use super::node::Node;
use super::suggest::shortened;
use crate::appearance::material::ReliefTracks;
use crate::appearance::texture::{
    ColorChannel, ColorEncoding, Image, ImageTextureTracks, SharedAsset, TextureFilter, TextureMappingTracks,
    TextureTracks, Wrap,
};
use crate::base::color::Rgb;
use crate::base::math::{DVec2, DVec3};
use crate::geometry::mesh::{Map, MapChannel, MapUse, MtlMaterial};
use std::cell::RefCell;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::ops::Range;
use std::path::Path;

/// How high white is above black in an image of heights, for each `-bm`: a share of the diagonal of the mesh. The format
/// states no unit.
const BUMP_DEPTH: f64 = 0.01;

/// The images of a material by what they are for.
#[derive(Default)]
pub struct MtlImages {
    pub ambient: Option<ImageTextureTracks>,
    pub diffuse: Option<ImageTextureTracks>,
    pub specular: Option<ImageTextureTracks>,
    pub emission: Option<ImageTextureTracks>,
    /// White, with opacity as its alpha.
    pub opacity: Option<TextureTracks>,
    pub roughness: Option<ImageTextureTracks>,
    pub metallic: Option<ImageTextureTracks>,
    pub relief: Option<ReliefTracks>,
}

/// Reads images for the materials of a mesh.
pub struct MtlImageReader<'a, 's> {
    pub node: Node<'s>,
    /// Where the file names the mesh.
    pub place: &'a Range<usize>,
    /// The diagonal of the box around the mesh.
    pub diagonal: f64,
    /// The masks so far, by the files of their images and their channels: materials often share one.
    pub masks: RefCell<HashMap<(String, MapChannel), SharedAsset<Image>>>,
}

impl MtlImageReader<'_, '_> {
    /// Reads the images of a material. None if that of its colour cannot be read, which is a fault. Others are left out
    /// with a warning, since many libraries name images that were never handed on.
    pub fn read(&self, material: &MtlMaterial) -> Option<MtlImages> {
        let other = |usage, encoding| {
            let map = material.map(usage)?;
            match self.image(map, encoding) {
                Ok(image) => Some((map, image)),
                Err(why) => {
                    let warning = format!("left out of the mesh: the image {:?}: {why}", name(map));
                    self.node.file.warn(self.place.start, warning);
                    None
                }
            }
        };
        let color = |usage| other(usage, ColorEncoding::Srgb).map(|(map, image)| tracks(map, image, false));
        let level = |usage| {
            let (map, image) = other(usage, ColorEncoding::Linear)?;
            let channel = match map.channel {
                Some(MapChannel::Red) => Some(ColorChannel::R),
                Some(MapChannel::Green) => Some(ColorChannel::G),
                Some(MapChannel::Blue) => Some(ColorChannel::B),
                _ => None,
            };
            Some(ImageTextureTracks { channel, ..tracks(map, image, false) })
        };
        let diffuse = match material.map(MapUse::Diffuse) {
            Some(map) => Some(self.diffuse(&material.name, map)?),
            None => None,
        };
        let normals =
            || other(MapUse::Normal, ColorEncoding::Linear).map(|(map, image)| self.normals(map, image));
        let bump = || {
            let (map, image) = other(MapUse::Bump, ColorEncoding::Linear)?;
            // Several exporters write maps of normals under the name of maps of heights.
            if shows_normals(&image) {
                return Some(self.normals(map, image));
            }
            let height = TextureTracks::Image(Box::new(tracks(map, image, false)));
            Some(ReliefTracks::Bump { height, depth: (map.strength * BUMP_DEPTH * self.diagonal).into() })
        };
        Some(MtlImages {
            diffuse,
            ambient: color(MapUse::Ambient),
            specular: color(MapUse::Specular),
            emission: color(MapUse::Emission),
            opacity: other(MapUse::Opacity, ColorEncoding::Linear)
                .and_then(|(map, image)| self.mask(map, &image)),
            roughness: level(MapUse::Roughness),
            metallic: level(MapUse::Metallic),
            relief: normals().or_else(bump),
        })
    }

    fn image(&self, map: &Map, encoding: ColorEncoding) -> Result<SharedAsset<Image>, String> {
        self.node.file.images.image(&map.file, encoding).map_err(|why| why.to_string())
    }

    /// A map of normals. A negative `-bm`, which would turn the relief inside out, leaves it flat, with a warning.
    fn normals(&self, map: &Map, image: SharedAsset<Image>) -> ReliefTracks {
        if map.strength < 0.0 {
            let warning = format!("left out of the mesh: the negative `-bm` of the normals {:?}", name(map));
            self.node.file.warn(self.place.start, warning);
        }
        let strength = map.strength.max(0.0).into();
        ReliefTracks::NormalMap { map: TextureTracks::Image(Box::new(tracks(map, image, false))), strength }
    }

    /// White, with a channel of an image as its alpha: that of `-imfchan`, its alpha if it has any, or else its mean.
    fn mask(&self, map: &Map, image: &Image) -> Option<TextureTracks> {
        let otherwise = if image.has_alpha() { MapChannel::Alpha } else { MapChannel::Grey };
        let channel = map.channel.unwrap_or(otherwise);
        let mut masks = self.masks.borrow_mut();
        let mask = match masks.entry((map.file.clone(), channel)) {
            Entry::Occupied(known) => known.get().clone(),
            Entry::Vacant(new) => new.insert(SharedAsset::new(white_with(image, channel)?)).clone(),
        };
        Some(TextureTracks::Image(Box::new(tracks(map, mask, true))))
    }

    /// The image of the colour, whose alpha cuts holes.
    fn diffuse(&self, material: &str, map: &Map) -> Option<ImageTextureTracks> {
        match self.image(map, ColorEncoding::Srgb) {
            Ok(image) => Some(tracks(map, image, true)),
            Err(why) => {
                let title = format!("cannot read the image {:?} of the mesh", name(map));
                let help =
                    format!("material {:?} names it, relative to the mesh's folder", shortened(material));
                self.node.fault(Fault::new(self.place.clone(), title, why).help(help));
                None
            }
        }
    }
}

/// The name of an image in messages.
fn name(map: &Map) -> String {
    shortened(&Path::new(&map.file).file_name().unwrap_or_default().to_string_lossy())
}

fn tracks(map: &Map, image: SharedAsset<Image>, alpha: bool) -> ImageTextureTracks {
    ImageTextureTracks {
        image,
        wrap: map.clamps.then_some(Wrap::Clamp),
        axis_wraps: None,
        filter: TextureFilter::default(),
        channel: None,
        tint: Rgb::ONE.into(),
        alpha,
        mapping: placement(map),
    }
}

/// Whether an image holds normals: most of them point away from the surface, which is blue.
fn shows_normals(image: &Image) -> bool {
    // A few rows suffice, and many materials may name a large image.
    let rows = (0..image.height()).step_by(image.height().div_ceil(64) as usize);
    let texels = rows.flat_map(|y| (0..image.width()).map(move |x| image.texel(x, y).as_dvec3()));
    let (sum, count) = texels.fold((DVec3::ZERO, 0.0), |(sum, count), texel| (sum + texel, count + 1.0));
    sum.z > sum.x.max(sum.y) + BLUE * count
}

/// How much more blue than red and green is in the mean of normals. Level normals have 0.5.
const BLUE: f64 = 0.15;

/// A white image whose alpha is a channel of another one.
fn white_with(image: &Image, channel: MapChannel) -> Option<Image> {
    let places = (0..image.height()).flat_map(|y| (0..image.width()).map(move |x| (x, y)));
    let alpha = places.map(|(x, y)| {
        let texel = image.texel(x, y);
        match channel {
            MapChannel::Red => texel.x,
            MapChannel::Green => texel.y,
            MapChannel::Blue => texel.z,
            MapChannel::Alpha => image.alpha(x, y),
            MapChannel::Grey => texel.element_sum() / 3.0,
        }
        .clamp(0.0, 1.0)
    });
    let alpha: Vec<f32> = alpha.collect();
    Image::new(image.width(), image.height(), vec![Rgb::ONE; alpha.len()])?.with_alpha(alpha)
}

/// In MTL files, a larger scale shows more of the image, and the offset points from the surface to the image.
fn placement(Map { scale, offset, .. }: &Map) -> TextureMappingTracks {
    if (*scale, *offset) == (DVec2::ONE, DVec2::ZERO) {
        return TextureMappingTracks::default();
    }
    TextureMappingTracks {
        offset: (-*offset / *scale).extend(0.0).into(),
        scale: scale.recip().extend(1.0).into(),
        ..TextureMappingTracks::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::time::Time;
    use crate::import;

    #[test]
    fn options_place_images() {
        let text = "newmtl a\nmap_Kd -s 2 -4 1 -o 0.5 0.25 0 a.png";
        let material = import::mtl::read(text.as_bytes()).expect("a material").remove(0);
        let placed = placement(material.map(MapUse::Diffuse).expect("an image")).at(Time::from_integer(0));
        let (at, _) = placed.local_point(DVec3::new(0.75, 0.5, 0.0));
        assert_eq!(at, DVec3::new(2.0 * 0.75 + 0.5, -4.0 * 0.5 + 0.25, 0.0));
    }
}
