//! Whitted's integrator: at every surface it adds ambient light and the light of every light source, and follows
//! reflected and transmitted rays (Whitted, *An Improved Illumination Model for Shaded Display*, 1980). Paths branch.
//! Only samples of a lens, an area light, a rough surface or motion are random.

use super::bsdf::{Bsdf, GlossySample};
use super::interaction::SurfaceInteraction;
use super::light::LightRequest;
use super::materials::LobeSet;
use super::shade::{ShadingContext, WaveState, active};
use super::shadow_stream::ShadowItem;
use super::spawn::{Spawn, spawn, spawn_reflected, spawn_scattered};
use super::stream::{PathState, Throughput, flags};
use crate::base::lanes::{Bits, Color, Level, Lookup, Mask, Real, Row, Select, SimdKernel, Single};
use crate::base::math::LaneRay;
use crate::sampling::{dimension, hash_lanes};

/// Up to eight paths at surfaces whose materials share one set of lobes.
pub struct ShadeWhitted<'a, 's, 'w> {
    pub wave: &'s mut WaveState<'a>,
    pub items: &'w [u32],
    pub lobes: LobeSet,
}

impl SimdKernel for ShadeWhitted<'_, '_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { wave, items, lobes } = self;
        let (places, active) = (Lookup::ascending(items), active::<L::F64>(items));
        let path = wave.paths.gather::<L::F64>(&places);
        let mut surface = SurfaceInteraction::at_hits(&path, (wave.hits, &places));
        let at = ShadingContext::new(wave, (&path, &mut surface), active, lobes);
        WhittedShader { at: &at }.run(wave);
    }
}

/// Keys that separate the random numbers of a surface's branches.
mod branch {
    pub const ROUGH: u32 = 1;
    pub const MIRROR: u32 = 2;
    pub const TRANSPARENT: u32 = 3;
    pub const REFRACTED: u32 = 4;
    pub const REFLECTED: u32 = 5;
    pub const COAT: u32 = 6;
}

/// A branch of a path.
struct Branch<F: Real> {
    /// The key that separates its random numbers from those of other branches.
    number: u32,
    ray: Spawn<F>,
    /// The share of light that it carries.
    share: Color<F::F32>,
    /// Lanes with a branch.
    mask: F::Mask,
    /// The flags of the paths.
    flags: F::U32,
    /// The media around the rays.
    medium: F::U32,
}

struct WhittedShader<'a, F: Real> {
    at: &'a ShadingContext<'a, F>,
}

