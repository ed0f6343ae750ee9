//! Images as textures.

use super::Exporter;
use crate::appearance::texture::{Image, ImageTextureTracks, TextureFilter, TextureTracks, Wrap};
use crate::base::color::{Rgb, linear_to_srgb};
use crate::base::math::{DVec2, DVec3};
use crate::encode::{Picture, png_bytes};
use serde_json::{Value, json};

/// A texture as glTF has it: an image times factors.
pub struct Flattened {
    pub factor: Rgb,
    pub image: Option<Value>,
    pub alpha: f64,
    pub has_alpha: bool,
    /// Where alpha is below this, there is no surface.
    pub cutoff: Option<f32>,
}

impl Exporter<'_> {
    /// A texture as one image and factors. Constant parts of materials are in their lobes, not here.
    pub fn flattened(&mut self, texture: &TextureTracks) -> Flattened {
        let mut flat = Flattened {
            factor: Rgb::ONE,
            image: None,
            alpha: 1.0,
            has_alpha: texture.has_alpha(),
            cutoff: None,
        };
        let start = self.sequence.timeline.clock(0).time;
        // A texture of one colour is a part of the lobe.
        if texture.at(start).constant().is_none() {
            self.flatten(texture, &mut flat);
        }
        flat
    }

    /// The image of a texture that is only that.
    pub fn picture_of(&mut self, texture: &TextureTracks) -> Option<Value> {
        self.flattened(texture).image
    }

    fn flatten(&mut self, texture: &TextureTracks, into: &mut Flattened) {
        let start = self.sequence.timeline.clock(0).time;
        match texture {
            TextureTracks::Color(color) => into.factor *= color.at(start).max(Rgb::ZERO),
            // The attribute of the mesh multiplies.
            TextureTracks::VertexColor => {}
            TextureTracks::Product(factors) => factors.iter().for_each(|factor| self.flatten(factor, into)),
            TextureTracks::Cutout(texture, cutoff) => {
                into.cutoff = Some(*cutoff);
                self.flatten(texture, into);
            }
            TextureTracks::Image(tracks) => {
                into.factor *= tracks.tint.at(start).max(Rgb::ZERO);
                if let Some((color, alpha)) = single(&tracks.image) {
                    into.factor *= color;
                    into.alpha *= if tracks.alpha { f64::from(alpha) } else { 1.0 };
                } else if into.image.is_none() {
                    into.image = self.image_texture(tracks, true);
                } else {
                    self.left_out.note_of("all but the first image", "material");
                }
            }
            TextureTracks::Pattern(tracks) => {
                self.left_out.note_of("the pattern", "material");
                let part = |texture: &TextureTracks| texture.at(start).constant().unwrap_or(Rgb::splat(0.5));
                into.factor *= (part(&tracks.first) + part(&tracks.second)) * 0.5;
            }
            TextureTracks::Data(_) => {
                self.left_out.note_of("the colours of data", "material");
                into.factor *= Rgb::splat(0.5);
            }
        }
    }

    /// Adds an image as a texture, in sRGB or with linear numbers.
    pub fn image_texture(&mut self, tracks: &ImageTextureTracks, srgb: bool) -> Option<Value> {
        let start = self.sequence.timeline.clock(0).time;
        let bytes = png_bytes(&picture(&tracks.image, srgb)).ok()?;
        let view = self.document.view(&bytes, None);
        let image = self.document.push("images", json!({ "bufferView": view, "mimeType": "image/png" }));
        let [across, up] = tracks.axis_wraps.unwrap_or([tracks.wrap.unwrap_or_default(); 2]);
        let filter = if tracks.filter == TextureFilter::Nearest { 9728 } else { 9729 };
        let sampler = json!({ "magFilter": filter, "wrapS": code(across), "wrapT": code(up) });
        let sampler = self.document.push("samplers", sampler);
        let texture = self.document.push("textures", json!({ "source": image, "sampler": sampler }));
        let mut info = json!({ "index": texture });
        let mapping = tracks.mapping.at(start);
        let at = |x: f64, y: f64| {
            let point = mapping.local_point(DVec3::new(x, y, 0.0)).0;
            DVec2::new(point.x, point.y)
        };
        match transform([at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0)]) {
            Some(None) => {}
            Some(Some(transform)) => {
                let name = self.document.uses("KHR_texture_transform");
                info["extensions"] = json!({ name: transform });
            }
            None => self.left_out.note_of("the shear of textures", "material"),
        }
        Some(info)
    }
}

/// The colour and the alpha of an image of one texel.
fn single(image: &Image) -> Option<(Rgb, f32)> {
    (image.width() == 1 && image.height() == 1).then(|| (image.texel(0, 0), image.alpha(0, 0)))
}

/// An image with 8 bits per channel.
fn picture(image: &Image, srgb: bool) -> Picture {
    let code = |part: f32| {
        let linear = f64::from(part).clamp(0.0, 1.0);
        let shown = if srgb { linear_to_srgb(linear) } else { linear };
        (shown * 255.0 + 0.5) as u8
    };
    let places = || (0..image.height()).flat_map(|y| (0..image.width()).map(move |x| (x, y)));
    let rgb = places().flat_map(|(x, y)| image.texel(x, y).to_array().map(code)).collect();
    let alpha = |(x, y)| (image.alpha(x, y) * 255.0 + 0.5) as u8;
    let alpha = image.has_alpha().then(|| places().map(alpha).collect());
    Picture { width: image.width(), height: image.height(), rgb, alpha }
}

fn code(wrap: Wrap) -> u32 {
    match wrap {
        Wrap::Repeat => 10497,
        Wrap::Mirror => 33648,
        Wrap::Clamp => 33071,
    }
}

/// The largest difference of coordinates that counts as none.
const SAME: f64 = 1e-9;

/// `KHR_texture_transform` of a map that takes (0, 0), (1, 0) and (0, 1) to these points, with v upwards: a scale, then a
/// rotation, then an offset. The inner option is none for the identity, the outer one for maps that shear.
fn transform([origin, u, v]: [DVec2; 3]) -> Option<Option<Value>> {
    let (along_u, along_v) = (u - origin, v - origin);
    // With v downwards on both sides.
    let columns = [DVec2::new(along_u.x, -along_u.y), DVec2::new(-along_v.x, along_v.y)];
    let offset = DVec2::new(along_v.x + origin.x, 1.0 - along_v.y - origin.y);
    let angle = libm::atan2(-columns[0].y, columns[0].x);
    let (s, c) = libm::sincos(angle);
    let scale = DVec2::new(columns[0].length(), columns[1].x * s + columns[1].y * c);
    let sheared = (columns[1].x * c - columns[1].y * s).abs() > SAME * (1.0 + scale.y.abs());
    let same = |a: f64, b: f64| (a - b).abs() <= SAME;
    let is_identity = same(angle, 0.0)
        && same(scale.x, 1.0)
        && same(scale.y, 1.0)
        && same(offset.x, 0.0)
        && same(offset.y, 0.0);
    let given = || json!({ "offset": offset.to_array(), "rotation": angle, "scale": scale.to_array() });
    if sheared { None } else { Some((!is_identity).then(given)) }
}
