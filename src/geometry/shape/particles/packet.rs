//! The spheres of a leaf.

use crate::base::lanes::{Level, Row, Vec3};
use crate::geometry::shape::{Sphere, SphereLanes};

/// Up to eight spheres as structure of arrays. Lanes without a sphere repeat the last one.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub struct SpherePacket {
    center: [[f64; 8]; 3],
    radius: [f64; 8],
    parts: [u32; 8],
    count: u32,
}

impl SpherePacket {
    /// The spheres of these indices: at least one and at most eight.
    pub(super) fn new(spheres: &[Sphere], parts: &[u32]) -> Self {
        let last = parts.len() - 1;
        let parts: [u32; 8] = std::array::from_fn(|lane| parts[lane.min(last)]);
        let each = parts.map(|part| spheres[part as usize]);
        Self {
            center: [0, 1, 2].map(|axis: usize| each.map(|sphere| sphere.center[axis])),
            radius: each.map(|sphere| sphere.radius),
            parts,
            count: last as u32 + 1,
        }
    }

    pub fn count(&self) -> usize {
        self.count as usize
    }

    /// The indices of its spheres.
    pub fn parts(&self) -> &[u32] {
        &self.parts[..self.count()]
    }

    /// The index of a lane's sphere.
    #[inline(always)]
    pub fn part(&self, lane: usize) -> u32 {
        self.parts[lane & 7]
    }

    /// The spheres, one per lane.
    #[inline(always)]
    pub fn lanes<L: Level>(&self) -> SphereLanes<L::F64> {
        let [x, y, z] = self.center.map(L::F64::from_array);
        SphereLanes { center: Vec3::new(x, y, z), radius: L::F64::from_array(self.radius) }
    }

    /// One of the spheres.
    #[inline(always)]
    pub fn sphere(&self, lane: usize) -> Sphere {
        let [x, y, z] = self.center.map(|axis| axis[lane & 7]);
        Sphere { center: crate::base::math::DVec3::new(x, y, z), radius: self.radius[lane & 7] }
    }
}
