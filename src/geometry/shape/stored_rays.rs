//! Rays of eight lanes in memory, without a SIMD level.

use crate::base::lanes::{Level, Real, Row, Vec3};
use crate::base::math::{DVec3, LaneRay, Ray};

/// Eight rays in memory, as structure of arrays.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct StoredRays {
    origin: [[f64; 8]; 3],
    direction: [[f64; 8]; 3],
}

impl StoredRays {
    /// Stores the rays of all lanes, at most eight.
    #[inline(always)]
    pub fn of<F: Real>(ray: &LaneRay<F>) -> Self {
        Self { origin: rows(ray.origin), direction: rows(ray.direction) }
    }

    #[inline(always)]
    pub fn load<L: Level>(&self) -> LaneRay<L::F64> {
        let ([x, y, z], [dx, dy, dz]) = (self.origin, self.direction);
        let row = L::F64::from_array;
        LaneRay { origin: Vec3::new(row(x), row(y), row(z)), direction: Vec3::new(row(dx), row(dy), row(dz)) }
    }

    pub fn one(&self, lane: usize) -> Ray {
        let [x, y, z] = &self.origin;
        let [dx, dy, dz] = &self.direction;
        Ray {
            origin: DVec3::new(x[lane], y[lane], z[lane]),
            direction: DVec3::new(dx[lane], dy[lane], dz[lane]),
        }
    }
}

/// The coordinates of vectors, one array each.
#[inline(always)]
fn rows<F: Real>(v: Vec3<F>) -> [[f64; 8]; 3] {
    [store_lanes(v.x), store_lanes(v.y), store_lanes(v.z)]
}

/// The values of all lanes, padded with 0.
#[inline(always)]
pub fn store_lanes<F: Real>(row: F) -> [f64; 8] {
    let (lanes, mut all) = (row.to_array(), [0.0; 8]);
    for (lane, value) in all.iter_mut().enumerate().take(F::LANES) {
        *value = lanes[lane];
    }
    all
}
