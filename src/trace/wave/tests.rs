//! Pictures do not tell how many paths were followed at once.

use super::{LEAST, SUMS, WAVE, at_once};
use crate::simd::tests::portably;
use crate::trace::worlds::World;

#[test]
fn waves_of_paths_see_what_each_of_them_does() {
    let mut total = [0; 4];
    for seed in 0..64 {
        let world = World::of_paths(seed);
        let (alone, counts) = world.trace(|pixels| pixels.one_by_one());
        let (waves, counts_of_waves) = world.trace(|_| {});
        assert_eq!(counts, counts_of_waves, "seed {seed}");
        let differ = alone.iter().zip(&waves).filter(|(a, b)| a != b).count();
        assert_eq!(differ, 0, "seed {seed}");
        if seed % 8 == 0 {
            assert!(portably(|| world.trace(|_| {})).0 == waves, "seed {seed}");
        }
        let rays = counts.rays;
        for (total, rays) in
            total.iter_mut().zip([rays.shadow, rays.mirror, rays.scattered, rays.transmitted])
        {
            *total += rays;
        }
    }
    assert!(total.iter().all(|rays| *rays > 10_000), "{total:?}");
}

#[test]
fn waves_are_made_of_whole_eights() {
    for layers in 0..3000 {
        let paths = at_once(layers);
        assert!(paths.is_multiple_of(8) && (LEAST..=WAVE).contains(&paths), "{layers} layers");
        assert!(paths == LEAST || paths * layers <= SUMS, "{layers} layers");
    }
}
