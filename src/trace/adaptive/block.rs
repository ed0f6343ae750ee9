//! A block of pixels, and the error estimate from its samples.
//!
//! Samples double from one of the numbers of a [`Round`] to the next. The means of the samples before and after give the
//! squared error ([`super::halves`]).

use super::SIDE;
use super::halves::SampleHalves;
use super::layer_products::LayerProducts;
use super::round::Round;
use crate::base::color::Rgb;
use crate::base::math::DVec3;
use crate::film::{ErrorVariance, Variances};
use crate::trace::settings::Moment;
use smallvec::SmallVec;
use std::ops::Range;
use std::sync::Arc;

/// A number for each pixel of a block; the default for pixels that do not exist.
pub type PixelArray<T> = [T; (SIDE * SIDE) as usize];

/// The length of a list that takes no memory of its own: for two layers of light and their three pairs.
pub const SHORT: usize = 3;
pub type ShortList<T> = SmallVec<[T; SHORT]>;

/// Sums of pixels, `of_pixel` for each of them. Those of its layers begin at `first`.
#[derive(Clone, Copy)]
struct PixelSums<'a> {
    sums: &'a [DVec3],
    of_pixel: usize,
    first: usize,
}

impl PixelSums<'_> {
    /// The sums of a layer, pixel by pixel.
    fn of_layer(&self, layer: usize) -> impl Iterator<Item = DVec3> {
        self.sums.chunks_exact(self.of_pixel).map(move |pixel| pixel[self.first + layer])
    }
}

/// The layers of a pixel, the same in all blocks of a frame.
#[derive(Debug)]
pub struct PixelLayers {
    /// The number of all of them.
    pub count: usize,
    /// The indices of those that hold light.
    pub held: Vec<usize>,
}

/// A block of pixels.
pub struct Block {
    left: u32,
    top: u32,
    width: u32,
    height: u32,
    layers: Arc<PixelLayers>,
    /// The layers of each pixel: the sums of all samples before this round.
    sums: Box<[DVec3]>,
    /// While some moments of a round are still to be traced: the sums at each of its ends so far, pixel by pixel.
    partial: Option<Box<[DVec3]>>,
    /// The number of samples before this round.
    drawn: u32,
    /// The current round, if the block takes part in it.
    round: Option<Round>,
    /// Its rays so far. Blocks that are traced together share theirs by their pixels.
    rays: u64,
    /// The mean over the pixels of each layer that holds light.
    means: ShortList<DVec3>,
    /// The error from the halves of the last round, not yet combined with earlier rounds.
    last_round: Option<SquaredErrors>,
    /// The error from all rounds that have been combined.
    combined: Option<SquaredErrors>,
    pub trend: Option<Trend>,
}

/// The squared error of a block, if samples were independent: a mean over its pixels.
#[derive(Clone, Debug)]
struct SquaredErrors {
    products: LayerProducts,
    /// With all light weighted equally.
    square: f64,
    /// Relative to the squared estimate.
    variances: Variances,
}

/// The error of a block with one weighting, as means over pixels and colours.
#[derive(Clone, Copy, Debug, Default)]
pub struct SquaredError {
    /// The squared error, if samples were independent.
    pub square: f64,
    pub variances: Variances,
}

/// The squared error of a block before and after its last round, with all light weighted equally, and the variances of
/// these estimates as far as they were measured.
#[derive(Clone, Copy, Debug)]
pub struct Trend {
    pub before: (f64, f64),
    pub after: (f64, f64),
}

impl SquaredErrors {
    fn weighted(&self, weights: &[Rgb]) -> SquaredError {
        let square = self.products.weighted(weights);
        SquaredError { square, variances: self.variances.scaled(square * square) }
    }
}

impl Block {
    /// A block without samples, before this round.
    pub fn new(
        (left, top): (u32, u32),
        (width, height): (u32, u32),
        layers: Arc<PixelLayers>,
        first: Round,
    ) -> Self {
        let sums = vec![DVec3::ZERO; layers.count * (width * height) as usize];
        Self {
            left,
            top,
            width,
            height,
            means: SmallVec::from_elem(DVec3::ZERO, layers.held.len()),
            layers,
            sums: sums.into(),
            partial: None,
            drawn: 0,
            round: Some(first),
            rays: 0,
            last_round: None,
            combined: None,
            trend: None,
        }
    }

