//! Metrics of picture pairs with known values.

use super::*;
use crate::base::color::Rgb;
use crate::testing::Random;

/// A picture of displayed colours, by a function of column and row.
fn picture(width: usize, height: usize, of: impl Fn(usize, usize) -> [f64; 3]) -> Vec<[f32; 3]> {
    let pixels = (0..width * height).map(|i| of(i % width, i / width));
    pixels.map(|color| color.map(|value| value as f32)).collect()
}

fn flip_of(a: [f64; 3], b: [f64; 3]) -> f64 {
    let [a, b] = [a, b].map(|color| picture(8, 8, |_, _| color));
    Flip::new(&a, 8, PIXELS_PER_DEGREE).mean(&b)
}

/// Values of the authors' own program (`flip_evaluator` 1.7) for the same pictures. It computes in f32, so with the
/// small exponents its values differ by up to 5e-5.
#[test]
fn flip_matches_its_authors_program() {
    let cases = [
        ([0.0; 3], [1.0; 3], 0.967_388),
        ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0], 1.0),
        ([0.5; 3], [0.6, 0.5, 0.5], 0.249_647),
        ([1.0, 0.0, 0.0], [0.0, 1.0, 1.0], 0.979_911),
        ([0.2; 3], [0.2; 3], 0.0),
    ];
    for (a, b, wanted) in cases {
        assert!((flip_of(a, b) - wanted).abs() < 1e-4, "{a:?} {b:?}: {}", flip_of(a, b));
    }
    let part = |n: usize, of: usize| (n % of) as f64 / (of - 1) as f64;
    let reference = picture(48, 32, |x, y| [part(x, 16), part(y, 12), part(x + y, 8)]);
    let test = picture(48, 32, |x, y| [part(x + 1, 16), part(y, 12), part(x * y, 8)]);
    let places = [(0, 0), (7, 5), (24, 16), (47, 31)];
    for (ppd, mean, values) in [
        (67.0206, 0.351_484, [0.365_204, 0.280_443, 0.280_049, 0.913_109]),
        (20.0, 0.525_125, [0.022_840, 0.357_216, 0.487_002, 0.974_392]),
    ] {
        let flip = Flip::new(&reference, 48, ppd);
        let map = flip.map(&test);
        for ((x, y), wanted) in places.into_iter().zip(values) {
            assert!(
                (f64::from(map[y * 48 + x]) - wanted).abs() < 2e-5,
                "{ppd} at {x} {y}: {}",
                map[y * 48 + x]
            );
        }
        assert!((flip.mean(&test) - mean).abs() < 1e-4, "{ppd}: {}", flip.mean(&test));
    }
}

/// As above: a dot, and an edge moved by a pixel; both differ more in their features than in their colours.
#[test]
fn flip_sees_dots_and_edges_as_its_authors_do() {
    let black = picture(33, 33, |_, _| [0.0; 3]);
    let dot = picture(33, 33, |x, y| [f64::from(u8::from((x, y) == (16, 16))); 3]);
    let flip = Flip::new(&black, 33, PIXELS_PER_DEGREE);
    let map = flip.map(&dot);
    assert!((flip.mean(&dot) - 0.013_139_8).abs() < 1e-4, "{}", flip.mean(&dot));
    assert!((map[16 * 33 + 16] - 0.864_907).abs() < 1e-4 && (map[16 * 33 + 20] - 0.018_017).abs() < 1e-4);
    let edge = |at: usize| picture(33, 33, |x, _| [f64::from(u8::from(x >= at)); 3]);
    let flip = Flip::new(&edge(16), 33, PIXELS_PER_DEGREE);
    assert!((flip.mean(&edge(17)) - 0.100_328).abs() < 1e-4, "{}", flip.mean(&edge(17)));
}

#[test]
fn squared_errors_have_their_closed_forms() {
    let (a, b) = (vec![Rgb::new(1.0, 0.5, 0.0); 6], vec![Rgb::new(1.0, 0.5, 0.25); 6]);
    let x = vec![Rgb::new(1.5, 0.5, 0.5); 6];
    let references = ReferencePair { a: a.clone(), b };
    // (0.5² + 0 + 0.5 · 0.25) / 3.
    assert!((references.squared_error(&x) - 0.125).abs() < 1e-15);
    let relative = (0.25 / 1.01 + 0.125 / (0.015_625 + 0.01)) / 3.0;
    assert!((references.relative_squared_error(&x) - relative).abs() < 1e-12);
    assert!((references.noise() - 0.0625 / 12.0).abs() < 1e-15);
    assert!((references.brightness() - (1.0 + 0.5 + 0.125) / 3.0).abs() < 1e-15);
    assert!((mean_squared_error(&a, &x) - 0.5 / 3.0).abs() < 1e-15);
    assert_eq!((psnr(0.01), psnr(1.0), psnr(0.0)), (20.0, 0.0, f64::INFINITY));
}

/// If all pictures are noisy, only the noise of the compared picture counts; against one reference it would be twice
/// that.
#[test]
fn the_noise_of_references_does_not_count() {
    let mut random = Random(3);
    let mut noisy = |bias: f64| -> Vec<Rgb> {
        (0..40_000).map(|_| Rgb::splat((0.5 + bias + 0.2 * (random.unit() - 0.5)) as f32)).collect()
    };
    let references = ReferencePair { a: noisy(0.0), b: noisy(0.0) };
    let x = noisy(0.05);
    let variance = 0.2 * 0.2 / 12.0;
    let error = references.squared_error(&x);
    assert!((error / (variance + 0.0025) - 1.0).abs() < 0.03, "{error}");
    let errors = references.squared_errors(&x);
    assert!((errors.iter().sum::<f64>() / errors.len() as f64 / error - 1.0).abs() < 1e-9);
    assert!((references.noise() / (variance / 2.0) - 1.0).abs() < 0.03);
    assert!((mean_squared_error(&x, &references.a) / (2.0 * variance + 0.0025) - 1.0).abs() < 0.03);
}
