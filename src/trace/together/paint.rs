//! Paint under eight rays. It is looked up for one after the other, as what it is made of differs from point to point.

use super::super::tracer::Tracer;
use super::Pixels;
use super::shade::{Color, Reflectors};
use crate::bvh::Hits;
use crate::color::Rgb;
use crate::shape::{Rays, Surface, Surfaces, lanes};
use crate::simd::Lanes;
use crate::texture::Footprint;

/// The beams of eight rays, as [`Beam`](crate::camera::Beam) is one.
pub struct Beams {
    widths: [f64; 8],
    spreads: [f64; 8],
}

impl Beams {
    /// Of rays from the camera.
    pub fn new(tracer: &Tracer, pixels: &Pixels, rays: &Rays) -> Self {
        let height = 2.0 / f64::from(pixels.size.1);
        let mut beams = Self { widths: [0.0; 8], spreads: [0.0; 8] };
        for lane in lanes(pixels.wanted) {
            let beam = tracer.scene.camera.beam(&rays.one(lane), height);
            (beams.widths[lane], beams.spreads[lane]) = (beam.width, beam.spread);
        }
        beams
    }

    /// Goes on to what the rays have met.
    pub fn advance(&mut self, hits: &Hits) {
        for lane in lanes(hits.at.met) {
            self.widths[lane] += self.spreads[lane] * hits.at.t[lane];
        }
    }
}

/// What paint makes of eight surfaces.
struct Painted {
    ambient: [[f32; 8]; 3],
    diffuse: [[f32; 8]; 3],
    specular: [[f32; 8]; 3],
    mirror: [[f32; 8]; 3],
    /// A bit for each with a highlight, or a mirror.
    shining: u32,
    mirrors: u32,
}

impl Painted {
    /// Of surfaces whose bits are set, which have not been turned to the rays yet.
    #[inline(never)]
    fn of(eye: &Eye, surfaces: &Surfaces, materials: &[u32; 8], wanted: u32) -> Self {
        let &Eye { tracer, rays, hits, beams } = eye;
        let black = [[0.0; 8]; 3];
        let mut found =
            Self { ambient: black, diffuse: black, specular: black, mirror: black, shining: 0, mirrors: 0 };
        for lane in lanes(wanted) {
            let Some(hit) = hits.one(lane) else { continue };
            let (point, error) = (surfaces.point.one(lane), surfaces.error.one(lane));
            let surface = Surface::new(point, error, surfaces.normal.one(lane));
            let seen = Footprint::new(beams.widths[lane], rays.direction.one(lane), surface.normal);
            let material = &tracer.scene.shading.materials[materials[lane] as usize];
            let spot = tracer.scene.geometry.spot(&hit, &surface, &seen, material.is_printed());
            let lobes = material.painted(&spot);
            for (rows, color) in [
                (&mut found.ambient, lobes.ambient),
                (&mut found.diffuse, lobes.diffuse),
                (&mut found.specular, lobes.specular),
                (&mut found.mirror, lobes.mirror),
            ] {
                rows.iter_mut().zip(color.to_array()).for_each(|(row, value)| row[lane] = value);
            }
            found.shining |= u32::from(lobes.specular != Rgb::ZERO) << lane;
            found.mirrors |= u32::from(lobes.mirror != Rgb::ZERO) << lane;
        }
        found
    }
}

/// From where surfaces are seen.
pub struct Eye<'a> {
    pub tracer: &'a Tracer<'a>,
    pub rays: &'a Rays,
    pub hits: &'a Hits,
    pub beams: &'a Beams,
}

impl<L: Lanes> Reflectors<L> {
    /// Gives the painted ones their colours; they have not been turned to the rays yet.
    #[inline(always)]
    pub fn paint(&mut self, eye: &Eye) {
        let painted = self.painted;
        let found = Painted::of(eye, &self.surfaces, &self.materials, painted);
        self.ambient = Color::load(&found.ambient).pick(painted, self.ambient);
        self.diffuse = Color::load(&found.diffuse).pick(painted, self.diffuse);
        self.specular = Color::load(&found.specular).pick(painted, self.specular);
        self.mirror = Color::load(&found.mirror).pick(painted, self.mirror);
        self.mirrors = self.mirrors & !painted | found.mirrors;
        self.shines.any = self.shines.any & !painted | found.shining;
    }
}
