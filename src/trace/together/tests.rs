//! Pictures do not tell how many rays were traced at once, nor on what kind of lanes.

use crate::simd::tests::portably;
use crate::trace::pixel::Pixels;
use crate::trace::worlds::World;

#[test]
fn eight_rays_see_what_each_of_them_does() {
    let together = |pixels: &mut Pixels| assert!(pixels.together, "a scene for eight rays");
    let (mut rays, mut mirrored, mut painted) = (0, 0, 0);
    for seed in 0..150 {
        let world = World::new(seed);
        let (alone, counts) = world.trace(|pixels| pixels.together = false);
        let (eight, counts_of_eight) = world.trace(together);
        assert_eq!(counts, counts_of_eight, "seed {seed}");
        let differ = alone.iter().zip(&eight).filter(|(a, b)| a != b).count();
        assert_eq!(differ, 0, "seed {seed}");
        rays += counts.rays.shadow;
        mirrored += counts.rays.mirror;
        painted += counts.evaluations.paint;
        if seed % 10 == 0 {
            assert!(portably(|| world.trace(together)).0 == eight, "seed {seed}");
        }
    }
    assert!(rays > 100_000 && mirrored > 100_000, "{rays} {mirrored}");
    assert!(painted > 50_000, "{painted}");
}
