//! Numbers that nobody knows exactly.

/// The likely value, and two between which it should lie.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Range {
    pub low: f64,
    pub mid: f64,
    pub high: f64,
}

impl Range {
    /// In any order.
    pub fn new(a: f64, mid: f64, b: f64) -> Self {
        Self { low: a.min(b).min(mid), mid, high: a.max(b).max(mid) }
    }

    /// Whether the likely value is a good answer by itself.
    pub fn is_narrow(&self) -> bool {
        self.high <= 1.5 * self.low
    }
}
