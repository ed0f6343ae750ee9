//! Where a ray meets a shape, and what the surface is like there.

use crate::base::math::DVec3;

/// Where a ray meets a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    pub t: f64,
    /// Which part of the shape is met, in the shape's own numbering: a triangle of a mesh, a cap.
    pub part: u32,
    /// Whether something else is met so near that it is not certain which comes first (see
    /// [`Vicinity`](super::Vicinity)).
    pub crowded: bool,
}

impl Crossing {
    /// A crossing of a shape that has one part.
    pub fn at(t: f64) -> Self {
        Self::of_part(t, 0)
    }

    pub fn of_part(t: f64, part: u32) -> Self {
        Self { t, part, crowded: false }
    }
}

/// A point on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// The point, put back onto the surface after the rounding of the way there.
    pub point: DVec3,
    /// How far each coordinate may be from the true surface, including the rounding of the shape's own test
    /// of a ray that starts at the point.
    pub error: DVec3,
    /// Unit geometric normal; outwards where the shape encloses a volume.
    pub normal: DVec3,
    /// Unit normal to shade with, on the geometric normal's side: that of the smooth surface which a mesh
    /// stands for. Elsewhere the geometric one.
    pub shading: DVec3,
    /// From the point to the smooth surface that a mesh stands for, where that lies above it; zero elsewhere. From
    /// there light is looked for, which the flat triangles would hide.
    pub lift: DVec3,
}

impl Surface {
    pub fn new(point: DVec3, error: DVec3, normal: DVec3) -> Self {
        Self { point, error, normal, shading: normal, lift: DVec3::ZERO }
    }
}
