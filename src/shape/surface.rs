//! Where a ray meets a shape, and what the surface is like there.

use crate::math::DVec3;

/// Where a ray meets a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    pub t: f64,
    /// Which part of the shape is met, in the shape's own numbering: a triangle of a mesh, a cap.
    pub part: u32,
}

impl Crossing {
    /// A crossing of a shape that has one part.
    pub fn at(t: f64) -> Self {
        Self { t, part: 0 }
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
}

impl Surface {
    pub fn new(point: DVec3, error: DVec3, normal: DVec3) -> Self {
        Self { point, error, normal, shading: normal }
    }

    /// A density per area at the point as one per solid angle, as seen `from` elsewhere; none when the surface
    /// is seen from its edge.
    pub fn density_from(&self, from: DVec3, per_area: f64) -> Option<f64> {
        let way = self.point - from;
        let distance_squared = way.length_squared();
        let facing = way.dot(self.normal).abs();
        let density = per_area * distance_squared * distance_squared.sqrt() / facing;
        (facing > 0.0 && density.is_finite() && density > 0.0).then_some(density)
    }

    /// The surface with a unit normal to shade with, turned to the geometric normal's side.
    pub fn shaded(self, shading: DVec3) -> Self {
        Self { shading: if shading.dot(self.normal) < 0.0 { -shading } else { shading }, ..self }
    }

    /// The surface with both normals turned to the other side.
    pub fn flipped(self) -> Self {
        Self { normal: -self.normal, shading: -self.shading, ..self }
    }
}