impl<F: Real> WhittedShader<'_, F> {
    #[inline(always)]
    fn run(&self, wave: &mut WaveState) {
        let ShadingContext { path, lobes, is_final, .. } = self.at;
        let visible = self.at.pass_hidden(wave);
        let rows = self.at.lobe_rows(wave);
        let mut bsdf = self.at.bsdf(wave, &rows);
        bsdf.cover(rows.table(wave), rows.at());
        self.at.add_ambient(wave, visible, &rows);
        if lobes.has(LobeSet::EMISSION) {
            self.at.add_emission(wave, visible, F::F32::splat(1.0), &rows);
        }
        let open = visible & !*is_final;
        if lobes.has(LobeSet::REFLECTS_LIGHTS) && open.any() {
            for index in 0..wave.context.lights.requests().len() {
                let request = wave.context.lights.requests()[index];
                self.sample_light(wave, &bsdf, (&request, index), open);
            }
        }
        // Beyond the last surface only emitted light counts.
        let last = path.bounces_left.eq(F::U32::splat(1));
        let bounces = if wave.context.emits { open } else { open & !last };
        if lobes.has(LobeSet::MICROFACET) && bounces.any() {
            let [u, v] = self.at.numbers(dimension::GLOSSY, 0);
            self.rough(wave, &bsdf, bounces, (branch::ROUGH, bsdf.glossy_sample(u, v)));
        }
        if lobes.has(LobeSet::COAT) && bounces.any() {
            let [u, v] = self.at.numbers(dimension::GLOSSY, 1);
            self.rough(wave, &bsdf, bounces, (branch::COAT, bsdf.coat_sample(u, v)));
        }
        if lobes.has(LobeSet::MIRROR) && bounces.any() {
            self.mirror(wave, &bsdf, bounces);
        }
        if lobes.has(LobeSet::TRANSPARENT) {
            self.transparent(wave, &bsdf, visible);
        }
        if lobes.has(LobeSet::REFRACTION) && bounces.any() {
            self.refracted(wave, &bsdf, bounces);
        }
    }

    /// Samples a light and appends shadow rays towards it.
    #[inline(always)]
    fn sample_light(
        &self,
        wave: &mut WaveState,
        bsdf: &Bsdf<F>,
        (request, light_index): (&LightRequest, usize),
        open: F::Mask,
    ) {
        let ShadingContext { path, surface, .. } = self.at;
        let light = self.at.sample_light(wave, request, open);
        if !light.is_lit.any() {
            return;
        }
        let reflected = bsdf.reflected(light.direction);
        let scattered = self.at.scattered(wave, &light, &reflected);
        let whole = path.throughput.at_surface() * (scattered + reflected.highlight) * light.radiance;
        let lit = self.at.add_unshadowed(wave, request, (&light, whole), light.is_lit & whole.is_lit());
        if !lit.any() {
            return;
        }
        let item = ShadowItem {
            ray: light.shadow_ray(&surface.surface),
            light: whole,
            mis_complement: Color::black(),
            medium: path.medium,
            slot: path.slot,
        };
        wave.shadows[light_index].push(lit, &item);
    }

    /// The reflection of a metallic-roughness surface, or of a coat, at one of its microfacets.
    #[inline(always)]
    fn rough(
        &self,
        wave: &mut WaveState,
        bsdf: &Bsdf<F>,
        bounces: F::Mask,
        (number, reflection): (u32, GlossySample<F>),
    ) {
        let sharp = reflection.is_smooth;
        let mirrored = spawn_reflected(bsdf.surface, bsdf.mirrored());
        let scattered = spawn_scattered(bsdf.surface, reflection.direction);
        let ray = Spawn::select(sharp, mirrored, scattered);
        let mask = bounces & (sharp | reflection.is_drawn);
        self.reflect(wave, number, ray, reflection.share, (mask, sharp));
    }

    #[inline(always)]
    fn mirror(&self, wave: &mut WaveState, bsdf: &Bsdf<F>, bounces: F::Mask) {
        let mut ray = spawn_reflected(bsdf.surface, bsdf.mirrored());
        let mut sharp = F::Mask::splat(true);
        if self.at.lobes.has(LobeSet::FUZZ) {
            let [u, v, w] = self.at.numbers(dimension::SCATTER, 0);
            sharp = !bsdf.is_fuzzy();
            ray = Spawn::select(sharp, ray, spawn_scattered(bsdf.surface, bsdf.fuzzy_sample([u, v, w])));
        }
        self.reflect(wave, branch::MIRROR, ray, bsdf.mirror, (bounces, sharp));
    }

    /// A straight transmission is not a bounce.
    #[inline(always)]
    fn transparent(&self, wave: &mut WaveState, bsdf: &Bsdf<F>, visible: F::Mask) {
        let path = self.at.path;
        let specular = path.throughput.specular * bsdf.transparency;
        let mask = visible & self.matters(wave, specular * path.throughput.fog_transmittance);
        if !mask.any() {
            return;
        }
        wave.counts.rays.transmitted += u64::from(mask.bits().count_ones());
        let throughput = Throughput { specular, ..path.throughput };
        let state = PathState { throughput, key: self.key(wave, branch::TRANSPARENT), ..*path };
        self.at.pass_on(wave, mask, &state);
    }

    #[inline(always)]
    fn refracted(&self, wave: &mut WaveState, bsdf: &Bsdf<F>, bounces: F::Mask) {
        let ShadingContext { path, lobes, interface, .. } = self.at;
        let refraction = interface.boundary.refract(lobes.fresnel(), path.ray.direction, bsdf.normal);
        let reflected = refraction.reflected.to_f32();
        let passes = bounces & !refraction.is_total;
        let medium = F::U32::select(bsdf.passes(refraction.direction), interface.behind, path.medium);
        let refracted = Branch {
            number: branch::REFRACTED,
            ray: spawn(bsdf.surface, refraction.direction),
            share: bsdf.refraction * (F::F32::splat(1.0) - reflected),
            mask: passes,
            // Shadow rays pass here too, so light that they have found must not count again.
            flags: path.flags,
            medium,
        };
        wave.counts.rays.transmitted += u64::from(self.push(wave, &refracted).bits().count_ones());
        // A boundary reflects all colours equally, whatever colour it transmits. Only total internal reflection has
        // that colour.
        let alike = Color::grey(bsdf.refraction.max_element() * reflected);
        let share = Color::select(refraction.is_total, bsdf.refraction, alike);
        let ray = spawn_reflected(bsdf.surface, bsdf.mirrored());
        self.reflect(wave, branch::REFLECTED, ray, share, (bounces, F::Mask::splat(true)));
    }

    /// Appends reflections, of which `sharp` are ideal. For the random ones light was sampled, so their rays ignore
    /// light that they hit.
    #[inline(always)]
    fn reflect(
        &self,
        wave: &mut WaveState,
        number: u32,
        ray: Spawn<F>,
        share: Color<F::F32>,
        (mask, sharp): (F::Mask, F::Mask),
    ) {
        let specular = self.at.path.flags.and(F::U32::splat(flags::SPECULAR));
        let flags = F::U32::select(sharp, specular, F::U32::splat(flags::LIGHT_COUNTED));
        let mask = mask & ray.is_valid;
        let branch = Branch { number, ray, share, mask, flags, medium: self.at.path.medium };
        wave.counts.rays.mirror += u64::from(self.push(wave, &branch).bits().count_ones());
    }

    /// Appends a branch in the lanes where it matters, and returns these lanes.
    #[inline(always)]
    fn push(&self, wave: &mut WaveState, branch: &Branch<F>) -> F::Mask {
        let path = self.at.path;
        let one = F::F32::splat(1.0);
        let specular = path.throughput.at_surface() * branch.share;
        let mask = branch.mask & self.matters(wave, specular);
        if !mask.any() {
            return mask;
        }
        let state = PathState {
            ray: LaneRay { origin: branch.ray.origin, direction: branch.ray.direction },
            throughput: Throughput { diffuse: Color::black(), specular, fog_transmittance: one },
            cone: self.at.cone(),
            bounces_left: path.bounces_left.wrapping_add(F::U32::splat(u32::MAX)),
            flags: branch.flags,
            medium: branch.medium,
            key: self.key(wave, branch.number),
            t_start: F::splat(0.0),
            pending: F::U32::splat(0),
            ..*path
        };
        wave.next.push(mask, &state);
        mask
    }

    #[inline(always)]
    fn key(&self, wave: &WaveState, number: u32) -> F::U32 {
        let key = self.at.path.key;
        if !wave.context.columns.keys {
            return key;
        }
        hash_lanes([key, F::U32::splat(number), F::U32::splat(0)])
    }

    /// Lanes whose throughput is worth a ray.
    #[inline(always)]
    fn matters(&self, wave: &WaveState, throughput: Color<F::F32>) -> F::Mask {
        let threshold = F::F32::splat(wave.context.quality.threshold);
        throughput.is_lit() & threshold.le(throughput.max_element())
    }
}
