//! Local reflection: how much of a light's radiance a surface sends to the eye.
//!
//! What a surface scatters is counted in shares: π times its bidirectional reflectance times the cosine of the
//! light's angle, so that a facing light of radiance 1 on a surface of diffuse 1 gives radiance 1.

use crate::color::Rgb;
use crate::material::{Highlight, Lobes, Material};
use crate::math::DVec3;
use crate::optics::{Fuzz, Microfacet, reflect};
use crate::sampling::{Frame, cosine_hemisphere_density};
use crate::shape::Surface;
use std::f64::consts::PI;

/// Rough surfaces smoother than this are mirrors: their highlight is narrower than a tenth of a degree.
const SMOOTH: f32 = 0.01;

/// A point of a surface as the eye sees it.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    pub material: &'a Material,
    /// The material's lobes at the point.
    pub lobes: &'a Lobes,
    /// Turned towards the eye.
    pub surface: &'a Surface,
    /// Unit vector.
    pub to_eye: DVec3,
    /// Unit vector across `to_eye`, from which the frame around the normal is made.
    pub tangent: DVec3,
}

/// The shares of a light that a surface sends to the eye, by what they count in fog.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reflected {
    /// Gathered by the diffuse lobe.
    pub diffuse: Rgb,
    /// Shown by a fuzzy mirror or small ones.
    pub shine: Rgb,
    /// Of lights alone.
    pub highlight: Rgb,
}

impl Reflected {
    /// What is scattered, where fog lets this share of light pass.
    pub fn scattered(&self, clear: f32) -> Rgb {
        self.diffuse + self.shine * clear
    }
}

