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
/// A test of a segment with a mover that has a tree of its own: the search of a single ray.
const TEST: u64 = 4;

/// Below this gain, frames are not traced together. It pays for what is not counted: tests of movers without trees, and
/// the marks of samples.
const MIN_GAIN: f64 = 1.2;

/// The work of tracing rays, of which `misses` leave the scene.
pub fn work(rays: &RayCounts, misses: u64) -> u64 {
    let segments = rays.total() - rays.shadow;
    HIT * segments.saturating_sub(misses) + MISS * misses + SHADOW * rays.shadow
}

/// Whether frames that shared the paths so far were less work than each alone. Alone, each of them has the work of its
/// paths that were traced again, and of the others without movers.
pub fn sharing_pays(counts: &Counts) -> bool {
    sharing_would_pay(counts, 1.0)
}

/// [`sharing_pays`] for so many times as many frames, if all have the same share of paths that are traced again.
pub fn sharing_would_pay(counts: &Counts, times: f64) -> bool {
    let SharedPaths { all, once, retraced, whole, still_work, retraced_work, tests } = counts.paths;
    if once == 0 {
        return true;
    }
    let (still, again) = (still_work as f64, retraced_work as f64);
    let unchanged = (all - whole).saturating_sub(retraced) as f64 / once as f64;
    let together = still + times * (again + (TEST * tests) as f64);
    together * MIN_GAIN <= times * (again + unchanged * still)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 48 frames of a thousand paths, each of which is a segment and a shadow ray, of which a share is traced again.
    fn counts(misses: u64, retraced: u64, tests: u64) -> Counts {
        let rays =
            |count| RayCounts { camera: count, shadow: count - misses.min(count), ..RayCounts::default() };
        let paths = SharedPaths {
            all: 48_000,
            once: 1000,
            retraced,
            whole: 0,
            still_work: work(&rays(1000), misses),
            retraced_work: work(&RayCounts { camera: retraced, shadow: retraced, ..RayCounts::default() }, 0),
            tests,
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
}
