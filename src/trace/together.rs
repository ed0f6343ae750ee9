//! Whitted's integrator for eight rays at once, in scenes where each ray leads to at most one other: whose surfaces are
//! not rough, reflect and do not let pass, and whose lights are points or infinitely far away.
//!
//! Eight neighbours of a picture meet mostly the same. Every number is computed as `whitted` does, lane by lane, so that
//! pictures do not tell how many rays were traced at once.

pub mod camera;
mod lights;
mod paint;
mod shade;
mod starts;

use super::tracer::Tracer;
use crate::bvh::Hits;
use crate::color::Rgb;
use crate::counters::Counts;
use crate::film::LayerId;
use crate::light::Source;
use crate::material::{MadeOf, Material};
use crate::math::{DVec2, DVec3};
use crate::scene::{Finish, Primitive};
use crate::shape::{Rays, Shape, Surface, lanes};
use crate::simd::{Lanes, Octo, Quad, Vector, Work, dispatch};
pub use lights::Arrivals;
use paint::Beams;
pub use shade::Color;
use shade::Reflectors;
pub use starts::Starts;

/// What eight rays add to each layer: red, green and blue of each.
pub struct Sums {
    pub layers: Vec<[[f64; 8]; 3]>,
    pub counts: Counts,
}

impl Sums {
    pub fn new(layers: usize) -> Self {
        Self { layers: vec![[[0.0; 8]; 3]; layers], counts: Counts::default() }
    }

    /// Adds to the rays whose bits are set.
    #[inline(always)]
    fn add<L: Lanes>(&mut self, layer: LayerId, radiance: Color<L>, rays: u32) {
        let sums = &mut self.layers[layer.index()];
        let none = L::splat(0.0);
        for (sum, radiance) in sums.iter_mut().zip([radiance.r, radiance.g, radiance.b]) {
            let more = radiance.pick(rays, none).store().map(f64::from);
            *sum = (Octo::<L::Quad>::load(sum) + Octo::load(&more)).store();
        }
    }

    /// Adds to one ray.
    fn add_to(&mut self, lane: usize, layer: LayerId, radiance: Rgb) {
        let sums = &mut self.layers[layer.index()];
        for (sum, radiance) in sums.iter_mut().zip(radiance.to_array()) {
            sum[lane] += f64::from(radiance);
        }
    }
}

/// Whether the tracer's scene is one in which rays are traced together.
pub fn suits(tracer: &Tracer) -> bool {
    let shading = tracer.scene.shading;
    let plain = |index: u32| {
        let material = &shading.materials[index as usize];
        let lobes = &material.lobes;
        let sharp = !lobes.is_fuzzy() || lobes.mirror == Rgb::ZERO;
        let shines_evenly = material.paints.is_empty() || lobes.emission == Rgb::ZERO;
        // Paint may make a mirror fuzzier than it is where nothing is painted.
        let stays_sharp = material.paints.is_empty() || lobes.fuzz == 0.0 || lobes.mirror == Rgb::ZERO;
        sharp && stays_sharp && shines_evenly && lobes.microfacet == 0.0
    };
    let is_plain = |finish: &Finish| match finish {
        Finish::Material(MadeOf::One(index)) => plain(*index),
        Finish::Material(MadeOf::Slots { .. }) | Finish::Light(_) => false,
    };
    let lit = |source: &Source| {
        matches!(source, Source::Point { .. } | Source::Spot { .. } | Source::Directional { .. })
    };
    let bare = tracer.fog.is_none() && !tracer.media && !tracer.clear;
    // Light may be looked for above the surface of a mesh, and meshes are met ray by ray anyway.
    let suited =
        |primitive: &Primitive| is_plain(&primitive.finish) && !matches!(primitive.shape, Shape::Mesh(_));
    bare && tracer.scene.geometry.primitives.iter().all(suited)
        && tracer.lights.iter().all(|(_, light)| lit(&light.source))
}

/// Eight pixels of a picture, and where in each of them a ray goes.
pub struct Pixels {
    /// Width and height of the picture.
    pub size: (u32, u32),
    pub pixels: [(u32, u32); 8],
    pub inside: DVec2,
    /// A bit for each that is wanted.
    pub wanted: u32,
}

/// Adds what is seen through pixels.
pub fn follow(tracer: &Tracer, pixels: &Pixels, sums: &mut Sums) {
    dispatch(Follow { tracer, pixels, sums });
}

struct Follow<'a, 't> {
    tracer: &'a Tracer<'t>,
    pixels: &'a Pixels,
    sums: &'a mut Sums,
}

