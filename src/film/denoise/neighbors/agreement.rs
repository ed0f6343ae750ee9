//! How much a neighbour's light is worth at each pixel.
//!
//! It is measured around the pixel, without the pixel itself, whose samples it weights. That is not quite all: light that is
//! interpolated, or compared with the pixels around it for outliers, shares samples with that of the next pixels.

use super::super::planes::Planes;
use super::super::surroundings::Sums;
use super::reprojection::Reprojection;
use rayon::prelude::*;

/// How far the light of a neighbour is compared with that of the picture, in pixels along an axis: from afar, for means of
/// little noise, and from nearby, since shadows and highlights may have moved there alone.
const FAR: usize = 6;
const NEAR: usize = 2;

/// The most that a neighbour weighs. Interpolation takes the mean of four pixels at most.
const MOST: f32 = 4.0;

/// How many times changes count. Unlike noise, those of several neighbours may add up.
const ADDED_UP: f32 = 2.0;

/// What is measured at each pixel: whether the neighbour sees the point; the squared error of a half of the picture by
/// noise; that of the neighbour by noise, and by what has changed. Relative to the light; 0 if the point is not seen.
const PLANES: usize = 4;
const SEEN: usize = 0;
const NOISE: usize = 1;
const THEIR_NOISE: usize = 2;
const CHANGE: usize = 3;
const ERRORS: [usize; 3] = [NOISE, THEIR_NOISE, CHANGE];

/// The weights of a neighbour at each pixel, relative to that of the picture's own samples: a plane. `own` is the light of
/// both halves, the planes of a layer from `first` on, and `theirs` that of the neighbour at the same points. `floor` is
/// added to the squared light of a pixel.
pub fn weights(
    (own, first): ([&Planes; 2], usize),
    theirs: [&Planes; 2],
    by: &Reprojection,
    floor: f32,
) -> Planes {
    let mut measured = Planes::new(own[0].size(), PLANES);
    let stride = measured.stride;
    measured.par_lines_mut().enumerate().for_each(|(y, line)| {
        let [a, b] = own.map(|light| [0, 1, 2].map(|channel| light.row(first + channel, y)));
        let [c, d] = theirs.map(|light| light.channels(0, y));
        let taps = by.row(y).iter().enumerate();
        for (x, _) in taps.filter(|(_, taps)| taps.is_seen()) {
            let (mut light, mut errors) = (0.0, [0.0; ERRORS.len()]);
            for channel in 0..3 {
                let [a, b, c, d] = [a, b, c, d].map(|light| light[channel][x]);
                light += 0.5 * (a + b);
                errors[0] += 0.5 * (a - b) * (a - b);
                errors[1] += 0.5 * (c - d) * (c - d);
                errors[2] += (c - a) * (d - b);
            }
            let unit = 1.0 / (light * light + floor);
            let errors = errors.map(|error| error * unit);
            // Light that overflows cannot be compared.
            if errors.iter().all(|error| error.is_finite()) {
                line[SEEN * stride + x] = 1.0;
                ERRORS.into_iter().zip(errors).for_each(|(plane, error)| line[plane * stride + x] = error);
            }
        }
    });
    let mut weights = Planes::new(own[0].size(), 1);
    weights.par_lines_mut().enumerate().for_each(|(y, line)| {
        let mut sums = Sums::new(stride);
        let mut around = |plane: usize, reach: usize| {
            let mut row = vec![0.0; stride];
            sums.add((&measured, plane), (y, reach), &mut row);
            row
        };
        let [seen, noise, theirs, change] =
            [SEEN, NOISE, THEIR_NOISE, CHANGE].map(|plane| around(plane, FAR));
        let [seen_near, change_near] = [SEEN, CHANGE].map(|plane| around(plane, NEAR));
        for (x, weight) in line.iter_mut().enumerate().filter(|(x, _)| measured.row(SEEN, y)[*x] > 0.0) {
            let near = if seen_near[x] > 0.0 { change_near[x] * seen[x] / seen_near[x] } else { 0.0 };
            let error = theirs[x] + ADDED_UP * change[x].max(near).max(0.0);
            if noise[x] > 0.0 {
                *weight = noise[x] / error.max(noise[x] / MOST);
            }
        }
    });
    weights
}
