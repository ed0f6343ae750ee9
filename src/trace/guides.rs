//! What a camera's ray meets first, for those who ask: depth, normal and albedo. It is looked up by a ray of its own,
//! so that pictures without guides take no work for them, and those with them have the same light.

use super::media::Media;
use super::tracer::{Met, Tracer, Work};
use crate::camera::{Beam, Ray};
use crate::color::Rgb;
use crate::film::LayerId;
use crate::material::Lobes;
use crate::math::DVec3;

/// Adds to the sample in hand what the ray meets, from the layer `first` on. A ray that meets nothing adds nothing.
pub fn record(tracer: &Tracer, (ray, beam): (&Ray, &Beam), first: LayerId, work: &mut Work) {
    let closest = || tracer.closest(ray);
    let stop = tracer.next_stop((ray, None), f64::INFINITY, closest, Media::default(), work);
    let Some(stop) = stop else { return };
    let (surface, albedo) = match tracer.met(ray, stop, beam.after(stop.passed.t)) {
        Met::Surface(face) => (face.surface, albedo(&face.lobes)),
        Met::Light { surface, .. } => (surface, Rgb::ONE),
        Met::Nothing => return,
    };
    let camera = tracer.scene.camera;
    let depth = (surface.point - camera.position).dot(camera.basis.forward);
    let values = [DVec3::new(depth, 1.0, 0.0), surface.shading, albedo.as_dvec3()];
    for (layer, value) in work.layers[work.first + first.index()..].iter_mut().zip(values) {
        *layer += value;
    }
}

/// The share of light that a surface sends on, by whatever lobe; all of it where the surface shines.
fn albedo(lobes: &Lobes) -> Rgb {
    let reflected = lobes.diffuse + lobes.mirror + lobes.base * lobes.microfacet;
    (reflected + lobes.transparency + lobes.refraction + lobes.emission).min(Rgb::ONE)
}
