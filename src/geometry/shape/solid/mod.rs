//! Solids made of solids: differences, intersections and unions, and shapes that planes cut open.
//!
//! A ray is inside of a solid in intervals. Those of a solid made of others follow from the intervals of its parts:
//! `crossings` has the hits of parts, `part_intervals` their intervals, `intervals` those of the solid. A plane is the
//! half-space behind it, so a cut is an intersection with half-spaces.

mod crossings;
mod geometric;
mod intervals;
mod part_intervals;
mod solid_rays;
#[cfg(test)]
mod tests;

use super::{Mesh, Plane, Shape};
use crate::base::digest::{Content, Digester};
use crate::base::math::{Aabb, DVec3, gamma, max};
use crate::geometry::mesh::ArrayKey;
use std::sync::Arc;

/// How the parts of a solid form it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Content)]
pub enum Operation {
    /// What is inside the first part and outside all others.
    Difference,
    /// What is inside all parts.
    Intersection,
    /// What is inside any part.
    Union,
}

impl Operation {
    /// Whether a place is inside of the solid, from where it is inside of the parts.
    fn is_inside(self, states: &[bool]) -> bool {
        match self {
            Self::Intersection => states.iter().all(|inside| *inside),
            Self::Union => states.iter().any(|inside| *inside),
            Self::Difference => {
                states.split_first().is_some_and(|(first, rest)| *first && !rest.contains(&true))
            }
        }
    }
}

/// A solid made of others, all in its own space. Its parts are shared, because copies of a solid are common.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid(Arc<Inner>);

#[derive(Debug, PartialEq)]
struct Inner {
    operation: Operation,
    parts: Vec<Shape>,
    /// The first number of each part's own parts.
    first: Vec<u32>,
    /// The parts from this index on are planes that cut the first one.
    cuts: usize,
    /// Whether the first part encloses nothing: cut, it stays a surface.
    is_open: bool,
    /// The largest coordinate.
    reach: f64,
    bounds: Option<Aabb>,
    /// The bounds, and those of the parts, with a margin for the rounding of hits. None if they are not finite.
    surroundings: Option<Aabb>,
    part_surroundings: Vec<Option<Aabb>>,
}

/// No shape has more parts than this, except meshes and particles.
const MOST_PARTS: u32 = 8;

/// How many part numbers a shape needs; `u32::MAX` if there are not as many.
pub fn part_count(shape: &Shape) -> u32 {
    match shape {
        Shape::Mesh(mesh) => mesh.mesh.triangles().len() as u32,
        Shape::Particles(particles) => particles.0.spheres().len() as u32,
        Shape::Solid(Solid(inner)) => {
            inner.parts.iter().fold(0, |sum: u32, part| sum.saturating_add(part_count(part)))
        }
        _ => MOST_PARTS,
    }
}

/// Whether a shape encloses a volume. A plane encloses what is behind it.
pub fn encloses(shape: &Shape) -> bool {
    match shape {
        Shape::Sphere(_) | Shape::Cuboid(_) | Shape::Torus(_) | Shape::Plane(_) | Shape::Particles(_) => true,
        Shape::Cylinder(cylinder) => cylinder.ends().1,
        Shape::Cone(cone) => cone.ends().1,
        Shape::Mesh(Mesh { mesh, .. }) => mesh.is_closed(),
        Shape::Solid(solid) => !solid.0.is_open,
        Shape::Rectangle(_) | Shape::Disk(_) | Shape::Triangle(_) | Shape::Group => false,
    }
}

#[warn(missing_docs)]
impl Shape {
    /// The number of shapes of which it is made: 1, if it is no solid made of others.
    pub fn solid_count(&self) -> usize {
        match self {
            Self::Solid(solid) => solid.parts().iter().map(Self::solid_count).sum(),
            _ => 1,
        }
    }
}

impl Solid {
    /// A solid of parts that enclose volumes.
    pub fn new(operation: Operation, parts: Vec<Shape>) -> Self {
        let cuts = parts.len();
        Self::made(operation, parts, cuts, false)
    }

