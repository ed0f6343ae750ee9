//! The path integrator: one path per sample. At every surface it samples light from the sources of every layer, then
//! continues the path by one lobe (Kajiya, *The Rendering Equation*, 1986; multiple importance sampling by the balance
//! heuristic, Veach 1997).
//!
//! The quality sets the most bounces of a path. At the last surface, diffuse light comes from sampled sources alone. A
//! final ray, which finds only emitted light, is traced for lobes and sources that sampling does not cover.

use super::bsdf::{Bsdf, BsdfSample};
use super::interaction::SurfaceInteraction;
use super::light::LightRequest;
use super::materials::LobeSet;
use super::shade::{ShadingContext, WaveState, active};
use super::shadow_stream::ShadowItem;
use super::spawn::{Spawn, spawn, spawn_lifted, spawn_reflected};
use super::stream::{PathState, Throughput, flags};
use crate::base::lanes::{Bits, Color, Level, Lookup, Mask, Real, Row, Select, SimdKernel, Single, Vec3};
use crate::base::math::LaneRay;
use crate::sampling::dimension;
use crate::sequence::quality::PathSettings;

/// Up to eight paths at surfaces whose materials share one set of lobes.
pub struct ShadePaths<'a, 's, 'w> {
    pub wave: &'s mut WaveState<'a>,
    pub items: &'w [u32],
    pub lobes: LobeSet,
    pub settings: PathSettings,
}

impl SimdKernel for ShadePaths<'_, '_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { wave, items, lobes, settings } = self;
        let (places, active) = (Lookup::ascending(items), active::<L::F64>(items));
        let path = wave.paths.gather::<L::F64>(&places);
        let mut surface = SurfaceInteraction::at_hits(&path, (wave.hits, &places));
        let at = ShadingContext::new(wave, (&path, &mut surface), active, lobes);
        PathShader { at: &at, settings }.run(wave);
    }
}

struct PathShader<'a, F: Real> {
    at: &'a ShadingContext<'a, F>,
    settings: PathSettings,
}

/// Lanes whose flags contain this flag.
#[inline(always)]
pub fn has_flag<F: Real>(flags: F::U32, flag: u32) -> F::Mask {
    !flags.and(F::U32::splat(flag)).eq(F::U32::splat(0))
}

/// The balance heuristic: the weight of a direction that one technique sampled with the density `pdf`, if another
/// technique samples it with the density `other`. It is 1 for a delta distribution, where `pdf` is 0.
#[inline(always)]
fn balance<F: Real>(pdf: F, other: F) -> F {
    F::select(F::splat(0.0).lt(pdf), pdf / (pdf + other), F::splat(1.0))
}

/// The weight of light that a path hits. `sampled` is the density of sampling that light from the last surface that
/// scattered the path. The weight is 1 if the light was not sampled.
#[inline(always)]
pub fn mis_weight<F: Real>(path: &PathState<F>, sampled: F) -> F::F32 {
    let (zero, one) = (F::splat(0.0), F::splat(1.0));
    let counted = has_flag::<F>(path.flags, flags::LIGHT_COUNTED);
    let weight = F::select(counted, zero, balance(path.pdf, sampled));
    F::select(zero.lt(sampled), weight, one).to_f32()
}

