//! The light of the audits.

use super::super::Film;
use super::planes::{COLUMN, channels, read_line};
use crate::base::lanes::{Color, Single};

/// The light of both audits in a row of a layer. It is read where it is needed: planes of it would cost more time, for
/// the system to make their memory.
pub struct AuditRow([Vec<f32>; 2]);

impl AuditRow {
    pub fn new(audits: [&Film; 2], layer: usize, y: usize) -> Self {
        Self(audits.map(|film| {
            let mut light = vec![0.0; 3 * (film.width as usize).next_multiple_of(COLUMN)];
            read_line(film, layer..layer + 1, y, &mut light);
            light
        }))
    }

    /// The light at eight pixels.
    #[inline(always)]
    pub fn at<S: Single>(&self, x: usize) -> [Color<S>; 2] {
        let [first, second] = &self.0;
        [Color::load(channels(first), x), Color::load(channels(second), x)]
    }
}
