//! Transmittance of shadow rays through surfaces: transparent ones and, if the settings allow it, refracting ones.
//!
//! A shadow ray keeps its origin and meets surfaces in their order along the ray. So it meets none twice, and several
//! surfaces in one place all count.

use super::bsdf::{passed_by_coat, passed_through};
use super::coincident::{Events, ISOLATED, NO_EVENT};
use super::context::{Queue, TraceContext};
use super::interaction::SurfaceInteraction;
use super::interface::Interface;
use super::light::ShadowRay;
use super::materials::{Column, LobeSet, LobeTable};
use super::medium::MediaLists;
use super::segment::transmittance;
use super::shade::LobeRows;
use super::textures;
use crate::base::lanes::{Bits, Color, LaneKernel, Level, Mask, Real, Row, Select, Single, Vec3, lanes};
use crate::base::math::Ray;
use crate::base::stats::Counts;
use crate::geometry::ray_kinds::RayKind;
use crate::geometry::shape::{LaneHit, RayInterval};
use crate::scene::top_level::{Coherence, Hit, NOTHING, Stacks};

/// The most surfaces that a shadow ray passes, which bounds its time. Beyond that, the point is in shadow.
const PASSED: u32 = 4096;

/// Shares of light that arrive.
#[derive(Clone, Copy, Debug)]
pub struct ShadowTransmittance<S> {
    pub all: Color<S>,
    /// Without refracted light.
    pub unrefracted: Color<S>,
}

impl<S: Single> ShadowTransmittance<S> {
    #[inline(always)]
    fn dim(&mut self, mask: S::Mask, all: Color<S>, unrefracted: Color<S>) {
        self.all = Color::select(mask, self.all * all, self.all);
        self.unrefracted = Color::select(mask, self.unrefracted * unrefracted, self.unrefracted);
    }
}

/// Walks along shadow rays from surface to surface.
pub struct TraceTransmittance<'a, 's, L: Level> {
    pub context: &'a TraceContext<'a>,
    pub ray: &'s ShadowRay<L::F64>,
    /// The media at the origins of the rays.
    pub inside: L::U32,
    /// The lanes to trace.
    pub wanted: L::Mask,
    pub coherence: Coherence,
    pub stacks: &'s mut Stacks,
    pub events: &'s mut Events,
    pub media: &'s mut MediaLists,
    pub rows: &'s mut LobeTable,
    pub counts: &'s mut Counts,
}

/// The next hits of the rays, in memory.
struct NextHits {
    t: [f64; 8],
    primitive: [u32; 8],
    part: [u32; 8],
    material: [u32; 8],
    event: [u32; 8],
}

impl<L: Level> LaneKernel<L> for TraceTransmittance<'_, '_, L> {
    type Output = ShadowTransmittance<L::F32>;

    #[inline(always)]
    fn run(mut self) -> ShadowTransmittance<L::F32> {
        let (black, one) = (Color::black(), Color::grey(L::F32::splat(1.0)));
        let mut left = ShadowTransmittance { all: one, unrefracted: one };
        let (mut t_start, mut open) = (L::F64::splat(0.0), self.wanted);
        let mut next = NextHits::default();
        for _ in 0..=PASSED {
            self.find(t_start, open, &mut next);
            let t = L::F64::load(&next.t, 0);
            let is_hit = t.lt(self.ray.t_max);
            self.absorb(&mut left, open, t.min(self.ray.t_max).max(t_start) - t_start);
            // Rays without another hit have arrived.
            open = open & is_hit;
            let blocked = L::Mask::from_bits(self.blocked(&next) & open.bits());
            left.dim(blocked, black, black);
            open = open & !blocked & left.all.is_lit();
            if !open.any() {
                return left;
            }
            self.pass(&mut left, open, &next);
            open = open & left.all.is_lit();
            self.counts.rays.shadow += u64::from(open.bits().count_ones());
            t_start = self.go_on(t, open, &mut next);
        }
        left.dim(open, black, black);
        left
    }
}

impl Default for NextHits {
    fn default() -> Self {
        Self { t: [0.0; 8], primitive: [NOTHING; 8], part: [0; 8], material: [0; 8], event: [NO_EVENT; 8] }
    }
}