impl<F: Real> PathShader<'_, F> {
    #[inline(always)]
    fn run(&self, wave: &mut WaveState) {
        let ShadingContext { path, surface, lobes, is_final, .. } = self.at;
        let visible = self.at.pass_hidden(wave);
        let rows = self.at.lobe_rows(wave);
        let mut bsdf = self.at.bsdf(wave, &rows);
        bsdf.cover(rows.table(wave), rows.at());
        self.at.add_ambient(wave, visible, &rows);
        if lobes.has(LobeSet::EMISSION) {
            let mut weight = F::F32::splat(1.0);
            if wave.context.columns.mis {
                let (context, point) = (wave.context, &surface.surface);
                let from = context.scattering(path);
                weight = mis_weight(path, context.lights.pdf_of_hit(from, surface.primitive, point, visible));
            }
            self.at.add_emission(wave, visible, weight, &rows);
        }
        let open = visible & !*is_final;
        let last = open & path.bounces_left.eq(F::U32::splat(1));
        if lobes.has(LobeSet::REFLECTS_LIGHTS) && open.any() {
            let is_first = path.bounces_left.eq(F::U32::splat(wave.context.quality.surfaces()));
            for index in 0..wave.context.lights.requests().len() {
                let request = wave.context.lights.requests()[index];
                let takers = open & request.takers(is_first);
                if takers.any() {
                    self.sample_light(wave, &bsdf, (&request, index), takers, last);
                }
            }
        }
        self.continue_paths(wave, &bsdf, visible, last);
    }

    /// Whether light samples cover all light at a path's last surface. Lobes that are narrower than lights find light
    /// better by their own directions, so both techniques are combined.
    #[inline(always)]
    fn samples_all_light(&self) -> bool {
        !self.at.lobes.has(LobeSet::FUZZ | LobeSet::BOUNDARIES)
    }

    /// Samples light and appends shadow rays towards it.
    #[inline(always)]
    fn sample_light(
        &self,
        wave: &mut WaveState,
        bsdf: &Bsdf<F>,
        (request, light_index): (&LightRequest, usize),
        open: F::Mask,
        last: F::Mask,
    ) {
        let ShadingContext { path, surface, .. } = self.at;
        let light = self.at.sample_light(wave, request, open);
        if !light.is_lit.any() {
            return;
        }
        let (zero, one) = (F::splat(0.0), F::splat(1.0));
        let reflected = bsdf.reflected(light.direction);
        let scattered = self.at.scattered(wave, &light, &reflected);
        // BSDF samples may find the same light, so light samples count less here.
        let mut rest = F::F32::splat(0.0);
        if request.is_sampled && wave.context.columns.mis {
            let pdf = bsdf.pdf(&bsdf.probabilities(), light.direction);
            let is_all = if self.samples_all_light() { last } else { F::Mask::splat(false) };
            rest = F::select(is_all, zero, one - balance(light.pdf, pdf)).to_f32();
        }
        let radiance = path.throughput.at_surface() * light.radiance;
        let (whole, mis_complement) =
            (radiance * (scattered + reflected.highlight), radiance * scattered * rest);
        let own = whole - mis_complement;
        let lit = self.at.add_unshadowed(wave, request, (&light, own), light.is_lit & whole.is_lit());
        if !lit.any() {
            return;
        }
        let item = ShadowItem {
            ray: light.shadow_ray(&surface.surface),
            light: if wave.context.has_transparency() { whole } else { own },
            mis_complement,
            medium: path.medium,
            slot: path.slot,
        };
        wave.shadows[light_index].push(lit, &item);
    }

    /// Continues paths by one lobe.
    #[inline(always)]
    fn continue_paths(&self, wave: &mut WaveState, bsdf: &Bsdf<F>, visible: F::Mask, last: F::Mask) {
        let ShadingContext { lobes, is_final, .. } = self.at;
        let context = wave.context;
        let lobes = *lobes;
        let directed = lobes.has(LobeSet::MIRROR | LobeSet::BOUNDARIES | LobeSet::REFRACTION);
        let final_rays = context.unsampled_light || (context.emits && directed);
        let bounces = visible & !*is_final;
        let bounces = if final_rays { bounces } else { bounces & !last };
        let continues = if lobes.has(LobeSet::TRANSPARENT) { visible } else { bounces };
        if !continues.any() {
            return;
        }
        let sample = bsdf.sample(self.at.boundary(), self.scatter_numbers());
        let mut continues = continues & sample.continues() & (bounces | sample.is_transmitted);
        if !context.unsampled_light && self.samples_all_light() {
            continues = continues & !(last & sample.is_scattered);
        }
        let mut state = self.next_state(wave, bsdf, &sample, last);
        continues = continues & state.throughput.at_emitter().is_lit();
        continues = continues & self.survives(wave, &mut state);
        self.count(wave, &sample, continues);
        if lobes.has(LobeSet::TRANSPARENT) {
            let passes = continues & sample.is_transmitted;
            self.at.pass_on(wave, passes, &state);
            continues = continues & !sample.is_transmitted;
        }
        wave.next.push(continues, &state);
    }

    /// Samples as many numbers in 0..1 as the lobes need. The others are 0.
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

    /// The state of paths that leave the surface.
    #[inline(always)]
    fn next_state(
        &self,
        wave: &WaveState,
        bsdf: &Bsdf<F>,
        sample: &BsdfSample<F>,
        last: F::Mask,
    ) -> PathState<F> {
        let ShadingContext { path, surface, interface, .. } = self.at;
        let (zero, columns) = (F::splat(0.0), wave.context.columns);
        let at = &surface.surface;
        // Every ray leaves by a lobe of the set. Those that pass straight on keep their origin instead.
        let lobes = self.at.lobes;
        let mut ray = Spawn { origin: at.point, direction: sample.direction, is_valid: F::Mask::splat(true) };
        if lobes.has(LobeSet::SAMPLED) {
            ray = spawn_lifted(at, sample.direction);
        }
        if lobes.has(LobeSet::REFRACTION) {
            ray = Spawn::select(sample.is_refracted, spawn(at, sample.direction), ray);
        }
        if lobes.has(LobeSet::MIRROR | LobeSet::BOUNDARIES | LobeSet::REFRACTION) {
            ray = Spawn::select(sample.is_mirrored, spawn_reflected(at, sample.direction), ray);
        }
        let one_less = path.bounces_left.wrapping_add(F::U32::splat(u32::MAX));
        let mut state = PathState {
            ray: LaneRay { origin: ray.origin, direction: ray.direction },
            throughput: next_throughput(&path.throughput, sample, columns.fog),
            cone: self.at.cone(),
            bounces_left: F::U32::select(sample.is_transmitted, path.bounces_left, one_less),
            t_start: zero,
            pending: F::U32::splat(0),
            ..**path
        };
        if columns.media {
            let passes = sample.is_refracted & bsdf.passes(sample.direction);
            state.medium = F::U32::select(passes, interface.behind, path.medium);
        }
        if columns.mis {
            // A path that continues straight on keeps the density of its direction.
            state.scattered_at = Vec3::select(sample.is_scattered, at.point, path.scattered_at);
            state.pdf = F::select(sample.is_transmitted, path.pdf, sample.pdf);
        }
        state.flags = self.next_flags(sample, last, wave.context.guides.is_some());
        state
    }

    #[inline(always)]
    fn next_flags(&self, sample: &BsdfSample<F>, last: F::Mask, guides: bool) -> F::U32 {
        let before = self.at.path.flags;
        let (none, sampled) = (F::U32::splat(0), F::U32::splat(flags::LIGHT_SAMPLED));
        let counted = F::U32::splat(flags::LIGHT_SAMPLED | flags::LIGHT_COUNTED);
        // Light samples do not cover reflections in a mirror.
        let mut after = F::U32::select(sample.is_scattered, sampled, none);
        if self.settings.refractive_shadows {
            let through = F::U32::select(has_flag::<F>(before, flags::LIGHT_SAMPLED), counted, none);
            after = F::U32::select(sample.is_refracted, through, after);
        }
        if self.samples_all_light() {
            after = F::U32::select(last & sample.is_scattered, counted, after);
        }
        if guides {
            let specular = before.and(F::U32::splat(flags::SPECULAR));
            after = F::U32::select(sample.is_scattered, after, after.or(specular));
        }
        F::U32::select(sample.is_transmitted, before, after)
    }

    /// Russian roulette: dim paths end at random, and the others are weighted up for them.
    #[inline(always)]
    fn survives(&self, wave: &WaveState, state: &mut PathState<F>) -> F::Mask {
        let (all, quality) = (F::Mask::splat(true), wave.context.quality);
        let Some(after) = self.settings.roulette.filter(|after| *after < quality.surfaces()) else {
            return all;
        };
        let dims = state.bounces_left.lt(F::U32::splat(quality.surfaces() - after));
        if !dims.any() {
            return all;
        }
        let [u] = self.at.numbers(dimension::ROULETTE, 0);
        let one = F::F32::splat(1.0);
        let chance = state.throughput.at_emitter().max_element().min(F::F32::splat(0.95));
        let chance = F::F32::select(dims, chance, one);
        state.throughput.diffuse = state.throughput.diffuse / chance;
        state.throughput.specular = state.throughput.specular / chance;
        u.lt(chance.to_f64())
    }

    #[inline(always)]
    fn count(&self, wave: &mut WaveState, sample: &BsdfSample<F>, continues: F::Mask) {
        let (rays, lobes) = (&mut wave.counts.rays, self.at.lobes);
        rays.scattered += u64::from((continues & sample.is_scattered).bits().count_ones());
        if lobes.has(LobeSet::MIRROR | LobeSet::BOUNDARIES | LobeSet::REFRACTION) {
            rays.mirror += u64::from((continues & sample.is_mirrored).bits().count_ones());
        }
        if lobes.has(LobeSet::PASSES) {
            let passed = sample.is_refracted | sample.is_transmitted;
            rays.transmitted += u64::from((continues & passed).bits().count_ones());
        }
    }
}

/// The throughput behind a surface, by diffuse and specular lobes.
#[inline(always)]
fn next_throughput<F: Real>(
    before: &Throughput<F::F32>,
    sample: &BsdfSample<F>,
    fog: bool,
) -> Throughput<F::F32> {
    let one = F::F32::splat(1.0);
    if !fog {
        let specular = before.specular * (sample.diffuse + sample.specular);
        return Throughput { diffuse: Color::black(), specular, fog_transmittance: one };
    }
    let lit = before.at_surface();
    let passes = sample.is_transmitted;
    Throughput {
        diffuse: Color::select(passes, before.diffuse * sample.specular, lit * sample.diffuse),
        specular: Color::select(passes, before.specular * sample.specular, lit * sample.specular),
        fog_transmittance: F::F32::select(passes, before.fog_transmittance, one),
    }
}