    pub fn pixels(&self) -> u32 {
        self.width * self.height
    }

    /// Samples of each pixel.
    pub fn drawn(&self) -> u32 {
        self.drawn
    }

    pub fn is_open(&self) -> bool {
        self.round.is_some()
    }

    /// Whether its samples show its error.
    pub fn is_measured(&self) -> bool {
        self.combined.is_some()
    }

    /// Rays per sample of all pixels: the cost of a sample.
    pub fn cost(&self) -> f64 {
        self.rays.max(1) as f64 / f64::from(self.drawn.max(1))
    }

    /// The positions of its pixels, row by row, in the order of the sums.
    pub fn places(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let (left, top, width) = (self.left, self.top, self.width);
        (0..self.pixels()).map(move |index| (left + index % width, top + index / width))
    }

    /// Takes samples that have been traced as two halves, with so many rays in all, as those of a round that is about to end.
    /// `read` writes the layers of a place in one of the halves: means over its samples.
    pub fn take_halves(&mut self, samples: u32, rays: u64, read: impl Fn((u32, u32), usize, &mut [DVec3])) {
        let (count, layers) = (f64::from(samples / 2), self.layers.count);
        let (places, mut all) = (self.places(), self.sums.clone());
        let pixels = self.sums.chunks_exact_mut(layers).zip(all.chunks_exact_mut(layers));
        for (place, (first, all)) in places.zip(pixels) {
            read(place, 0, first);
            read(place, 1, all);
            for (first, all) in first.iter_mut().zip(all) {
                *first *= count;
                *all = *first + *all * count;
            }
        }
        (self.drawn, self.round) = (samples / 2, Some(Round::after(samples / 2, samples)));
        self.take_sums(&all, rays, Moment::ONLY);
    }

    pub fn start_round(&mut self, round: Round) {
        self.round = Some(round);
    }

    /// Shortens the current round as far as pixels keep samples. Returns whether that leaves out any.
    pub fn shorten_round(&mut self) -> bool {
        let Some(round) = self.round else { return false };
        let shorter = round.shortened();
        if shorter == self.round {
            return false;
        }
        let pixels = self.layers.count * round.ends().len();
        let first = |all: Box<[DVec3]>| {
            all.chunks_exact(pixels).flat_map(|ends| &ends[..self.layers.count]).copied().collect()
        };
        self.partial = self.partial.take().filter(|_| shorter.is_some()).map(first);
        self.round = shorter;
        true
    }

    /// The current round, if the block takes part in it.
    pub fn round(&self) -> Option<Round> {
        self.round
    }

    /// Adds the sums so far at each end of the current round: for each pixel and each end, those of its layers.
    pub fn push_sums(&self, all: &mut Vec<DVec3>) {
        match (&self.partial, &self.round) {
            (Some(partial), _) => all.extend_from_slice(partial),
            (None, Some(round)) if self.drawn == 0 => {
                all.resize(all.len() + self.sums.len() * round.ends().len(), DVec3::ZERO);
            }
            (None, Some(round)) => {
                debug_assert_eq!(round.ends().len(), 1, "only the first round has several ends");
                all.extend_from_slice(&self.sums);
            }
            (None, None) => {}
        }
    }

    /// Takes the sums at each end of the current round after one of its moments, which has cost it this number of rays. After
    /// the last moment, they give its error.
    pub fn take_sums(&mut self, sums: &[DVec3], rays: u64, moment: Moment) {
        let Some(round) = self.round else { return };
        self.rays += rays;
        if moment.index + 1 < moment.of {
            self.partial = Some(sums.into());
            return;
        }
        self.partial = None;
        let (ends, layers) = (round.ends(), self.layers.count);
        let of_pixel = layers * ends.len();
        let (mut start, mut before) =
            (round.start(), PixelSums { sums: &self.sums, of_pixel: layers, first: 0 });
        for (part, &end) in ends.iter().enumerate() {
            let after = PixelSums { sums, of_pixel, first: part * layers };
            if start > 0 {
                let errors = self.errors(start..end, before, after);
                // Earlier rounds have been combined, so this one is of the same round.
                if let Some(earlier) = self.last_round.replace(errors) {
                    self.combined = Some(earlier);
                }
            }
            (start, before) = (end, after);
        }
        for (own, all) in self.sums.chunks_exact_mut(layers).zip(sums.chunks_exact(of_pixel)) {
            own.copy_from_slice(&all[of_pixel - layers..]);
        }
        let factor = 1.0 / (f64::from(round.end()) * f64::from(self.pixels()));
        for (mean, &layer) in self.means.iter_mut().zip(&self.layers.held) {
            *mean = factor * self.sums[layer..].iter().step_by(layers).sum::<DVec3>();
        }
    }