impl NextHits {
    fn meet(&mut self, lane: usize, number: u32, Hit { at, primitive }: Hit) {
        (self.t[lane], self.part[lane], self.primitive[lane]) = (at.t, at.part, primitive);
        self.event[lane] = number;
    }
}

impl<L: Level> TraceTransmittance<'_, '_, L> {
    /// Finds the next hits after a t, unless events give them.
    #[inline(always)]
    fn find(&mut self, t_start: L::F64, open: L::Mask, next: &mut NextHits) {
        let (bvh, geometry) = (self.context.bvh.of(RayKind::Shadow), self.context.scene.geometry);
        let mut wanted = open.bits();
        for lane in lanes(open.bits()) {
            if self.meet(lane, next.event[lane], next) {
                wanted &= !(1 << lane);
            }
        }
        if wanted == 0 {
            return self.name_materials(open, next);
        }
        let within = RayInterval { min: t_start, max: self.ray.t_max };
        let mask = L::Mask::from_bits(wanted);
        let (ray, stacks) = (&self.ray.ray, &mut *self.stacks);
        let found = bvh.intersect::<L>(geometry, ray, within, mask, self.coherence, stacks);
        let (t, part) = (found.at.t.to_array(), found.at.part.to_array());
        let primitive = found.primitive.to_array();
        for lane in lanes(wanted) {
            (next.t[lane], next.part[lane], next.primitive[lane]) = (t[lane], part[lane], primitive[lane]);
        }
        // It stays so if no other surface turns out to coincide: only the parts of the hit's own mesh matter.
        for lane in lanes(found.at.isolated & wanted) {
            next.event[lane] = ISOLATED;
        }
        let coincident = found.at.coincident.bits() & wanted;
        if coincident != 0 {
            self.resolve(coincident, next);
        }
        self.name_materials(open, next);
    }

    #[inline(always)]
    fn name_materials(&self, open: L::Mask, next: &mut NextHits) {
        for lane in lanes(open.bits()) {
            if next.primitive[lane] != NOTHING {
                (_, next.material[lane]) = self.context.route(next.primitive[lane], next.part[lane]);
            }
        }
    }

    /// Takes the next hit of a ray from an event, if there is one.
    #[inline(always)]
    fn meet(&self, lane: usize, number: u32, next: &mut NextHits) -> bool {
        let inside = (&*self.media, self.inside.to_array()[lane]);
        let Some(hit) = self.events.hit(number, inside, &self.context.scene.shading.materials) else {
            return false;
        };
        next.meet(lane, number, hit);
        true
    }

    /// Resolves hits that are close to others.
    #[inline(always)]
    fn resolve(&mut self, coincident: u32, next: &mut NextHits) {
        let t_max = self.ray.t_max.to_array();
        for lane in lanes(coincident) {
            let origin = self.ray.ray.origin.lane(lane);
            let ray = Ray { origin, direction: self.ray.ray.direction.lane(lane) };
            let number =
                self.context.resolve((&ray, RayKind::Shadow), (next.t[lane], t_max[lane]), self.events);
            self.meet(lane, number, next);
        }
    }

    /// Applies the absorption of the media along a segment.
    #[inline(always)]
    fn absorb(&self, left: &mut ShadowTransmittance<L::F32>, open: L::Mask, way: L::F64) {
        if self.context.media {
            let length = self.ray.ray.direction.length() * way;
            if let Some(passed) = transmittance::<L::F64>(self.media, self.inside, length) {
                left.dim(open, passed, passed);
            }
        }
    }

    /// The bits of the lanes whose hit transmits no light.
    #[inline(always)]
    fn blocked(&self, next: &NextHits) -> u32 {
        let mut bits = 0;
        for lane in 0..8 {
            if next.primitive[lane] != NOTHING {
                let passes = match self.context.route(next.primitive[lane], next.part[lane]).0 {
                    Queue::Surface(class) => self.context.classes[class as usize].has(self.context.passes),
                    _ => false,
                };
                bits |= u32::from(!passes) << lane;
            }
        }
        bits
    }

