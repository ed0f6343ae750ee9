//! Dims pixels that are far brighter than all pixels around them, and keeps fits between the samples around them.
//!
//! A path that few samples find makes a lonely bright pixel, which may hold most of the error of a picture. A fit would
//! spread it over its window. What is dimmed here are candidates: whether they have the smaller error is measured.

use super::planes::Planes;
use rayon::prelude::*;
use std::ops::Range;

/// How far around a pixel others are compared with it, in pixels.
const REACH: usize = 2;

/// How many times as bright as the brightest pixel around it a pixel may be. Plain noise of a few samples stays below.
const FACTOR: f32 = 2.0;

/// The light of all pixels without outliers.
pub fn dimmed(light: &Planes) -> Planes {
    let (stride, layers) = (light.stride, light.count / 3);
    let mut brightness = light.unset_like(layers);
    brightness.par_lines_mut().enumerate().for_each(|(y, line)| {
        for (layer, sums) in line.chunks_exact_mut(stride).enumerate() {
            let [red, green, blue] = light.channels(layer, y);
            for (x, sum) in sums.iter_mut().enumerate() {
                *sum = red[x] + green[x] + blue[x];
            }
        }
    });
    let mut dimmed = light.unset_like(light.count);
    dimmed.par_lines_mut().enumerate().for_each(|(y, line)| {
        for (layer, dimmed) in line.chunks_exact_mut(3 * stride).enumerate() {
            let mut factors = brightest_around(&brightness, layer, y);
            for (factor, own) in factors.iter_mut().zip(brightness.row(layer, y)) {
                let limit = FACTOR * *factor;
                *factor = if *own > limit { limit / own } else { 1.0 };
            }
            for (into, channel) in dimmed.chunks_exact_mut(stride).zip(light.channels(layer, y)) {
                for (x, factor) in factors.iter().enumerate() {
                    into[x] = channel[x] * factor;
                }
                into[factors.len()..].fill(0.0);
            }
        }
    });
    dimmed
}

/// The greatest of the numbers around each pixel of a row, itself not included, and 0.
fn brightest_around(numbers: &Planes, plane: usize, y: usize) -> Vec<f32> {
    // The others in the column of each pixel, and with the pixel itself.
    let mut others = vec![0.0; numbers.width];
    for other in near(y, numbers.height).filter(|other| *other != y) {
        raise(&mut others, numbers.row(plane, other));
    }
    let mut columns = others.clone();
    raise(&mut columns, numbers.row(plane, y));
    join_beside(&mut others, &columns, raise);
    others
}

/// Writes the least and the greatest light around each pixel of some rows, itself included, in every layer and channel,
/// to the first rows of planes. A fit beyond them extrapolates: next to a lamp, it may be negative.
pub fn bounds(light: &Planes, rows: Range<usize>, into: &mut [Planes; 2]) {
    let [least, most] = into;
    around(light, rows.clone(), lower, least);
    around(light, rows, raise, most);
}

/// Joins the numbers around each pixel of some rows, itself included, in every plane.
fn around(light: &Planes, rows: Range<usize>, join: Join, into: &mut Planes) {
    into.lines_mut().zip(rows).for_each(|(line, y)| {
        for (plane, into) in line.chunks_exact_mut(light.stride).enumerate() {
            let into = &mut into[..light.width];
            into.copy_from_slice(&light.row(plane, y)[..light.width]);
            near(y, light.height).for_each(|other| join(into, light.row(plane, other)));
            let columns = into.to_vec();
            join_beside(into, &columns, join);
        }
    });
}

/// Joins what is known of the columns beside each pixel of a row.
fn join_beside(row: &mut [f32], columns: &[f32], join: Join) {
    for offset in 1..=REACH.min(row.len()) {
        join(row, &columns[offset..]);
        join(&mut row[offset..], columns);
    }
}

/// The places around a place that are on an axis of this length.
fn near(place: usize, length: usize) -> Range<usize> {
    place.saturating_sub(REACH)..length.min(place + REACH + 1)
}

/// Joins numbers with others, as far as there are some.
type Join = fn(&mut [f32], &[f32]);

/// Raises numbers to others that are greater.
fn raise(numbers: &mut [f32], others: &[f32]) {
    numbers
        .iter_mut()
        .zip(others)
        .for_each(|(number, other)| *number = if *other > *number { *other } else { *number });
}

/// Lowers numbers to others that are smaller.
fn lower(numbers: &mut [f32], others: &[f32]) {
    numbers
        .iter_mut()
        .zip(others)
        .for_each(|(number, other)| *number = if *other < *number { *other } else { *number });
}

#[cfg(test)]
mod tests {
    use super::super::memory::Memory;
    use super::*;
    use crate::base::color::Rgb;

    /// The light of the pixels around one, itself included.
    fn near(light: &Planes, layer: usize, [x, y]: [usize; 2]) -> impl Iterator<Item = ([usize; 2], Rgb)> {
        let pixels = (0..light.height).flat_map(|y| (0..light.width).map(move |x| [x, y]));
        let is_near = move |other: &[usize; 2]| other[0].abs_diff(x) <= 2 && other[1].abs_diff(y) <= 2;
        pixels.filter(is_near).map(move |[x, y]| ([x, y], light.light(layer, [x, y])))
    }

    /// Two layers of small pictures.
    fn for_all_pixels(check: impl Fn(&Planes, usize, [usize; 2])) {
        for size in [(7, 6), (1, 4), (2, 1), (19, 3)] {
            let mut light = Planes::zeros(&Memory::default(), size, 6);
            let stride = light.stride;
            light.par_lines_mut().enumerate().for_each(|(y, line)| {
                for (at, number) in line.iter_mut().enumerate().filter(|(at, _)| at % stride < size.0) {
                    *number = ((at + 5 * y) * 37 % 84) as f32 * if (at + y) % 11 == 3 { 9.0 } else { 1.0 };
                }
            });
            for layer in 0..2 {
                (0..size.0 * size.1).for_each(|pixel| check(&light, layer, [pixel % size.0, pixel / size.0]));
            }
        }
    }

    #[test]
    fn bounds_are_those_of_the_neighbourhood() {
        for_all_pixels(|light, layer, [x, y]| {
            let near: Vec<Rgb> = near(light, layer, [x, y]).map(|(_, light)| light).collect();
            let least = near.iter().fold(Rgb::INFINITY, |all, one| all.min(*one));
            let most = near.iter().fold(Rgb::NEG_INFINITY, |all, one| all.max(*one));
            let mut found = [(); 2].map(|()| Planes::unset(light.memory(), (light.width, 1), light.count));
            bounds(light, y..y + 1, &mut found);
            assert_eq!(found.map(|bound| bound.light(layer, [x, 0])), [least, most]);
        });
    }

    #[test]
    fn outliers_become_twice_as_bright_as_the_brightest_around() {
        for_all_pixels(|light, layer, pixel| {
            let others = near(light, layer, pixel).filter(|(other, _)| *other != pixel);
            let limit = 2.0 * others.map(|(_, light)| light.element_sum()).fold(0.0, f32::max);
            let [own, dimmed] = [light, &dimmed(light)].map(|light| light.light(layer, pixel));
            let factor = if own.element_sum() > limit { limit / own.element_sum() } else { 1.0 };
            assert_eq!(dimmed, own * factor);
        });
    }
}
