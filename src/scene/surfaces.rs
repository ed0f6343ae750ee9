//! Tables from which lanes gather the surfaces of primitives.

use super::{Geometry, Primitive};
use crate::base::lanes::{Bits, Lookup, Mask, Real, Row, Select, Vec3, lanes, out_of_line};
use crate::base::math::{DVec3, LaneRay};
use crate::geometry::shape::{LaneHit, LaneSurface, Shape, SphereLanes, flat_surface};

/// How the surface of a primitive is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Flat,
    Sphere,
    /// The primitive computes its surface itself.
    Other,
}

/// Columns of the surfaces of primitives. Flat surfaces and spheres are gathered for all lanes at once. Other surfaces
/// are computed one primitive after the other.
#[derive(Clone, Debug, Default)]
pub struct SurfaceTable {
    kinds: Vec<Kind>,
    /// Points of flat surfaces, and centres of spheres.
    anchors: [Vec<f64>; 3],
    /// Unit normals of flat surfaces.
    normals: [Vec<f64>; 3],
    /// Radii of spheres.
    radii: Vec<f64>,
    /// [`Primitive::clearance`] of all primitives.
    clearances: Vec<f64>,
}

impl SurfaceTable {
    /// Adds slots at the end.
    pub fn resize(&mut self, slots: usize) {
        self.kinds.resize(slots, Kind::Other);
        self.anchors.iter_mut().chain(&mut self.normals).for_each(|column| column.resize(slots, 0.0));
        self.radii.resize(slots, 0.0);
        self.clearances.resize(slots, 0.0);
    }

    /// Sets the surface of a slot.
    pub fn set(&mut self, slot: usize, primitive: &Primitive) {
        self.clearances[slot] = primitive.clearance();
        let flat = match (&primitive.shape, &primitive.transform) {
            (Shape::Sphere(sphere), None) => {
                put(&mut self.anchors, slot, sphere.center);
                (self.radii[slot], self.kinds[slot]) = (sphere.radius, Kind::Sphere);
                return;
            }
            (Shape::Plane(plane), None) => (plane.point, plane.normal),
            (Shape::Rectangle(rectangle), None) => (rectangle.corner, rectangle.normal()),
            (Shape::Disk(disk), None) => (disk.center, disk.normal),
            (Shape::Triangle(triangle), None) => (triangle.corners[0], triangle.normal()),
            _ => return self.kinds[slot] = Kind::Other,
        };
        put(&mut self.anchors, slot, flat.0);
        put(&mut self.normals, slot, flat.1);
        self.kinds[slot] = Kind::Flat;
    }
}

#[warn(missing_docs)]
impl Geometry {
    /// Writes the surfaces at hits of rays with primitives, in the lanes of a mask; others are nowhere. Surfaces in lanes
    /// are large, so they are written to where they are used.
    #[inline(always)]
    pub fn find_surfaces<F: Real>(
        &self,
        ray: &LaneRay<F>,
        (at, primitives): (LaneHit<F>, F::U32),
        wanted: F::Mask,
        into: &mut LaneSurface<F>,
    ) {
        find_surfaces(self, ray, at, primitives, wanted, into);
    }

    /// The [clearances](Primitive::clearance) of primitives, in the lanes of a mask; those of others mean nothing.
    #[inline(always)]
    pub fn clearances<F: Real>(&self, primitives: F::U32, wanted: F::Mask) -> F {
        let slots = F::U32::select(wanted, primitives, F::U32::splat(0)).to_array();
        let mut clearances = F::splat(0.0).to_array();
        for lane in 0..F::LANES {
            clearances[lane] = self.surfaces.clearances[slots[lane] as usize];
        }
        F::from_array(clearances)
    }
}

out_of_line! {
    fn find_surfaces<'k, F>(
        geometry: &'k Geometry,
        ray: &'k LaneRay<F>,
        at: LaneHit<F>,
        primitives: F::U32,
        wanted: F::Mask,
        into: &'k mut LaneSurface<F>,
    ) -> () {
        let (table, indices) = (&geometry.surfaces, primitives.to_array());
        let (mut flat, mut sphere, mut other) = (0u32, 0u32, 0u32);
        // Other lanes read the first slot.
        let mut slots = [0; 8];
        for lane in lanes(wanted.bits()) {
            slots[lane] = indices[lane];
            match table.kinds[indices[lane] as usize] {
                Kind::Flat => flat |= 1 << lane,
                Kind::Sphere => sphere |= 1 << lane,
                Kind::Other => other |= 1 << lane,
            }
        }
        *into = LaneSurface::nowhere();
        let lookup = Lookup::new(&slots[..F::LANES]);
        if flat != 0 {
            let anchor = Vec3::gather(columns(&table.anchors), &lookup);
            let normal = Vec3::gather(columns(&table.normals), &lookup);
            let found = flat_surface(anchor, ray.at(at.t), normal);
            *into = LaneSurface::select(F::Mask::from_bits(flat), found, *into);
        }
        if sphere != 0 {
            let center = Vec3::gather(columns(&table.anchors), &lookup);
            let found = SphereLanes { center, radius: F::gather(&table.radii, &lookup) }.surface(ray, at.t);
            *into = LaneSurface::select(F::Mask::from_bits(sphere), found, *into);
        }
        while other != 0 {
            let index = indices[other.trailing_zeros() as usize];
            let same = F::Mask::from_bits(primitives.eq(F::U32::splat(index)).bits() & other);
            // Parts of other primitives may not exist on this one. Every shape has a part 0.
            let part = F::U32::select(same, at.part, F::U32::splat(0));
            let found = geometry.primitives[index as usize].surface(ray, LaneHit { part, ..at });
            *into = LaneSurface::select(same, found, *into);
            other &= !same.bits();
        }
    }
}

fn put([x, y, z]: &mut [Vec<f64>; 3], slot: usize, v: DVec3) {
    (x[slot], y[slot], z[slot]) = (v.x, v.y, v.z);
}

#[inline(always)]
fn columns([x, y, z]: &[Vec<f64>; 3]) -> [&[f64]; 3] {
    [x, y, z]
}
