//! `materials` and `default_material`: what surfaces do with light.

use super::colors::color;
use super::fields::Fields;
use super::keys::keyed;
use super::node::Node;
use super::paint::paint;
use super::suggest::nearest;
use super::values::{between, is_number, not_negative, one_of, positive, whole_number};
use super::words::{is_literal, variant};
use crate::appearance::material::{Highlight, Level, Lobe, MaterialTracks};
use crate::appearance::optics::Fresnel;
use crate::appearance::texture::PaintTracks;
use crate::base::color::Rgb;
use crate::track::Animated;

/// The fields of a material that a file gives; the others come from the default material.
#[derive(Clone, Default)]
pub struct Given {
    pub(super) color: Option<PaintTracks>,
    pub(super) emission: GivenLobe,
    pub(super) ambient: GivenLobe,
    pub(super) diffuse: GivenLobe,
    pub(super) specular: GivenLobe,
    pub(super) mirror: GivenLobe,
    pub(super) fuzz: Option<Level>,
    pub(super) transparency: GivenLobe,
    pub(super) refraction: GivenLobe,
    pub(super) microfacet: Option<Animated<f64>>,
    pub(super) metallic: Option<Level>,
    pub(super) roughness: Option<Level>,
    pub(super) shininess: Option<Animated<f64>>,
    pub(super) highlight: Option<Highlight>,
    pub(super) fresnel: Option<Fresnel>,
    pub(super) ior: Option<Animated<f64>>,
    pub(super) absorption: Option<Animated<Rgb>>,
    pub(super) priority: Option<i32>,
}

/// What a file gives of a lobe.
#[derive(Clone, Default)]
pub struct GivenLobe {
    pub(super) strength: Option<Animated<f64>>,
    pub(super) tint: Option<PaintTracks>,
}

/// A word that stands for a whole material, and the reader of that.
type Kind<'s> = (&'static str, fn(Node<'s>) -> Option<Given>);

fn kinds<'s>() -> [Kind<'s>; 4] {
    [
        ("Lambertian", lambertian),
        ("Metal", metal),
        ("Dielectric", dielectric),
        ("MetallicRoughness", metallic_roughness),
    ]
}

/// Whether a value is written like a material, of whatever kind.
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

