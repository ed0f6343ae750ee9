//! A ray with what every test along it needs, computed once.

use crate::camera::Ray;
use crate::math::DVec3;

/// A ray prepared for box and triangle tests.
#[derive(Clone, Copy, Debug)]
pub struct Probe {
    pub ray: Ray,
    /// 1 / direction; infinite, with the sign of the zero, where the direction is zero.
    pub inverse: DVec3,
    /// Along the axis where it is longest, the direction's length.
    pub longest: f64,
    /// The axis along which the direction is longest, and the two others in cyclic order.
    pub axes: [usize; 3],
    /// Direction along the two others over direction along the longest: shears the ray onto that axis.
    pub shear: [f64; 2],
}

impl Probe {
    #[inline(always)]
    pub fn new(ray: Ray) -> Self {
        let d = ray.direction;
        let a = d.abs();
        // By tables and selections: branches could not be predicted.
        let (of_yz, yz) = (1 + usize::from(a.z > a.y), if a.z > a.y { a.z } else { a.y });
        let z = if a.x >= yz { 0 } else { of_yz };
        let [x, y] = [[1, 2], [2, 0], [0, 1]][z];
        let longest = if a.x >= yz { a.x } else { yz };
        let inverse = DVec3::new(1.0 / d.x, 1.0 / d.y, 1.0 / d.z);
        Self { ray, inverse, longest, axes: [x, y, z], shear: [d[x] * inverse[z], d[y] * inverse[z]] }
    }
}
