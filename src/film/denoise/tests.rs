use super::*;
use crate::base::lanes::tests::on_all_levels;
use crate::film::LayerId;
use crate::testing::Random;
use glam::Vec3;

const SIZE: (u32, u32) = (64, 48);

/// Layers whose light depends on guides, on the position alone, and on a pattern that no guide shows.
fn truth(x: u32, y: u32, layer: usize) -> Rgb {
    let (u, v) = (f64::from(x) / 64.0, f64::from(y) / 48.0);
    let smooth = Rgb::new(0.3, 0.4, 0.5) * (1.0 + 0.8 * libm::sin(3.0 * u + 2.0 * v)) as f32;
    let hidden_edge = if (x / 9 + y / 7).is_multiple_of(2) { 1.0 } else { 0.3 };
    match layer {
        0 => smooth * albedo(x),
        _ => Rgb::new(0.6, 0.5, 0.2) * hidden_edge,
    }
}

fn albedo(x: u32) -> f32 {
    if x < 30 { 0.8 } else { 0.2 }
}

/// Two halves and two audits.
struct Films([Film; 4]);

impl Films {
    fn denoise(&self) -> Film {
        self.denoise_with(&[])
    }

    /// The film with neighbours, whose pixels see the same as those so many columns to the right.
    fn denoise_with(&self, others: &[(Films, usize)]) -> Film {
        let memory = Memory::default();
        let others: Vec<(Halves, usize)> = others.iter().map(|(films, by)| (films.halves(), *by)).collect();
        let shifted = |by: usize| {
            let place = |pixel: usize| {
                let [x, y] = [pixel % SIZE.0 as usize, pixel / SIZE.0 as usize].map(|at| at as f64 + 0.5);
                [x - by as f64, y]
            };
            Reprojection::unhidden(&memory, SIZE, place)
        };
        let neighbors: Vec<Neighbor> =
            others.iter().map(|(halves, by)| Neighbor { halves, reprojection: shifted(*by) }).collect();
        let [_, _, a, b] = &self.0;
        let films = SampleFilms { halves: &self.halves(), neighbors: &neighbors, audits: [a, b] };
        denoise(&films, SAMPLES)
    }

    fn halves(&self) -> Halves {
        let [first, second, ..] = &self.0;
        Halves::new([first.clone(), second.clone()], &Memory::default())
    }

    /// The samples of both halves, without a filter.
    fn samples_alone(&self) -> Film {
        let [first, second, ..] = &self.0;
        let mut film = first.clone();
        let pairs = film.data_mut().iter_mut().zip(second.data.iter());
        pairs.for_each(|(value, other)| *value = (*value + *other) * 0.5);
        film
    }
}

/// Samples per pixel of all films.
const SAMPLES: f64 = 10.0;

/// Films of the truth. Halves have noise of the standard deviation `noise`, in proportion to the light; audits have a
/// quarter of their samples.
fn noisy(layers: usize, noise: f32, seed: u64) -> Films {
    noisy_from(0, layers, noise, seed)
}

/// Films of the truth from a column on.
fn noisy_from(first: u32, layers: usize, noise: f32, seed: u64) -> Films {
    let mut random = Random(seed);
    let films = [(noise, true), (noise, true), (2.0 * noise, false), (2.0 * noise, false)];
    Films(films.map(|(noise, guides)| {
        let aovs = AovSet { guides, ..AovSet::default() };
        let mut film = Film::with_aovs(SIZE.0, SIZE.1, vec![Rgb::ONE; layers], aovs);
        let count = film.layers();
        for (pixel, data) in film.data_mut().chunks_exact_mut(count).enumerate() {
            let (x, y) = (first + pixel as u32 % SIZE.0, pixel as u32 / SIZE.0);
            for (layer, value) in data[..layers].iter_mut().enumerate() {
                // Twelve uniform numbers add up to nearly normal noise of the variance 1.
                let mut normal = || (0..12).map(|_| random.unit() as f32).sum::<f32>() - 6.0;
                *value = truth(x, y, layer) * (Rgb::ONE + Vec3::new(normal(), normal(), normal()) * noise);
            }
            if guides {
                let guides = [Vec3::new(0.1, 1.0, 0.0), Vec3::Y, Vec3::splat(albedo(x))];
                data[layers..].copy_from_slice(&guides);
            }
        }
        film
    }))
}

