//! Where a ray meets a shape, and what the surface is like there.

use super::flat;
use crate::math::{DVec2, DVec3, larger};

/// Where a ray meets a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    pub t: f64,
    /// Which part of the shape is met, in the shape's own numbering: a triangle of a mesh, a cap.
    pub part: u32,
    /// Whether something else is met so near that it is not certain which comes first (see
    /// [`Vicinity`](crate::tree::Vicinity)).
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

/// Where a ray leaves a convex solid: if it enters it ahead, then behind that, also where it only touches the solid.
#[inline]
pub fn exit(enter: f64, leave: f64) -> f64 {
    if enter > 0.0 { larger(leave, enter.next_up()) } else { leave }
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

    /// Whether light from this direction, which may lie below the surface's own horizon, falls on the smooth surface
    /// that it stands for.
    pub fn smoothly_faces(&self, direction: DVec3) -> bool {
        self.lift != DVec3::ZERO && direction.dot(self.shading) > 0.0
    }

    /// The surface with its point as far from the edges of the flat triangle that it lies in as rounding may move rays
    /// that start there: by its error, their way off the surface and the error of the test from there, with a neighbour
    /// at any angle but a sharp one. In triangles too small for that, the middle.
    pub fn clear_of_edges(self, [a, b, c]: [DVec3; 3]) -> Self {
        let DVec2 { x, y } = flat::shares(self.point - a, b - a, c - a);
        let doubled_area = (b - a).cross(c - a).length();
        let clear = 8.0 * self.error.length() / doubled_area;
        // A weight is the distance from the opposite edge over the height above it, which is the doubled area over the
        // edge.
        let lacks = [
            clear * (c - b).length() - (1.0 - x - y),
            clear * (a - c).length() - x,
            clear * (b - a).length() - y,
        ];
        let lack = lacks.into_iter().fold(0.0, f64::max).min(1.0 / 3.0);
        Self { point: self.point + ((a - self.point) + (b - self.point) + (c - self.point)) * lack, ..self }
    }

    /// The surface with both normals turned to the other side.
    pub fn flipped(self) -> Self {
        Self { normal: -self.normal, shading: -self.shading, ..self }
    }
}
