//! Light on surfaces: where there is a highlight, and where there is not.

use super::*;
use crate::appearance::material::{Exponent, Highlight, Lobes, Material, Medium};
use crate::appearance::optics::Fresnel;
use crate::base::color::Rgb;
use crate::base::math::DVec3;
use crate::film::LayerId;

fn material(highlight: Highlight, shininess: f64) -> Material {
    Material {
        lobes: Lobes { specular: Rgb::ONE, ..Lobes::default() },
        textures: Vec::new(),
        emission_layer: LayerId::CONSTANT,
        highlight,
        shininess: Exponent::new(shininess),
        fresnel: Fresnel::Off,
        medium: Medium::EMPTY,
        relief: Default::default(),
    }
}

/// The reflection of a level surface to the eye: diffuse, glossy, and the highlight.
fn reflected(material: &Material, to_light: DVec3, to_eye: DVec3) -> [Rgb; 3] {
    let surface = LaneSurface::<f64>::new(Vec3::zero(), Vec3::zero(), DVec3::Y.into());
    let table = LobeTable::new([&material.lobes].into_iter());
    let lobes = LobeSet::of(material);
    let shininess = Shininess::gather(|_| material.shininess);
    let eye = LocalFrame::from_z_near_x(to_eye.into(), [DVec3::X, DVec3::Y]);
    let rows = (&table, &Lookup::run(0, 1));
    let bsdf = Bsdf::gather(lobes, rows, shininess, material.medium.ior, (&surface, &eye, true));
    let Reflected { diffuse, glossy, highlight } = bsdf.reflected(to_light.into());
    [diffuse, glossy, highlight].map(Rgb::from)
}

#[test]
fn sh_01_the_half_vector_lies_between_light_and_eye() {
    // Eye and light mirror each other about the normal. So this is the centre of the highlight, wherever they are.
    for shift in [DVec3::ZERO, DVec3::new(1024.0, -512.0, 256.0)] {
        let point = DVec3::new(10.0, 0.0, 0.0) + shift;
        let to_light = (DVec3::new(13.0, 4.0, 0.0) + shift - point).normalize();
        let to_eye = (DVec3::new(7.0, 4.0, 0.0) + shift - point).normalize();
        for model in [Highlight::Phong, Highlight::BlinnPhong] {
            let [diffuse, glossy, highlight] = reflected(&material(model, 32.0), to_light, to_eye);
            assert_eq!((diffuse, glossy), (Rgb::ZERO, Rgb::ZERO));
            assert!((highlight - Rgb::ONE).abs().max_element() <= f32::EPSILON, "{highlight}");
        }
    }
}

/// Corner cases of the highlight, in which a power alone gives light that should not exist, or NaN.
#[test]
fn sh_02_no_highlight_without_light_on_the_surface() {
    let eye = DVec3::new(-1.0, 0.0, 0.0);
    let (grazing, below) = (DVec3::X, DVec3::new(0.8, -0.6, 0.0));
    for model in [Highlight::Phong, Highlight::BlinnPhong] {
        for shininess in [0.0, 1.0, 0.5, 1e6] {
            for light in [grazing, below, DVec3::NEG_Y] {
                let found = reflected(&material(model, shininess), light, eye);
                assert_eq!(found, [Rgb::ZERO; 3], "{model:?} {shininess} {light}");
            }
        }
    }
    // The light is above the surface, but its mirror image is at or beyond a right angle to the eye.
    let light = DVec3::new(0.6, 0.8, 0.0);
    for eye in [DVec3::new(0.8, 0.6, 0.0), DVec3::new(0.96, 0.28, 0.0)] {
        for shininess in [0.0, 0.5, 1.0, 1e6] {
            let found = reflected(&material(Highlight::Phong, shininess), light, eye);
            assert_eq!(found, [Rgb::ZERO; 3], "{shininess} {eye}");
        }
    }
}

#[test]
fn diffuse_follows_the_cosine() {
    let lobes = Lobes { diffuse: Rgb::splat(0.5), ..Lobes::default() };
    let matte = Material { lobes, ..material(Highlight::Phong, 1.0) };
    let at_60 = DVec3::new(0.75f64.sqrt(), 0.5, 0.0);
    assert_eq!(reflected(&matte, at_60, DVec3::Y), [Rgb::splat(0.25), Rgb::ZERO, Rgb::ZERO]);
}
