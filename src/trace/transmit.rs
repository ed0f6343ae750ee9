//! What is left of light that comes straight through surfaces: transparent ones, and, for shadow rays that may pass them,
//! refracting ones.
//!
//! A shadow ray is not moved: its surfaces are met in the order in which they lie along it, so none is met twice, and of
//! those in one place each counts.

use super::coincident::{Events, NO_EVENT};
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
use crate::geometry::shape::{LaneHit, Span};
use crate::scene::top_level::{Coherence, Hit, NOTHING, Stacks};

/// Surfaces that a shadow ray passes at most; what lies behind more is in shadow. It bounds the time that it takes.
const PASSED: u32 = 4096;

/// Shares of light that arrive.
#[derive(Clone, Copy, Debug)]
pub struct Transmitted<S> {
    pub whole: Color<S>,
    /// Without what has been refracted.
    pub transmitted: Color<S>,
}

impl<S: Single> Transmitted<S> {
    #[inline(always)]
    fn dim(&mut self, mask: S::Mask, whole: Color<S>, transmitted: Color<S>) {
        self.whole = Color::select(mask, self.whole * whole, self.whole);
        self.transmitted = Color::select(mask, self.transmitted * transmitted, self.transmitted);
    }
}

/// Goes along shadow rays surface by surface.
pub struct Transmit<'a, 's, L: Level> {
    pub context: &'a TraceContext<'a>,
    pub ray: &'s ShadowRay<L::F64>,
    /// What rays are inside of where they start.
    pub inside: L::U32,
    /// Lanes that are asked for.
    pub wanted: L::Mask,
    pub coherence: Coherence,
    pub stacks: &'s mut Stacks,
    pub events: &'s mut Events,
    pub media: &'s mut MediaLists,
    pub rows: &'s mut LobeTable,
    pub counts: &'s mut Counts,
}

/// What rays meet next, in memory.
struct Next {
    t: [f64; 8],
    primitive: [u32; 8],
    part: [u32; 8],
    material: [u32; 8],
    event: [u32; 8],
}

impl<L: Level> LaneKernel<L> for Transmit<'_, '_, L> {
    type Output = Transmitted<L::F32>;

    #[inline(always)]
    fn run(mut self) -> Transmitted<L::F32> {
        let (black, one) = (Color::black(), Color::grey(L::F32::splat(1.0)));
        let mut left = Transmitted { whole: one, transmitted: one };
        let (mut after, mut open) = (L::F64::splat(0.0), self.wanted);
        let mut next = Next::default();
        for _ in 0..=PASSED {
            self.find(after, open, &mut next);
            let t = L::F64::load(&next.t, 0);
            let is_hit = t.lt(self.ray.t_max);
            self.absorb(&mut left, open, t.min(self.ray.t_max).max(after) - after);
            // What meets nothing more has arrived.
            open = open & is_hit;
            let blocked = L::Mask::from_bits(self.blocked(&next) & open.bits());
            left.dim(blocked, black, black);
            open = open & !blocked & left.whole.is_lit();
            if !open.any() {
                return left;
            }
            self.pass(&mut left, open, &next);
            open = open & left.whole.is_lit();
            self.counts.rays.shadow += u64::from(open.bits().count_ones());
            after = self.go_on(t, open, &mut next);
        }
        left.dim(open, black, black);
        left
    }
}

impl Default for Next {
    fn default() -> Self {
        Self { t: [0.0; 8], primitive: [NOTHING; 8], part: [0; 8], material: [0; 8], event: [NO_EVENT; 8] }
    }
}

impl Next {
    fn meet(&mut self, lane: usize, number: u32, Hit { at, primitive }: Hit) {
        (self.t[lane], self.part[lane], self.primitive[lane]) = (at.t, at.part, primitive);
        self.event[lane] = number;
    }
}

impl<L: Level> Transmit<'_, '_, L> {
    /// Finds what rays meet after a t, unless that is known.
    #[inline(always)]
    fn find(&mut self, after: L::F64, open: L::Mask, next: &mut Next) {
        let (bvh, geometry) = (self.context.bvh, self.context.scene.geometry);
        let mut wanted = open.bits();
        for lane in lanes(open.bits()) {
            if self.meet(lane, next.event[lane], next) {
                wanted &= !(1 << lane);
            }
        }
        if wanted == 0 {
            return self.name_materials(open, next);
        }
        let within = Span { min: after, max: self.ray.t_max };
        let mask = L::Mask::from_bits(wanted);
        let (ray, stacks) = (&self.ray.ray, &mut *self.stacks);
        let found = bvh.intersect::<L>(geometry, ray, within, mask, self.coherence, stacks);
        let (t, part) = (found.at.t.to_array(), found.at.part.to_array());
        let primitive = found.primitive.to_array();
        for lane in lanes(wanted) {
            (next.t[lane], next.part[lane], next.primitive[lane]) = (t[lane], part[lane], primitive[lane]);
        }
        let crowded = found.at.crowded.bits() & wanted;
        if crowded != 0 {
            self.resolve(crowded, next);
        }
        self.name_materials(open, next);
    }

