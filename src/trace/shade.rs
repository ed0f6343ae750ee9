//! The shade stage: surfaces that paths have come to, eight of one set of lobes at a time.
//!
//! In: a queue of paths at surfaces. Out: light for the sums, shadow rays, and the paths that go on.

use super::accumulate::Accumulator;
use super::bsdf::{Boundary, Bsdf, Reflected, Shininess};
use super::coincident::Events;
use super::context::TraceContext;
use super::generate::PixelSamples;
use super::interaction::SurfaceInteraction;
use super::interface::Interface;
use super::intersect::Hits;
use super::light::{LightRequest, LightSample, Receiver};
use super::materials::{Column, LobeSet, LobeTable};
use super::medium::MediaLists;
use super::shadow_stream::ShadowStream;
use super::stream::{PathState, PathStream};
use super::{path, textures, whitted};
use crate::base::color::Rgb;
use crate::base::lanes::{Bits, Color, Level, Lookup, Mask, Real, Row, SimdKernel, lanes};
use crate::base::math::LaneRay;
use crate::base::stats::Counts;
use crate::camera::RayCone;
use crate::sampling::{Frame, LaneSampler, dimension};
use crate::sequence::quality::Integrator;

/// What stages read, and what they append to.
pub struct Stage<'a> {
    pub context: &'a TraceContext<'a>,
    pub paths: &'a PathStream,
    pub hits: &'a Hits,
    pub events: &'a Events,
    pub next: &'a mut PathStream,
    pub samples: &'a PixelSamples,
    /// By the numbers of requests for light.
    pub shadows: &'a mut [ShadowStream],
    pub sums: &'a mut Accumulator,
    pub counts: &'a mut Counts,
    pub media: &'a mut MediaLists,
    /// Room for the lobes of eight textured points.
    pub rows: &'a mut LobeTable,
}

/// Shades the surfaces of a queue.
pub struct Shade<'a, 's> {
    pub stage: &'s mut Stage<'a>,
    pub queue: &'s [u32],
    pub lobes: LobeSet,
}

impl SimdKernel for Shade<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { stage, queue, lobes } = self;
        for which in queue.chunks(8) {
            match stage.context.quality.integrator {
                Integrator::Path(settings) => L::call(path::Shade { stage, which, lobes, settings }),
                Integrator::Whitted => L::call(whitted::Shade { stage, which, lobes }),
            }
        }
    }
}

/// Paths at surfaces, and what both integrators need to know of them.
pub struct ShadingContext<F: Real> {
    /// Lanes that have a path.
    pub there: F::Mask,
    pub path: PathState<F>,
    pub surface: SurfaceInteraction<F>,
    pub lobes: LobeSet,
    pub interface: Interface<F>,
    /// The frame around the direction to the eye.
    pub eye: Frame<F>,
    /// Lanes whose surface reflects and refracts no more light: it may only emit some, or let it pass straight on.
    pub is_final: F::Mask,
    /// The random numbers of the paths, where any are drawn.
    sampler: LaneSampler<F>,
}

impl<F: Real> ShadingContext<F> {
    #[inline(always)]
    pub fn gather(stage: &mut Stage, which: &[u32], lobes: LobeSet) -> Self {
        let at = Lookup::new(which);
        let there = F::Mask::from_bits(0xff >> (8 - which.len()));
        let path = stage.paths.gather::<F>(&at);
        let context = stage.context;
        let mut surface = SurfaceInteraction::gather(context, &path, (stage.hits, &at), there);
        surface.prepare(context, lobes, stage.events, there);
        let interface = match lobes.has(LobeSet::REFRACTION) {
            true => Interface::meet(context, (stage.media, stage.events), &surface, path.medium, there),
            false => Interface::none(path.medium),
        };
        let to_eye = -path.ray.direction;
        // Frames are for samples.
        let eye = match context.is_random {
            true => Frame::along(to_eye, context.picture_axes),
            false => Frame { z: to_eye, ..Frame::identity() },
        };
        let is_final = path.left.eq(F::U32::splat(0));
        let points = context.quality.points;
        let sampler = match context.is_random {
            true => stage.samples.sampler(path.slot, points),
            false => LaneSampler { pixel: path.key, sample: path.key, points },
        };
        Self { there, path, surface, lobes, interface, eye, is_final, sampler }
    }

