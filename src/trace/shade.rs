//! Shading, eight paths at a time, whose materials share one set of lobes.
//!
//! In: a queue of paths at surfaces. Out: light for the sums, shadow rays, and the paths that continue.

use super::accumulate::Accumulator;
use super::bsdf::{Boundary, Bsdf, Reflected, Shininess};
use super::camera_rays::PixelSamples;
use super::coincident::Events;
use super::context::TraceContext;
use super::interaction::SurfaceInteraction;
use super::interface::Interface;
use super::intersect::HitStream;
use super::light::{LightRequest, LightSample, Receiver};
use super::materials::{Column, LobeSet, LobeTable};
use super::medium::MediaLists;
use super::shadow_stream::ShadowStream;
use super::stream::{PathState, PathStream};
use super::textures;
use crate::base::color::Rgb;
use crate::base::lanes::{Bits, Color, Lookup, Mask, Real, Row, lanes};
use crate::base::math::LaneRay;
use crate::base::stats::Counts;
use crate::camera::RayCone;
use crate::sampling::{FrameAxes, LaneSampler, dimension};

/// The state of a wave: inputs of its stages, and the streams to which they append.
pub struct WaveState<'a> {
    pub context: &'a TraceContext<'a>,
    pub paths: &'a PathStream,
    pub hits: &'a HitStream,
    pub events: &'a Events,
    pub next: &'a mut PathStream,
    pub samples: &'a PixelSamples,
    /// One stream for each light request.
    pub shadows: &'a mut [ShadowStream],
    pub sums: &'a mut Accumulator,
    pub counts: &'a mut Counts,
    pub media: &'a mut MediaLists,
    /// Rows for the lobes of eight textured points.
    pub rows: &'a mut LobeTable,
}

/// Paths at surfaces, with everything that both integrators need. It refers to paths and surfaces, since moving them takes
/// time: they are 3 kB in eight lanes.
pub struct ShadingContext<'a, F: Real> {
    /// Lanes that have a path.
    pub active: F::Mask,
    pub path: &'a PathState<F>,
    pub surface: &'a SurfaceInteraction<F>,
    pub lobes: LobeSet,
    pub interface: Interface<F>,
    /// The axes around the direction to the eye.
    pub eye: FrameAxes<F>,
    /// Lanes at a final surface, which reflects and refracts no light. It may only emit light or let it pass straight
    /// on.
    pub is_final: F::Mask,
    /// The random numbers of the paths, if the scene needs any.
    sampler: LaneSampler<F>,
    /// The key of the random numbers at the surfaces, if all paths share it.
    common_key: Option<u32>,
}

/// The lanes of paths, at most eight.
#[inline(always)]
pub fn active<F: Real>(items: &[u32]) -> F::Mask {
    F::Mask::from_bits(0xff >> (8 - items.len()))
}

impl<'a, F: Real> ShadingContext<'a, F> {
    /// The paths in the lanes of a mask, and the surfaces that they have hit, which are still to be found and to be prepared
    /// for materials with these lobes.
    #[inline(always)]
    pub fn new(
        wave: &mut WaveState,
        (path, surface): (&'a PathState<F>, &'a mut SurfaceInteraction<F>),
        active: F::Mask,
        lobes: LobeSet,
    ) -> Self {
        let context = wave.context;
        surface.find(context, &path.ray, active);
        surface.prepare(context, lobes, wave.events, active);
        if lobes.has(LobeSet::RELIEF) {
            textures::turn_normals(context, surface, path.ray.direction, active);
        }
        let surface = &*surface;
        let interface = match lobes.has(LobeSet::REFRACTION) {
            true => Interface::gather(context, (wave.media, wave.events), surface, path.medium, active),
            false => Interface::none(path.medium),
        };
        let to_eye = -path.ray.direction;
        // Only samples need frames.
        let eye = match context.is_random {
            true => FrameAxes::from_z_near_x(to_eye, context.picture_axes),
            false => FrameAxes { z: to_eye, ..FrameAxes::identity() },
        };
        let is_final = path.bounces_left.eq(F::U32::splat(0));
        let points = context.quality.points;
        let sampler = match context.is_random {
            true => wave.samples.sampler(path.slot, points),
            false => LaneSampler { pixel_hash: path.key, sample: path.key, kind: points },
        };
        Self {
            active,
            path,
            surface,
            lobes,
            interface,
            eye,
            is_final,
            sampler,
            common_key: wave.paths.common_key(),
        }
    }

    /// The rows of the lobes at the points, after textures were looked up.
    #[inline(always)]
    pub fn lobe_rows(&self, wave: &mut WaveState) -> LobeRows {
        if self.lobes.has(LobeSet::TEXTURED) {
            let needed = self.active & !self.is_final;
            let counts = &mut wave.counts.evaluations;
            let direction = self.path.ray.direction;
            let (context, rows) = (wave.context, &mut *wave.rows);
            let lanes = [self.active, needed];
            textures::look_up(context, self.lobes, self.surface, direction, lanes, rows, counts);
        }
        LobeRows::new::<F>(self.lobes, self.surface.material)
    }

    /// The lobes at the points, of these rows, without the coat.
    #[inline(always)]
    pub fn bsdf(&self, wave: &WaveState, rows: &LobeRows) -> Bsdf<'_, F> {
        let context = wave.context;
        let shininess = self.shininess(context);
        let ior = self.ior(context);
        let seen = (&self.surface.surface, &self.eye, context.is_random);
        Bsdf::gather(self.lobes, (rows.table(wave), &rows.at), shininess, ior, seen)
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

