//! A ray with what every test along it needs, computed once.

use crate::camera::Ray;
use crate::math::{DVec3, Real, larger};
use crate::simd::{Octo, Quad, Vector};

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

/// How near to each other hits along a ray have to be for their surfaces to be compared, and not only their t, as rounding may
/// have exchanged them.
#[derive(Clone, Copy, Debug)]
pub struct Vicinity {
    /// The t in which the ray comes as far as its own coordinates and those of what it may meet.
    reach: f64,
}

/// As a share of the coordinates and the way. The rounding of any surface is below 128 u of these, so that of two surfaces it is
/// less than this over every cosine above 2^-17: only where they are seen from less than two seconds of arc above
/// themselves, t alone decides.
const SHARE: f64 = 1.0 / (1u64 << 28) as f64;

impl Vicinity {
    /// For what lies between coordinates up to `reach`.
    #[inline(always)]
    pub fn new(probe: &Probe, reach: f64) -> Self {
        let o = probe.ray.origin.abs();
        let afar = larger(larger(o.x, o.y), o.z);
        Self { reach: (reach + afar) * (1.0 / probe.longest) }
    }

    /// Before which t hits are near one at `t`.
    #[inline(always)]
    pub fn end(self, t: f64) -> f64 {
        end(t, self.reach)
    }

    /// That of each of several rays.
    #[inline(always)]
    pub fn of_each<Q: Quad>(origin: Vector<Q>, direction: Vector<Q>, reach: f64) -> Vicinities {
        let per_length = Octo::splat(1.0) / direction.longest();
        Vicinities { reach: ((Octo::splat(reach) + origin.longest()) * per_length).store() }
    }
}

/// [`Vicinity`] along eight rays.
#[derive(Clone, Copy, Debug)]
pub struct Vicinities {
    reach: [f64; 8],
}

impl Vicinities {
    #[inline(always)]
    pub fn ends<Q: Quad>(&self, t: Octo<Q>) -> Octo<Q> {
        end(t, Octo::load(&self.reach))
    }

    #[inline(always)]
    pub fn end(&self, ray: usize, t: f64) -> f64 {
        end(t, self.reach[ray])
    }
}

#[inline(always)]
fn end<T: Real>(t: T, reach: T) -> T {
    t + (t + reach) * T::of(SHARE)
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
