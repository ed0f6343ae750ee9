//! The path integrator: one path per sample. At every surface light is sampled from every layer's sources, and the path
//! goes on by one lobe (Kajiya, *The Rendering Equation*, 1986; multiple importance sampling by the balance heuristic,
//! Veach 1997).
//!
//! A path reflects or refracts at most at as many surfaces as the quality sets. At the last one, diffuse light comes from
//! sampled sources alone; a final ray, which only sees what emits light, is traced for lobes and sources that sampling
//! does not serve.

use super::bsdf::{Bsdf, BsdfSample};
use super::light::LightRequest;
use super::materials::LobeSet;
use super::shade::{ShadingContext, Stage};
use super::shadow_stream::ShadowItem;
use super::spawn::{Spawn, spawn, spawn_gathering, spawn_mirrored};
use super::stream::{PathState, Throughput, flags};
use crate::base::lanes::{Bits, Color, Level, Mask, Real, Row, Select, SimdKernel, Single, Vec3};
use crate::base::math::LaneRay;
use crate::sampling::dimension;
use crate::sequence::quality::PathSettings;

/// Up to eight paths at surfaces whose materials have lobes of one set.
pub struct Shade<'a, 's, 'w> {
    pub stage: &'s mut Stage<'a>,
    pub which: &'w [u32],
    pub lobes: LobeSet,
    pub settings: PathSettings,
}

impl SimdKernel for Shade<'_, '_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { stage, which, lobes, settings } = self;
        let at = ShadingContext::<L::F64>::gather(stage, which, lobes);
        PathShade { at: &at, settings }.run(stage);
    }
}

struct PathShade<'a, F: Real> {
    at: &'a ShadingContext<F>,
    settings: PathSettings,
}

/// Lanes whose bits of a flag are set.
#[inline(always)]
pub fn has_flag<F: Real>(flags: F::U32, flag: u32) -> F::Mask {
    !flags.and(F::U32::splat(flag)).eq(F::U32::splat(0))
}

/// The balance heuristic: the weight of a direction that one technique drew with a density, and that another one draws
/// with the other density. All of it where there was no choice of direction.
#[inline(always)]
fn balance<F: Real>(pdf: F, other: F) -> F {
    F::select(F::splat(0.0).lt(pdf), pdf / (pdf + other), F::splat(1.0))
}

/// The weight of light that a path meets, against the density with which it was sampled where the path was scattered
/// last. All of it where it was not sampled.
#[inline(always)]
pub fn mis_weight<F: Real>(path: &PathState<F>, sampled: F) -> F::F32 {
    let (zero, one) = (F::splat(0.0), F::splat(1.0));
    let counted = has_flag::<F>(path.flags, flags::LIGHT_COUNTED);
    let weight = F::select(counted, zero, balance(path.pdf, sampled));
    F::select(zero.lt(sampled), weight, one).to_f32()
}