impl Work for Follow<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { tracer, pixels: &Pixels { size, ref pixels, inside, wanted }, sums } = self;
        sums.counts.rays.camera += u64::from(wanted.count_ones());
        let x = Octo::load(&pixels.map(|(x, _)| f64::from(x))) + Octo::splat(inside.x);
        let y = Octo::load(&pixels.map(|(_, y)| f64::from(y))) + Octo::splat(inside.y);
        let rays = camera::rays::<L::Quad>(tracer.scene.camera, size, [x, y], &[[0.0; 8]; 2]);
        let mut bundle = Bundle::<L> { rays, throughput: Color::splat(Rgb::ONE), wanted };
        let mut beams = tracer.painted.then(|| Beams::new(tracer, self.pixels, &bundle.rays));
        let mut left = tracer.quality.surfaces();
        while bundle.wanted != 0 && left > 0 {
            bundle = bundle.step(tracer, left, beams.as_mut(), sums);
            left -= 1;
        }
        if bundle.wanted != 0 {
            bundle.end(tracer, sums);
        }
    }
}

/// Eight rays on their way.
struct Bundle<L: Lanes> {
    rays: Rays,
    throughput: Color<L>,
    /// A bit for each ray that is followed.
    wanted: u32,
}

impl<L: Lanes> Bundle<L> {
    /// What the rays meet, with the surfaces where several coincide; the sky's light is added where that is nothing.
    #[inline(always)]
    fn meet(&self, tracer: &Tracer, sums: &mut Sums) -> (Hits, Vec<(usize, Surface)>) {
        let Self { rays, throughput, wanted } = self;
        let mut hits = tracer.bvh.closest_together::<L>(tracer.scene.geometry, rays, *wanted);
        if let Some(environment) = tracer.environment {
            for lane in lanes(wanted & !hits.at.met) {
                let sky = environment.radiance(rays.direction.one(lane));
                sums.add_to(lane, environment.layer, throughput.one(lane) * sky);
            }
        }
        let places =
            if hits.at.crowded & hits.at.met == 0 { Vec::new() } else { tracer.settle(rays, &mut hits) };
        (hits, places)
    }

    /// Adds what shines by itself to a ray.
    fn add_emission(&self, lane: usize, material: &Material, sums: &mut Sums) {
        sums.add_to(lane, material.emission_layer, self.throughput.one(lane) * material.lobes.emission);
    }

    /// Follows the rays behind the last surfaces that reflect, where only what gives off light is seen.
    #[inline(always)]
    fn end(self, tracer: &Tracer, sums: &mut Sums) {
        let (hits, _) = self.meet(tracer, sums);
        for lane in lanes(hits.at.met) {
            let Some(hit) = hits.one(lane) else { continue };
            let material = tracer.material_of(&hit);
            if material.lobes.emission != Rgb::ZERO {
                self.add_emission(lane, material, sums);
            }
        }
    }

    /// Follows the rays to where they end; gives those that start there. `left` surfaces may still reflect light.
    #[inline(always)]
    fn step(self, tracer: &Tracer, left: u32, mut beams: Option<&mut Beams>, sums: &mut Sums) -> Self {
        let (hits, places) = self.meet(tracer, sums);
        let Self { rays, throughput, .. } = self;
        let met = hits.at.met;
        if met == 0 {
            return Self { wanted: 0, ..self };
        }
        if let Some(beams) = &mut beams {
            beams.advance(&hits);
        }
        let found = Reflectors::<L>::of(tracer, &rays, &hits, &places, beams.as_deref());
        sums.counts.evaluations.paint += u64::from(found.painted.count_ones());
        if let Some(ambient) = &tracer.ambient {
            let share = throughput.times(found.ambient).times(Color::splat(ambient.radiance));
            sums.add(ambient.layer, share, met);
        }
        for lane in lanes(found.emissive) {
            let material = &tracer.scene.shading.materials[found.materials[lane] as usize];
            self.add_emission(lane, material, sums);
        }
        let starts = Starts::new(&found.surfaces);
        for (_, light) in &tracer.lights {
            let (arrivals, arriving) = Arrivals::<L>::of(light, Vector::load(&found.surfaces.point));
            let (share, lit) = found.reflected(arrivals.direction, met & arriving);
            if lit == 0 {
                continue;
            }
            let (shadow, t_max) = arrivals.shadow_rays(&starts);
            let way = Vector::<L::Quad>::load(&shadow.direction).longest();
            let moving = Octo::splat(0.0).below(way).bits();
            sums.counts.rays.shadow += u64::from((lit & moving).count_ones());
            let hidden = match lit & moving {
                0 => 0,
                moving => tracer.bvh.occluded_together::<L>(tracer.scene.geometry, &shadow, moving, t_max),
            };
            let radiance = throughput.times(share).times(arrivals.radiance);
            sums.add(light.layer, radiance, lit & !hidden);
        }
        let share = throughput.times(found.mirror);
        let bright = L::splat(tracer.quality.threshold).at_most(share.largest());
        let on = met & found.mirrors & bright & if tracer.goes_on(left) { 0xff } else { 0 };
        sums.counts.rays.mirror += u64::from(on.count_ones());
        Self { rays: starts.mirrored(found.mirrored), throughput: share, wanted: on }
    }
}

/// The point that a vector of the world stands for, in all lanes.
#[inline(always)]
fn everywhere<Q: Quad>(point: DVec3) -> Vector<Q> {
    Vector::splat(point)
}

#[cfg(test)]
mod tests;
