//! Translates the materials of a mesh's file into Kinora's.

use super::fault::Fault;
use super::material_description::{LobeDescription, MaterialDescription, MeshMaterials};
use super::mtl_images::{MtlImageReader, MtlImages};
use super::node::Node;
use crate::appearance::material::{Highlight, ScalarTextureTracks};
use crate::appearance::optics::Fresnel;
use crate::appearance::texture::{ImageTextureTracks, TextureTracks};
use crate::base::color::Rgb;
use crate::base::math::Aabb;
use crate::geometry::mesh::{MtlMaterial, TriangleMesh};
use std::ops::Range;

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
    let Aabb { min, max } = mesh.bounds();
    let images = MtlImageReader { node, place, diagonal: (max - min).length(), masks: Default::default() };
    let slots = mesh.materials().iter().map(|material| {
        let images = images.read(material)?;
        Some((material.name.clone(), translated(material, images, &bare)))
    });
    // Reads all of them, so that every missing image is reported.
    let slots: Vec<_> = slots.collect();
    let mut given = slots.into_iter().collect::<Option<Vec<_>>>()?;
    given.push((String::new(), bare));
    Some(given.into())
}

/// Follows the illumination models of the format's description (Wavefront, *Advanced Visualizer*, appendix B2), or the
/// model with microfacets if any of its numbers is given. Highlights are Blinn's. Models from 3 on also mirror; 6 and 7
/// refract, 7 with Fresnel's equations.
fn translated(material: &MtlMaterial, images: MtlImages, bare: &MaterialDescription) -> MaterialDescription {
    let own = material.diffuse.map(|color| color.max(Rgb::ZERO));
    let color = paint(&images.diffuse, own).or_else(|| bare.color.clone());
    let mask = images.opacity.clone();
    let level = |number: f32| ScalarTextureTracks::scaled(None, number.into());
    let (coat, coat_roughness) = (material.coat.map(level), material.coat_roughness.map(level));
    let relief = images.relief.clone();
    let microfacets = material.roughness.is_some()
        || material.metallic.is_some()
        || images.roughness.is_some()
        || images.metallic.is_some();
    let surface = match microfacets {
        true => with_microfacets(material, images, color),
        false => by_model(material, &images, color, bare),
    };
    MaterialDescription { relief, mask, coat: coat.or(surface.coat), coat_roughness, ..surface }
}

/// An image in a colour. None without both.
fn paint(image: &Option<ImageTextureTracks>, color: Option<Rgb>) -> Option<TextureTracks> {
    match image {
        Some(image) => {
            let tint = color.unwrap_or(Rgb::ONE).into();
            Some(TextureTracks::Image(Box::new(ImageTextureTracks { tint, ..image.clone() })))
        }
        None => color.map(TextureTracks::from),
    }
}

/// What is emitted, if the file states it.
fn emission(material: &MtlMaterial, images: &MtlImages) -> Option<LobeDescription> {
    let color = material.emission.map(|emission| emission.max(Rgb::ZERO));
    let tint = paint(&images.emission, color)?;
    Some(LobeDescription { strength: Some(1.0.into()), tint: Some(tint) })
}

/// The roughness of a material that states only how metallic it is.
const ROUGHNESS: f32 = 0.5;

/// The metallic-roughness model.
fn with_microfacets(
    material: &MtlMaterial,
    images: MtlImages,
    color: Option<TextureTracks>,
) -> MaterialDescription {
    let emission = emission(material, &images);
    // An image multiplies the number, and is the number if there is none.
    let factor =
        |number: Option<f32>, image: bool, otherwise| number.unwrap_or(if image { 1.0 } else { otherwise });
    let roughness = factor(material.roughness, images.roughness.is_some(), ROUGHNESS);
    let metallic = factor(material.metallic, images.metallic.is_some(), 0.0);
    let opacity = f64::from(material.opacity.unwrap_or(1.0));
    let bare = MaterialDescription::bare();
    let passing = LobeDescription { strength: Some((1.0 - opacity).into()), tint: None };
    MaterialDescription {
        color,
        microfacet: Some(opacity.into()),
        metallic: Some(ScalarTextureTracks::scaled(images.metallic, metallic.into())),
        roughness: Some(ScalarTextureTracks::scaled(images.roughness, roughness.into())),
        emission: emission.unwrap_or(bare.emission),
        transparency: if opacity < 1.0 { passing } else { bare.transparency },
        ior: material.ior.map(|ior| f64::from(ior).into()),
        ..bare
    }
}

