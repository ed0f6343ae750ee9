//! Decodes `materials` and `default_material`.

use super::colors::color;
use super::fault::Fault;
use super::fields::Fields;
use super::image::image;
use super::keys::keyed;
use super::material_description::{LobeDescription, MaterialDescription};
use super::node::Node;
use super::paint::{image_fields, paint, plain_image};
use super::suggest::nearest;
use super::values::{between, is_number, not_negative, number, one_of, positive, whole_number};
use super::words::{is_literal, variant};
use crate::appearance::material::{Highlight, ReliefTracks, ScalarTextureTracks};
use crate::appearance::optics::Fresnel;
use crate::appearance::texture::ColorEncoding;
use crate::base::color::Rgb;
use crate::track::Animated;

/// A word for a kind of material, and its decoder.
type Kind<'s> = (&'static str, fn(Node<'s>) -> Option<MaterialDescription>);

fn kinds<'s>() -> [Kind<'s>; 5] {
    [
        ("Lambertian", lambertian),
        ("Metal", metal),
        ("Dielectric", dielectric),
        ("MetallicRoughness", metallic_roughness),
        ("Unlit", unlit),
    ]
}

/// Whether a value looks like a material of any kind.
pub fn is_material(node: Node<'_>) -> bool {
    match node.bare_word() {
        Some(word) => kinds().iter().any(|(name, _)| *name == word),
        None => node.opens_with('(') || !node.word().is_empty(),
    }
}

/// Whether a word may be a misspelt kind of material.
pub fn resembles_a_kind(word: &str) -> bool {
    nearest(word, kinds().map(|(name, _)| name)).is_some()
}

/// Decodes a material: lobes in ( ), or one of the kinds.
pub fn material(node: Node<'_>) -> Option<MaterialDescription> {
    if node.opens_with('(') {
        return lobes(node);
    }
    if node.word().is_empty() {
        let fault = node.mismatch("the fields of a material in ( ), or a kind such as Metal( )");
        let quoted = kinds().iter().any(|(name, _)| node.text().trim_matches('"') == *name);
        node.fault(if quoted { fault.help("write it without quotes") } else { fault });
        return None;
    }
    variant(node, "kind of material", &kinds())
}

fn lobes(node: Node<'_>) -> Option<MaterialDescription> {
    let mut fields = Fields::of(node, "a material")?;
    let base = fields.optional("color", paint);
    let emission = lobe(&mut fields, "emission", "emission_color");
    let ambient = lobe(&mut fields, "ambient", "ambient_color");
    let diffuse = lobe(&mut fields, "diffuse", "diffuse_color");
    let specular = lobe(&mut fields, "specular", "specular_color");
    let shininess = fields.optional("shininess", keyed(not_negative));
    let highlights = &[("Phong", Highlight::Phong), ("BlinnPhong", Highlight::BlinnPhong)];
    let highlight = fields.optional("highlight", one_of("highlight", highlights));
    let mirror = lobe(&mut fields, "mirror", "mirror_color");
    let fuzz = fields.optional("fuzz", level);
    let transparency = lobe(&mut fields, "transparency", "transparency_color");
    let refraction = lobe(&mut fields, "refraction", "refraction_color");
    let fresnel = fields.optional("fresnel", fresnel);
    let (ior, absorption, priority) = medium(&mut fields);
    let relief = relief(&mut fields);
    let coated = coat(&mut fields, MaterialDescription::default());
    fields.finish();
    Some(MaterialDescription {
        relief: relief?,
        color: base?,
        emission: emission?,
        ambient: ambient?,
        diffuse: diffuse?,
        specular: specular?,
        shininess: shininess?,
        highlight: highlight?,
        mirror: mirror?,
        fuzz: fuzz?,
        transparency: transparency?,
        refraction: refraction?,
        fresnel: fresnel?,
        ior: ior?,
        absorption: absorption?,
        priority: priority?,
        ..coated?
    })
}

