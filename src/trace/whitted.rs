//! Whitted's integrator: at every surface ambient light, every light as far as it reaches the surface, and on to what
//! mirrors show and what lies behind the transparent (Whitted, *An Improved Illumination Model for Shaded Display*,
//! 1980). Paths branch; chance decides nothing but samples of a lens, an area light, a rough surface or motion.

use super::bsdf::Bsdf;
use super::light::LightRequest;
use super::materials::LobeSet;
use super::shade::{ShadingContext, Stage};
use super::shadow_stream::ShadowItem;
use super::spawn::{Spawn, spawn, spawn_mirrored, spawn_scattered};
use super::stream::{PathState, Throughput, flags};
use crate::base::lanes::{Bits, Color, Level, Mask, Real, Row, Select, SimdKernel, Single};
use crate::base::math::LaneRay;
use crate::sampling::{dimension, hash_lanes};

/// Up to eight paths at surfaces whose materials have lobes of one set.
pub struct Shade<'a, 's, 'w> {
    pub stage: &'s mut Stage<'a>,
    pub which: &'w [u32],
    pub lobes: LobeSet,
}

impl SimdKernel for Shade<'_, '_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { stage, which, lobes } = self;
        let at = ShadingContext::<L::F64>::gather(stage, which, lobes);
        WhittedShade { at: &at }.run(stage);
    }
}

/// By which the random numbers of a surface's branches differ.
mod branch {
    pub const ROUGH: u32 = 1;
    pub const MIRROR: u32 = 2;
    pub const TRANSPARENT: u32 = 3;
    pub const REFRACTED: u32 = 4;
    pub const REFLECTED: u32 = 5;
}

/// A branch of a path.
struct Branch<F: Real> {
    /// By which its random numbers differ from those of others.
    number: u32,
    ray: Spawn<F>,
    /// The share of light from there.
    share: Color<F::F32>,
    /// Lanes in which there is one.
    mask: F::Mask,
    /// Flags of the paths.
    flags: F::U32,
    /// What rays are inside of.
    medium: F::U32,
}

struct WhittedShade<'a, F: Real> {
    at: &'a ShadingContext<F>,
}

