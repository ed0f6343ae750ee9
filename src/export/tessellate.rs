//! Shapes as triangles.

mod mesh;
#[cfg(test)]
mod tests;

use crate::base::math::{Angle, DVec2, DVec3};
use crate::geometry::shape::{Cuboid, Disk, Frustum, FrustumEnd, Rectangle, Shape, Sphere, Torus, flat_axes};
use std::f64::consts::PI;

/// A corner of triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    pub position: DVec3,
    /// A unit vector outwards; zero in meshes of flat triangles.
    pub normal: DVec3,
    /// Texture coordinates with v upwards.
    pub uv: DVec2,
    /// Linear.
    pub color: DVec3,
}

/// Triangles, counter-clockwise when seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tessellation {
    pub vertices: Vec<Vertex>,
    /// The triangles of each material: its slot in the file of a mesh, if it has one.
    pub groups: Vec<(Option<u16>, Vec<[u32; 3]>)>,
    /// Whether the vertices have normals, texture coordinates and colours of their own.
    pub has: Attributes,
}

/// The data that vertices have besides positions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Attributes {
    pub normals: bool,
    pub uvs: bool,
    pub colors: bool,
}

/// The shape as triangles in its own space. Round shapes are within `tolerance` times their radius of the surface: that
/// of a sphere, of the wider end of a cone or cylinder, and of the tube of a torus. Infinite planes become squares that
/// reach `reach` from their point. None for groups, particles and solids made of others.
pub fn tessellated(shape: &Shape, tolerance: f64, reach: f64) -> Option<Tessellation> {
    let mut to = Builder::default();
    match shape {
        Shape::Sphere(sphere) => to.sphere(sphere, tolerance),
        Shape::Plane(plane) => to.square((plane.point, plane.normal), reach, DVec2::splat(2.0 * reach)),
        Shape::Rectangle(rectangle) => to.rectangle(rectangle),
        Shape::Disk(Disk { center, normal, radius }) => {
            let (right, up) = flat_axes(*normal);
            to.disk(*center, [right * *radius, up * *radius], *normal, segments(tolerance, 1.0));
        }
        Shape::Triangle(triangle) => to.triangle(triangle.corners),
        Shape::Cuboid(cuboid) => to.cuboid(cuboid),
        Shape::Cylinder(cylinder) => to.frustum(cylinder.frustum(), tolerance),
        Shape::Cone(cone) => to.frustum(cone.frustum(), tolerance),
        Shape::Torus(torus) => to.torus(torus, tolerance),
        Shape::Mesh(mesh) => return Some(mesh::tessellated(mesh)),
        Shape::Particles(_) | Shape::Solid(_) | Shape::Group => return None,
    }
    Some(to.finished())
}

/// The fewest and the most straight pieces of a circle.
const PIECES: [f64; 2] = [8.0, 2048.0];

/// The number of chords of a circle, a multiple of 4, that stay within `tolerance` of it. `radius` is that of the circle
/// in units of the tolerance. The middle of a chord of the angle a is off by 1 - cos(a/2) radii.
fn segments(tolerance: f64, radius: f64) -> u32 {
    let half_angle = libm::acos((1.0 - tolerance / radius).max(0.0));
    let count = (PI / half_angle / 4.0).ceil() * 4.0;
    count.clamp(PIECES[0], PIECES[1]) as u32
}

/// Collects triangles of one material.
#[derive(Default)]
struct Builder {
    vertices: Vec<Vertex>,
    triangles: Vec<[u32; 3]>,
}

impl Builder {
    fn finished(self) -> Tessellation {
        let Self { vertices, triangles } = self;
        let has = Attributes { normals: true, uvs: true, colors: false };
        Tessellation { vertices, groups: vec![(None, triangles)], has }
    }

    fn vertex(&mut self, (position, normal): (DVec3, DVec3), uv: DVec2) -> u32 {
        self.vertices.push(Vertex { position, normal, uv, color: DVec3::ONE });
        self.vertices.len() as u32 - 1
    }

    /// Adds a triangle, turned such that its front faces along its normals, unless two of its corners coincide.
    fn corners(&mut self, [a, b, c]: [u32; 3]) {
        let [p, q, r] = [a, b, c].map(|index| self.vertices[index as usize]);
        let (first, second) = (q.position - p.position, r.position - p.position);
        if p.position == q.position || q.position == r.position || p.position == r.position {
            return;
        }
        let faces_in = first.cross(second).dot(p.normal + q.normal + r.normal) < 0.0;
        self.triangles.push(if faces_in { [a, c, b] } else { [a, b, c] });
    }

