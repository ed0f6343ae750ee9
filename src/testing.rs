//! What tests share: random numbers of their own, the same in every run, and geometry.

use crate::math::{Angle, DAffine3, DVec3};
use crate::scene::{Finish, Geometry};
use crate::shape::Shape;

/// splitmix64 (Steele, Lea, Flood 2014) from a seed.
pub struct Random(pub u64);

impl Random {
    /// Evenly in 0..1.
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Evenly in a cube that reaches this far from the origin along each axis.
    pub fn point(&mut self, reach: f64) -> DVec3 {
        DVec3::new(self.unit() - 0.5, self.unit() - 0.5, self.unit() - 0.5) * (2.0 * reach)
    }

    /// Evenly over the sphere.
    pub fn direction(&mut self) -> DVec3 {
        let z = 2.0 * self.unit() - 1.0;
        let turn = Angle(360.0 * self.unit()).cos_sin();
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * turn.x, r * turn.y, z)
    }
}

/// Shapes of the first material where they stand.
pub fn geometry(shapes: impl IntoIterator<Item = Shape>) -> Geometry {
    let mut geometry = Geometry::default();
    shapes.into_iter().for_each(|shape| geometry.push(&shape, DAffine3::IDENTITY, Finish::Material(0)));
    geometry
}
