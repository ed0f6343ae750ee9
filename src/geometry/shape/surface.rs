//! Hits of rays with shapes, and surfaces.

use crate::base::math::DVec3;

/// A hit of a ray with a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeHit {
    pub t: f64,
    /// The part of the shape, in the shape's own numbering: a triangle of a mesh, a cap.
    pub part: u32,
    /// Whether another hit is so near that the order is uncertain (see [`CoincidenceRange`](super::CoincidenceRange)).
    pub coincident: bool,
    /// Whether no other part of a mesh lies within [`CLEARANCE`](crate::geometry::bvh::CLEARANCE) of the hit, in the
    /// space of its tree. False if the search does not show that, or was not to find out.
    pub isolated: bool,
}

impl ShapeHit {
    /// A hit of a shape with a single part.
    pub fn at(t: f64) -> Self {
        Self::of_part(t, 0)
    }

    pub fn of_part(t: f64, part: u32) -> Self {
        Self { t, part, coincident: false, isolated: false }
    }
}

/// A point on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// The point, projected onto the surface after the rounding of `ray.at(t)`.
    pub point: DVec3,
    /// Distance of each coordinate from the true surface, at most. It includes the rounding of the shape's test of a
    /// ray that starts at the point.
    pub error: DVec3,
    /// Unit geometric normal; outwards if the shape encloses a volume.
    pub normal: DVec3,
    /// Unit shading normal, on the geometric normal's side: that of the smooth surface which a mesh approximates. For
    /// other shapes, the geometric normal.
    pub shading: DVec3,
    /// The offset from the point to the smooth surface that a mesh approximates, if that is above the point; otherwise
    /// zero. Shadow rays start from there, because the flat triangles would block the light.
    pub lift: DVec3,
}

impl Surface {
    pub fn new(point: DVec3, error: DVec3, normal: DVec3) -> Self {
        Self { point, error, normal, shading: normal, lift: DVec3::ZERO }
    }
}
