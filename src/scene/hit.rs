//! Hits of rays with primitives.

use crate::geometry::shape::ShapeHit;

/// A hit of a ray with a primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    pub at: ShapeHit,
    /// Index into the geometry's primitives.
    pub primitive: u32,
}