    /// Passes surfaces.
    #[inline(always)]
    fn pass(&mut self, left: &mut ShadowTransmittance<L::F32>, open: L::Mask, next: &NextHits) {
        let context = self.context;
        let (mut lobes, mut refracts) = (LobeSet::default(), 0);
        for lane in lanes(open.bits()) {
            let set = context.lobes_of(next.material[lane]);
            lobes = lobes | set;
            refracts |= u32::from(set.has(LobeSet::REFRACTION)) << lane;
        }
        let none = L::Mask::splat(false);
        let (t, part) = (L::F64::load(&next.t, 0), L::U32::load(&next.part, 0));
        let at = LaneHit { t, part, ..LaneHit::none() };
        let (primitive, material) = (L::U32::load(&next.primitive, 0), L::U32::load(&next.material, 0));
        let (ray, zero) = (&self.ray.ray, L::F64::splat(0.0));
        let hit = (at, primitive, material);
        let mut surface = SurfaceInteraction::<L::F64>::new(context, ray, hit, zero, open);
        surface.event = L::U32::load(&next.event, 0);
        let direction = ray.direction.normalize();
        if lobes.has(LobeSet::TEXTURED) {
            let counts = &mut self.counts.evaluations;
            let wanted = LobeSet::PASSES | LobeSet::COAT;
            textures::look_up(context, wanted, &surface, direction, [open, none], self.rows, counts);
        }
        let rows = LobeRows::new::<L::F64>(lobes, material);
        let table = if lobes.has(LobeSet::TEXTURED) { &*self.rows } else { &context.table };
        let mut transparency: Color<L::F32> = table.color(Column::TRANSPARENCY, rows.at());
        let mut passed = L::F32::splat(1.0);
        if lobes.has(LobeSet::COAT) {
            let cosine = direction.dot(surface.surface.normal).abs();
            passed = passed_by_coat::<L::F64>(table.number(Column::COAT, rows.at()), cosine);
            transparency = passed_through(transparency, passed, table.number(Column::HOLE, rows.at()));
        }
        let refracts = L::Mask::from_bits(refracts);
        if !refracts.any() {
            return left.dim(open, transparency, transparency);
        }
        let media = (&mut *self.media, &*self.events);
        let interface = Interface::gather(context, media, &surface, self.inside, refracts);
        self.inside = L::U32::select(refracts, interface.behind, self.inside);
        let mut all = transparency;
        if context.refractive_shadows {
            let normal = surface.surface.normal;
            let reflected = self.reflected(&interface, direction, normal, material);
            let refraction: Color<L::F32> = table.color(Column::REFRACTION, rows.at());
            let passes = refraction * (passed * (L::F32::splat(1.0) - reflected.to_f32()));
            all = Color::select(refracts, transparency + passes, transparency);
        }
        left.dim(open & !interface.is_hidden, all, transparency);
    }

    /// The share that boundaries reflect of light that continues straight on, by each material's formula.
    #[inline(always)]
    fn reflected(
        &self,
        interface: &Interface<L::F64>,
        direction: Vec3<L::F64>,
        normal: Vec3<L::F64>,
        material: L::U32,
    ) -> L::F64 {
        let materials = material.to_array();
        let mut reflected = L::F64::splat(0.0);
        let mut rest = 0xffu32;
        while rest != 0 {
            let index = materials[rest.trailing_zeros() as usize];
            let same = material.eq(L::U32::splat(index));
            rest &= !same.bits();
            let fresnel = self.context.material(index).fresnel;
            let found = interface.boundary.straight_reflectance(fresnel, direction, normal);
            reflected = L::F64::select(same, found, reflected);
        }
        reflected
    }

    /// The t from which rays continue, and their next events where surfaces coincide.
    #[inline(always)]
    fn go_on(&self, t: L::F64, open: L::Mask, next: &mut NextHits) -> L::F64 {
        let mut t_start = t.to_array();
        for lane in lanes(open.bits()) {
            match self.events.get(next.event[lane]) {
                Some(event) => (t_start[lane], next.event[lane]) = (event.t_last, event.next),
                None => next.event[lane] = NO_EVENT,
            }
        }
        L::F64::from_array(t_start)
    }
}
