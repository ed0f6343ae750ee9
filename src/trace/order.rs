//! Finds samples whose sums may depend on the order in which their paths are shaded.
//!
//! Paths that do not branch add light in an order that depends on the sample alone. The branches of a sample may share
//! rows of lanes with those of others, so their order depends on the other samples of the wave. That shows only if an
//! addition is rounded: then the sum depends on the order. So a sample is safe if it has no branches, or if all its
//! additions are exact.

/// Which samples of a wave have several paths at one depth.
#[derive(Debug, Default)]
pub struct BranchCheck {
    /// For each sample, the depth of its last path.
    depths: Vec<u32>,
    branched: Vec<bool>,
}

impl BranchCheck {
    /// Starts a wave of this number of samples; 0 if branches do not matter.
    pub fn reset(&mut self, samples: usize) {
        self.depths.clear();
        self.depths.resize(samples, 0);
        self.branched.clear();
        self.branched.resize(samples, false);
    }

    /// Notes the paths of these samples at a depth above 0.
    pub fn note(&mut self, depth: u32, slots: &[u32]) {
        if self.depths.is_empty() {
            return;
        }
        for &slot in slots {
            let last = std::mem::replace(&mut self.depths[slot as usize], depth);
            self.branched[slot as usize] |= last == depth;
        }
    }

    pub fn has_branched(&self, slot: usize) -> bool {
        self.branched.get(slot).is_some_and(|branched| *branched)
    }
}