impl Seen<'_> {
    /// The normal to shade with: the smooth one, unless it faces away from the eye.
    pub fn normal(&self) -> DVec3 {
        let smooth = self.surface.shading;
        if smooth.dot(self.to_eye) > 0.0 { smooth } else { self.surface.normal }
    }

    /// The frame around that normal.
    pub fn frame(&self) -> Frame {
        Frame::carried(self.tangent, self.to_eye, self.normal())
    }

    /// The directions to the eye and another one in the frame.
    pub fn local(&self, direction: DVec3) -> [DVec3; 2] {
        let frame = self.frame();
        [self.to_eye, direction].map(|v| frame.to_local(v).into())
    }

    /// The shares of the light from `to_light` (a unit vector) that the surface sends to the eye. Black when the
    /// light is behind the surface: then there is no highlight either.
    pub fn reflected(&self, to_light: DVec3) -> Reflected {
        let normal = self.normal();
        let cosine = normal.dot(to_light);
        let mut reflected = Reflected::default();
        let above = self.surface.normal.dot(to_light) > 0.0 || self.surface.smoothly_faces(to_light);
        if cosine <= 0.0 || !above {
            return reflected;
        }
        reflected.diffuse = self.lobes.diffuse * cosine as f32;
        if let Some(fuzz) = self.fuzz() {
            reflected.shine = self.lobes.mirror * (PI * fuzz.density(self.mirrored(), to_light)) as f32;
        }
        if self.lobes.microfacet > 0.0 {
            let (below, shine) = self.rough(to_light);
            reflected.diffuse += below * self.lobes.microfacet;
            reflected.shine += shine * self.lobes.microfacet;
        }
        if self.lobes.specular != Rgb::ZERO {
            reflected.highlight = self.lobes.specular * self.highlight(to_light) as f32;
        }
        reflected
    }

    /// The direction in which a mirror shows the eye what it does.
    pub fn mirrored(&self) -> DVec3 {
        reflect(-self.to_eye, self.normal())
    }

    /// How the mirror scatters; none if it is sharp.
    pub fn fuzz(&self) -> Option<Fuzz> {
        self.lobes.is_fuzzy().then(|| Fuzz(f64::from(self.lobes.fuzz)))
    }

    /// Whether a ray in this direction leaves the surface behind itself: a smooth normal may bend one that should
    /// pass back to the side that it came from.
    pub fn passes(&self, direction: DVec3) -> bool {
        self.surface.normal.dot(direction) < 0.0
    }

    fn highlight(&self, to_light: DVec3) -> f64 {
        let cosine = match self.material.highlight {
            Highlight::Phong => self.mirrored().dot(to_light),
            Highlight::BlinnPhong => self.normal().dot((to_light + self.to_eye).normalize_or_zero()),
        };
        self.material.shininess.raise(cosine)
    }

    /// The distribution of the rough surface's small mirrors; none if it is smooth.
    pub fn microfacet(&self) -> Option<Microfacet> {
        let roughness = self.lobes.roughness;
        (roughness >= SMOOTH).then(|| Microfacet { alpha: f64::from(roughness) * f64::from(roughness) })
    }

    /// The share that small mirrors turned half way reflect, from the cosine of the angle to them (glTF 2.0,
    /// appendix B): Schlick's between the base colour of metals, or that of a boundary to the medium, and 1.
    pub fn metallic_fresnel(&self, cosine: f64) -> Rgb {
        let eta = self.material.medium.ior;
        let boundary = ((eta - 1.0) / (eta + 1.0) * (eta - 1.0) / (eta + 1.0)) as f32;
        let normal = Rgb::splat(boundary).lerp(self.lobes.base, self.lobes.metallic);
        normal + (Rgb::ONE - normal) * crate::optics::schlick(0.0, cosine) as f32
    }

    /// The metallic-roughness surface's shares from below its boundary and from its small mirrors, without its
    /// strength.
    fn rough(&self, to_light: DVec3) -> (Rgb, Rgb) {
        let half = (self.to_eye + to_light).normalize_or(self.normal());
        let fresnel = self.metallic_fresnel(self.to_eye.dot(half));
        let cosine = self.normal().dot(to_light);
        let below = self.rough_base() * (Rgb::ONE - fresnel) * cosine as f32;
        let Some(microfacet) = self.microfacet() else { return (below, Rgb::ZERO) };
        let [eye, light] = self.local(to_light);
        let shine = microfacet.reflected(eye, light);
        (below, fresnel * (PI * shine) as f32)
    }

    /// What the metallic-roughness surface scatters from below its boundary, without Fresnel's factor.
    pub fn rough_base(&self) -> Rgb {
        self.lobes.base * (1.0 - self.lobes.metallic)
    }

    /// Density of cosine-weighted directions.
    pub fn diffuse_density(&self, direction: DVec3) -> f64 {
        cosine_hemisphere_density(self.normal().dot(direction))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::LayerId;
    use crate::material::{Exponent, Medium};
    use crate::optics::Fresnel;

    fn material(highlight: Highlight, shininess: f64) -> Material {
        Material {
            lobes: Lobes { specular: Rgb::ONE, ..Lobes::default() },
            paints: Vec::new(),
            emission_layer: LayerId::CONSTANT,
            highlight,
            shininess: Exponent::new(shininess),
            fresnel: Fresnel::Off,
            medium: Medium::EMPTY,
        }
    }

    /// What a level surface of the material sends to the eye.
    fn reflected(material: &Material, to_light: DVec3, to_eye: DVec3) -> Reflected {
        let (point, normal) = (DVec3::ZERO, DVec3::Y);
        let surface = Surface::new(point, DVec3::ZERO, normal);
        let tangent = Frame::around(to_eye).x;
        Seen { material, lobes: &material.lobes, surface: &surface, to_eye, tangent }.reflected(to_light)
    }

    #[test]
    fn sh_01_the_half_vector_lies_between_light_and_eye() {
        // Eye and light mirror each other about the normal: the highlight's centre, wherever they are.
        for shift in [DVec3::ZERO, DVec3::new(1024.0, -512.0, 256.0)] {
            let point = DVec3::new(10.0, 0.0, 0.0) + shift;
            let to_light = (DVec3::new(13.0, 4.0, 0.0) + shift - point).normalize();
            let to_eye = (DVec3::new(7.0, 4.0, 0.0) + shift - point).normalize();
            for model in [Highlight::Phong, Highlight::BlinnPhong] {
                let Reflected { diffuse, shine, highlight } =
                    reflected(&material(model, 32.0), to_light, to_eye);
                assert_eq!((diffuse, shine), (Rgb::ZERO, Rgb::ZERO));
                assert!((highlight - Rgb::ONE).abs().max_element() <= f32::EPSILON, "{highlight}");
            }
        }
    }

    /// Corners of the highlight: exponents and angles where a power alone would give light that is not there,
    /// or no number.
    #[test]
    fn sh_02_no_highlight_without_light_on_the_surface() {
        let eye = DVec3::new(-1.0, 0.0, 0.0);
        let (grazing, below) = (DVec3::X, DVec3::new(0.8, -0.6, 0.0));
        for model in [Highlight::Phong, Highlight::BlinnPhong] {
            for shininess in [0.0, 1.0, 0.5, 1e6] {
                for light in [grazing, below, DVec3::NEG_Y] {
                    let found = reflected(&material(model, shininess), light, eye);
                    assert_eq!(found, Reflected::default(), "{model:?} {shininess} {light}");
                }
            }
        }
        // The light is on the surface, but its mirror image is at a right angle to the eye, or beyond it.
        let light = DVec3::new(0.6, 0.8, 0.0);
        for eye in [DVec3::new(0.8, 0.6, 0.0), DVec3::new(0.96, 0.28, 0.0)] {
            for shininess in [0.0, 0.5, 1.0, 1e6] {
                let found = reflected(&material(Highlight::Phong, shininess), light, eye);
                assert_eq!(found, Reflected::default(), "{shininess} {eye}");
            }
        }
    }

    #[test]
    fn diffuse_follows_the_cosine() {
        let lobes = Lobes { diffuse: Rgb::splat(0.5), ..Lobes::default() };
        let matte = Material { lobes, ..material(Highlight::Phong, 1.0) };
        let at_60 = DVec3::new(0.75f64.sqrt(), 0.5, 0.0);
        let quarter = Reflected { diffuse: Rgb::splat(0.25), ..Reflected::default() };
        assert_eq!(reflected(&matte, at_60, DVec3::Y), quarter);
    }
}
