//! Dims pixels that are far brighter than all pixels around them, and keeps fits between the samples around them.
//!
//! A path that few samples find makes a lonely bright pixel, which may hold most of the error of a picture. A fit would
//! spread it over its window. What is dimmed here are candidates: whether they have the smaller error is measured.

use super::super::Film;
use crate::base::color::Rgb;
use rayon::prelude::*;

/// How far around a pixel others are compared with it, in pixels.
const REACH: usize = 2;

/// How many times as bright as the brightest pixel around it a pixel may be. Plain noise of a few samples stays below.
const FACTOR: f32 = 2.0;

/// The layers of light of all pixels, row by row, without outliers.
pub fn dimmed(film: &Film) -> Vec<Rgb> {
    let (width, height) = (film.width as usize, film.height as usize);
    let layers = film.held.len();
    let brightness = |pixel: usize, layer: usize| film.pixel(pixel)[layer].element_sum();
    let mut light = vec![Rgb::ZERO; width * height * layers];
    light.par_chunks_exact_mut(layers.max(1)).enumerate().for_each(|(pixel, light)| {
        let (x, y) = (pixel % width, pixel / width);
        for (layer, light) in light.iter_mut().enumerate() {
            let mut limit = 0.0_f32;
            for row in y.saturating_sub(REACH)..height.min(y + REACH + 1) {
                for column in x.saturating_sub(REACH)..width.min(x + REACH + 1) {
                    if (column, row) != (x, y) {
                        limit = limit.max(brightness(row * width + column, layer));
                    }
                }
            }
            let (own, limit) = (brightness(pixel, layer), FACTOR * limit);
            let factor = if own > limit { limit / own } else { 1.0 };
            *light = film.pixel(pixel)[layer] * factor;
        }
    });
    light
}

/// The least and the greatest light around each pixel, itself included, in every layer and channel. A fit beyond them
/// extrapolates: next to a lamp, it may be negative.
pub fn ranges((width, height): (usize, usize), layers: usize, light: &[Rgb]) -> Vec<[Rgb; 2]> {
    let join = |all: [Rgb; 2], one: &[Rgb; 2]| [all[0].min(one[0]), all[1].max(one[1])];
    let own: Vec<[Rgb; 2]> = light.iter().map(|light| [*light; 2]).collect();
    let row = width * layers;
    let around = |values: &[[Rgb; 2]], at: usize, (place, length, step): (usize, usize, usize)| {
        let first = place.saturating_sub(REACH);
        let last = length.min(place + REACH + 1);
        (first..last).map(|other| &values[at + other * step - place * step]).fold(values[at], join)
    };
    let along = |at: usize| around(&own, at, (at / layers % width, width, layers));
    let rows: Vec<[Rgb; 2]> = (0..own.len()).into_par_iter().map(along).collect();
    (0..own.len()).into_par_iter().map(|at| around(&rows, at, (at / row, height, row))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_those_of_the_neighbourhood() {
        // Two layers of a picture of 7 x 6 pixels.
        let light: Vec<Rgb> =
            (0..84).map(|at| Rgb::new((at * 37 % 84) as f32, at as f32, -(at as f32))).collect();
        for (at, range) in ranges((7, 6), 2, &light).iter().enumerate() {
            let (layer, x, y) = (at % 2, at / 2 % 7, at / 14);
            let near =
                (0..42).filter(|other: &usize| (other % 7).abs_diff(x) <= 2 && (other / 7).abs_diff(y) <= 2);
            let near: Vec<Rgb> = near.map(|other| light[other * 2 + layer]).collect();
            let least = near.iter().fold(Rgb::INFINITY, |all, one| all.min(*one));
            let most = near.iter().fold(Rgb::NEG_INFINITY, |all, one| all.max(*one));
            assert_eq!(*range, [least, most]);
        }
    }
}