    /// The part of a shape behind all planes. Their normals point to what is cut away. What encloses a volume gets caps.
    pub fn cut(shape: &Shape, planes: impl IntoIterator<Item = Plane>) -> Self {
        let is_open = !encloses(shape) || matches!(shape, Shape::Plane(_));
        let planes = planes.into_iter().map(Shape::Plane);
        let parts = std::iter::once(shape.clone()).chain(planes).collect();
        Self::made(Operation::Intersection, parts, 1, is_open)
    }

    fn made(operation: Operation, parts: Vec<Shape>, cuts: usize, is_open: bool) -> Self {
        let mut next = 0u32;
        let number = |part: &Shape| {
            let first = next;
            next = next.saturating_add(part_count(part));
            first
        };
        let first = parts.iter().map(number).collect();
        let reach = parts.iter().map(reach).fold(0.0, max);
        let bounds = bounds(operation, &parts);
        let around = |bounds: Option<Aabb>| {
            bounds.filter(|bounds| bounds.min.is_finite() && bounds.max.is_finite()).map(
                |Aabb { min, max }| {
                    let margin = gamma(32) * min.abs().max(max.abs()).max_element();
                    Aabb { min: min - margin, max: max + margin }
                },
            )
        };
        let part_surroundings = parts.iter().map(|part| around(part.bounds())).collect();
        let surroundings = around(bounds);
        let inner =
            Inner { operation, parts, first, cuts, is_open, reach, bounds, surroundings, part_surroundings };
        Self(Arc::new(inner))
    }

    /// The parts in their order.
    pub fn parts(&self) -> &[Shape] {
        &self.0.parts
    }

    /// The index of a part and the number in its own numbering.
    fn of(&self, part: u32) -> (usize, u32) {
        let first = &self.0.first;
        let index = first.partition_point(|&first| first <= part).saturating_sub(1);
        (index, part - first[index])
    }

    /// Whether the outside of a part is the inside of the solid.
    fn is_turned(&self, index: usize) -> bool {
        self.0.operation == Operation::Difference && index > 0
    }

    /// Whether a number is that of a plane that cuts the shape.
    pub fn is_cap(&self, part: u32) -> bool {
        self.of(part).0 >= self.0.cuts
    }

    /// The slot of the material of a part, if it is a triangle of a mesh with materials.
    pub fn material_of(&self, part: u32) -> Option<u16> {
        let (index, part) = self.of(part);
        self.0.parts[index].material_of(part)
    }

    /// See [`Shape::triangle_of`].
    pub fn triangle_of(&self, part: u32) -> Option<[DVec3; 3]> {
        let (index, part) = self.of(part);
        self.0.parts[index].triangle_of(part)
    }

    /// See [`Shape::number`].
    pub fn number(&self, key: &ArrayKey, point: DVec3, part: u32) -> Option<f64> {
        let (index, part) = self.of(part);
        self.0.parts[index].number(key, point, part)
    }
}

impl Content for Solid {
    fn feed(&self, into: &mut Digester) {
        let Inner { operation, parts, cuts, .. } = &*self.0;
        ((operation, parts), *cuts as u32).feed(into);
    }
}

/// The bounds of a solid. Of an intersection, those common to all parts with bounds.
fn bounds(operation: Operation, parts: &[Shape]) -> Option<Aabb> {
    let mut all = parts.iter().map(Shape::bounds);
    match operation {
        Operation::Difference => all.next().flatten(),
        Operation::Union => all.try_fold(Aabb::EMPTY, |sum, bounds| Some(sum.union(bounds?))),
        Operation::Intersection => all.flatten().reduce(|a, b| {
            let common = Aabb { min: a.min.max(b.min), max: a.max.min(b.max) };
            if common.is_empty() { a } else { common }
        }),
    }
}

/// The largest coordinate of a shape; of a plane, of its point.
fn reach(shape: &Shape) -> f64 {
    let largest = |Aabb { min, max }: Aabb| min.abs().max(max.abs()).max_element();
    match shape {
        Shape::Plane(plane) => plane.point.abs().max_element(),
        Shape::Solid(solid) => solid.0.reach,
        _ => shape.bounds().map_or(0.0, largest),
    }
}
