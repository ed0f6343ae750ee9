//! A choice among many, by weights.

use crate::base::lanes::{Real, Row};

/// A discrete distribution: probabilities and their cumulative sums.
pub(super) struct DiscreteDistribution {
    pub(super) probabilities: Vec<f64>,
    cdf: Vec<f64>,
}

impl DiscreteDistribution {
    pub(super) fn of(weights: impl Iterator<Item = f64>) -> Self {
        let weights: Vec<f64> = weights.collect();
        let whole: f64 = weights.iter().sum();
        // If all weights are 0, the choice is uniform.
        let even = 1.0 / weights.len() as f64;
        let probabilities: Vec<f64> =
            weights.iter().map(|weight| if whole > 0.0 { weight / whole } else { even }).collect();
        let cdf = probabilities.iter().scan(0.0, |sum, chance| {
            *sum += chance;
            Some(*sum)
        });
        Self { cdf: cdf.collect(), probabilities }
    }

    /// Samples an index with its probability, from a number in 0..1.
    #[inline(always)]
    pub(super) fn sample<F: Real>(&self, u: F) -> (F::U32, F) {
        let numbers = u.to_array();
        let (mut indices, mut each) = (F::U32::splat(0).to_array(), numbers);
        for lane in 0..F::LANES {
            let index = self.index_at(numbers[lane]);
            (indices[lane], each[lane]) = (index as u32, self.probabilities[index]);
        }
        (F::U32::from_array(indices), F::from_array(each))
    }

    fn index_at(&self, u: f64) -> usize {
        let mut index = self.cdf.partition_point(|sum| *sum <= u).min(self.probabilities.len() - 1);
        // Rounding of the sums must not select an index of probability 0.
        while self.probabilities[index] == 0.0 && index > 0 {
            index -= 1;
        }
        index
    }
}
