//! Textures: an image, a sampler and a transform of the texture coordinates.

use super::GltfResult;
use super::features::LeftOut;
use super::json::Item;
use crate::appearance::texture::{TextureFilter, Wrap};
use crate::base::math::{DMat3, DVec3};

/// A texture of a material.
#[derive(Clone, Debug, PartialEq)]
pub struct GltfTexture {
    /// The index of its image.
    pub image: usize,
    /// Beyond the edges, across and upwards.
    pub wrap: [Wrap; 2],
    pub filter: TextureFilter,
    /// The number of the texture coordinates.
    pub coordinates: u64,
    /// The map (u, v, 1) → (u, v, 1) before the image is looked up, with v upwards; none if it is the identity.
    pub transform: Option<DMat3>,
}

/// Reads a texture of a material. None if there is none, or if it has no image that Kinora can read, which is noted.
pub fn texture(
    (root, material): (&Item<'_>, &Item<'_>),
    key: &str,
    left_out: &mut LeftOut,
) -> GltfResult<Option<GltfTexture>> {
    let Some(info) = material.object(key)? else { return Ok(None) };
    let index = info.index("index", ("textures", root.len_of("textures")))?;
    let index = index.ok_or_else(|| info.error("it has no `index`"))?;
    let item = root.entry("textures", index)?;
    let Some(image) = item.index("source", ("images", root.len_of("images")))? else {
        left_out.note("textures without a PNG or JPEG image", "material");
        return Ok(None);
    };
    let (wrap, filter) = match item.index("sampler", ("samplers", root.len_of("samplers")))? {
        Some(sampler) => self::sampler(&root.entry("samplers", sampler)?)?,
        None => ([Wrap::Repeat; 2], TextureFilter::Bilinear),
    };
    let mut coordinates = info.whole("texCoord")?.unwrap_or(0);
    let mut transform = None;
    if let Some(item) = info.extension("KHR_texture_transform")? {
        coordinates = item.whole("texCoord")?.unwrap_or(coordinates);
        transform = self::transform(&item)?;
    }
    Ok(Some(GltfTexture { image, wrap, filter, coordinates, transform }))
}

fn sampler(item: &Item<'_>) -> GltfResult<([Wrap; 2], TextureFilter)> {
    let wrap = |key| match item.whole(key)? {
        None | Some(10497) => Ok(Wrap::Repeat),
        Some(33648) => Ok(Wrap::Mirror),
        Some(33071) => Ok(Wrap::Clamp),
        Some(_) => Err(item.error(format!("its `{key}` is none of 10497, 33648 and 33071"))),
    };
    let nearest = item.whole("magFilter")? == Some(9728);
    let filter = if nearest { TextureFilter::Nearest } else { TextureFilter::Bilinear };
    Ok(([wrap("wrapS")?, wrap("wrapT")?], filter))
}

/// The smallest scale of a texture.
const TINY: f64 = 1e-9;

/// The transform: scaled, then rotated counterclockwise on the picture, then moved.
///
/// With v downwards, as in glTF, (u, v) becomes offset + (c u' + s v', c v' - s u'), where (u', v') = scale · (u, v) and
/// c and s are the cosine and the sine of the angle. With v upwards, v is 1 - v on both sides.
fn transform(item: &Item<'_>) -> GltfResult<Option<DMat3>> {
    let [x, y] = item.numbers("offset")?.unwrap_or([0.0; 2]);
    // A map must be invertible. A tiny scale shows one point of the image, as 0 does.
    let [across, down] =
        item.numbers("scale")?.unwrap_or([1.0; 2]).map(|scale: f64| match scale.abs() < TINY {
            true => TINY,
            false => scale,
        });
    let angle = item.number("rotation", 0.0)?;
    let (s, c) = libm::sincos(angle);
    let flip = DMat3::from_cols(DVec3::X, DVec3::NEG_Y, DVec3::new(0.0, 1.0, 1.0));
    let down = DMat3::from_cols(
        DVec3::new(c * across, -s * across, 0.0),
        DVec3::new(s * down, c * down, 0.0),
        DVec3::new(x, y, 1.0),
    );
    let upwards = flip * down * flip;
    Ok((upwards != DMat3::IDENTITY).then_some(upwards))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// The first example of the extension: the lower left quadrant of the image, turned clockwise.
    #[test]
    fn the_example_of_the_specification_shows_the_lower_left_quadrant() {
        let value = json!({ "offset": [0, 1], "rotation": std::f64::consts::FRAC_PI_2, "scale": [0.5, 0.5] });
        let map = transform(&Item::root(&value)).expect("a transform").expect("not the identity");
        for (u, v) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
            let at = map * DVec3::new(u, v, 1.0);
            assert!((-1e-9..=0.5 + 1e-9).contains(&at.x) && (-1e-9..=0.5 + 1e-9).contains(&at.y), "{at}");
        }
        // The lower left corner of the surface shows the image's lower right of that quadrant.
        let corner = map * DVec3::new(0.0, 0.0, 1.0);
        assert!((corner - DVec3::new(0.5, 0.0, 1.0)).length() < 1e-9, "{corner}");
    }

    #[test]
    fn no_transform_is_no_map() {
        assert_eq!(transform(&Item::root(&json!({}))).expect("a transform"), None);
        let turned = json!({ "offset": [0, 1], "scale": [1, -1] });
        let map = transform(&Item::root(&turned)).expect("a transform").expect("a flip");
        assert_eq!(map * DVec3::new(0.25, 0.75, 1.0), DVec3::new(0.25, 0.25, 1.0));
    }
}