/// A material of one of the illumination models.
fn by_model(
    material: &MtlMaterial,
    images: &MtlImages,
    color: Option<TextureTracks>,
    bare: &MaterialDescription,
) -> MaterialDescription {
    let model = material.model.unwrap_or(2);
    let opacity = f64::from(material.opacity.unwrap_or(1.0));
    let refracts = matches!(model, 6 | 7);
    let ambient_image = images.ambient.as_ref().or(images.diffuse.as_ref()).cloned();
    let ambient_color = |color: Option<Rgb>| paint(&ambient_image, color.map(|color| color.max(Rgb::ZERO)));
    let mut given = bare.clone();
    given.color = color;
    if given.color.is_some() || opacity < 1.0 {
        given.diffuse.strength = Some(opacity.into());
    }
    if let Some(ambient) = material.effective_ambient() {
        (given.ambient.strength, given.ambient.tint) = (Some(opacity.into()), ambient_color(Some(ambient)));
    } else if opacity < 1.0 {
        // If the file gives no ambient colour, the default material's share applies to the opaque part.
        given.ambient.tint = ambient_color(material.diffuse.map(|color| color * opacity as f32));
    }
    if let Some(specular) = paint(&images.specular, material.specular.map(|color| color.max(Rgb::ZERO))) {
        let lobe = |there: bool| if there { 1.0 } else { 0.0 };
        let tint = Some(specular);
        (given.specular.strength, given.specular.tint) = (Some(lobe(model >= 2).into()), tint.clone());
        (given.mirror.strength, given.mirror.tint) = (Some(lobe(model >= 3).into()), tint);
        given.highlight = Some(Highlight::BlinnPhong);
    }
    if let Some(emission) = emission(material, images) {
        given.emission = emission;
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
    use crate::import;

    fn tracks(text: &str) -> MaterialTracks {
        let material = import::mtl::read(text.as_bytes()).expect("a material").remove(0);
        translated(&material, MtlImages::default(), &MaterialDescription::default())
            .over(&MaterialDescription::default())
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
    fn numbers_of_microfacets_choose_their_model() {
        let m = tracks(
            "newmtl a\nKd 0.8 0.4 0\nKs 1 1 1\nPr 0.25\nPm 0.75\nd 0.5\nNi 1.25\nPc 0.5\nPcr 0.125\nKe 0 2 0",
        );
        let number = |value: f64| ScalarTextureTracks::Constant(value.into());
        assert_eq!((&m.roughness, &m.metallic), (&number(0.25), &number(0.75)));
        assert_eq!((&m.coat, &m.coat_roughness), (&number(0.5), &number(0.125)));
        assert_eq!((&m.base, &m.microfacet), (&Rgb::new(0.8, 0.4, 0.0).into(), &0.5.into()));
        assert_eq!((&m.transparency.strength, &m.ior), (&0.5.into(), &1.25.into()));
        assert_eq!(
            (m.diffuse.strength, m.specular.strength, m.ambient.strength),
            (0.0.into(), 0.0.into(), 0.0.into())
        );
        assert_eq!(m.emission.tint, Rgb::new(0.0, 2.0, 0.0).into());
        assert_eq!(tracks("newmtl a\nPm 1").roughness, number(0.5));
        let coated = tracks("newmtl a\nKd 1 1 1\nPc 1");
        assert_eq!((coated.coat, coated.diffuse.strength), (number(1.0), 1.0.into()));
    }

    #[test]
    fn absent_values_are_the_default() {
        let m = tracks("newmtl nothing");
        assert_eq!(m, MaterialDescription::default().over(&MaterialDescription::default()));
    }
}