/// Reads a material: lobes in ( ), or one of the kinds.
pub fn material(node: Node<'_>) -> Option<Given> {
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

fn lobes(node: Node<'_>) -> Option<Given> {
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
    fields.finish();
    Some(Given {
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
        ..Given::default()
    })
}

fn lobe(fields: &mut Fields<'_>, strength: &'static str, tint: &'static str) -> Option<GivenLobe> {
    let strength = fields.optional(strength, |node| match looks_like_paint(node) {
        false => keyed(not_negative)(node),
        true => {
            let fault = node.mismatch("a number of 0 or more");
            node.fault(fault.help(format!("this is the part's strength; its colour is `{tint}`")));
            None
        }
    });
    let tint = fields.optional(tint, paint);
    Some(GivenLobe { strength: strength?, tint: tint? })
}

/// Whether a value without keys is a colour or a pattern rather than a number.
fn looks_like_paint(node: Node<'_>) -> bool {
    node.is_text()
        || node.opens_with('(')
        || (node.bare_word().is_none() && !matches!(node.word(), "" | "Track"))
}

/// A number of 0..=1 with or without keys, or paint.
fn level(node: Node<'_>) -> Option<Level> {
    let keys = node.opens_with('[') || node.word() == "Track";
    if keys || is_number(node) {
        return keyed(between(0.0..=1.0))(node).map(Level::Even);
    }
    if node.bare_word().is_some_and(is_literal) {
        node.expected("a number from 0 to 1, or paint");
        return None;
    }
    paint(node).map(Level::Painted)
}

fn fresnel(node: Node<'_>) -> Option<Fresnel> {
    let models = &[("Off", Fresnel::Off), ("Exact", Fresnel::Exact), ("Schlick", Fresnel::Schlick)];
    one_of("Fresnel model", models)(node)
}

type GivenMedium = (Option<Option<Animated<f64>>>, Option<Option<Animated<Rgb>>>, Option<Option<i32>>);

fn medium(fields: &mut Fields<'_>) -> GivenMedium {
    let ior = fields.optional("ior", keyed(positive));
    let absorption = fields.optional("absorption", keyed(color));
    let priority = fields.optional("priority", whole_number(-1000..=1000));
    (ior, absorption, priority)
}

/// A strength of every lobe.
fn only(strength: f64) -> GivenLobe {
    GivenLobe { strength: Some(strength.into()), tint: None }
}

impl Given {
    /// A material without any lobe.
    fn bare() -> Self {
        let none = only(0.0);
        Self {
            emission: none.clone(),
            ambient: none.clone(),
            diffuse: none.clone(),
            specular: none.clone(),
            mirror: none.clone(),
            transparency: none.clone(),
            refraction: none,
            microfacet: Some(0.0.into()),
            ..Self::default()
        }
    }
}

/// A matte surface that reflects the share `color` of all light.
fn lambertian(node: Node<'_>) -> Option<Given> {
    let mut fields = Fields::of(node, "`Lambertian`")?;
    let color = fields.or("color", paint, Rgb::splat(0.5));
    fields.finish();
    Some(Given { color: Some(color?), diffuse: only(1.0), ..Given::bare() })
}

/// A mirror of a colour, sharp or fuzzy.
fn metal(node: Node<'_>) -> Option<Given> {
    let mut fields = Fields::of(node, "`Metal`")?;
    let color = fields.or("color", paint, Rgb::splat(0.8));
    let fuzz = fields.or("fuzz", level, Level::Even(0.0.into()));
    fields.finish();
    let mirror = GivenLobe { strength: Some(1.0.into()), tint: color.clone() };
    Some(Given { color: Some(color?), mirror, fuzz: Some(fuzz?), ..Given::bare() })
}

/// Glass, water, diamond.
fn dielectric(node: Node<'_>) -> Option<Given> {
    let mut fields = Fields::of(node, "`Dielectric`")?;
    let color = fields.or("color", paint, Rgb::ONE);
    let model = fields.or("fresnel", fresnel, Fresnel::Exact);
    let (ior, absorption, priority) = medium(&mut fields);
    fields.finish();
    let refraction = GivenLobe { strength: Some(1.0.into()), tint: color.clone() };
    let color = Some(color?);
    let (fresnel, ior, absorption, priority) = (Some(model?), ior?, absorption?, priority?);
    Some(Given { color, refraction, fresnel, ior, absorption, priority, ..Given::bare() })
}

/// The metallic-roughness model of glTF 2.0.
fn metallic_roughness(node: Node<'_>) -> Option<Given> {
    let mut fields = Fields::of(node, "`MetallicRoughness`")?;
    let color = fields.or("color", paint, Rgb::ONE);
    let metallic = fields.or("metallic", level, Level::Even(1.0.into()));
    let roughness = fields.or("roughness", level, Level::Even(1.0.into()));
    let ambient = lobe(&mut fields, "ambient", "ambient_color");
    let emission = lobe(&mut fields, "emission", "emission_color");
    let ior = fields.optional("ior", keyed(positive));
    fields.finish();
    let (ambient, emission) = (ambient?, emission?);
    let dark = |lobe: GivenLobe| GivenLobe { strength: lobe.strength.or(Some(0.0.into())), ..lobe };
    Some(Given {
        color: Some(color?),
        microfacet: Some(1.0.into()),
        metallic: Some(metallic?),
        roughness: Some(roughness?),
        ambient: dark(ambient),
        emission: dark(emission),
        ior: ior?,
        ..Given::bare()
    })
}

impl Given {
    /// The material, with what is absent taken from the file's default material, then from Kinora's own.
    pub fn over(&self, default: &Self) -> MaterialTracks {
        let base = self.color.clone().or_else(|| default.color.clone());
        let base = base.unwrap_or(Rgb::splat(0.8).into());
        let white = PaintTracks::from(Rgb::ONE);
        let lobe = |own: fn(&Self) -> &GivenLobe, strength: f64, tint: &PaintTracks| {
            let (own, other) = (own(self), own(default));
            let given = own.strength.clone().or_else(|| other.strength.clone());
            let tinted = own.tint.clone().or_else(|| other.tint.clone());
            Lobe { strength: given.unwrap_or(strength.into()), tint: tinted.unwrap_or_else(|| tint.clone()) }
        };
        let level = |own: fn(&Self) -> &Option<Level>, otherwise: f64| {
            own(self).clone().or_else(|| own(default).clone()).unwrap_or(Level::Even(otherwise.into()))
        };
        let value = |own: fn(&Self) -> &Option<Animated<f64>>, otherwise: f64| {
            own(self).clone().or_else(|| own(default).clone()).unwrap_or(otherwise.into())
        };
        MaterialTracks {
            emission: lobe(|given| &given.emission, 0.0, &base),
            ambient: lobe(|given| &given.ambient, 0.1, &base),
            diffuse: lobe(|given| &given.diffuse, 0.9, &base),
            specular: lobe(|given| &given.specular, 0.0, &white),
            mirror: lobe(|given| &given.mirror, 0.0, &white),
            fuzz: level(|given| &given.fuzz, 0.0),
            transparency: lobe(|given| &given.transparency, 0.0, &white),
            refraction: lobe(|given| &given.refraction, 0.0, &white),
            microfacet: value(|given| &given.microfacet, 0.0),
            metallic: level(|given| &given.metallic, 0.0),
            roughness: level(|given| &given.roughness, 0.0),
            shininess: value(|given| &given.shininess, 32.0),
            highlight: self.highlight.or(default.highlight).unwrap_or_default(),
            fresnel: self.fresnel.or(default.fresnel).unwrap_or_default(),
            ior: value(|given| &given.ior, 1.5),
            absorption: self
                .absorption
                .clone()
                .or_else(|| default.absorption.clone())
                .unwrap_or(Rgb::ZERO.into()),
            priority: self.priority.or(default.priority).unwrap_or(0),
            base,
        }
    }
}