    /// The first N random numbers of a sample dimension at these surfaces.
    #[inline(always)]
    pub fn numbers<const N: usize>(&self, of: u32, index: u32) -> [F; N] {
        let dimension = match self.common_key {
            Some(key) => F::U32::splat(dimension::at_surface(of, key, index)),
            None => dimension::at_surface(of, self.path.key, index),
        };
        self.sampler.numbers(dimension)
    }

    /// The ray cones of rays that leave the surfaces, as if the surfaces were flat.
    #[inline(always)]
    pub fn cone(&self) -> RayCone<F> {
        RayCone { width: self.surface.width, ..self.path.cone }
    }

    /// Continues paths in the lanes of a mask straight through their surfaces. The ray keeps its origin, so its cone
    /// grows from there.
    #[inline(always)]
    pub fn pass_on(&self, wave: &mut WaveState, mask: F::Mask, state: &PathState<F>) {
        let (t, events) = (self.surface.at.t, self.surface.event.to_array());
        let (mut t_start, mut pending) = (t.to_array(), F::U32::splat(0).to_array());
        for lane in lanes(mask.bits()) {
            if let Some(event) = wave.events.get(events[lane]) {
                (t_start[lane], pending[lane]) = (event.t_last, event.next);
            }
        }
        let (t_start, pending) = (F::from_array(t_start), F::U32::from_array(pending));
        let (&PathState { ray, cone, .. }, medium) = (self.path, self.interface.behind);
        wave.next.push(mask, &PathState { ray, cone, t_start, pending, medium, ..*state });
    }

    /// Continues paths straight through surfaces that another medium hides. Returns the other lanes that have a path.
    #[inline(always)]
    pub fn pass_hidden(&self, wave: &mut WaveState) -> F::Mask {
        let hidden = self.interface.is_hidden;
        if !self.lobes.has(LobeSet::REFRACTION) || !hidden.any() {
            return self.active;
        }
        self.pass_on(wave, self.active & hidden, self.path);
        self.active & !hidden
    }

    /// Adds the ambient light that surfaces reflect.
    #[inline(always)]
    pub fn add_ambient(&self, wave: &mut WaveState, visible: F::Mask, rows: &LobeRows) {
        if let Some(ambient) = wave.context.ambient.filter(|_| self.lobes.has(LobeSet::AMBIENT)) {
            let share: Color<F::F32> = rows.table(wave).color(Column::AMBIENT, &rows.at);
            let light = self.path.throughput.at_surface() * share * Color::splat(ambient.radiance);
            wave.sums.add::<F>(ambient.layer, light, visible & !self.is_final, self.path.slot);
        }
    }

    /// Adds the emission of surfaces, weighted.
    #[inline(always)]
    pub fn add_emission(&self, wave: &mut WaveState, visible: F::Mask, weight: F::F32, rows: &LobeRows) {
        let emission: Color<F::F32> = rows.table(wave).color(Column::EMISSION, &rows.at);
        let light = self.path.throughput.at_emitter() * emission * weight;
        let mask = visible & light.is_lit();
        let (slots, materials) = (self.path.slot.to_array(), self.surface.material.to_array());
        let (r, g, b) = (light.r.to_array(), light.g.to_array(), light.b.to_array());
        for lane in lanes(mask.bits()) {
            let layer = wave.context.material(materials[lane]).emission_layer;
            wave.sums.add_to(layer, Rgb::new(r[lane], g[lane], b[lane]), slots[lane]);
        }
    }

    /// Samples light. It takes random numbers only if the request has a choice.
    #[inline(always)]
    pub fn sample_light(
        &self,
        wave: &mut WaveState,
        request: &LightRequest,
        wanted: F::Mask,
    ) -> LightSample<F> {
        let context = wave.context;
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
            wave.counts.evaluations.light_samples += u64::from(light.is_lit.bits().count_ones());
        }
        light
    }

    /// Adds the light of lights that cast no shadows, in the lanes of a mask. Returns the other lanes.
    #[inline(always)]
    pub fn add_unshadowed(
        &self,
        wave: &mut WaveState,
        request: &LightRequest,
        (sample, light): (&LightSample<F>, Color<F::F32>),
        lit: F::Mask,
    ) -> F::Mask {
        if !request.some_unshadowed {
            return lit;
        }
        wave.sums.add::<F>(request.layer, light, lit & !sample.casts_shadows, self.path.slot);
        lit & sample.casts_shadows
    }

    /// The shares of light that the surfaces reflect. Fog on the way to them dims only the share of glossy lobes.
    #[inline(always)]
    pub fn scattered(
        &self,
        wave: &mut WaveState,
        light: &LightSample<F>,
        reflected: &Reflected<F::F32>,
    ) -> Color<F::F32> {
        let one = F::F32::splat(1.0);
        let shown = light.is_lit & reflected.glossy.is_lit();
        let fog = match &wave.context.fog {
            Some(fog) if shown.any() => fog,
            _ => return reflected.scattered(one),
        };
        wave.counts.evaluations.fog += u64::from(shown.bits().count_ones());
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

/// The rows of a lobe table that hold the lobes of points.
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

    /// Textured points have rows of their own. Others use the rows of their materials.
    #[inline(always)]
    pub fn table<'a>(&self, wave: &'a WaveState) -> &'a LobeTable {
        if self.is_textured { wave.rows } else { &wave.context.table }
    }

    #[inline(always)]
    pub fn at(&self) -> &Lookup {
        &self.at
    }
}
