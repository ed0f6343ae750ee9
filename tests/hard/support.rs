//! What the hard cases share.

#[path = "../integration/support.rs"]
#[allow(dead_code, reason = "shared with the other tests, which need more of it")]
mod shared;

pub use shared::{Random, geometry, radiance_at_target, sequence, shoot, shoot_all, shoot_counting};

use kinora::appearance::material::MaterialBinding;
use kinora::base::math::{Angle, DAffine3, DVec3, Ray, UNIT_ROUNDOFF};
use kinora::geometry::bvh::TraversalRay;
use kinora::geometry::shape::{LaneSurface, Shape, ShapeHit, Surface};
use kinora::scene::top_level::{Bvh, Hit};
use kinora::scene::{Finish, Geometry, Primitive};

/// The unit round-off.
pub const U: f64 = UNIT_ROUNDOFF;

/// The default size of a sweep whose whole size is `whole`.
pub fn few(whole: u32) -> u32 {
    if cfg!(debug_assertions) { whole / 200 } else { whole / 10 }
}

/// Evenly over the sphere.
pub fn direction(random: &mut Random) -> DVec3 {
    let z = 2.0 * random.unit() - 1.0;
    let turn = Angle(360.0 * random.unit()).cos_sin() * ((1.0 - z) * (1.0 + z)).sqrt();
    DVec3::new(turn.x, turn.y, z)
}

/// A point of the unit disk across a unit vector, evenly over its area, times `radius`.
pub fn disk_across(random: &mut Random, axis: DVec3, inner: f64, outer: f64) -> DVec3 {
    let (u, v) = axis.any_orthonormal_pair();
    let radius = (inner * inner + (outer * outer - inner * inner) * random.unit()).sqrt();
    let turn = Angle(360.0 * random.unit()).cos_sin() * radius;
    u * turn.x + v * turn.y
}

pub fn placed(shape: &Shape, to_world: DAffine3) -> Primitive {
    Primitive::new(shape, to_world, Finish::Material(MaterialBinding::One(0))).expect("a primitive")
}

/// The closest hit, found primitive by primitive, of equally near ones that of the lowest index, and whether another one is
/// near it.
pub fn scan(geometry: &Geometry, bvh: &Bvh, probe: &TraversalRay) -> Option<Hit> {
    let hits = (0..).zip(&geometry.primitives);
    let hits = hits
        .filter_map(|(primitive, p)| Some(Hit { at: p.intersect_up_to(probe, f64::INFINITY)?, primitive }));
    let hits: Vec<_> = hits.collect();
    let mut nearest = *hits.iter().reduce(|best, hit| if hit.at.t < best.at.t { hit } else { best })?;
    let end = bvh.coincidence_range(probe).end(nearest.at.t);
    nearest.at.coincident |= hits.iter().filter(|hit| hit.at.t < end).count() > 1;
    Some(nearest)
}

pub fn hit(primitive: &Primitive, origin: DVec3, direction: DVec3) -> Option<ShapeHit> {
    primitive.intersect_up_to(&TraversalRay::new(Ray { origin, direction }), f64::INFINITY)
}

/// Where a ray meets the primitive, with the surface as the primitive gives it.
pub fn met(primitive: &Primitive, origin: DVec3, direction: DVec3) -> Option<(f64, Surface)> {
    let at = hit(primitive, origin, direction)?;
    Some((at.t, primitive.surface_at(&Ray { origin, direction }, at)))
}

/// The surface with its normal against the direction, as integrators see it.
pub fn facing(surface: Surface, direction: DVec3) -> Surface {
    let below = surface.normal.dot(direction) > 0.0;
    let mut surface = LaneSurface::from(&surface);
    surface.flip(below);
    surface.into()
}
