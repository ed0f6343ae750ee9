//! The samples of a picture together with those of its neighbours.

use super::super::guides::{Guides, PixelGuides};
use super::super::halves::Halves;
use super::super::planes::Planes;
use super::Neighbor;
use super::agreement::Agreement;
use super::reprojection::{Reprojection, Taps};
use crate::film::LayerId;
use rayon::prelude::*;

/// The samples of a layer of light of both halves, pooled with those of neighbours: weighted means.
pub struct Pooled {
    /// The light without outliers: three planes for each half.
    pub light: [Planes; 2],
    /// Guides of the same samples, to which the light is fitted.
    pub guides: [Guides; 2],
    /// Guides at which fits are evaluated, if they differ from those of the picture: pooled where neighbours see a point
    /// through the same pixel. Elsewhere, those of neighbours are interpolated, so pooled ones would blur.
    pub shown: Option<[Guides; 2]>,
    /// What the neighbours weigh that see a point through the same pixel, if there are any. The picture's own samples
    /// weigh 1.
    pub still: Option<Planes>,
}

/// What the samples of a neighbour weigh at each pixel, relative to that of the picture's own samples: a plane.
struct WeightedNeighbor<'a> {
    neighbor: &'a Neighbor<'a>,
    weights: Planes,
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
        let dimmed = halves.dimmed.each_ref();
        let mut light = dimmed.map(|light| light.layer(place));
        // One neighbour after the other is seen in the same memory.
        let size = dimmed[0].size();
        let mut seen = [(); 2].map(|()| Planes::zeros(halves.memory(), size, 3));
        let mut agreement = Agreement::new(dimmed[0]);
        let mut all = Vec::with_capacity(neighbors.len());
        for neighbor in neighbors {
            let Neighbor { halves: theirs, reprojection: by } = neighbor;
            let Some(their_place) = theirs.place_of(layer) else { continue };
            theirs.dimmed.iter().zip(&mut seen).for_each(|(from, into)| gather(from, their_place, by, into));
            let weights = agreement.weights((dimmed, place), seen.each_ref(), by, floor);
            light.iter_mut().zip(&seen).for_each(|(sums, seen)| add(sums, seen, &weights));
            all.push(WeightedNeighbor { neighbor, weights });
        }
        light.iter_mut().for_each(|light| divide(light, &all));
        let pooled = |when: fn(&Taps) -> bool| {
            [0, 1].map(|half| {
                own[half].with(size.0, |[x, y]| {
                    let guides = halves.guides[half][y * size.0 + x];
                    pooled_guides((guides, half), &all, [x, y], when)
                })
            })
        };
        let still = still(&all);
        let shown = still.is_some().then(|| pooled(|taps| taps.is_still));
        Self { light, guides: pooled(|_| true), shown, still }
    }
}

/// Writes a layer of a neighbour's light at the points of the pixels; zero where it does not see them.
fn gather(from: &Planes, layer: usize, by: &Reprojection, into: &mut Planes) {
    let stride = into.stride;
    into.par_lines_mut().enumerate().for_each(|(y, line)| {
        for (x, taps) in by.row(y).iter().enumerate() {
            let mut light = [0.0; 3];
            for (place, weight) in taps.pixels() {
                let offset = from.offset(place);
                for (channel, light) in (3 * layer..).zip(&mut light) {
                    *light += from.at_offset(channel, offset) * weight;
                }
            }
            line[x..].iter_mut().step_by(stride).zip(light).for_each(|(into, light)| *into = light);
        }
    });
}

/// Adds light, by weights.
fn add(sums: &mut Planes, light: &Planes, weights: &Planes) {
    let stride = weights.stride;
    sums.par_lines_mut().enumerate().for_each(|(y, line)| {
        for (channel, sums) in line.chunks_exact_mut(stride).enumerate() {
            for ((sum, light), weight) in sums.iter_mut().zip(light.row(channel, y)).zip(weights.row(0, y)) {
                // Without weight, light may be infinite.
                *sum += if *weight > 0.0 { light * weight } else { 0.0 };
            }
        }
    });
}

/// Divides sums by the sum of all weights.
fn divide(sums: &mut Planes, all: &[WeightedNeighbor]) {
    let stride = sums.stride;
    sums.par_lines_mut().enumerate().for_each(|(y, line)| {
        let mut total = vec![1.0; stride];
        for WeightedNeighbor { weights, .. } in all {
            total.iter_mut().zip(weights.row(0, y)).for_each(|(sum, weight)| *sum += weight);
        }
        for sums in line.chunks_exact_mut(stride) {
            sums.iter_mut().zip(&total).for_each(|(sum, total)| *sum /= total);
        }
    });
}

/// The guides of a pixel of one of the halves, pooled with those of neighbours whose taps are chosen by `when`.
#[inline(always)]
fn pooled_guides(
    (guides, half): (PixelGuides, usize),
    all: &[WeightedNeighbor],
    [x, y]: [usize; 2],
    when: fn(&Taps) -> bool,
) -> PixelGuides {
    let (mut sums, mut total) = (guides, 1.0);
    for WeightedNeighbor { neighbor: Neighbor { halves, reprojection }, weights } in all {
        let (weight, taps) = (weights.row(0, y)[x], &reprojection.row(y)[x]);
        if weight > 0.0 && when(taps) {
            let mut guides = PixelGuides::default();
            for ([row, column], share) in taps.pixels() {
                let found = &halves.guides[half][row * weights.width + column];
                guides.iter_mut().zip(found).for_each(|(guide, found)| *guide += found * share);
            }
            sums.iter_mut().zip(guides).for_each(|(sum, guide)| *sum += guide * weight);
            total += weight;
        }
    }
    sums.map(|sum| sum / total)
}

/// What neighbours weigh at points that the same pixel sees, if there are any.
fn still(all: &[WeightedNeighbor]) -> Option<Planes> {
    let mut partly = all.iter().filter(|one| one.neighbor.reprojection.is_partly_still).peekable();
    let first = partly.peek()?;
    let mut still = Planes::zeros(first.weights.memory(), first.weights.size(), 1);
    for WeightedNeighbor { neighbor, weights } in partly {
        still.par_lines_mut().enumerate().for_each(|(y, line)| {
            let pixels = weights.row(0, y).iter().zip(neighbor.reprojection.row(y));
            for (sum, (weight, taps)) in line.iter_mut().zip(pixels) {
                *sum += if taps.is_still { *weight } else { 0.0 };
            }
        });
    }
    Some(still)
}
