//! Estimates with bounds.

/// A likely value, and the bounds between which it should be.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Range {
    pub low: f64,
    pub mid: f64,
    pub high: f64,
}

impl Range {
    /// A range of these values. The bounds may be in any order.
    pub fn new(a: f64, mid: f64, b: f64) -> Self {
        Self { low: a.min(b).min(mid), mid, high: a.max(b).max(mid) }
    }

    /// Whether the likely value alone is a good answer: the bounds differ by at most a factor of 1.5.
    pub fn is_narrow(&self) -> bool {
        self.high <= 1.5 * self.low
    }
}
