//! `materials` and `default_material`: what surfaces do with light.

use super::colors::color;
use super::fields::Fields;
use super::keys::keyed;
use super::node::Node;
use super::values::{not_negative, one_of};
use crate::color::Rgb;
use crate::material::{Highlight, Lobe, MaterialTracks};
use crate::track::Animated;

/// The fields of a material that a file gives; the others come from the default material.
#[derive(Clone, Default)]
pub struct Given {
    color: Option<Animated<Rgb>>,
    ambient: Option<Animated<f64>>,
    diffuse: Option<Animated<f64>>,
    specular: Option<Animated<f64>>,
    mirror: Option<Animated<f64>>,
    ambient_color: Option<Animated<Rgb>>,
    diffuse_color: Option<Animated<Rgb>>,
    specular_color: Option<Animated<Rgb>>,
    mirror_color: Option<Animated<Rgb>>,
    shininess: Option<Animated<f64>>,
    highlight: Option<Highlight>,
}

/// Reads the fields of a material.
pub fn material(node: Node<'_>) -> Option<Given> {
    let mut fields = Fields::of(node, "a material")?;
    let base = fields.optional("color", keyed(color));
    let [ambient, diffuse, specular, mirror, shininess] =
        ["ambient", "diffuse", "specular", "mirror", "shininess"]
            .map(|name| fields.optional(name, keyed(not_negative)));
    let [ambient_color, diffuse_color, specular_color, mirror_color] =
        ["ambient_color", "diffuse_color", "specular_color", "mirror_color"]
            .map(|name| fields.optional(name, keyed(color)));
    let highlights = &[("Phong", Highlight::Phong), ("BlinnPhong", Highlight::BlinnPhong)];
    let highlight = fields.optional("highlight", one_of("highlight", highlights));
    fields.finish();
    Some(Given {
        color: base?,
        ambient: ambient?,
        diffuse: diffuse?,
        specular: specular?,
        mirror: mirror?,
        ambient_color: ambient_color?,
        diffuse_color: diffuse_color?,
        specular_color: specular_color?,
        mirror_color: mirror_color?,
        shininess: shininess?,
        highlight: highlight?,
    })
}

impl Given {
    /// The material, with what is absent taken from the file's default material, then from Kinora's own.
    pub fn over(&self, default: &Self) -> MaterialTracks {
        let pick =
            |own: fn(&Self) -> &Option<Animated<Rgb>>| own(self).clone().or_else(|| own(default).clone());
        let strength = |own: fn(&Self) -> &Option<Animated<f64>>, otherwise: f64| {
            own(self).clone().or_else(|| own(default).clone()).unwrap_or(otherwise.into())
        };
        let base = pick(|given| &given.color).unwrap_or(Rgb::splat(0.8).into());
        let white = || Animated::from(Rgb::ONE);
        MaterialTracks {
            ambient: Lobe {
                strength: strength(|given| &given.ambient, 0.1),
                tint: pick(|given| &given.ambient_color).unwrap_or_else(|| base.clone()),
            },
            diffuse: Lobe {
                strength: strength(|given| &given.diffuse, 0.9),
                tint: pick(|given| &given.diffuse_color).unwrap_or_else(|| base.clone()),
            },
            specular: Lobe {
                strength: strength(|given| &given.specular, 0.0),
                tint: pick(|given| &given.specular_color).unwrap_or_else(white),
            },
            mirror: Lobe {
                strength: strength(|given| &given.mirror, 0.0),
                tint: pick(|given| &given.mirror_color).unwrap_or_else(white),
            },
            shininess: strength(|given| &given.shininess, 32.0),
            highlight: self.highlight.or(default.highlight).unwrap_or_default(),
        }
    }
}