/// The mean squared error over pixels and channels, with these weights.
fn squared_error(film: &Film, weights: &[Rgb]) -> f64 {
    let shown = film.weighted_by(weights);
    let pixels = (SIZE.0 * SIZE.1) as usize;
    let sum: f64 = (0..pixels)
        .map(|pixel| {
            let (x, y) = (pixel as u32 % SIZE.0, pixel as u32 / SIZE.0);
            let exact: Rgb =
                weights.iter().enumerate().map(|(layer, weight)| *weight * truth(x, y, layer)).sum();
            f64::from((shown.radiance_at(pixel) - exact).length_squared())
        })
        .sum();
    sum / (3 * pixels) as f64
}

#[test]
fn light_that_follows_guides_loses_nearly_all_noise() {
    let films = noisy(1, 0.5, 1);
    let weights = [Rgb::ONE];
    let (before, after) =
        (squared_error(&films.samples_alone(), &weights), squared_error(&films.denoise(), &weights));
    assert!(after < before / 20.0, "{before} {after}");
}

/// Where guides show nothing, more samples lead to the truth: the error falls at least as that of the samples does.
#[test]
fn denoised_films_converge() {
    let weights = [Rgb::ZERO, Rgb::ONE];
    for noise in [0.5, 0.1, 0.02, 0.004] {
        let films = noisy(2, noise, 2);
        let (before, after) =
            (squared_error(&films.samples_alone(), &weights), squared_error(&films.denoise(), &weights));
        assert!(after < 1.1 * before, "{noise}: {before} {after}");
    }
    let films = noisy(2, 0.0, 2);
    assert_eq!(films.denoise().data.len(), films.0[0].held.len() * (SIZE.0 * SIZE.1) as usize);
    assert!(squared_error(&films.denoise(), &weights) < 1e-12);
}

/// Four neighbours of the same light, moved by so many columns each, and changed.
fn neighbors(by: [u32; 4], noise: f32, change: impl Fn(usize, &mut Rgb)) -> Vec<(Films, usize)> {
    let moved = |(seed, by): (u64, u32)| {
        let mut films = noisy_from(by, 2, noise, 40 + seed);
        for film in &mut films.0[..2] {
            let count = film.layers();
            let pixels = film.data_mut().chunks_exact_mut(count).enumerate();
            pixels.for_each(|(pixel, data)| change(pixel, &mut data[1]));
        }
        (films, by as usize)
    };
    (0..).zip(by).map(moved).collect()
}

/// The error of the layer that no guide shows, with neighbours over that without.
fn gain(others: &[(Films, usize)], noise: f32) -> f64 {
    let (films, weights) = (noisy(2, noise, 2), [Rgb::ZERO, Rgb::ONE]);
    squared_error(&films.denoise_with(others), &weights) / squared_error(&films.denoise(), &weights)
}

#[test]
fn neighbors_are_more_samples() {
    for noise in [0.5, 0.1] {
        let still = gain(&neighbors([0; 4], noise, |_, _| ()), noise);
        let moved = gain(&neighbors([1, 2, 4, 7], noise, |_, _| ()), noise);
        // Neighbours at the edge see less, and all of them show the pattern that windows of pixels mix.
        assert!(still < 0.45 && moved < 0.5, "{noise}: {still} {moved}");
    }
}

/// Neighbours that show other light, everywhere or here and there, do hardly any harm.
#[test]
fn neighbors_that_have_changed_are_refused() {
    for noise in [0.3, 0.1, 0.02] {
        let brighter = gain(&neighbors([0; 4], noise, |_, light| *light *= 1.5), noise);
        let spots = |pixel: usize, light: &mut Rgb| {
            if (pixel % 64 / 12 + pixel / 64 / 12).is_multiple_of(2) {
                *light *= 2.0;
            }
        };
        let spotted = gain(&neighbors([0; 4], noise, spots), noise);
        let black = gain(&neighbors([0; 4], noise, |_, light| *light = Rgb::ZERO), noise);
        let wild = gain(&neighbors([0; 4], noise, |_, light| *light = Rgb::splat(f32::INFINITY)), noise);
        let all = [brighter, spotted, black, wild];
        assert!(all.iter().all(|gain| *gain < 1.1), "{noise}: {all:?}");
    }
}

/// Glints that no guide shows, and too faint to be refused one by one, are not filtered away: the audits show that
/// samples are better there.
#[test]
fn faint_glints_remain() {
    const GLINT: f32 = 4.0;
    let is_glint = |pixel: usize| (pixel * 7 + pixel / 64 * 3).is_multiple_of(29);
    let mut films = noisy(1, 0.4, 5);
    for film in &mut films.0 {
        let count = film.layers();
        let pixels = film.data_mut().chunks_exact_mut(count).enumerate();
        pixels.filter(|(pixel, _)| is_glint(*pixel)).for_each(|(_, data)| data[0] *= GLINT);
    }
    let error = |film: &Film| -> f32 {
        let glints = (0..(SIZE.0 * SIZE.1) as usize).filter(|pixel| is_glint(*pixel));
        let square = |pixel: usize| {
            let exact = truth(pixel as u32 % SIZE.0, pixel as u32 / SIZE.0, 0) * GLINT;
            (film.radiance_at(pixel) - exact).length_squared()
        };
        glints.map(square).sum()
    };
    let (before, after) = (error(&films.samples_alone()), error(&films.denoise()));
    assert!(after < 2.0 * before, "{before} {after}");
}

