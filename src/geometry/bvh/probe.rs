//! A ray with what every test along it needs, computed once.

use crate::base::math::{DVec3, Ray, larger};
use std::hint::select_unpredictable;

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
        let yz = larger(a.z, a.y);
        let z = select_unpredictable(a.x >= yz, 0, 1 + usize::from(a.z > a.y));
        let [x, y] = [[1, 2], [2, 0], [0, 1]][z];
        let inverse = DVec3::new(1.0 / d.x, 1.0 / d.y, 1.0 / d.z);
        let (d, per_longest) = (d.to_array(), inverse.to_array()[z]);
        let shear = [d[x] * per_longest, d[y] * per_longest];
        Self { ray, inverse, longest: larger(a.x, yz), axes: [x, y, z], shear }
    }
}