    /// The lobes of the points.
    #[inline(always)]
    pub fn bsdf<'b>(&'b self, stage: &mut Stage) -> (Bsdf<'b, F>, LobeRows) {
        let context = stage.context;
        if self.lobes.has(LobeSet::TEXTURED) {
            let needed = self.there & !self.is_final;
            let counts = &mut stage.counts.evaluations;
            let direction = self.path.ray.direction;
            textures::look_up(context, &self.surface, direction, (self.there, needed), (stage.rows, counts));
        }
        let rows = LobeRows::new::<F>(self.lobes, self.surface.material);
        let shininess = self.shininess(context);
        let ior = self.ior(context);
        let seen = (&self.surface.surface, &self.eye, context.is_random);
        let bsdf = Bsdf::gather(self.lobes, (rows.table(stage), &rows.at), shininess, ior, seen);
        (bsdf, rows)
    }

    #[inline(always)]
    fn shininess(&self, context: &TraceContext) -> Shininess<F> {
        if !self.lobes.has(LobeSet::PHONG | LobeSet::BLINN_PHONG) {
            return Shininess::Whole(1);
        }
        let materials = self.surface.material.to_array();
        Shininess::gather(|lane| context.material(materials[lane]).shininess)
    }

    /// The indices of refraction of metallic-roughness surfaces.
    #[inline(always)]
    fn ior(&self, context: &TraceContext) -> F {
        let mut iors = F::splat(1.0).to_array();
        if self.lobes.has(LobeSet::MICROFACET) {
            let materials = self.surface.material.to_array();
            for lane in 0..F::LANES {
                iors[lane] = context.material(materials[lane]).medium.ior;
            }
        }
        F::from_array(iors)
    }

    /// The first N random numbers of a use at these surfaces.
    #[inline(always)]
    pub fn numbers<const N: usize>(&self, of: u32, which: u32) -> [F; N] {
        self.sampler.numbers(dimension::at_surface(of, self.path.key, which))
    }

    /// The cones of rays that leave the surfaces, as if these were flat.
    #[inline(always)]
    pub fn cone(&self) -> RayCone<F> {
        RayCone { width: self.surface.width, ..self.path.cone }
    }

    /// Sends paths in the lanes of a mask straight on through what they have come to: along the same ray, so that its cone
    /// goes on from where the ray starts.
    #[inline(always)]
    pub fn pass_on(&self, stage: &mut Stage, mask: F::Mask, state: &PathState<F>) {
        let (t, events) = (self.surface.at.t, self.surface.event.to_array());
        let (mut after, mut pending) = (t.to_array(), F::U32::splat(0).to_array());
        for lane in lanes(mask.bits()) {
            if let Some(event) = stage.events.get(events[lane]) {
                (after[lane], pending[lane]) = (event.after, event.next);
            }
        }
        let (after, pending) = (F::from_array(after), F::U32::from_array(pending));
        let (PathState { ray, cone, .. }, medium) = (self.path, self.interface.behind);
        stage.next.push(mask, &PathState { ray, cone, after, pending, medium, ..*state });
    }

    /// Sends paths straight on through surfaces that another medium hides. The other lanes that have a path.
    #[inline(always)]
    pub fn pass_hidden(&self, stage: &mut Stage) -> F::Mask {
        let hidden = self.interface.is_hidden;
        if !self.lobes.has(LobeSet::REFRACTION) || !hidden.any() {
            return self.there;
        }
        self.pass_on(stage, self.there & hidden, &self.path);
        self.there & !hidden
    }

    /// Adds the ambient light that surfaces reflect.
    #[inline(always)]
    pub fn add_ambient(&self, stage: &mut Stage, visible: F::Mask, rows: &LobeRows) {
        if let Some(ambient) = stage.context.ambient.filter(|_| self.lobes.has(LobeSet::AMBIENT)) {
            let share: Color<F::F32> = rows.table(stage).color(Column::AMBIENT, &rows.at);
            let light = self.path.throughput.lit() * share * Color::splat(ambient.radiance);
            stage.sums.add::<F>(ambient.layer, light, visible & !self.is_final, self.path.slot);
        }
    }

    /// Adds what surfaces emit, weighted.
    #[inline(always)]
    pub fn add_emission(&self, stage: &mut Stage, visible: F::Mask, weight: F::F32, rows: &LobeRows) {
        let emission: Color<F::F32> = rows.table(stage).color(Column::EMISSION, &rows.at);
        let light = self.path.throughput.shining() * emission * weight;
        let mask = visible & light.is_lit();
        let (slots, materials) = (self.path.slot.to_array(), self.surface.material.to_array());
        let (r, g, b) = (light.r.to_array(), light.g.to_array(), light.b.to_array());
        for lane in lanes(mask.bits()) {
            let layer = stage.context.material(materials[lane]).emission_layer;
            stage.sums.add_to(layer, Rgb::new(r[lane], g[lane], b[lane]), slots[lane]);
        }
    }

    /// Samples light. Random numbers are drawn where there is a choice.
    #[inline(always)]
    pub fn sample_light(&self, stage: &mut Stage, request: &LightRequest, wanted: F::Mask) -> LightSample<F> {
        let context = stage.context;
        let (mut u, mut choice) = ([F::splat(0.0); 2], F::splat(0.0));
        if request.is_sampled {
            u = self.numbers(dimension::LIGHT, request.number);
        }
        if request.is_choice() {
            [choice] = self.numbers(dimension::CHOICE, request.layer.0);
        }
        let point = self.surface.surface.point;
        let at = Receiver { point, eye: &self.eye, rounding: context.rounding };
        let mut light = context.lights.sample(request, &at, u, choice);
        light.is_lit = light.is_lit & wanted;
        if request.is_sampled {
            stage.counts.evaluations.light_samples += u64::from(light.is_lit.bits().count_ones());
        }
        light
    }

    /// The shares of light that the surfaces scatter, dimmed by the fog on its way to them: that which glossy lobes show.
    #[inline(always)]
    pub fn scattered(
        &self,
        stage: &mut Stage,
        light: &LightSample<F>,
        reflected: &Reflected<F::F32>,
    ) -> Color<F::F32> {
        let one = F::F32::splat(1.0);
        let shown = light.is_lit & reflected.glossy.is_lit();
        let fog = match &stage.context.fog {
            Some(fog) if shown.any() => fog,
            _ => return reflected.scattered(one),
        };
        stage.counts.evaluations.fog += u64::from(shown.bits().count_ones());
        let point = self.surface.surface.point;
        let segment = LaneRay { origin: point, direction: light.direction };
        reflected.scattered(one - fog.opacity(&segment, light.distance(point)).to_f32())
    }

    /// The boundaries of the surfaces.
    #[inline(always)]
    pub fn boundary(&self) -> &Boundary<F> {
        &self.interface.boundary
    }
}

/// Where the lobes of points are looked up.
pub struct LobeRows {
    is_textured: bool,
    at: Lookup,
}

impl LobeRows {
    #[inline(always)]
    pub fn new<F: Real>(lobes: LobeSet, materials: F::U32) -> Self {
        let (lanes, mut indices) = (materials.to_array(), [0; 8]);
        let count = F::LANES;
        for lane in 0..8 {
            indices[lane] = lanes[lane.min(count - 1)];
        }
        let is_textured = lobes.has(LobeSet::TEXTURED);
        Self { is_textured, at: if is_textured { Lookup::run(0, count) } else { Lookup::new(&indices) } }
    }

    /// Textured points have rows of their own, others those of their materials.
    #[inline(always)]
    pub fn table<'a>(&self, stage: &'a Stage) -> &'a LobeTable {
        if self.is_textured { stage.rows } else { &stage.context.table }
    }

    #[inline(always)]
    pub fn at(&self) -> &Lookup {
        &self.at
    }
}
