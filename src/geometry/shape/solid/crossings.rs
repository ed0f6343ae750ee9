//! The hits of a part along whole rays, eight rays at a time.

use super::solid_rays::SolidRays;
use crate::base::lanes::{Mask, Real, Row, lanes};
use crate::base::math::{LaneRay, Ray, gamma};
use crate::geometry::bvh::TraversalRay;
use crate::geometry::shape::{
    CoincidenceRange, LaneHit, LaneSurface, PreparedRay, RayInterval, Shape, ShapeHit, store_lanes,
};

/// A hit of a part.
#[derive(Clone, Copy, Debug)]
pub struct PartHit {
    pub t: f64,
    /// Bound of the error of t.
    pub error: f64,
    /// In the part's own numbering.
    pub part: u32,
    /// The ray's direction along the normal: negative where the ray enters.
    pub along: f64,
    /// Whether the ray may touch the surface without crossing it: the bound of the error of t has no limit there.
    pub may_touch: bool,
}

impl PartHit {
    fn new(t: f64, part: u32, Crossing { error, along, may_touch }: Crossing<f64>) -> Self {
        Self { t, error, part, along, may_touch }
    }

    pub fn enters(&self) -> bool {
        self.along < 0.0
    }
}

/// The hits of a part along the ray of each lane, in order.
#[derive(Debug, Default)]
pub struct Crossings([Vec<PartHit>; 8]);

impl Crossings {
    pub fn of(&self, lane: usize) -> &[PartHit] {
        &self.0[lane]
    }

    fn clear(&mut self) {
        self.0.iter_mut().for_each(Vec::clear);
    }

    /// Finds all hits of a shape along the rays in the lanes of a mask.
    #[inline(always)]
    pub fn find<F: Real>(
        &mut self,
        shape: &Shape,
        rays: &SolidRays<F>,
        range: CoincidenceRange<F>,
        wanted: F::Mask,
    ) {
        self.clear();
        match shape {
            Shape::Mesh(_) | Shape::Particles(_) => {
                for lane in lanes(wanted.bits()) {
                    self.search(lane, shape, &rays.stored.one(lane), range.lane(lane));
                }
            }
            Shape::Solid(solid) => {
                let found = solid.hits(rays, wanted);
                for lane in lanes(wanted.bits()) {
                    let (ray, range) = (LaneRay::from(&rays.stored.one(lane)), range.lane(lane));
                    found.of(lane).iter().for_each(|at| self.take(lane, (shape, &ray), *at, range));
                    self.sort(lane);
                }
            }
            _ => self.find_each(shape, rays.prepared, range, wanted),
        }
    }

    /// [`Crossings::find`] along one ray, for shapes with a tree of parts.
    #[inline(never)]
    pub fn search(&mut self, lane: usize, shape: &Shape, ray: &Ray, range: CoincidenceRange<f64>) {
        let (lanes, ray) = (LaneRay::from(ray), TraversalRay::new(*ray));
        shape.each_crossing(&ray, RayInterval::up_to(f64::INFINITY), &mut |at| {
            self.take(lane, (shape, &lanes), at, range);
        });
        self.sort(lane);
    }

    fn sort(&mut self, lane: usize) {
        self.0[lane].sort_by(|a, b| a.t.total_cmp(&b.t).then(a.part.cmp(&b.part)));
    }

    /// Rays keep their origins and only the minimum of t grows, so each hit is found, however close hits are, in order.
    #[inline(always)]
    fn find_each<F: Real>(
        &mut self,
        shape: &Shape,
        rays: &PreparedRay<F>,
        range: CoincidenceRange<F>,
        wanted: F::Mask,
    ) {
        let (mut min, mut left) = (F::splat(0.0), wanted);
        loop {
            let max = F::select(left, F::splat(f64::INFINITY), F::splat(-1.0));
            let at = shape.intersect(rays, RayInterval { min, max });
            left = left & at.is_hit();
            if !left.any() {
                return;
            }
            min = F::select(left, at.t, min);
            let surface = shape.surface(&rays.ray, at, 0.0);
            self.push(&rays.ray, (at, &surface), range, left);
        }
    }

    /// Adds a hit of one ray.
    #[inline(never)]
    fn take(
        &mut self,
        lane: usize,
        (shape, ray): (&Shape, &LaneRay<f64>),
        at: ShapeHit,
        range: CoincidenceRange<f64>,
    ) {
        let at = LaneHit::from(at);
        let crossing = crossing(ray, at.t, &shape.surface(ray, at, 0.0), range);
        self.0[lane].push(PartHit::new(at.t, at.part, crossing));
    }

    #[inline(always)]
    fn push<F: Real>(
        &mut self,
        ray: &LaneRay<F>,
        (at, surface): (LaneHit<F>, &LaneSurface<F>),
        range: CoincidenceRange<F>,
        wanted: F::Mask,
    ) {
        let Crossing { error, along, may_touch } = crossing(ray, at.t, surface, range);
        let ([t, error, along], parts) = ([at.t, error, along].map(store_lanes), at.part.to_array());
        for lane in lanes(wanted.bits()) {
            let (error, along, may_touch) = (error[lane], along[lane], may_touch.bits() >> lane & 1 == 1);
            let crossing = Crossing::<f64> { error, along, may_touch };
            self.0[lane].push(PartHit::new(t[lane], parts[lane], crossing));
        }
    }
}

/// How rays cross a surface.
struct Crossing<F: Real> {
    error: F,
    along: F,
    may_touch: F::Mask,
}

/// The error of t has no limit where a ray grazes a surface, so its bound ends at the range within which hits may
/// coincide.
#[inline(always)]
fn crossing<F: Real>(
    ray: &LaneRay<F>,
    t: F,
    surface: &LaneSurface<F>,
    range: CoincidenceRange<F>,
) -> Crossing<F> {
    let along = surface.normal.dot(ray.direction);
    let way = ray.direction * t;
    let off = (ray.origin + way - surface.point).dot(surface.normal);
    // The point's own error, its distance from the ray, and the rounding of that.
    let rounding = (ray.origin.abs() + way.abs()) * F::splat(gamma(4));
    let error = surface.normal.abs().dot(surface.error + rounding) + off.abs();
    let most = range.end(t) - t;
    let may_touch = (most * along.abs()).le(error);
    Crossing { error: F::select(may_touch, most, error / along.abs()), along, may_touch }
}