/// The estimates are the true squared errors on average, and the intervals hold them, with any weights.
#[test]
fn the_stated_error_is_true() {
    const RUNS: u64 = 60;
    for (noise, weights) in [
        (0.5, [Rgb::ONE, Rgb::ZERO]),
        (0.5, [Rgb::ZERO, Rgb::ONE]),
        (0.1, [Rgb::new(0.2, 1.0, 3.0), Rgb::splat(0.5)]),
    ] {
        let (mut sum, mut squares, mut before, mut held) = (0.0, 0.0, 0.0, 0);
        for seed in 0..RUNS {
            let films = noisy(2, noise, 100 + seed);
            let film = films.denoise();
            let remaining = film.remaining.as_ref().expect("denoised films have an error");
            let error = squared_error(&film, &weights);
            let off = remaining.square(&weights).0 - error;
            (sum, squares) = (sum + off, squares + off * off);
            before += squared_error(&films.samples_alone(), &weights);
            let pixels = f64::from(SIZE.0 * SIZE.1);
            let light = film
                .weighted_by(&weights)
                .radiance()
                .map(|light| f64::from(light.element_sum()))
                .sum::<f64>();
            let (stated, relative) = (remaining.of(&weights), error.sqrt() / (light / (3.0 * pixels)));
            held += u32::from((stated.low..=stated.high).contains(&relative));
        }
        // Four standard errors of the mean, which are small beside what the samples alone have.
        let runs = RUNS as f64;
        let within = 4.0 * squares.sqrt() / runs;
        assert!((sum / runs).abs() < within, "{noise}: {sum} {squares} {before}");
        assert!(within < 0.1 * before / runs, "{noise}: {sum} {squares} {before}");
        assert!(held >= 54, "{noise}: {held} of {RUNS}");
    }
}

#[test]
fn samples_are_kept_if_asked_for() {
    let mut films = noisy(2, 0.5, 6);
    assert_eq!(films.denoise().samples, None);
    films.0.iter_mut().for_each(|film| film.aovs.samples = true);
    let (film, alone) = (films.denoise(), films.samples_alone());
    assert!((0..(SIZE.0 * SIZE.1) as usize).all(|pixel| film.samples_at(pixel) == alone.radiance_at(pixel)));
}

#[test]
fn threads_and_guides_leave_no_trace() {
    let films = noisy(2, 0.3, 3);
    let others = neighbors([0, 1, 2, 3], 0.3, |_, _| ());
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| [films.denoise(), films.denoise_with(&others)])
    };
    let [film, pooled] = with(1);
    assert_eq!([&film, &pooled], with(3).each_ref());
    assert_ne!(film.data, pooled.data);
    assert_eq!(
        (film.aovs, film.layers(), &*film.held),
        (AovSet::default(), 2, &[LayerId(0), LayerId(1)][..])
    );
    assert_eq!(film.noise.expect("denoised films have an error").samples, SAMPLES);
}

#[test]
fn all_levels_give_the_same_bytes() {
    let films = noisy(2, 0.3, 7);
    let others = neighbors([0, 1, 2, 3], 0.3, |_, _| ());
    // Levels are forced for a thread.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
    let results = pool.install(|| on_all_levels(|| (films.denoise(), films.denoise_with(&others))));
    assert!(results.iter().all(|(_, films)| *films == results[0].1));
}

/// Pixels whose guides are useless, or whose light overflows, harm neither their neighbours nor the program.
#[test]
fn wild_guides_are_no_harm() {
    let mut films = noisy(1, 0.1, 4);
    for film in &mut films.0[..2] {
        let count = film.layers();
        let guides = [f32::INFINITY, f32::NAN, f32::MAX, -1e30];
        for (at, guide) in guides.into_iter().enumerate() {
            film.data_mut()[(700 + 40 * at) * count + 1..][..GUIDES_OF_A_PIXEL].fill(Vec3::splat(guide));
        }
    }
    let film = films.denoise();
    assert!(film.data.iter().all(|light| light.is_finite()));
    let weights = [Rgb::ONE];
    assert!(squared_error(&film, &weights) < squared_error(&films.samples_alone(), &weights));
}

const GUIDES_OF_A_PIXEL: usize = crate::film::aov::GUIDES;
