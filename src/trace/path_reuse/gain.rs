//! Whether it is less work to trace frames together than each alone.
//!
//! Work is counted, not timed, so that what is traced does not depend on the machine. It is counted in quarters of the work
//! of a shadow ray.

use crate::base::stats::{Counts, RayCounts, SharedPaths};

/// A segment of a path that hits something, with the shading of its surface, and one that leaves the scene: most of these
/// are searched in bundles, which the box around the scene ends.
const HIT: u64 = 8;
const MISS: u64 = 1;
/// A shadow ray.
const SHADOW: u64 = 4;
/// A search of a mover with many parts along a segment: that of a ray in a bundle.
const TEST: u64 = 4;

/// Below this gain, pixels of frames are not traced together. It pays for what is not counted: tests of simple movers, and
/// the marks of samples.
pub const MIN_GAIN: f64 = 1.2;

/// The work of tracing rays, of which `misses` leave the scene.
pub fn work(rays: &RayCounts, misses: u64) -> u64 {
    let segments = rays.total() - rays.shadow;
    HIT * segments.saturating_sub(misses) + MISS * misses + SHADOW * rays.shadow
}

/// The work of frames alone, whose samples were traced together: each frame has the work of its samples that were traced
/// again, and the work without movers of its others. `samples` is the number of samples of each frame.
pub fn work_alone((still, again): (u64, u64), frames: u64, samples: u64, retraced: u64) -> u64 {
    again + still * (frames * samples).saturating_sub(retraced) / samples.max(1)
}

/// Whether frames that shared the paths so far were less work than each alone.
pub fn sharing_pays(counts: &Counts) -> bool {
    gains(counts, 1.0, MIN_GAIN)
}

/// [`sharing_pays`] for so many times as many frames, if all have the same share of paths that are traced again.
pub fn sharing_would_pay(counts: &Counts, times: f64) -> bool {
    gains(counts, times, MIN_GAIN)
}

/// Whether so many times as many frames would have been at least this many times the work alone.
pub fn gains(counts: &Counts, times: f64, at_least: f64) -> bool {
    let SharedPaths { still_work, retraced_work, alone_work, tests, .. } = counts.paths;
    let of_frames = times * (retraced_work + TEST * tests) as f64;
    (still_work as f64 + of_frames) * at_least <= times * alone_work as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A thousand paths in 48 frames, each a segment and, if it hits something, a shadow ray. So many are traced again.
    fn counts(misses: u64, retraced: u64, tests: u64) -> Counts {
        let rays = |camera, shadow| RayCounts { camera, shadow, ..RayCounts::default() };
        let still = work(&rays(1000, 1000 - misses), misses);
        let again = work(&rays(retraced, retraced), 0);
        let paths = SharedPaths {
            still_work: still,
            retraced_work: again,
            alone_work: work_alone((still, again), 48, 1000, retraced),
            tests,
            ..SharedPaths::default()
        };
        Counts { paths, ..Counts::default() }
    }

    #[test]
    fn sharing_pays_if_most_work_is_the_same() {
        assert!(sharing_pays(&counts(0, 480, 0)));
        assert!(sharing_pays(&counts(0, 30_000, 0)));
        assert!(!sharing_pays(&counts(0, 46_000, 0)));
        // Most paths are the same, but these miss everything.
        assert!(sharing_pays(&counts(1000, 2000, 0)));
        assert!(!sharing_pays(&counts(1000, 24_000, 0)));
        // Tests of a mesh take as long as the rays that they save.
        assert!(sharing_pays(&counts(0, 480, 48_000)));
        assert!(!sharing_pays(&counts(0, 480, 150_000)));
        assert!(sharing_pays(&Counts::default()));
    }

    #[test]
    fn cheap_and_expensive_parts_of_a_picture_count_by_themselves() {
        // Half the picture misses everything, and a mover covers the other half in all frames.
        let mut all = counts(1000, 0, 0);
        all += counts(1000, 48_000, 0);
        assert!(!sharing_pays(&all));
        assert!(sharing_pays(&counts(500, 24_000, 0)), "as a mean, it would");
    }

    #[test]
    fn more_frames_gain_more() {
        let few =
            SharedPaths { still_work: 100, retraced_work: 600, alone_work: 800, ..SharedPaths::default() };
        let few = Counts { paths: few, ..Counts::default() };
        assert!(!sharing_pays(&few) && sharing_would_pay(&few, 8.0));
    }
}
