//! Translates the materials of a mesh's file into Kinora's.

use super::fault::Fault;
use super::material_description::{MaterialDescription, MeshMaterials};
use super::node::Node;
use super::suggest::shortened;
use crate::appearance::material::Highlight;
use crate::appearance::optics::Fresnel;
use crate::appearance::texture::{
    ColorEncoding, ImageTextureTracks, TextureFilter, TextureMappingTracks, TextureTracks, Wrap,
};
use crate::base::color::Rgb;
use crate::base::math::DVec2;
use crate::geometry::mesh::Map;
use crate::geometry::mesh::{MtlMaterial, TriangleMesh};
use std::ops::Range;
use std::path::Path;

/// The materials of a mesh whose object names none: those of its file with their names, or its vertex colours. Returns
/// None if a library or an image cannot be read, and reports that at `place`.
pub fn mesh_materials(node: Node<'_>, place: &Range<usize>, mesh: &TriangleMesh) -> Option<MeshMaterials> {
    if let Some(why) = mesh.materials().iter().find_map(|material| material.missing.as_ref()) {
        let fault = Fault::new(place.clone(), "cannot read the materials of the mesh", why);
        node.fault(fault.help("an object with a `material` does not need them"));
        return None;
    }
    let color = mesh.has_colors().then_some(TextureTracks::VertexColor);
    let bare = MaterialDescription { color, ..MaterialDescription::default() };
    let slots = mesh.materials().iter().map(|material| {
        let image = match &material.diffuse_map {
            Some(map) => Some(diffuse_map(node, place, &material.name, map)?),
            None => None,
        };
        Some((material.name.clone(), translated(material, image, &bare)))
    });
    // Reads all of them, so that every missing image is reported.
    let slots: Vec<_> = slots.collect();
    let mut given = slots.into_iter().collect::<Option<Vec<_>>>()?;
    given.push((String::new(), bare));
    Some(given.into())
}

