//! Dims pixels that are far brighter than all pixels around them, and keeps fits between the samples around them.
//!
//! A path that few samples find makes a lonely bright pixel, which may hold most of the error of a picture. A fit would
//! spread it over its window. What is dimmed here are candidates: whether they have the smaller error is measured.

use super::planes::Planes;
use crate::base::lanes::{Level, Row, SimdKernel, Single, dispatch};
use std::ops::Range;

/// How far around a pixel others are compared with it, in pixels.
const REACH: usize = 2;

/// How many times as bright as the brightest pixel around it a pixel may be. Plain noise of a few samples stays below.
const FACTOR: f32 = 2.0;

/// By what the light of the pixels of a row is multiplied, so that none is an outlier. `brightness` has a plane for
/// each layer: the sums over the channels.
pub fn factors(brightness: &Planes, layer: usize, y: usize) -> Vec<f32> {
    let mut factors = brightest_around(brightness, layer, y);
    for (factor, own) in factors.iter_mut().zip(brightness.row(layer, y)) {
        let limit = FACTOR * *factor;
        *factor = if *own > limit { limit / own } else { 1.0 };
    }
    factors
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
    for offset in 1..=REACH.min(others.len()) {
        raise(&mut others, &columns[offset..]);
        raise(&mut others[offset..], &columns);
    }
    others
}

/// Writes the least and the greatest light around each pixel of some rows, itself included, in every layer and channel,
/// to planes, which may have fewer rows: each takes the place of an earlier one. A fit beyond the bounds extrapolates:
/// next to a lamp, it may be negative.
pub fn bounds(light: &Planes, rows: Range<usize>, into: &mut [Planes; 2]) {
    let [least, most] = into;
    let mut columns = [f32::INFINITY, f32::NEG_INFINITY].map(|none| vec![none; light.stride + 2 * MARGIN]);
    for y in rows {
        let [least, most] = [&mut *least, &mut *most].map(|bound| bound.line_mut(y % bound.height));
        let lines = least.chunks_exact_mut(light.stride).zip(most.chunks_exact_mut(light.stride));
        for (plane, (least, most)) in lines.enumerate() {
            dispatch(Bounds { light, plane, y, columns: &mut columns, least, most });
        }
    }
}

/// What is before a row of bounds of columns, and after it: those of no column.
const MARGIN: usize = 8;

/// The bounds of the pixels of a row.
struct Bounds<'a> {
    light: &'a Planes,
    plane: usize,
    y: usize,
    /// Memory for the least and the greatest light of columns. The margins are set.
    columns: &'a mut [Vec<f32>; 2],
    least: &'a mut [f32],
    most: &'a mut [f32],
}

impl SimdKernel for Bounds<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { light, plane, y, columns: [low, high], least, most } = self;
        let (own, near) = (light.row(plane, y), near(y, light.height));
        for x in (0..own.len()).step_by(L::F32::LANES) {
            let [mut lowest, mut highest] = [L::F32::load(own, x); 2];
            for other in near.clone() {
                let light = L::F32::load(light.row(plane, other), x);
                (lowest, highest) = (light.min(lowest), light.max(highest));
            }
            lowest.store(low, MARGIN + x);
            highest.store(high, MARGIN + x);
        }
        low[MARGIN + light.width..].fill(f32::INFINITY);
        high[MARGIN + light.width..].fill(f32::NEG_INFINITY);
        for x in (0..own.len()).step_by(L::F32::LANES) {
            let (low, high) = (&low[x..][..3 * MARGIN], &high[x..][..3 * MARGIN]);
            let (mut lowest, mut highest) = (L::F32::load(low, MARGIN), L::F32::load(high, MARGIN));
            for offset in 1..=REACH {
                for beside in [MARGIN + offset, MARGIN - offset] {
                    lowest = L::F32::load(low, beside).min(lowest);
                    highest = L::F32::load(high, beside).max(highest);
                }
            }
            lowest.store(least, x);
            highest.store(most, x);
        }
    }
}

/// The places around a place that are on an axis of this length.
fn near(place: usize, length: usize) -> Range<usize> {
    place.saturating_sub(REACH)..length.min(place + REACH + 1)
}

/// Raises numbers to others that are greater, as far as there are some.
fn raise(numbers: &mut [f32], others: &[f32]) {
    numbers
        .iter_mut()
        .zip(others)
        .for_each(|(number, other)| *number = if *other > *number { *other } else { *number });
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
            light.lines_mut().enumerate().for_each(|(y, line)| {
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
            let own = light.light(layer, pixel);
            let mut brightness = light.unset_like(1);
            brightness.lines_mut().enumerate().for_each(|(y, line)| {
                let [red, green, blue] = light.channels(layer, y);
                line.iter_mut().enumerate().for_each(|(x, sum)| *sum = red[x] + green[x] + blue[x]);
            });
            let dimmed = own * factors(&brightness, 0, pixel[1])[pixel[0]];
            let factor = if own.element_sum() > limit { limit / own.element_sum() } else { 1.0 };
            assert_eq!(dimmed, own * factor);
        });
    }
}
