//! What the light of a pixel is fitted to.

use super::super::Film;
use super::columns::Columns;
use super::planes::{COLUMN, Planes, read_line};
use crate::base::lanes::{Real, Row, Single};
use crate::film::aov::GUIDES;
use rayon::prelude::*;

/// The number of guides of a pixel: albedo, normal, closeness, and the position in the picture.
pub const COUNT: usize = POSITION + 2;

/// The guides of the last two entries, which are positions in pixels.
pub const POSITION: usize = 7;

/// The places of the guides before positions among the channels of the film's guides, which begin with closeness.
const CHANNELS: [usize; POSITION] = [6, 7, 8, 3, 4, 5, 0];

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
    values: Vec<f32>,
    /// For a row: 1 in the picture and 0 beside it, and the positions along it.
    row: Vec<f32>,
}

impl Guides {
    /// Positions are the same in all rows.
    pub const BYTES_PER_PIXEL: u64 = size_of::<[f32; POSITION]>() as u64;

    /// The guides of a film. Closeness is 1 over the distance, which is linear in the position on planes, relative to
    /// its mean over the picture.
    pub fn new(film: &Film) -> Self {
        let unit = unit_of_closeness(film, film.layers() - GUIDES);
        Self::of_rows((film.width, film.height), unit, |y, row| read_guides(film, y, row))
    }

    /// Guides whose closeness has the unit of these, from planes as [`guide_planes`] gives them.
    pub fn with_planes(&self, planes: &Planes) -> Self {
        let size = (planes.width as u32, planes.height as u32);
        Self::of_rows(size, self.unit, |y, row| {
            for (guide, row) in row.chunks_exact_mut(planes.stride).enumerate() {
                row.copy_from_slice(planes.row(guide, y));
            }
        })
    }

    /// `read` writes the guides of a row without positions, each padded to whole columns.
    fn of_rows((width, height): (u32, u32), unit: f32, read: impl Fn(usize, &mut [f32]) + Sync) -> Self {
        let (width, height) = (width as usize, height as usize);
        let columns = Columns::new(width);
        let mut values = vec![0.0; height * POSITION * columns.of_row()];
        let rows = values.par_chunks_exact_mut(POSITION * columns.of_row()).enumerate();
        rows.for_each(|(y, values)| {
            let mut row = vec![0.0; POSITION * columns.pixels()];
            read(y, &mut row);
            let guides = row.chunks_exact(columns.pixels());
            for (guide, values) in guides.zip(values.chunks_exact_mut(columns.of_row())) {
                columns.spread(guide, values);
            }
            let closeness = &mut values[(POSITION - 1) * columns.of_row()..];
            closeness.iter_mut().for_each(|near| *near = finite(*near * unit));
        });
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

/// The guides of a film without positions, a plane each. Closeness has no unit yet.
pub fn guide_planes(film: &Film) -> Planes {
    let mut planes = Planes::new((film.width as usize, film.height as usize), POSITION);
    planes.par_lines_mut().enumerate().for_each(|(y, row)| read_guides(film, y, row));
    planes
}

/// Reads the guides of a row without positions, each padded to whole columns.
fn read_guides(film: &Film, y: usize, into: &mut [f32]) {
    let (first, stride) = (film.layers() - GUIDES, into.len() / POSITION);
    let mut line = vec![0.0; 3 * GUIDES * stride];
    read_line(film, first..first + GUIDES, y, &mut line);
    for (channel, into) in CHANNELS.into_iter().zip(into.chunks_exact_mut(stride)) {
        let guides = &line[channel * stride..][..stride];
        into.iter_mut().zip(guides).for_each(|(into, guide)| *into = finite(*guide));
    }
}

/// By what closeness is multiplied to have the mean 1 where something is seen.
fn unit_of_closeness(film: &Film, layer: usize) -> f32 {
    let all = film.data.chunks_exact(film.layers()).map(|pixel| f64::from(finite(pixel[layer].x)));
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
