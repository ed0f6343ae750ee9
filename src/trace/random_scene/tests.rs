//! Images depend neither on the SIMD level nor on the number of rays that are traced at once.

use super::{RandomScene, SIZE};
use crate::base::lanes::tests::on_all_levels;
use crate::base::math::DVec3;
use crate::base::stats::Counts;
use crate::trace::Moment;
use crate::trace::pixels::SampleSet;

/// All pixels and all their samples at once.
const ALL: (usize, u32) = ((SIZE.0 * SIZE.1) as usize, u32::MAX);

/// The bits of an image, and the counts.
fn traced(scene: &RandomScene, (pixels, samples): (usize, u32)) -> (Vec<[u64; 3]>, Counts) {
    let (sums, counts) = scene.trace(pixels, samples);
    (sums.into_iter().map(|sum| sum.to_array().map(f64::to_bits)).collect(), counts)
}

/// The counts of a scene. Checks that its image and counts are the same on all SIMD levels, one sample at a time, and
/// in other divisions.
fn traced_alike(scene: &RandomScene, seed: u64) -> Counts {
    let (alone, counts) = traced(scene, (1, 1));
    let same = |(bytes, counts_of): (Vec<[u64; 3]>, Counts), how: &str| {
        assert_eq!(counts_of, counts, "seed {seed}, {how}");
        let differ = bytes.iter().zip(&alone).filter(|(a, b)| a != b).count();
        assert_eq!((differ, bytes.len()), (0, alone.len()), "seed {seed}, {how}");
    };
    for (level, found) in on_all_levels(|| traced(scene, ALL)) {
        same(found, level.name());
    }
    if seed.is_multiple_of(8) {
        for at_once in [(13, u32::MAX), (256, 2), (ALL.0, 1)] {
            same(traced(scene, at_once), &format!("{at_once:?} at once"));
        }
    }
    counts
}

#[test]
fn whitted_pictures_are_the_same_on_all_levels_and_divided_anyhow() {
    let (mut shadow, mut mirror, mut textured) = (0, 0, 0);
    for seed in 0..150 {
        let counts = traced_alike(&RandomScene::new(seed), seed);
        shadow += counts.rays.shadow;
        mirror += counts.rays.mirror;
        textured += counts.evaluations.paint;
    }
    assert!(shadow > 100_000 && mirror > 100_000, "{shadow} {mirror}");
    assert!(textured > 50_000, "{textured}");
}

#[test]
fn pictures_of_paths_are_the_same_on_all_levels_and_divided_anyhow() {
    let mut total = [0; 4];
    for seed in 0..64 {
        let rays = traced_alike(&RandomScene::of_paths(seed), seed).rays;
        for (total, rays) in
            total.iter_mut().zip([rays.shadow, rays.mirror, rays.scattered, rays.transmitted])
        {
            *total += rays;
        }
    }
    assert!(total.iter().all(|rays| *rays > 10_000), "{total:?}");
}

#[test]
fn pictures_of_everything_are_the_same_on_all_levels_and_divided_anyhow() {
    let (mut fog, mut rays) = (0, 0);
    for seed in 0..64 {
        let counts = traced_alike(&RandomScene::of_everything(seed), seed);
        fog += counts.evaluations.fog;
        rays += counts.rays.transmitted;
    }
    assert!(fog > 10_000 && rays > 10_000, "{fog} {rays}");
}

#[test]
fn guides_are_the_same_on_all_levels_and_divided_anyhow() {
    for seed in 0..16 {
        let mut scene = RandomScene::of_paths(seed);
        scene.aovs.guides = true;
        traced_alike(&scene, seed);
    }
}

/// Films of parts of the samples have the mean that a film of all samples is.
#[test]
fn films_of_halves_make_the_film() {
    let mut differ = 0;
    for seed in 0..8 {
        let scene = RandomScene::of_paths(seed);
        let [first, second, all] = [0..4, 4..8, 0..8].map(|samples| scene.film(samples));
        for ((first, second), all) in first.data.iter().zip(second.data.iter()).zip(all.data.iter()) {
            differ += u32::from(first != second);
            let off = ((*first + *second) * 0.5 - *all).abs().max_element();
            // Both halves are rounded, at most twice as bright as the mean, and their sum and the film of all are.
            let most = 2.0 * f32::EPSILON * all.abs().max_element();
            assert!(off <= most, "seed {seed}: {first} {second} {all}");
        }
    }
    assert!(differ > 10_000, "{differ}");
}

/// The sums at the ends of parts are those of as many samples, also if these belong to several moments, and if light is
/// limited.
#[test]
fn sums_at_ends_are_those_of_fewer_samples() {
    let (ends, mut differ) = ([2, 4, 8], 0);
    for seed in 0..12 {
        let mut scene = RandomScene::of_everything(seed.into());
        scene.quality.clamp = (seed % 3 == 0).then_some(0.5);
        let of = 1 + seed % 2;
        let (mut at_ends, mut apart) = (Vec::new(), [const { Vec::new() }; 3]);
        for index in 0..of {
            scene.with_tracer(Moment { index, of }, |pixels, places| {
                let sums = places.len() * pixels.layers();
                at_ends.resize(ends.len() * sums, DVec3::ZERO);
                pixels.add_to_ends(places, (&SampleSet { samples: 0..8, seed }, &ends), &mut at_ends);
                for (&end, apart) in ends.iter().zip(&mut apart) {
                    apart.resize(sums, DVec3::ZERO);
                    pixels.add(places, &SampleSet { samples: 0..end, seed }, apart);
                }
            });
        }
        let layers = apart[0].len() / (SIZE.0 * SIZE.1) as usize;
        let sums = apart.each_ref().map(|apart| apart.chunks_exact(layers));
        let [first, second, third] = sums;
        for (pixel, ((first, second), third)) in first.zip(second).zip(third).enumerate() {
            let expected = [first, second, third].concat();
            assert_eq!(at_ends[pixel * expected.len()..][..expected.len()], expected, "seed {seed}");
            differ += u32::from(first != second);
        }
    }
    assert!(differ > 1000, "{differ}");
}