    #[inline(always)]
    fn name_materials(&self, open: L::Mask, next: &mut Next) {
        for lane in lanes(open.bits()) {
            if next.primitive[lane] != NOTHING {
                (_, next.material[lane]) = self.context.route(next.primitive[lane], next.part[lane]);
            }
        }
    }

    /// Has a ray meet an event, if there is one.
    #[inline(always)]
    fn meet(&self, lane: usize, number: u32, next: &mut Next) -> bool {
        let inside = (&*self.media, self.inside.to_array()[lane]);
        let Some(hit) = self.events.hit(number, inside, &self.context.scene.shading.materials) else {
            return false;
        };
        next.meet(lane, number, hit);
        true
    }

    /// Looks again where hits are close to others.
    #[inline(always)]
    fn resolve(&mut self, crowded: u32, next: &mut Next) {
        let t_max = self.ray.t_max.to_array();
        for lane in lanes(crowded) {
            let origin = self.ray.ray.origin.lane(lane);
            let ray = Ray { origin, direction: self.ray.ray.direction.lane(lane) };
            let number = self.context.resolve(&ray, (next.t[lane], t_max[lane]), self.events);
            self.meet(lane, number, next);
        }
    }

    /// Dims light by the media on a way.
    #[inline(always)]
    fn absorb(&self, left: &mut Transmitted<L::F32>, open: L::Mask, way: L::F64) {
        if self.context.media {
            let length = self.ray.ray.direction.length() * way;
            if let Some(passed) = transmittance::<L::F64>(self.media, self.inside, length) {
                left.dim(open, passed, passed);
            }
        }
    }

    /// A bit for each lane that meets what lets no light pass.
    #[inline(always)]
    fn blocked(&self, next: &Next) -> u32 {
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
    fn pass(&mut self, left: &mut Transmitted<L::F32>, open: L::Mask, next: &Next) {
        let context = self.context;
        let (mut lobes, mut refracts) = (LobeSet::default(), 0);
        for lane in lanes(open.bits()) {
            let set = context.lobes_of(next.material[lane]);
            lobes = lobes | set;
            refracts |= u32::from(set.has(LobeSet::REFRACTION)) << lane;
        }
        let none = L::Mask::splat(false);
        let at = LaneHit { t: L::F64::load(&next.t, 0), part: L::U32::load(&next.part, 0), crowded: none };
        let (primitive, material) = (L::U32::load(&next.primitive, 0), L::U32::load(&next.material, 0));
        let (ray, zero) = (&self.ray.ray, L::F64::splat(0.0));
        let hit = (at, primitive, material);
        let mut surface = SurfaceInteraction::<L::F64>::new(context, ray, hit, zero, open);
        surface.event = L::U32::load(&next.event, 0);
        let direction = ray.direction.normalize();
        if lobes.has(LobeSet::TEXTURED) {
            let room = (&mut *self.rows, &mut self.counts.evaluations);
            textures::look_up(context, &surface, direction, (open, none), room);
        }
        let rows = LobeRows::new::<L::F64>(lobes, material);
        let table = if lobes.has(LobeSet::TEXTURED) { &*self.rows } else { &context.table };
        let transparency: Color<L::F32> = table.color(Column::TRANSPARENCY, rows.at());
        let refracts = L::Mask::from_bits(refracts);
        if !refracts.any() {
            return left.dim(open, transparency, transparency);
        }
        let media = (&mut *self.media, &*self.events);
        let interface = Interface::meet(context, media, &surface, self.inside, refracts);
        self.inside = L::U32::select(refracts, interface.behind, self.inside);
        let mut whole = transparency;
        if context.refractive_shadows {
            let normal = surface.surface.normal;
            let reflected = self.reflected(&interface, direction, normal, material);
            let refraction: Color<L::F32> = table.color(Column::REFRACTION, rows.at());
            let passes = refraction * (L::F32::splat(1.0) - reflected.to_f32());
            whole = Color::select(refracts, transparency + passes, transparency);
        }
        left.dim(open & !interface.is_hidden, whole, transparency);
    }

    /// The share of light that boundaries reflect where it goes straight on, by each material's formula.
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
            let found = interface.boundary.straight(fresnel, direction, normal);
            reflected = L::F64::select(same, found, reflected);
        }
        reflected
    }

    /// From where on rays are looked along, and what they meet next where surfaces coincide.
    #[inline(always)]
    fn go_on(&self, t: L::F64, open: L::Mask, next: &mut Next) -> L::F64 {
        let mut after = t.to_array();
        for lane in lanes(open.bits()) {
            match self.events.get(next.event[lane]) {
                Some(event) => (after[lane], next.event[lane]) = (event.after, event.next),
                None => next.event[lane] = NO_EVENT,
            }
        }
        L::F64::from_array(after)
    }
}
