//! Pictures of one channel, and separable filters.

/// One channel, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct GrayImage {
    pub width: usize,
    pub values: Vec<f64>,
}

impl GrayImage {
    /// Filters rows by `across` and columns by `down`, which have odd numbers of weights. Edge pixels are repeated
    /// beyond the edges.
    pub fn filtered(&self, across: &[f64], down: &[f64]) -> Self {
        let (width, height) = (self.width, self.values.len() / self.width.max(1));
        let rows = self.values.chunks_exact(width.max(1));
        let rows: Vec<f64> =
            rows.flat_map(|row| (0..width).map(|x| around(row, x, 1, width, across))).collect();
        let at = |i: usize| around(&rows[i % width..], i / width, width, height, down);
        Self { width, values: (0..rows.len()).map(at).collect() }
    }

    /// A picture of `of` applied to the values of both pictures.
    pub fn combined(&self, other: &Self, of: impl Fn(f64, f64) -> f64) -> Self {
        let values = self.values.iter().zip(&other.values).map(|(a, b)| of(*a, *b)).collect();
        Self { width: self.width, values }
    }
}

/// The weighted sum around the value with the index `at` in a row of `count` values that are `step` apart.
fn around(values: &[f64], at: usize, step: usize, count: usize, weights: &[f64]) -> f64 {
    let radius = weights.len() / 2;
    let value =
        |(k, weight): (usize, &f64)| weight * values[(at + k).saturating_sub(radius).min(count - 1) * step];
    weights.iter().enumerate().map(value).sum()
}
