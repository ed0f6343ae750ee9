//! Reproducible random numbers for tests. Integration tests include this file too.

use glam::DVec3;

/// splitmix64 (Steele, Lea, Flood 2014), initialised with a seed.
pub struct Random(pub u64);

impl Random {
    /// A uniform number in 0..1.
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A uniform point in the cube with coordinates from -`reach` to `reach`.
    pub fn point(&mut self, reach: f64) -> DVec3 {
        DVec3::new(self.unit() - 0.5, self.unit() - 0.5, self.unit() - 0.5) * (2.0 * reach)
    }
}
