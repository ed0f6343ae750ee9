//! The samples of a picture together with those of its neighbours.

use super::super::guides::{BLOCK, Guides, OF_HALF, OF_PIXEL};
use super::super::halves::Halves;
use super::super::planes::Planes;
use super::Neighbor;
use super::agreement::Agreement;
use super::reprojection::AHEAD;
use crate::base::lanes::{Level, Row, SimdKernel, dispatch};
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
    /// Pools the layer number `place` of a picture, whose light without outliers is `dimmed` and whose guides are
    /// `own`. `floor` is added to the squared light of a pixel, to which errors are relative.
    pub fn new(
        (halves, dimmed): (&Halves, &[Planes; 2]),
        own: [&Guides; 2],
        neighbors: &[Neighbor],
        (layer, place, floor): (LayerId, usize, f32),
    ) -> Self {
        let mut light = dimmed.each_ref().map(|light| light.layer(place));
        let agreement = Agreement { own: dimmed, place, floor };
        let mut all = Vec::with_capacity(neighbors.len());
        for neighbor in neighbors {
            let Some(their_place) = neighbor.halves.place_of(layer) else { continue };
            let weights = agreement.add_weighted(neighbor, their_place, &mut light);
            all.push(WeightedNeighbor { neighbor, weights });
        }
        light.iter_mut().for_each(|light| divide(light, &all));
        let still = still(&all);
        let shown = still.is_some().then(|| pooled_guides::<true>(halves, own, &all));
        Self { light, guides: pooled_guides::<false>(halves, own, &all), shown, still }
    }
}

/// The guides of both halves, pooled with those of neighbours: of all, or where they see a point through the same
/// pixel.
fn pooled_guides<const STILL: bool>(
    halves: &Halves,
    own: [&Guides; 2],
    all: &[WeightedNeighbor],
) -> [Guides; 2] {
    let (width, _) = halves.size();
    Guides::others(own, width, |[x, y], into| {
        dispatch(PoolGuides::<STILL> { own: &halves.guides, width, all, pixel: [x, y], into });
    })
}

/// Pools the guides of some pixels of a row, from one on: those of a block at most.
struct PoolGuides<'a, const STILL: bool> {
    own: &'a [f32],
    width: usize,
    all: &'a [WeightedNeighbor<'a>],
    pixel: [usize; 2],
    into: &'a mut [[f32; OF_PIXEL]],
}

impl<const STILL: bool> SimdKernel for PoolGuides<'_, STILL> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { own, width, all, pixel: [first, y], into } = self;
        let own = &own[(y * width + first) * OF_PIXEL..][..into.len() * OF_PIXEL];
        into.as_flattened_mut().copy_from_slice(own);
        let mut totals = [1.0; BLOCK];
        for WeightedNeighbor { neighbor: Neighbor { halves, reprojection }, weights } in all {
            let row = &reprojection.row(y)[first..];
            let pixels = weights.row(0, y)[first..].iter().zip(row).enumerate();
            for ((sums, total), (x, (weight, taps))) in into.iter_mut().zip(&mut totals).zip(pixels) {
                if let Some(soon) = row.get(x + AHEAD).filter(|soon| !STILL || soon.is_still) {
                    soon.prefetch::<L>(&halves.guides, (0, OF_PIXEL), width);
                }
                if *weight > 0.0 && (!STILL || taps.is_still) {
                    *total += weight;
                    for half in [0, OF_HALF] {
                        let guides = taps.sum::<L::F32>(&halves.guides, (half, OF_PIXEL), width);
                        let sum = L::F32::load(sums, half) + guides * L::F32::splat(*weight);
                        sum.store(sums, half);
                    }
                }
            }
        }
        for (sums, total) in into.iter_mut().zip(totals) {
            for half in [0, OF_HALF] {
                (L::F32::load(sums, half) / L::F32::splat(total)).store(sums, half);
            }
        }
    }
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