impl<F: Real> WhittedShade<'_, F> {
    #[inline(always)]
    fn run(&self, stage: &mut Stage) {
        let ShadingContext { path, lobes, is_final, .. } = self.at;
        let visible = self.at.pass_hidden(stage);
        let (bsdf, rows) = self.at.bsdf(stage);
        self.at.add_ambient(stage, visible, &rows);
        if lobes.has(LobeSet::EMISSION) {
            self.at.add_emission(stage, visible, F::F32::splat(1.0), &rows);
        }
        let open = visible & !*is_final;
        if lobes.has(LobeSet::REFLECTS_LIGHTS) && open.any() {
            for index in 0..stage.context.lights.requests().len() {
                let request = stage.context.lights.requests()[index];
                self.sample_light(stage, &bsdf, (&request, index), open);
            }
        }
        // Behind the last surface only what emits light is seen.
        let last = path.left.eq(F::U32::splat(1));
        let turns = if stage.context.emits { open } else { open & !last };
        if lobes.has(LobeSet::MICROFACET) && turns.any() {
            self.rough(stage, &bsdf, turns);
        }
        if lobes.has(LobeSet::MIRROR) && turns.any() {
            self.mirror(stage, &bsdf, turns);
        }
        if lobes.has(LobeSet::TRANSPARENT) {
            self.transparent(stage, &bsdf, visible);
        }
        if lobes.has(LobeSet::REFRACTION) && turns.any() {
            self.refracted(stage, &bsdf, turns);
        }
    }

    /// Samples a light, and appends the shadow rays along which it may come.
    #[inline(always)]
    fn sample_light(
        &self,
        stage: &mut Stage,
        bsdf: &Bsdf<F>,
        (request, light_index): (&LightRequest, usize),
        open: F::Mask,
    ) {
        let ShadingContext { path, surface, .. } = self.at;
        let light = self.at.sample_light(stage, request, open);
        if !light.is_lit.any() {
            return;
        }
        let reflected = bsdf.reflected(light.direction);
        let scattered = self.at.scattered(stage, &light, &reflected);
        let whole = path.throughput.lit() * (scattered + reflected.highlight) * light.radiance;
        let item = ShadowItem {
            ray: light.shadow_ray(&surface.surface),
            light: whole,
            weighed: Color::black(),
            medium: path.medium,
            slot: path.slot,
        };
        stage.shadows[light_index].push(light.is_lit & whole.is_lit(), &item);
    }

    /// The metallic-roughness surface's reflection: in one of its small mirrors.
    #[inline(always)]
    fn rough(&self, stage: &mut Stage, bsdf: &Bsdf<F>, turns: F::Mask) {
        let [u, v] = self.at.numbers(dimension::GLOSSY, 0);
        let reflection = bsdf.glossy_sample(u, v);
        let sharp = reflection.is_smooth;
        let mirrored = spawn_mirrored(bsdf.surface, bsdf.mirrored());
        let scattered = spawn_scattered(bsdf.surface, reflection.direction);
        let ray = Spawn::select(sharp, mirrored, scattered);
        let mask = turns & (sharp | reflection.is_drawn);
        self.reflect(stage, branch::ROUGH, ray, reflection.share, (mask, sharp));
    }

    #[inline(always)]
    fn mirror(&self, stage: &mut Stage, bsdf: &Bsdf<F>, turns: F::Mask) {
        let mut ray = spawn_mirrored(bsdf.surface, bsdf.mirrored());
        let mut sharp = F::Mask::splat(true);
        if self.at.lobes.has(LobeSet::FUZZ) {
            let [u, v, w] = self.at.numbers(dimension::SCATTER, 0);
            sharp = !bsdf.is_fuzzy();
            ray = Spawn::select(sharp, ray, spawn_scattered(bsdf.surface, bsdf.fuzzy_sample([u, v, w])));
        }
        self.reflect(stage, branch::MIRROR, ray, bsdf.mirror, (turns, sharp));
    }

    /// Passing straight on takes no bounce.
    #[inline(always)]
    fn transparent(&self, stage: &mut Stage, bsdf: &Bsdf<F>, visible: F::Mask) {
        let path = &self.at.path;
        let specular = path.throughput.specular * bsdf.transparency;
        let mask = visible & self.matters(stage, specular * path.throughput.clear);
        if !mask.any() {
            return;
        }
        stage.counts.rays.transmitted += u64::from(mask.bits().count_ones());
        let throughput = Throughput { specular, ..path.throughput };
        let state = PathState { throughput, key: self.key(stage, branch::TRANSPARENT), ..*path };
        self.at.pass_on(stage, mask, &state);
    }

    #[inline(always)]
    fn refracted(&self, stage: &mut Stage, bsdf: &Bsdf<F>, turns: F::Mask) {
        let ShadingContext { path, lobes, interface, .. } = self.at;
        let bent = interface.boundary.meet(lobes.fresnel(), path.ray.direction, bsdf.normal);
        let reflected = bent.reflected.to_f32();
        let passes = turns & !bent.is_total;
        let medium = F::U32::select(bsdf.passes(bent.direction), interface.behind, path.medium);
        let refracted = Branch {
            number: branch::REFRACTED,
            ray: spawn(bsdf.surface, bent.direction),
            share: bsdf.refraction * (F::F32::splat(1.0) - reflected),
            mask: passes,
            // Shadow rays pass here too, so that what they have found must not count again.
            flags: path.flags,
            medium,
        };
        stage.counts.rays.transmitted += u64::from(self.push(stage, &refracted).bits().count_ones());
        // A boundary reflects all colours alike, whatever colour it lets pass; but totally it reflects as it passes.
        let alike = Color::grey(bsdf.refraction.max_element() * reflected);
        let share = Color::select(bent.is_total, bsdf.refraction, alike);
        let ray = spawn_mirrored(bsdf.surface, bsdf.mirrored());
        self.reflect(stage, branch::REFLECTED, ray, share, (turns, F::Mask::splat(true)));
    }

    /// Appends reflections, sharp ones among them. Where a reflection is drawn, light has been sampled instead of being met.
    #[inline(always)]
    fn reflect(
        &self,
        stage: &mut Stage,
        number: u32,
        ray: Spawn<F>,
        share: Color<F::F32>,
        (mask, sharp): (F::Mask, F::Mask),
    ) {
        let (none, counted) = (F::U32::splat(0), F::U32::splat(flags::LIGHT_COUNTED));
        let flags = F::U32::select(sharp, none, counted);
        let mask = mask & ray.is_sound;
        let branch = Branch { number, ray, share, mask, flags, medium: self.at.path.medium };
        stage.counts.rays.mirror += u64::from(self.push(stage, &branch).bits().count_ones());
    }

    /// Appends a branch where it matters: there.
    #[inline(always)]
    fn push(&self, stage: &mut Stage, branch: &Branch<F>) -> F::Mask {
        let path = &self.at.path;
        let one = F::F32::splat(1.0);
        let specular = path.throughput.lit() * branch.share;
        let mask = branch.mask & self.matters(stage, specular);
        if !mask.any() {
            return mask;
        }
        let state = PathState {
            ray: LaneRay { origin: branch.ray.origin, direction: branch.ray.direction },
            throughput: Throughput { diffuse: Color::black(), specular, clear: one },
            cone: self.at.cone(),
            left: path.left.wrapping_add(F::U32::splat(u32::MAX)),
            flags: branch.flags,
            medium: branch.medium,
            key: self.key(stage, branch.number),
            after: F::splat(0.0),
            pending: F::U32::splat(0),
            ..*path
        };
        stage.next.push(mask, &state);
        mask
    }

    #[inline(always)]
    fn key(&self, stage: &Stage, number: u32) -> F::U32 {
        let key = self.at.path.key;
        if !stage.context.columns.keys {
            return key;
        }
        hash_lanes([key, F::U32::splat(number), F::U32::splat(0)])
    }

    /// Lanes in which so much throughput is worth a ray.
    #[inline(always)]
    fn matters(&self, stage: &Stage, throughput: Color<F::F32>) -> F::Mask {
        let threshold = F::F32::splat(stage.context.quality.threshold);
        throughput.is_lit() & threshold.le(throughput.max_element())
    }
}