    /// A surface over u and v in 0..=1, in so many columns and rows. `at` gives its points and normals.
    fn grid(&mut self, [columns, rows]: [u32; 2], at: impl Fn(DVec2) -> (DVec3, DVec3)) {
        let first = self.vertices.len() as u32;
        for row in 0..=rows {
            for column in 0..=columns {
                let uv = DVec2::new(f64::from(column) / f64::from(columns), f64::from(row) / f64::from(rows));
                self.vertex(at(uv), uv);
            }
        }
        for row in 0..rows {
            for column in 0..columns {
                let low = first + row * (columns + 1) + column;
                let high = low + columns + 1;
                self.corners([low, low + 1, high + 1]);
                self.corners([low, high + 1, high]);
            }
        }
    }

    /// Columns and rows each take half of the tolerance.
    fn sphere(&mut self, sphere: &Sphere, tolerance: f64) {
        let around = segments(0.5 * tolerance, 1.0);
        self.grid([around, around / 2], |uv| sphere.at_uv(uv));
    }

    fn torus(&mut self, torus: &Torus, tolerance: f64) {
        let (major, minor) = torus.radii();
        let counts = [segments(0.5 * tolerance, (major + minor) / minor), segments(0.5 * tolerance, 1.0)];
        self.grid(counts, |uv| torus.at_uv(uv));
    }

    fn frustum(&mut self, frustum: &Frustum, tolerance: f64) {
        let around = segments(tolerance, 1.0);
        self.grid([around, 1], |uv| frustum.side_at_uv(uv));
        let ([(bottom, wide), (top, narrow)], capped) = frustum.ends();
        if !capped {
            return;
        }
        for (center, radius, part) in [(bottom, wide, FrustumEnd::Bottom), (top, narrow, FrustumEnd::Top)] {
            let (axes, normal) = frustum.end_axes(part);
            if radius > 0.0 {
                self.disk(center, axes.map(|axis| axis * radius), normal, around);
            }
        }
    }

    /// A disk with these radii along u and v.
    fn disk(&mut self, center: DVec3, [right, up]: [DVec3; 2], normal: DVec3, around: u32) {
        let middle = self.vertex((center, normal), DVec2::splat(0.5));
        for piece in 0..around {
            let turn = Angle(360.0 * f64::from(piece) / f64::from(around)).cos_sin();
            let uv = DVec2::splat(0.5) + turn * 0.5;
            self.vertex((center + right * turn.x + up * turn.y, normal), uv);
        }
        for piece in 0..around {
            self.corners([middle, middle + 1 + piece, middle + 1 + (piece + 1) % around]);
        }
    }

    /// A square that reaches `reach` from a point. `uv` is the length of its sides in texture coordinates.
    fn square(&mut self, (center, normal): (DVec3, DVec3), reach: f64, uv: DVec2) {
        let (right, up) = flat_axes(normal);
        let first = self.vertices.len() as u32;
        for [x, y] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
            let position = center + (right * x + up * y) * reach;
            self.vertex((position, normal), uv * 0.5 * DVec2::new(x, y));
        }
        self.corners([first, first + 1, first + 2]);
        self.corners([first, first + 2, first + 3]);
    }

    fn rectangle(&mut self, rectangle: &Rectangle) {
        let Rectangle { corner, u, v } = *rectangle;
        let normal = rectangle.normal();
        self.grid([1, 1], |uv| (corner + u * uv.x + v * uv.y, normal));
    }

    fn triangle(&mut self, [a, b, c]: [DVec3; 3]) {
        let normal = (b - a).cross(c - a).normalize_or(DVec3::Y);
        let uvs = [DVec2::ZERO, DVec2::X, DVec2::Y];
        let [a, b, c] = [a, b, c].map(|corner| (corner, normal));
        let corners = [(a, uvs[0]), (b, uvs[1]), (c, uvs[2])].map(|(corner, uv)| self.vertex(corner, uv));
        self.corners(corners);
    }

    /// Six faces, each with its own texture coordinates.
    fn cuboid(&mut self, cuboid: &Cuboid) {
        for (axis, outwards) in (0..3).flat_map(|axis| [(axis, -1.0), (axis, 1.0)]) {
            let mut normal = DVec3::ZERO;
            normal[axis] = outwards;
            let (right, up) = flat_axes(normal);
            let (center, half) = ((cuboid.min + cuboid.max) * 0.5, (cuboid.max - cuboid.min) * 0.5);
            let face = |uv: DVec2| {
                let across = right * (2.0 * uv.x - 1.0) + up * (2.0 * uv.y - 1.0);
                (center + half * (normal + across), normal)
            };
            self.grid([1, 1], face);
        }
    }
}
