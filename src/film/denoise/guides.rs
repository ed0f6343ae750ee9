//! What the light of a pixel is fitted to.

use super::super::Film;
use super::columns::Columns;
use super::memory::{Held, Memory};
use super::planes::COLUMN;
use crate::base::lanes::{Real, Row, Single};
use crate::film::aov::GUIDES;
use rayon::prelude::*;

/// The number of guides of a pixel: albedo, normal, closeness, and the position in the picture.
pub const COUNT: usize = POSITION + 2;

/// The guides of the last two entries, which are positions in pixels.
pub const POSITION: usize = 7;

/// The last guide before positions.
const CLOSENESS: usize = POSITION - 1;

/// The guides of a pixel without positions, and a zero that fills lanes. Closeness has no unit yet.
pub type PixelGuides = [f32; 8];

/// The number of features of a pixel: 1, and its guides. A linear function of the guides with a constant is a linear
/// form of the features.
pub const FEATURES: usize = COUNT + 1;

/// The guides of all pixels of a picture, in lanes.
pub struct Guides {
    columns: Columns,
    /// By what closeness is multiplied.
    unit: f32,
    height: usize,
    /// Per row: the guides without positions.
    values: Held<f32>,
    /// For a row: 1 in the picture and 0 beside it, and the positions along it.
    row: Vec<f32>,
}

impl Guides {
    /// Positions are the same in all rows.
    pub const BYTES_PER_PIXEL: u64 = size_of::<[f32; POSITION]>() as u64;

    /// Those of a picture of this size. Closeness is 1 over the distance, which is linear in the position on planes,
    /// relative to its mean over the picture.
    pub fn new(memory: &Memory, (width, height): (usize, usize), pixels: &[PixelGuides]) -> Self {
        let unit = unit_of_closeness(pixels);
        Self::of_pixels(memory, (width, height), unit, |[x, y]| pixels[y * width + x])
    }

    /// Others of a picture of the same size, whose closeness has the same unit.
    pub fn with(&self, width: usize, read: impl Fn([usize; 2]) -> PixelGuides + Sync) -> Self {
        Self::of_pixels(self.values.memory(), (width, self.height), self.unit, read)
    }

    fn of_pixels(
        memory: &Memory,
        (width, height): (usize, usize),
        unit: f32,
        read: impl Fn([usize; 2]) -> PixelGuides + Sync,
    ) -> Self {
        let columns = Columns::new(width);
        let mut values = memory.zeros(height * POSITION * columns.of_row());
        let rows = values.par_chunks_exact_mut(POSITION * columns.of_row()).enumerate();
        rows.for_each_init(
            || vec![0.0; POSITION * columns.pixels()],
            |row, (y, values)| {
                for x in 0..width {
                    let mut guides = read([x, y]);
                    guides[CLOSENESS] = finite(guides[CLOSENESS] * unit);
                    let into = row[x..].iter_mut().step_by(columns.pixels());
                    into.zip(guides).for_each(|(into, guide)| *into = guide);
                }
                let guides = row.chunks_exact(columns.pixels());
                for (guide, values) in guides.zip(values.chunks_exact_mut(columns.of_row())) {
                    columns.spread(guide, values);
                }
            },
        );
        let mut row = vec![0.0; 2 * columns.of_row()];
        let (inside, along) = row.split_at_mut(columns.of_row());
        let places = |number: fn(usize) -> f32| {
            let mut row = vec![0.0; columns.pixels()];
            row.iter_mut().enumerate().take(width).for_each(|(x, value)| *value = number(x));
            row
        };
        columns.spread(&places(|_| 1.0), inside);
        columns.spread(&places(|x| x as f32), along);
        Self { columns, unit, height, values, row }
    }

    /// The features of eight pixels of a row: of those at the same place in columns from `column` on. Beside the
    /// picture, they are zero.
    #[inline(always)]
    pub fn features<F: Real>(&self, y: usize, place: usize, column: usize) -> [F; FEATURES] {
        let mut features = [F::splat(0.0); FEATURES];
        if y < self.height {
            let at = place * self.columns.padded + column;
            let inside = F::F32::load(&self.row, at).to_f64();
            features[0] = inside;
            for guide in 0..POSITION {
                let at = ((y * POSITION + guide) * COLUMN + place) * self.columns.padded + column;
                features[guide + 1] = F::F32::load(&self.values, at).to_f64();
            }
            features[POSITION + 1] = F::F32::load(&self.row, self.columns.of_row() + at).to_f64();
            features[POSITION + 2] = inside * F::splat(y as f64);
        }
        features
    }
}

/// The guides of the pixels of a film, row by row.
pub fn guides_of(film: &Film) -> Vec<PixelGuides> {
    let first = film.layers() - GUIDES;
    let pixels = film.data.par_chunks_exact(film.layers()).with_min_len(1 << 10);
    let guides = pixels.map(|layers| {
        let [closeness, normal, albedo] = [0, 1, 2].map(|layer| layers[first + layer]);
        let guides = [albedo.x, albedo.y, albedo.z, normal.x, normal.y, normal.z, closeness.x, 0.0];
        guides.map(finite)
    });
    guides.collect()
}

/// By what closeness is multiplied to have the mean 1 where something is seen.
fn unit_of_closeness(pixels: &[PixelGuides]) -> f32 {
    let all = pixels.iter().map(|guides| f64::from(guides[CLOSENESS]));
    let (count, sum) =
        all.filter(|near| *near > 0.0).fold((0.0, 0.0), |(count, sum), near| (count + 1.0, sum + near));
    if sum > 0.0 { (count / sum) as f32 } else { 0.0 }
}

/// Albedos of thousands and surfaces at the camera would outweigh everything else.
fn finite(guide: f32) -> f32 {
    if guide.is_finite() { guide.clamp(-LARGEST, LARGEST) } else { 0.0 }
}

/// No picture has more pixels in a row.
const LARGEST: f32 = 1e6;