impl<F: Real> PathShade<'_, F> {
    #[inline(always)]
    fn run(&self, stage: &mut Stage) {
        let ShadingContext { path, surface, lobes, is_final, .. } = self.at;
        let visible = self.at.pass_hidden(stage);
        let (bsdf, rows) = self.at.bsdf(stage);
        self.at.add_ambient(stage, visible, &rows);
        if lobes.has(LobeSet::EMISSION) {
            let mut weight = F::F32::splat(1.0);
            if stage.context.columns.mis {
                let lights = &stage.context.lights;
                let point = &surface.surface;
                weight =
                    mis_weight(path, lights.pdf_of_hit(path.scattered_at, surface.primitive, point, visible));
            }
            self.at.add_emission(stage, visible, weight, &rows);
        }
        let open = visible & !*is_final;
        let last = open & path.left.eq(F::U32::splat(1));
        if lobes.has(LobeSet::REFLECTS_LIGHTS) && open.any() {
            for index in 0..stage.context.lights.requests().len() {
                let request = stage.context.lights.requests()[index];
                self.sample_light(stage, &bsdf, (&request, index), open, last);
            }
        }
        self.go_on(stage, &bsdf, visible, last);
    }

    /// Whether light is sampled in full at a path's last surface. Lobes that are narrower than lights find them better by
    /// their own directions, so both are weighed.
    #[inline(always)]
    fn samples_all_light(&self) -> bool {
        !self.at.lobes.has(LobeSet::FUZZ | LobeSet::MICROFACET)
    }

    /// Samples light, and appends the shadow rays along which it may come.
    #[inline(always)]
    fn sample_light(
        &self,
        stage: &mut Stage,
        bsdf: &Bsdf<F>,
        (request, light_index): (&LightRequest, usize),
        open: F::Mask,
        last: F::Mask,
    ) {
        let ShadingContext { path, surface, .. } = self.at;
        let light = self.at.sample_light(stage, request, open);
        if !light.is_lit.any() {
            return;
        }
        let (zero, one) = (F::splat(0.0), F::splat(1.0));
        let reflected = bsdf.reflected(light.direction);
        let scattered = self.at.scattered(stage, &light, &reflected);
        // What directions of the surface's own may find as well counts less here.
        let mut rest = F::F32::splat(0.0);
        if request.is_sampled && stage.context.columns.mis {
            let pdf = bsdf.pdf(&bsdf.chances(), light.direction);
            let is_all = if self.samples_all_light() { last } else { F::Mask::splat(false) };
            rest = F::select(is_all, zero, one - balance(light.pdf, pdf)).to_f32();
        }
        let radiance = path.throughput.lit() * light.radiance;
        let (whole, weighed) = (radiance * (scattered + reflected.highlight), radiance * scattered * rest);
        let item = ShadowItem {
            ray: light.shadow_ray(&surface.surface),
            light: if stage.context.clear { whole } else { whole - weighed },
            weighed,
            medium: path.medium,
            slot: path.slot,
        };
        stage.shadows[light_index].push(light.is_lit & whole.is_lit(), &item);
    }

    /// Sends paths on by one lobe.
    #[inline(always)]
    fn go_on(&self, stage: &mut Stage, bsdf: &Bsdf<F>, visible: F::Mask, last: F::Mask) {
        let ShadingContext { lobes, is_final, .. } = self.at;
        let context = stage.context;
        let lobes = *lobes;
        let directed = lobes.has(LobeSet::MIRROR | LobeSet::MICROFACET | LobeSet::REFRACTION);
        let final_rays = context.unsampled_light || (context.emits && directed);
        let turns = visible & !*is_final;
        let turns = if final_rays { turns } else { turns & !last };
        let goes = if lobes.has(LobeSet::TRANSPARENT) { visible } else { turns };
        if !goes.any() {
            return;
        }
        let sample = bsdf.sample(self.at.boundary(), self.scatter_numbers());
        let mut goes = goes & sample.goes_on() & (turns | sample.is_transmitted);
        if !context.unsampled_light && self.samples_all_light() {
            goes = goes & !(last & sample.is_scattered);
        }
        let mut state = self.next_state(stage, bsdf, &sample, last);
        goes = goes & state.throughput.shining().is_lit();
        goes = goes & self.survives(stage, &mut state);
        self.count(stage, &sample, goes);
        if lobes.has(LobeSet::TRANSPARENT) {
            let passes = goes & sample.is_transmitted;
            self.at.pass_on(stage, passes, &state);
            goes = goes & !sample.is_transmitted;
        }
        stage.next.push(goes, &state);
    }

    /// As many numbers in 0..1 as the lobes need; the others are 0.
    #[inline(always)]
    fn scatter_numbers(&self) -> [F; 4] {
        let (zero, lobes) = (F::splat(0.0), self.at.lobes);
        if lobes.has(LobeSet::FUZZ) {
            self.at.numbers(dimension::SCATTER, 0)
        } else if lobes.is_only(LobeSet::DIFFUSE) {
            let [u, v] = self.at.numbers(dimension::SCATTER, 0);
            [u, v, zero, zero]
        } else if lobes.is_only(LobeSet::MIRROR) || lobes.is_only(LobeSet::TRANSPARENT) {
            [zero; 4]
        } else {
            let [u, v, w] = self.at.numbers(dimension::SCATTER, 0);
            [u, v, w, zero]
        }
    }

    /// Paths after they have left the surface.
    #[inline(always)]
    fn next_state(
        &self,
        stage: &Stage,
        bsdf: &Bsdf<F>,
        sample: &BsdfSample<F>,
        last: F::Mask,
    ) -> PathState<F> {
        let ShadingContext { path, surface, interface, .. } = self.at;
        let (zero, columns) = (F::splat(0.0), stage.context.columns);
        let at = &surface.surface;
        let mut ray = Spawn::select(
            sample.is_scattered,
            spawn_gathering(at, sample.direction),
            spawn(at, sample.direction),
        );
        if self.at.lobes.has(LobeSet::MIRROR | LobeSet::MICROFACET | LobeSet::REFRACTION) {
            ray = Spawn::select(sample.is_mirrored, spawn_mirrored(at, sample.direction), ray);
        }
        let one_less = path.left.wrapping_add(F::U32::splat(u32::MAX));
        let mut state = PathState {
            ray: LaneRay { origin: ray.origin, direction: ray.direction },
            throughput: leave(&path.throughput, sample, columns.fog),
            cone: self.at.cone(),
            left: F::U32::select(sample.is_transmitted, path.left, one_less),
            after: zero,
            pending: F::U32::splat(0),
            ..*path
        };
        if columns.media {
            let passes = sample.is_refracted & bsdf.passes(sample.direction);
            state.medium = F::U32::select(passes, interface.behind, path.medium);
        }
        if columns.mis {
            // Straight on: what was drawn before still leads there.
            state.scattered_at = Vec3::select(sample.is_scattered, at.point, path.scattered_at);
            state.pdf = F::select(sample.is_transmitted, path.pdf, sample.pdf);
        }
        state.flags = self.next_flags(sample, last);
        state
    }

    #[inline(always)]
    fn next_flags(&self, sample: &BsdfSample<F>, last: F::Mask) -> F::U32 {
        let before = self.at.path.flags;
        let (none, sampled) = (F::U32::splat(0), F::U32::splat(flags::LIGHT_SAMPLED));
        let counted = F::U32::splat(flags::LIGHT_SAMPLED | flags::LIGHT_COUNTED);
        // No shadow ray goes by a mirror.
        let mut after = F::U32::select(sample.is_scattered, sampled, none);
        if self.settings.refractive_shadows {
            let through = F::U32::select(has_flag::<F>(before, flags::LIGHT_SAMPLED), counted, none);
            after = F::U32::select(sample.is_refracted, through, after);
        }
        if self.samples_all_light() {
            after = F::U32::select(last & sample.is_scattered, counted, after);
        }
        F::U32::select(sample.is_transmitted, before, after)
    }

    /// Russian roulette: dim paths end at random, and those that go on make up for them.
    #[inline(always)]
    fn survives(&self, stage: &Stage, state: &mut PathState<F>) -> F::Mask {
        let (all, quality) = (F::Mask::splat(true), stage.context.quality);
        let Some(after) = self.settings.roulette.filter(|after| *after < quality.surfaces()) else {
            return all;
        };
        let dims = state.left.lt(F::U32::splat(quality.surfaces() - after));
        if !dims.any() {
            return all;
        }
        let [u] = self.at.numbers(dimension::ROULETTE, 0);
        let one = F::F32::splat(1.0);
        let chance = state.throughput.shining().max_element().min(F::F32::splat(0.95));
        let chance = F::F32::select(dims, chance, one);
        state.throughput.diffuse = state.throughput.diffuse / chance;
        state.throughput.specular = state.throughput.specular / chance;
        u.lt(chance.to_f64())
    }

    #[inline(always)]
    fn count(&self, stage: &mut Stage, sample: &BsdfSample<F>, goes: F::Mask) {
        let (rays, lobes) = (&mut stage.counts.rays, self.at.lobes);
        rays.scattered += u64::from((goes & sample.is_scattered).bits().count_ones());
        if lobes.has(LobeSet::MIRROR | LobeSet::MICROFACET | LobeSet::REFRACTION) {
            rays.mirror += u64::from((goes & sample.is_mirrored).bits().count_ones());
        }
        if lobes.has(LobeSet::PASSES) {
            let passed = sample.is_refracted | sample.is_transmitted;
            rays.transmitted += u64::from((goes & passed).bits().count_ones());
        }
    }
}

/// What is left of the light beyond a surface, which gathers and shows shares of it.
#[inline(always)]
fn leave<F: Real>(before: &Throughput<F::F32>, sample: &BsdfSample<F>, fog: bool) -> Throughput<F::F32> {
    let one = F::F32::splat(1.0);
    if !fog {
        let specular = before.specular * (sample.diffuse + sample.specular);
        return Throughput { diffuse: Color::black(), specular, clear: one };
    }
    let lit = before.lit();
    let passes = sample.is_transmitted;
    Throughput {
        diffuse: Color::select(passes, before.diffuse * sample.specular, lit * sample.diffuse),
        specular: Color::select(passes, before.specular * sample.specular, lit * sample.specular),
        clear: F::F32::select(passes, before.clear, one),
    }
}