    /// Ends a round in which it took part.
    pub fn end_round(&mut self) {
        if let Some(round) = self.round.take() {
            self.drawn = round.end();
        }
        let [before, after] = [&self.combined, &self.last_round].map(|errors| {
            let Some(SquaredErrors { square, variances, .. }) = errors else { return (0.0, 0.0) };
            (*square, square * square * variances.measured.estimate)
        });
        self.trend = (before.0 > 0.0).then_some(Trend { before, after });
    }

    /// Combines the error of the last round with that of earlier rounds, scaled by the factor `fall`. Each counts half,
    /// so recent rounds count most, and no single round decides that the block is good enough.
    pub fn join(&mut self, fall: f64) {
        let Some(mut last_round) = self.last_round.take() else { return };
        if let Some(before) = self.combined.take() {
            let parts = [last_round.square, fall * before.square];
            let sum = parts[0] + parts[1];
            if sum > 0.0 {
                let shares = parts.map(|part| part * part / (sum * sum));
                let estimate = |last: f64, before: f64| shares[0] * last + shares[1] * before;
                let (last, before) = (&mut last_round.variances, &before.variances);
                last.bound.estimate = estimate(last.bound.estimate, before.bound.estimate);
                last.measured.estimate = estimate(last.measured.estimate, before.measured.estimate);
            }
            last_round.products.mean(&before.products, fall);
            last_round.square = 0.5 * sum;
        }
        self.combined = Some(last_round);
    }

    /// The squared error with these weights.
    pub fn square(&self, weights: &[Rgb]) -> SquaredError {
        self.combined.as_ref().map_or(SquaredError::default(), |combined| combined.weighted(weights))
    }

    /// The mean over pixels and colours.
    pub fn mean(&self, weights: &[Rgb]) -> f64 {
        let sum: DVec3 = self.means.iter().zip(weights).map(|(mean, weight)| *mean * weight.as_dvec3()).sum();
        sum.element_sum() / 3.0
    }

    /// The mean of a layer over all samples of a pixel.
    pub fn value(&self, pixel: usize, layer: usize) -> DVec3 {
        self.sums[pixel * self.layers.count + layer] / f64::from(self.drawn.max(1))
    }

