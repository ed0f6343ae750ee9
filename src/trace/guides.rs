//! What a camera's ray meets first, for those who ask: depth, normal and albedo. It is looked up by a ray of its own,
//! so that pictures without guides take no work for them, and those with them have the same light.

use super::media::Media;
use super::place::Passed;
use super::tracer::{Met, Tracer, Work};
use crate::camera::{Beam, Ray};
use crate::color::Rgb;
use crate::film::LayerId;
use crate::material::Lobes;
use crate::math::DVec3;

/// Adds to the sample in hand what the ray meets, from the layer `first` on. A ray that meets nothing adds nothing.
pub fn record(tracer: &Tracer, (ray, beam): (&Ray, &Beam), first: LayerId, work: &mut Work) {
    let (surface, albedo) = match first_there(tracer, (ray, beam), work) {
        Some(Met::Surface(face)) => (face.surface, albedo(&face.lobes)),
        Some(Met::Light { surface, .. }) => (surface, Rgb::ONE),
        Some(Met::Nothing) | None => return,
    };
    let camera = tracer.scene.camera;
    let depth = (surface.point - camera.position).dot(camera.basis.forward);
    let values = [DVec3::new(depth, 1.0, 0.0), surface.shading, albedo.as_dvec3()];
    for (layer, value) in work.layers[work.first + first.index()..].iter_mut().zip(values) {
        *layer += value;
    }
}

/// What the ray meets first, but for parts of surfaces that are not there.
fn first_there<'a>(tracer: &Tracer<'a>, (ray, beam): (&Ray, &Beam), work: &mut Work) -> Option<Met<'a>> {
    let mut passed: Option<Passed> = None;
    loop {
        let closest = || tracer.closest(ray);
        let stop = tracer.next_stop((ray, passed), f64::INFINITY, closest, Media::default(), work)?;
        let met = tracer.met(ray, stop, beam.after(stop.passed.t));
        let Met::Surface(face) = &met else { return Some(met) };
        if !face.material.is_cut_out() || face.lobes.transparency != Rgb::ONE {
            return Some(met);
        }
        passed = Some(face.passed);
    }
}

/// The share of light that a surface sends on, by whatever lobe; all of it where the surface shines.
fn albedo(lobes: &Lobes) -> Rgb {
    let reflected = lobes.diffuse + lobes.mirror + lobes.base * lobes.microfacet;
    (reflected + lobes.transparency + lobes.refraction + lobes.emission).min(Rgb::ONE)
}
