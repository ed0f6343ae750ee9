//! Whether a search along a ray came near other triangles at its hit.

/// The most parts that are kept.
const ENCOUNTERS: usize = 4;

/// Parts that the line of a ray meets or may meet, with the ranges of depth in which they lie, if they are few.
#[derive(Clone, Copy, Debug)]
pub struct Encounters {
    /// The ends of the ranges. Those of unused places hold no depth.
    near: [f32; ENCOUNTERS],
    far: [f32; ENCOUNTERS],
    parts: [u32; ENCOUNTERS],
    count: usize,
}

impl Encounters {
    #[inline(always)]
    pub fn new() -> Self {
        Self { near: [f32::INFINITY; ENCOUNTERS], far: [0.0; ENCOUNTERS], parts: [0; ENCOUNTERS], count: 0 }
    }

    #[inline(always)]
    pub fn add(&mut self, [near, far]: [f32; 2], part: u32) {
        // More than there is room for take turns: then nothing is isolated.
        let place = self.count % ENCOUNTERS;
        (self.near[place], self.far[place], self.parts[place]) = (near, far, part);
        self.count += 1;
    }

    /// Whether no other part than this one is at a depth.
    #[inline(always)]
    pub fn is_isolated(&self, part: u32, depth: f32) -> bool {
        // All places, without a branch: the processor could not predict their number.
        let mut others = self.count > ENCOUNTERS;
        for place in 0..ENCOUNTERS {
            others |= (self.parts[place] != part) & (self.near[place] <= depth) & (depth <= self.far[place]);
        }
        !others
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn others_at_the_depth_or_too_many_leave_doubt() {
        let mut met = Encounters::new();
        assert!(met.is_isolated(7, 1.0));
        met.add([0.5, 1.5], 7);
        met.add([1.5, 2.0], 8);
        met.add([0.0, 0.5], 9);
        assert!(
            met.is_isolated(7, 1.0)
                && !met.is_isolated(7, 0.5)
                && !met.is_isolated(7, 1.5)
                && !met.is_isolated(8, 1.0)
        );
        met.add([5.0, 6.0], 7);
        assert!(met.is_isolated(7, 1.0));
        met.add([5.0, 6.0], 7);
        assert!(!met.is_isolated(7, 1.0), "no room for the last one");
    }
}
