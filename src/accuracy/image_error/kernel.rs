//! Pictures of one channel, and filters that are products of one along each axis.

/// One channel, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    pub width: usize,
    pub values: Vec<f64>,
}

impl Plane {
    /// Filters rows by `across` and columns by `down`; both have an odd number of weights. Beyond its edges a picture
    /// goes on as it ends.
    pub fn filtered(&self, across: &[f64], down: &[f64]) -> Self {
        let (width, height) = (self.width, self.values.len() / self.width.max(1));
        let rows = self.values.chunks_exact(width.max(1));
        let rows: Vec<f64> =
            rows.flat_map(|row| (0..width).map(|x| around(row, x, 1, width, across))).collect();
        let at = |i: usize| around(&rows[i % width..], i / width, width, height, down);
        Self { width, values: (0..rows.len()).map(at).collect() }
    }

    pub fn combined(&self, other: &Self, of: impl Fn(f64, f64) -> f64) -> Self {
        let values = self.values.iter().zip(&other.values).map(|(a, b)| of(*a, *b)).collect();
        Self { width: self.width, values }
    }
}

/// The weighted sum around the value number `at` of `count` that are `step` apart.
fn around(values: &[f64], at: usize, step: usize, count: usize, weights: &[f64]) -> f64 {
    let radius = weights.len() / 2;
    let value =
        |(k, weight): (usize, &f64)| weight * values[(at + k).saturating_sub(radius).min(count - 1) * step];
    weights.iter().enumerate().map(value).sum()
}
