//! Tables from which lanes gather the surfaces of primitives.

use super::{Geometry, Primitive};
use crate::base::lanes::{Bits, Lookup, Mask, Real, Row, Select, Vec3, lanes, out_of_line};
use crate::base::math::{DVec3, LaneRay};
use crate::geometry::shape::{LaneHit, LaneSurface, Shape, SphereLanes, flat_surface};

/// The table that holds the surface of a primitive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// A plane through a point with a normal, by its index.
    Flat(u32),
    Sphere(u32),
    /// The primitive computes its surface itself.
    Other,
}

/// Tables of the surfaces of primitives. Flat surfaces and spheres are gathered for all lanes at once. Other surfaces
/// are computed one primitive after the other.
#[derive(Clone, Debug, Default)]
pub struct SurfaceTable {
    kinds: Vec<Kind>,
    /// Points and unit normals.
    anchors: [Vec<f64>; 3],
    normals: [Vec<f64>; 3],
    centers: [Vec<f64>; 3],
    radii: Vec<f64>,
}

impl SurfaceTable {
    pub fn new(geometry: &Geometry) -> Self {
        let mut table = Self::default();
        for primitive in &geometry.primitives {
            let kind = table.add(primitive);
            table.kinds.push(kind);
        }
        table
    }

    fn add(&mut self, primitive: &Primitive) -> Kind {
        let flat = match (&primitive.shape, &primitive.transform) {
            (Shape::Sphere(sphere), None) => {
                push(&mut self.centers, sphere.center);
                self.radii.push(sphere.radius);
                return Kind::Sphere(self.radii.len() as u32 - 1);
            }
            (Shape::Plane(plane), None) => (plane.point, plane.normal),
            (Shape::Rectangle(rectangle), None) => (rectangle.corner, rectangle.normal()),
            (Shape::Disk(disk), None) => (disk.center, disk.normal),
            (Shape::Triangle(triangle), None) => (triangle.corners[0], triangle.normal()),
            _ => return Kind::Other,
        };
        push(&mut self.anchors, flat.0);
        push(&mut self.normals, flat.1);
        Kind::Flat(self.normals[0].len() as u32 - 1)
    }

    /// The surfaces at hits of rays with primitives, in the lanes of a mask.
    #[inline(always)]
    pub fn surfaces<F: Real>(
        &self,
        geometry: &Geometry,
        ray: &LaneRay<F>,
        at: LaneHit<F>,
        primitives: F::U32,
        wanted: F::Mask,
    ) -> LaneSurface<F> {
        surfaces(self, geometry, ray, at, primitives, wanted)
    }
}

out_of_line! {
    fn surfaces<'k, F>(
        table: &'k SurfaceTable,
        geometry: &'k Geometry,
        ray: &'k LaneRay<F>,
        at: LaneHit<F>,
        primitives: F::U32,
        wanted: F::Mask,
    ) -> LaneSurface<F> {
        let indices = primitives.to_array();
        let (mut flat, mut sphere, mut other) = (0u32, 0u32, 0u32);
        let (mut flats, mut spheres) = ([0; 8], [0; 8]);
        for lane in lanes(wanted.bits()) {
            match table.kinds[indices[lane] as usize] {
                Kind::Flat(index) => (flats[lane], flat) = (index, flat | 1 << lane),
                Kind::Sphere(index) => (spheres[lane], sphere) = (index, sphere | 1 << lane),
                Kind::Other => other |= 1 << lane,
            }
        }
        let mut surface = LaneSurface::nowhere();
        if flat != 0 {
            let lookup = Lookup::new(&flats[..F::LANES]);
            let anchor = Vec3::gather(columns(&table.anchors), &lookup);
            let normal = Vec3::gather(columns(&table.normals), &lookup);
            let found = flat_surface(anchor, ray.at(at.t), normal);
            surface = LaneSurface::select(F::Mask::from_bits(flat), found, surface);
        }
        if sphere != 0 {
            let lookup = Lookup::new(&spheres[..F::LANES]);
            let center = Vec3::gather(columns(&table.centers), &lookup);
            let found = SphereLanes { center, radius: F::gather(&table.radii, &lookup) }.surface(ray, at.t);
            surface = LaneSurface::select(F::Mask::from_bits(sphere), found, surface);
        }
        while other != 0 {
            let index = indices[other.trailing_zeros() as usize];
            let same = F::Mask::from_bits(primitives.eq(F::U32::splat(index)).bits() & other);
            // Parts of other primitives may not exist on this one. Every shape has a part 0.
            let part = F::U32::select(same, at.part, F::U32::splat(0));
            let found = geometry.primitives[index as usize].surface(ray, LaneHit { part, ..at });
            surface = LaneSurface::select(same, found, surface);
            other &= !same.bits();
        }
        surface
    }
}

fn push([x, y, z]: &mut [Vec<f64>; 3], v: DVec3) {
    x.push(v.x);
    y.push(v.y);
    z.push(v.z);
}

#[inline(always)]
fn columns([x, y, z]: &[Vec<f64>; 3]) -> [&[f64]; 3] {
    [x, y, z]
}