fn lobe(fields: &mut Fields<'_>, strength: &'static str, tint: &'static str) -> Option<LobeDescription> {
    let strength = fields.optional(strength, |node| match looks_like_paint(node) {
        false => keyed(not_negative)(node),
        true => {
            let fault = node.mismatch("a number of 0 or more");
            node.fault(fault.help(format!("this is the part's strength; its colour is `{tint}`")));
            None
        }
    });
    let tint = fields.optional(tint, paint);
    Some(LobeDescription { strength: strength?, tint: tint? })
}

/// Whether a constant looks like a colour or a pattern instead of a number.
fn looks_like_paint(node: Node<'_>) -> bool {
    node.is_text()
        || node.opens_with('(')
        || (node.bare_word().is_none() && !matches!(node.word(), "" | "Track"))
}

/// Decodes a number of 0..=1 with or without keys, or paint.
fn level(node: Node<'_>) -> Option<ScalarTextureTracks> {
    let keys = node.opens_with('[') || node.begins_with("Track");
    if keys || is_number(node) {
        return keyed(between(0.0..=1.0))(node).map(ScalarTextureTracks::Constant);
    }
    if node.bare_word().is_some_and(is_literal) {
        node.expected("a number from 0 to 1, or paint");
        return None;
    }
    paint(node).map(ScalarTextureTracks::Textured)
}

/// Decodes `coat` and `coat_roughness`, over a material.
fn coat(fields: &mut Fields<'_>, over: MaterialDescription) -> Option<MaterialDescription> {
    let coat = fields.optional("coat", level);
    let coat_roughness = fields.optional("coat_roughness", level);
    Some(MaterialDescription { coat: coat?.or(over.coat), coat_roughness: coat_roughness?, ..over })
}

fn fresnel(node: Node<'_>) -> Option<Fresnel> {
    let models = &[("Off", Fresnel::Off), ("Exact", Fresnel::Exact), ("Schlick", Fresnel::Schlick)];
    one_of("Fresnel model", models)(node)
}

type MediumFields = (Option<Option<Animated<f64>>>, Option<Option<Animated<Rgb>>>, Option<Option<i32>>);

fn medium(fields: &mut Fields<'_>) -> MediumFields {
    let ior = fields.optional("ior", keyed(positive));
    let absorption = fields.optional("absorption", keyed(color));
    let priority = fields.optional("priority", whole_number(-1000..=1000));
    (ior, absorption, priority)
}

/// Decodes `bump` and `normal_map`, of which a material has one.
fn relief(fields: &mut Fields<'_>) -> Option<Option<ReliefTracks>> {
    let both = (fields.has("bump") && fields.has("normal_map")).then(|| fields.place("normal_map"));
    let bump = fields.optional("bump", bump);
    let map = fields.optional("normal_map", normal_map);
    if let Some(place) = both {
        let fault = Fault::new(place, "a material has either `bump` or `normal_map`", "besides `bump`");
        fields.node().fault(fault);
        return None;
    }
    Some(bump?.or(map?))
}

/// Heights: `(height: Noise(), depth: 0.05)`.
fn bump(node: Node<'_>) -> Option<ReliefTracks> {
    let mut fields = Fields::of(node, "`bump`")?;
    let height = fields.required("height", paint);
    let depth = fields.or("depth", keyed(number), 0.05);
    fields.finish();
    Some(ReliefTracks::Bump { height: height?, depth: depth? })
}

/// A map of normals: `"normals.png"`, or the fields of an image and `strength`.
fn normal_map(node: Node<'_>) -> Option<ReliefTracks> {
    if node.is_text() {
        let map = plain_image(image(ColorEncoding::Linear)(node)?);
        return Some(ReliefTracks::NormalMap { map, strength: 1.0.into() });
    }
    let mut fields = Fields::of(node, "`normal_map`")?;
    let strength = fields.or("strength", keyed(not_negative), 1.0);
    let map = image_fields(fields, ColorEncoding::Linear);
    Some(ReliefTracks::NormalMap { map: map?, strength: strength? })
}

