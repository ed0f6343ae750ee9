//! The samples of a picture together with those of its neighbours.

use super::super::guides::{Guides, guide_planes};
use super::super::halves::Halves;
use super::super::planes::Planes;
use super::Neighbor;
use super::agreement::weights;
use super::reprojection::Reprojection;
use crate::film::LayerId;
use rayon::prelude::*;
use std::ops::Range;

/// The samples of a layer of light of both halves, pooled with those of neighbours: weighted means.
pub struct Pooled {
    /// The light without outliers: three planes for each half.
    pub light: [Planes; 2],
    /// Guides of the same samples, to which the light is fitted.
    pub guides: [Guides; 2],
    /// Guides at which fits are evaluated, if they differ from those of the picture: pooled where neighbours see a point
    /// through the same pixel. Elsewhere, those of neighbours are interpolated, so pooled ones would blur.
    pub shown: Option<[Guides; 2]>,
    /// What the neighbours weigh that see a point through the same pixel. The picture's own samples weigh 1.
    pub still: Planes,
}

/// Weighted sums, and their weights.
struct Sum {
    values: Planes,
    weights: Planes,
}

impl Sum {
    fn new(values: Planes) -> Self {
        let mut weights = Planes::new(values.size(), 1);
        weights.par_lines_mut().for_each(|line| line.fill(1.0));
        Self { values, weights }
    }

    /// Adds values, by weights.
    fn add(&mut self, values: &Planes, weights: &Planes) {
        let stride = weights.stride;
        self.values.par_lines_mut().zip(self.weights.par_lines_mut()).enumerate().for_each(
            |(y, (line, sums))| {
                let weights = weights.row(0, y);
                for (plane, sums) in line.chunks_exact_mut(stride).enumerate() {
                    for ((sum, value), weight) in sums.iter_mut().zip(values.row(plane, y)).zip(weights) {
                        // Without weight, light may be infinite.
                        *sum += if *weight > 0.0 { value * weight } else { 0.0 };
                    }
                }
                sums.iter_mut().zip(weights).for_each(|(sum, weight)| *sum += weight);
            },
        );
    }

    fn mean(mut self) -> Planes {
        let (stride, weights) = (self.weights.stride, self.weights);
        self.values.par_lines_mut().enumerate().for_each(|(y, line)| {
            for sums in line.chunks_exact_mut(stride) {
                sums.iter_mut().zip(weights.row(0, y)).for_each(|(sum, weight)| *sum /= weight);
            }
        });
        self.values
    }
}

impl Pooled {
    /// Pools the layer number `place` of a picture, whose guides are `own`. `floor` is added to the squared light of a pixel,
    /// to which errors are relative.
    pub fn new(
        halves: &Halves,
        own: [&Guides; 2],
        neighbors: &[Neighbor],
        (layer, place, floor): (LayerId, usize, f32),
    ) -> Self {
        let light = halves.dimmed.each_ref();
        let mut light_sums = light.map(|light| Sum::new(light.layer(place)));
        let mut guide_sums = sums_of_guides(halves);
        let mut shown_sums = None;
        let mut still = Planes::new(light[0].size(), 1);
        for Neighbor { halves: theirs, reprojection: by, guides } in neighbors {
            let Some(their_place) = theirs.place_of(layer) else { continue };
            let found =
                theirs.dimmed.each_ref().map(|light| moved(light, 3 * their_place..3 * their_place + 3, by));
            let weights = weights((light, 3 * place), found.each_ref(), by, floor);
            light_sums.iter_mut().zip(&found).for_each(|(sum, found)| sum.add(found, &weights));
            if by.is_partly_still {
                let weights = of_still(&weights, by);
                let shown = shown_sums.get_or_insert_with(|| sums_of_guides(halves));
                shown.iter_mut().zip(guides).for_each(|(sum, guides)| sum.add(guides, &weights));
                still.add(&weights);
            }
            guide_sums.iter_mut().zip(guides).for_each(|(sum, guides)| sum.add(guides, &weights));
        }
        let [first, second] = own;
        let with_unit = |sums: [Sum; 2]| {
            let [a, b] = sums.map(Sum::mean);
            [first.with_planes(&a), second.with_planes(&b)]
        };
        Self {
            light: light_sums.map(Sum::mean),
            guides: with_unit(guide_sums),
            shown: shown_sums.map(with_unit),
            still,
        }
    }
}

/// The guides of a picture, to which others are added.
fn sums_of_guides(halves: &Halves) -> [Sum; 2] {
    halves.films.each_ref().map(|film| Sum::new(guide_planes(film)))
}

/// Planes of a neighbour at the points of the pixels; zero where it does not see them.
pub(super) fn moved(from: &Planes, planes: Range<usize>, by: &Reprojection) -> Planes {
    let mut into = Planes::new(from.size(), planes.len());
    let stride = into.stride;
    into.par_lines_mut().enumerate().for_each(|(y, line)| {
        for (x, taps) in by.row(y).iter().enumerate().filter(|(_, taps)| taps.is_seen()) {
            // Pixels without weight may hold any light, also an infinite one, and may be beyond the edge.
            let (mut pixels, mut count) = ([(0, 0.0); 4], 0);
            for (tap, weight) in taps.weights.into_iter().enumerate().filter(|(_, weight)| *weight > 0.0) {
                let place = [taps.row as usize + tap / 2, taps.column as usize + tap % 2];
                pixels[count] = (from.offset(place), weight);
                count += 1;
            }
            for (plane, into) in planes.clone().zip(line[x..].iter_mut().step_by(stride)) {
                for (offset, weight) in &pixels[..count] {
                    *into += from.at_offset(plane, *offset) * weight;
                }
            }
        }
    });
    into
}

/// Weights at points that the same pixel sees, and 0 elsewhere.
fn of_still(weights: &Planes, by: &Reprojection) -> Planes {
    let mut still = Planes::new(weights.size(), 1);
    still.par_lines_mut().enumerate().for_each(|(y, line)| {
        for ((into, weight), taps) in line.iter_mut().zip(weights.row(0, y)).zip(by.row(y)) {
            *into = if taps.is_still { *weight } else { 0.0 };
        }
    });
    still
}