fn diffuse_map(
    node: Node<'_>,
    place: &Range<usize>,
    material: &str,
    map: &Map,
) -> Option<ImageTextureTracks> {
    let image = match node.file.images.image(&map.file, ColorEncoding::Srgb) {
        Ok(image) => image,
        Err(why) => {
            let name = Path::new(&map.file).file_name().unwrap_or_default().to_string_lossy();
            let title = format!("cannot read the image {:?} of the mesh", shortened(&name));
            let help = format!("material {:?} names it, relative to the mesh's folder", shortened(material));
            node.fault(Fault::new(place.clone(), title, why.to_string()).help(help));
            return None;
        }
    };
    Some(ImageTextureTracks {
        image,
        wrap: map.clamps.then_some(Wrap::Clamp),
        axis_wraps: None,
        filter: TextureFilter::default(),
        channel: None,
        tint: Rgb::ONE.into(),
        alpha: true,
        mapping: placement(map),
    })
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

/// Follows the illumination models of the format's description (Wavefront, *Advanced Visualizer*, appendix B2).
/// Highlights are Blinn's. Models from 3 on also mirror; 6 and 7 refract, 7 with Fresnel's equations.
fn translated(
    material: &MtlMaterial,
    image: Option<ImageTextureTracks>,
    bare: &MaterialDescription,
) -> MaterialDescription {
    let model = material.model.unwrap_or(2);
    let opacity = f64::from(material.opacity.unwrap_or(1.0));
    let refracts = matches!(model, 6 | 7);
    let tinted = |color: Option<Rgb>| match (&image, color) {
        (Some(image), color) => {
            let tint = color.unwrap_or(Rgb::ONE).max(Rgb::ZERO).into();
            Some(TextureTracks::Image(Box::new(ImageTextureTracks { tint, ..image.clone() })))
        }
        (None, color) => color.map(|color| color.max(Rgb::ZERO).into()),
    };
    let mut given = bare.clone();
    given.color = tinted(material.diffuse).or(given.color);
    if given.color.is_some() || opacity < 1.0 {
        given.diffuse.strength = Some(opacity.into());
    }
    if let Some(ambient) = material.effective_ambient() {
        (given.ambient.strength, given.ambient.tint) = (Some(opacity.into()), tinted(Some(ambient)));
    } else if opacity < 1.0 {
        // If the file gives no ambient colour, the default material's share applies to the opaque part.
        given.ambient.tint = tinted(material.diffuse.map(|color| color * opacity as f32));
    }
    if let Some(specular) = material.specular {
        let lobe = |there: bool| if there { 1.0 } else { 0.0 };
        let tint = Some(TextureTracks::from(specular.max(Rgb::ZERO)));
        (given.specular.strength, given.specular.tint) = (Some(lobe(model >= 2).into()), tint.clone());
        (given.mirror.strength, given.mirror.tint) = (Some(lobe(model >= 3).into()), tint);
        given.highlight = Some(Highlight::BlinnPhong);
    }
    if let Some(emission) = material.emission {
        let tint = emission.max(Rgb::ZERO).into();
        (given.emission.strength, given.emission.tint) = (Some(1.0.into()), Some(tint));
    }
    if refracts {
        let share = material.opacity.map_or(1.0, |_| 1.0 - opacity);
        given.refraction.strength = Some(share.into());
        given.fresnel = (model == 7).then_some(Fresnel::Exact);
    } else if opacity < 1.0 {
        given.transparency.strength = Some((1.0 - opacity).into());
    }
    given.shininess = material.shininess.map(|value| f64::from(value).into());
    given.ior = material.ior.map(|ior| f64::from(ior).into());
    given
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::appearance::material::MaterialTracks;
    use crate::base::math::DVec3;
    use crate::base::time::Time;
    use crate::import;

    fn tracks(text: &str) -> MaterialTracks {
        let material = import::mtl::read(text.as_bytes()).expect("a material").remove(0);
        translated(&material, None, &MaterialDescription::default()).over(&MaterialDescription::default())
    }

    #[test]
    fn values_become_lobes() {
        let m = tracks("newmtl a\nKd 0.8 0.1 0\nKa 0.2 0 0\nKs 0.5 0.5 0.5\nNs 90\nKe 0 0 2\nillum 2");
        assert_eq!((&m.diffuse.strength, &m.diffuse.tint), (&1.0.into(), &Rgb::new(0.8, 0.1, 0.0).into()));
        assert_eq!((&m.ambient.strength, &m.ambient.tint), (&1.0.into(), &Rgb::new(0.2, 0.0, 0.0).into()));
        assert_eq!((&m.specular.strength, &m.specular.tint), (&1.0.into(), &Rgb::splat(0.5).into()));
        assert_eq!((&m.emission.strength, &m.emission.tint), (&1.0.into(), &Rgb::new(0.0, 0.0, 2.0).into()));
        assert_eq!((m.shininess, m.highlight), (90.0.into(), Highlight::BlinnPhong));
        assert_eq!((m.mirror.strength, m.transparency.strength), (0.0.into(), 0.0.into()));
    }

    #[test]
    fn illumination_models_select_lobes() {
        let m = tracks("newmtl matte\nKd 1 1 1\nKs 1 1 1\nillum 1");
        assert_eq!((m.specular.strength, m.mirror.strength), (0.0.into(), 0.0.into()));
        let m = tracks("newmtl mirror\nKs 0.9 0.9 0.9\nillum 3");
        assert_eq!((m.mirror.strength, m.mirror.tint), (1.0.into(), Rgb::splat(0.9).into()));
        let m = tracks("newmtl veil\nKd 1 1 1\nd 0.25");
        assert_eq!((m.diffuse.strength, m.transparency.strength), (0.25.into(), 0.75.into()));
        let m = tracks("newmtl glass\nKd 0 0 0\nNi 1.4\nd 0\nillum 7");
        assert_eq!((m.diffuse.strength, m.refraction.strength), (0.0.into(), 1.0.into()));
        assert_eq!(m.fresnel, Fresnel::Exact);
        assert_eq!(m.transparency.strength, 0.0.into());
    }

    #[test]
    fn absent_ambient_light_is_the_default_share_of_the_opaque_part() {
        let m = tracks("newmtl a\nKa 1 1 1\nKd 0.8 0.4 0");
        assert_eq!((&m.ambient.strength, &m.ambient.tint), (&0.1.into(), &Rgb::new(0.8, 0.4, 0.0).into()));
        let m = tracks("newmtl a\nKa 1 1 1\nKd 0.8 0.4 0\nd 0.5");
        assert_eq!((&m.ambient.strength, &m.ambient.tint), (&0.1.into(), &Rgb::new(0.4, 0.2, 0.0).into()));
    }

    #[test]
    fn options_place_images() {
        let text = "newmtl a\nmap_Kd -s 2 -4 1 -o 0.5 0.25 0 a.png";
        let material = import::mtl::read(text.as_bytes()).expect("a material").remove(0);
        let placed = placement(material.diffuse_map.as_ref().expect("an image")).at(Time::from_integer(0));
        let (at, _) = placed.local(DVec3::new(0.75, 0.5, 0.0), DVec3::ZERO);
        assert_eq!(at, DVec3::new(2.0 * 0.75 + 0.5, -4.0 * 0.5 + 0.25, 0.0));
    }

    #[test]
    fn absent_values_are_the_default() {
        let m = tracks("newmtl nothing");
        assert_eq!(m, MaterialDescription::default().over(&MaterialDescription::default()));
    }
}
