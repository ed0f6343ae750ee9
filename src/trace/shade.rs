//! Local reflection: how much of a light's radiance a surface sends to the eye.

use crate::color::Rgb;
use crate::material::{Highlight, Material};
use crate::math::DVec3;

/// Reflected share of the light from `to_light` towards `to_eye` at a surface of normal `normal` that faces
/// the eye; all unit vectors. Black when the light is behind the surface: then there is no highlight either.
pub fn reflected(material: &Material, normal: DVec3, to_light: DVec3, to_eye: DVec3) -> Rgb {
    let cosine = normal.dot(to_light);
    if cosine <= 0.0 {
        return Rgb::ZERO;
    }
    let diffuse = material.diffuse * cosine as f32;
    if material.specular == Rgb::ZERO {
        return diffuse;
    }
    diffuse + material.specular * highlight(material, normal, to_light, to_eye) as f32
}

fn highlight(material: &Material, normal: DVec3, to_light: DVec3, to_eye: DVec3) -> f64 {
    let cosine = match material.highlight {
        Highlight::Phong => mirrored(-to_eye, normal).dot(to_light),
        Highlight::BlinnPhong => normal.dot((to_light + to_eye).normalize_or_zero()),
    };
    material.shininess.raise(cosine)
}

/// `direction` as a mirror across `normal` sends it on.
pub fn mirrored(direction: DVec3, normal: DVec3) -> DVec3 {
    direction - normal * (2.0 * normal.dot(direction))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Exponent;

    fn material(highlight: Highlight, shininess: f64) -> Material {
        Material {
            ambient: Rgb::ZERO,
            diffuse: Rgb::ZERO,
            specular: Rgb::ONE,
            mirror: Rgb::ZERO,
            highlight,
            shininess: Exponent::new(shininess),
        }
    }

    #[test]
    fn the_half_vector_lies_between_light_and_eye() {
        // Eye and light mirror each other about the normal: the highlight's centre, wherever they are.
        for shift in [DVec3::ZERO, DVec3::new(1024.0, -512.0, 256.0)] {
            let point = DVec3::new(10.0, 0.0, 0.0) + shift;
            let to_light = (DVec3::new(13.0, 4.0, 0.0) + shift - point).normalize();
            let to_eye = (DVec3::new(7.0, 4.0, 0.0) + shift - point).normalize();
            for model in [Highlight::Phong, Highlight::BlinnPhong] {
                assert!((highlight(&material(model, 32.0), DVec3::Y, to_light, to_eye) - 1.0).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn no_highlight_without_light_on_the_surface() {
        let grazing = DVec3::new(1.0, 0.0, 0.0);
        let eye = DVec3::new(-1.0, 0.0, 0.0);
        assert_eq!(reflected(&material(Highlight::Phong, 0.0), DVec3::Y, grazing, eye), Rgb::ZERO);
        let below = DVec3::new(0.8, -0.6, 0.0);
        assert_eq!(reflected(&material(Highlight::Phong, 0.0), DVec3::Y, below, eye), Rgb::ZERO);
    }

    #[test]
    fn diffuse_follows_the_cosine() {
        let matte =
            Material { diffuse: Rgb::splat(0.5), specular: Rgb::ZERO, ..material(Highlight::Phong, 1.0) };
        let at_60 = DVec3::new(0.75f64.sqrt(), 0.5, 0.0);
        assert_eq!(reflected(&matte, DVec3::Y, at_60, DVec3::Y), Rgb::splat(0.25));
    }
}