    /// The error by the sums of each pixel before and after these samples.
    fn errors(&self, samples: Range<u32>, before: PixelSums, after: PixelSums) -> SquaredErrors {
        let halves = SampleHalves::new(samples.start, samples.end);
        let factor = halves.factor() / f64::from(self.pixels());
        let held = &self.layers.held;
        let mut layers: ShortList<PixelArray<DVec3>> = SmallVec::new();
        for &layer in held {
            let mut apart = PixelArray::default();
            let both = before.of_layer(layer).zip(after.of_layer(layer));
            for (apart, (before, after)) in apart.iter_mut().zip(both) {
                *apart = halves.difference(before, after);
            }
            layers.push(apart);
        }
        let mut all = PixelArray::<DVec3>::default();
        for layer in &layers {
            all.iter_mut().zip(layer).for_each(|(all, apart)| *all += *apart);
        }
        let mut squares = PixelArray::<f64>::default();
        squares.iter_mut().zip(&all).for_each(|(square, apart)| *square = apart.length_squared());
        let sum: f64 = squares.iter().sum();
        let fourth: f64 = squares.iter().map(|square| square * square).sum();
        // The mean squared difference of two independent numbers is the sum of their variances, plus the squared
        // difference of their means. A last one without a partner is compared with 0.
        let pairs = squares.as_chunks::<2>().0.iter();
        let differences: f64 = pairs.map(|[left, right]| (right - left) * (right - left)).sum();
        // The variance of a mean of independent numbers is their variance over their count, and each variance is at
        // most the mean square. This bound holds even if pixels differ widely or few of them are far off.
        let [bound, measured] = [fourth, differences].map(|part| {
            let variance = if sum > 0.0 { part / (sum * sum) } else { 0.0 };
            ErrorVariance { estimate: variance, truth: variance }
        });
        SquaredErrors {
            products: LayerProducts::new(&layers, factor),
            square: factor * sum / 3.0,
            variances: Variances { bound, measured },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layers() -> Arc<PixelLayers> {
        Arc::new(PixelLayers { count: 2, held: vec![1] })
    }

    /// A block of two pixels after two samples, in a round that ends at four.
    fn block() -> Block {
        let mut block = Block::new((0, 0), (2, 1), layers(), Round::first(8));
        assert!(block.shorten_round());
        block.take_sums(&[1.0, 4.0, 2.0, 8.0].map(DVec3::splat), 10, Moment::ONLY);
        block.end_round();
        block.join(0.5);
        block.start_round(Round::after(2, 8));
        block
    }

    const AFTER: [f64; 4] = [3.0, 12.0, 5.0, 12.0];

    /// The second layer of the first pixel has means of 2 and 4 in the halves, that of the second one 4 and 2.
    #[test]
    fn moments_make_one_round() {
        let mut once = block();
        once.take_sums(&AFTER.map(DVec3::splat), 6, Moment::ONLY);
        let mut parts = block();
        parts.take_sums(&[2.0, 9.0, 3.0, 8.0].map(DVec3::splat), 4, Moment { index: 0, of: 2 });
        let mut sums = Vec::new();
        parts.push_sums(&mut sums);
        assert_eq!(sums, [2.0, 9.0, 3.0, 8.0].map(DVec3::splat));
        parts.take_sums(&AFTER.map(DVec3::splat), 2, Moment { index: 1, of: 2 });
        for mut block in [once, parts] {
            block.end_round();
            block.join(0.5);
            let weights = [Rgb::ONE];
            assert_eq!((block.drawn(), block.mean(&weights), block.cost()), (4, 3.0, 4.0));
            assert_eq!((block.value(0, 0), block.value(1, 1)), (DVec3::splat(0.75), DVec3::splat(3.0)));
            assert_eq!(block.square(&weights).square, 1.0);
        }
    }

    /// One pixel with the sums 4, 12 and 40 after 2, 4 and 8 samples: the means of the halves are 2 and 4, and 3 and 7.
    #[test]
    fn first_rounds_measure_two_errors() {
        let mut block = Block::new((0, 0), (1, 1), layers(), Round::first(8));
        let mut sums = Vec::new();
        block.push_sums(&mut sums);
        assert_eq!(sums, [DVec3::ZERO; 6]);
        block.take_sums(&[0.0, 4.0, 0.0, 12.0, 0.0, 40.0].map(DVec3::splat), 1, Moment::ONLY);
        block.end_round();
        let trend = block.trend.expect("two errors");
        assert_eq!((block.drawn(), trend.before.0, trend.after.0), (8, 1.0, 4.0));
        block.join(0.5);
        assert_eq!(block.square(&[Rgb::ONE]).square, 0.5 * (4.0 + 0.5 * 1.0));
    }

    #[test]
    fn rounds_that_are_shortened_leave_what_was_before() {
        let mut later = block();
        later.take_sums(&AFTER.map(DVec3::splat), 4, Moment { index: 0, of: 2 });
        assert!(later.shorten_round() && !later.is_open() && !later.shorten_round());
        let mut sums = Vec::new();
        later.push_sums(&mut sums);
        assert_eq!((sums.len(), later.drawn(), later.value(1, 1)), (0, 2, DVec3::splat(4.0)));
        // The first round keeps its first part.
        let mut first = Block::new((0, 0), (1, 1), layers(), Round::first(8));
        let partial = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0].map(DVec3::splat);
        first.take_sums(&partial, 4, Moment { index: 0, of: 2 });
        assert!(first.shorten_round() && first.is_open() && !first.shorten_round());
        first.push_sums(&mut sums);
        assert_eq!(sums, partial[..2]);
        first.take_sums(&[2.0, 4.0].map(DVec3::splat), 4, Moment { index: 1, of: 2 });
        first.end_round();
        assert_eq!((first.drawn(), first.value(0, 1)), (2, DVec3::splat(2.0)));
    }
}
