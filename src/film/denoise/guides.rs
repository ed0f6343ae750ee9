//! What the light of a pixel is fitted to.

use super::super::Film;
use crate::film::aov::GUIDES;

/// The number of guides of a pixel: albedo, normal, closeness, and the position in the picture.
pub const COUNT: usize = 9;

/// The guides of the last two entries, which are positions in pixels.
pub const POSITION: usize = COUNT - 2;

/// The guides of all pixels of a picture, row by row.
pub struct Guides {
    pub width: usize,
    pub height: usize,
    values: Vec<[f32; COUNT]>,
}

impl Guides {
    pub const BYTES_PER_PIXEL: u64 = size_of::<[f32; COUNT]>() as u64;

    /// The guides of a film. Closeness is 1 over the distance, which is linear in the position on planes, relative to its
    /// mean over the picture.
    pub fn new(film: &Film) -> Self {
        let (width, height) = (film.width as usize, film.height as usize);
        let first = film.layers() - GUIDES;
        let mut values: Vec<[f32; COUNT]> = (0..width * height)
            .map(|pixel| {
                let [place, normal, albedo] = [0, 1, 2].map(|guide| film.pixel(pixel)[first + guide]);
                let (x, y) = ((pixel % width) as f32, (pixel / width) as f32);
                [albedo.x, albedo.y, albedo.z, normal.x, normal.y, normal.z, place.x, x, y].map(finite)
            })
            .collect();
        let closeness = POSITION - 1;
        let seen = values.iter().map(|guides| f64::from(guides[closeness])).filter(|near| *near > 0.0);
        let (count, sum) = seen.fold((0.0, 0.0), |(count, sum), near| (count + 1.0, sum + near));
        let unit = if sum > 0.0 { (count / sum) as f32 } else { 0.0 };
        values.iter_mut().for_each(|guides| guides[closeness] = finite(guides[closeness] * unit));
        Self { width, height, values }
    }

    pub fn at(&self, pixel: usize) -> [f64; COUNT] {
        self.values[pixel].map(f64::from)
    }
}

/// Albedos of thousands and surfaces at the camera would outweigh everything else.
fn finite(guide: f32) -> f32 {
    if guide.is_finite() { guide.clamp(-LARGEST, LARGEST) } else { 0.0 }
}

/// No picture has more pixels in a row.
const LARGEST: f32 = 1e6;
