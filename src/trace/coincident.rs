//! Surfaces that lie in one: a glass on a table, two slabs face to face.
//!
//! A ray that has passed a surface starts beyond all that rounding may have done to it, and so beyond whatever lies in
//! the same place. What it would miss is looked for across the place, and is there if it is no farther from the surface
//! than the rounding of both.

use super::tracer::{Met, Tracer};
use crate::camera::Ray;
use crate::math::{DVec3, UNIT_ROUNDOFF};
use crate::shape::Surface;
use crate::tree::Probe;

/// Surfaces in one place that are told apart; more are passed as one.
const MOST: usize = 4;

/// Where a ray has just passed a surface, or several that lie in one.
#[derive(Clone, Copy, Debug)]
pub struct Crossed {
    point: DVec3,
    /// Unit vector, against the way of the ray.
    normal: DVec3,
    /// How far off along the normal the surface may be.
    error: f64,
    primitives: [u32; MOST],
    count: usize,
}

/// The rounding of any surface, as a share of the coordinates that the scene has: what is looked at across a place.
const WIDEST: f64 = 128.0 * UNIT_ROUNDOFF;

/// The error of a surface's point along its normal.
fn error_of(surface: &Surface) -> f64 {
    surface.normal.abs().dot(surface.error)
}

impl Crossed {
    /// The place where a ray in a direction has passed a surface of a primitive. `before` is what lies in the same place
    /// and has been passed already.
    pub fn new(before: Option<Self>, primitive: u32, surface: &Surface, direction: DVec3) -> Self {
        let normal = if direction.dot(surface.normal) > 0.0 { -surface.normal } else { surface.normal };
        let (point, error) = (surface.point, error_of(surface));
        let (mut primitives, count) = before.map_or(([u32::MAX; MOST], 0), |b| (b.primitives, b.count));
        primitives[count % MOST] = primitive;
        Self { point, normal, error, primitives, count: count + 1 }
    }
}

impl<'a> Tracer<'a> {
    /// What lies in the surfaces that a ray has just passed, and has not been passed yet.
    /// `width` is that of the ray's beam.
    pub fn lying_in(&self, crossed: Option<&Crossed>, width: f64) -> Option<Met<'a>> {
        let Crossed { point, normal, error, mut primitives, mut count } = *crossed?;
        let wide = (self.bvh.reach() + point.abs().max_element()) * WIDEST;
        let way = Ray { origin: point + normal * wide, direction: normal * (-2.0 * wide) };
        while count < MOST {
            let skipped = &primitives[..count];
            let hit = self.bvh.closest_but(self.scene.geometry, &Probe::new(way), 1.0, skipped)?;
            let met = self.met(&way, hit, width);
            let surface = match &met {
                Met::Surface(face) => &face.surface,
                Met::Light { surface, .. } => surface,
                Met::Nothing => return None,
            };
            let apart = (surface.point - point).dot(normal).abs();
            // Twice, as its point was not found on the ray but across the place.
            if apart <= 2.0 * (error + error_of(surface)) {
                return Some(met);
            }
            // Near, but a surface of its own: the ray meets it by itself, or has met it.
            primitives[count] = hit.primitive;
            count += 1;
        }
        None
    }
}
