//! A ray with the values that every test along it needs, computed once.

use crate::base::math::{DVec3, Ray, max};
use std::hint::select_unpredictable;

/// A single ray, prepared for box and triangle tests.
#[derive(Clone, Copy, Debug)]
pub struct TraversalRay {
    pub ray: Ray,
    /// 1 / direction. For a zero component it is infinite, with the sign of the zero.
    pub inverse: DVec3,
    /// The largest absolute component of the direction.
    pub longest: f64,
    /// The two other axes in cyclic order, then the axis along which the direction is longest.
    pub axes: [usize; 3],
    /// Direction along the two other axes over direction along the longest: shears the ray onto that axis.
    pub shear: [f64; 2],
    /// 1 / the square of the direction's length.
    pub per_square: f64,
}

impl TraversalRay {
    #[inline(always)]
    pub fn new(ray: Ray) -> Self {
        let d = ray.direction;
        let a = d.abs();
        // By tables and selections: the processor could not predict branches.
        let yz = max(a.z, a.y);
        let z = select_unpredictable(a.x >= yz, 0, 1 + usize::from(a.z > a.y));
        let [x, y] = [[1, 2], [2, 0], [0, 1]][z];
        let inverse = DVec3::new(1.0 / d.x, 1.0 / d.y, 1.0 / d.z);
        let (d, per_longest) = (d.to_array(), inverse.to_array()[z]);
        let shear = [d[x] * per_longest, d[y] * per_longest];
        let per_square = 1.0 / ray.direction.length_squared();
        Self { ray, inverse, longest: max(a.x, yz), axes: [x, y, z], shear, per_square }
    }
}