/// A diffuse surface of reflectance `color`.
fn lambertian(node: Node<'_>) -> Option<MaterialDescription> {
    let mut fields = Fields::of(node, "`Lambertian`")?;
    let color = fields.or("color", paint, Rgb::splat(0.5));
    let relief = relief(&mut fields);
    let coated = coat(&mut fields, MaterialDescription::bare());
    fields.finish();
    Some(MaterialDescription {
        relief: relief?,
        color: Some(color?),
        diffuse: LobeDescription::of_strength(1.0),
        ..coated?
    })
}

/// A coloured mirror, sharp or fuzzy.
fn metal(node: Node<'_>) -> Option<MaterialDescription> {
    let mut fields = Fields::of(node, "`Metal`")?;
    let color = fields.or("color", paint, Rgb::splat(0.8));
    let fuzz = fields.or("fuzz", level, ScalarTextureTracks::Constant(0.0.into()));
    let relief = relief(&mut fields);
    let coated = coat(&mut fields, MaterialDescription::bare());
    fields.finish();
    let mirror = LobeDescription { strength: Some(1.0.into()), tint: color.clone() };
    Some(MaterialDescription { relief: relief?, color: Some(color?), mirror, fuzz: Some(fuzz?), ..coated? })
}

/// Glass, water, diamond.
fn dielectric(node: Node<'_>) -> Option<MaterialDescription> {
    let mut fields = Fields::of(node, "`Dielectric`")?;
    let color = fields.or("color", paint, Rgb::ONE);
    let model = fields.or("fresnel", fresnel, Fresnel::Exact);
    let (ior, absorption, priority) = medium(&mut fields);
    let relief = relief(&mut fields);
    fields.finish();
    let refraction = LobeDescription { strength: Some(1.0.into()), tint: color.clone() };
    let color = Some(color?);
    let (fresnel, ior, absorption, priority) = (Some(model?), ior?, absorption?, priority?);
    Some(MaterialDescription {
        relief: relief?,
        color,
        refraction,
        fresnel,
        ior,
        absorption,
        priority,
        ..MaterialDescription::bare()
    })
}

/// The metallic-roughness model of glTF 2.0.
fn metallic_roughness(node: Node<'_>) -> Option<MaterialDescription> {
    let mut fields = Fields::of(node, "`MetallicRoughness`")?;
    let color = fields.or("color", paint, Rgb::ONE);
    let metallic = fields.or("metallic", level, ScalarTextureTracks::Constant(1.0.into()));
    let roughness = fields.or("roughness", level, ScalarTextureTracks::Constant(1.0.into()));
    let ambient = lobe(&mut fields, "ambient", "ambient_color");
    let emission = lobe(&mut fields, "emission", "emission_color");
    let ior = fields.optional("ior", keyed(positive));
    let relief = relief(&mut fields);
    let coated = coat(&mut fields, MaterialDescription::bare());
    fields.finish();
    let (ambient, emission) = (ambient?, emission?);
    let dark =
        |lobe: LobeDescription| LobeDescription { strength: lobe.strength.or(Some(0.0.into())), ..lobe };
    Some(MaterialDescription {
        relief: relief?,
        color: Some(color?),
        microfacet: Some(1.0.into()),
        metallic: Some(metallic?),
        roughness: Some(roughness?),
        ambient: dark(ambient),
        emission: dark(emission),
        ior: ior?,
        ..coated?
    })
}

/// A surface that shows its colour whatever the light.
fn unlit(node: Node<'_>) -> Option<MaterialDescription> {
    let mut fields = Fields::of(node, "`Unlit`")?;
    let color = fields.or("color", paint, Rgb::ONE);
    fields.finish();
    Some(MaterialDescription {
        color: Some(color?),
        emission: LobeDescription::of_strength(1.0),
        ..MaterialDescription::bare()
    })
}
