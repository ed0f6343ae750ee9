//! What the light of a pixel is fitted to.

use super::super::Film;
use super::columns::{Columns, LANES};
use super::memory::{Held, Memory};
use super::planes::COLUMN;
use crate::base::lanes::{Level, Real, Row, SimdKernel, Single, dispatch};
use crate::film::aov::GUIDES;
use rayon::prelude::*;

/// The number of guides of a pixel: albedo, normal, closeness, and the position in the picture.
pub const COUNT: usize = POSITION + 2;

/// The guides of the last two entries, which are positions in pixels.
pub const POSITION: usize = 7;

/// The last guide before positions.
const CLOSENESS: usize = POSITION - 1;

/// Numbers of a pixel in one half: the guides without positions, and a zero that fills lanes. Closeness has no unit
/// yet.
pub const OF_HALF: usize = POSITION + 1;

/// The guides of a pixel in both halves, so that they are read at once.
pub const OF_PIXEL: usize = 2 * OF_HALF;

/// The pixels of a block.
pub const BLOCK: usize = COLUMN * LANES;

/// The number of features of a pixel: 1, and its guides. A linear function of the guides with a constant is a linear
/// form of the features.
pub const FEATURES: usize = COUNT + 1;

/// The guides of all pixels of a picture, in lanes.
pub struct Guides {
    columns: Columns,
    /// By what closeness is multiplied.
    unit: f32,
    pub height: usize,
    /// Per row: the guides without positions.
    values: Held<f32>,
    /// For a row: 1 in the picture and 0 beside it, and the positions along it.
    row: Vec<f32>,
}

impl Guides {
    /// Positions are the same in all rows.
    pub const BYTES_PER_PIXEL: u64 = size_of::<[f32; POSITION]>() as u64;

    /// Those of both halves of a picture. Closeness is 1 over the distance, which is linear in the position on planes,
    /// relative to its mean over the picture.
    pub fn new(size: (usize, usize), pixels: &Held<f32>) -> [Self; 2] {
        let all = pixels.as_chunks::<OF_PIXEL>().0;
        let units = units_of_closeness(all);
        Self::of_blocks(pixels.memory(), size, units, |[x, y], into| {
            Some(&all[y * size.0 + x..][..into.len()])
        })
    }

    /// Others of a picture of the same size, whose closeness has the same unit. `write` writes those of some pixels
    /// from one on, given its column and row.
    pub fn others(
        both: [&Self; 2],
        width: usize,
        write: impl Fn([usize; 2], &mut [[f32; OF_PIXEL]]) + Sync,
    ) -> [Self; 2] {
        let [first, second] = both;
        let (size, units) = ((width, first.height), [first.unit, second.unit]);
        Self::of_blocks(first.values.memory(), size, units, |pixel, into| {
            write(pixel, into);
            None
        })
    }

    /// `read` gives those of some pixels from one on, or writes them.
    fn of_blocks<'a>(
        memory: &Memory,
        (width, height): (usize, usize),
        units: [f32; 2],
        read: impl Fn([usize; 2], &mut [[f32; OF_PIXEL]]) -> Option<&'a [[f32; OF_PIXEL]]> + Sync,
    ) -> [Self; 2] {
        let columns = Columns::new(width);
        let of_row = POSITION * columns.of_row();
        let mut values = [(); 2].map(|()| memory.unset(height * of_row));
        let [first, second] = &mut values;
        let rows = first.par_chunks_exact_mut(of_row).zip(second.par_chunks_exact_mut(of_row));
        rows.enumerate().for_each_init(
            || [[0.0; OF_PIXEL]; BLOCK],
            |pixels, (y, (first, second))| {
                let blocks = first.as_chunks_mut::<{ POSITION * BLOCK }>().0.iter_mut();
                let blocks = blocks.zip(second.as_chunks_mut::<{ POSITION * BLOCK }>().0);
                for (x, (first, second)) in (0..).step_by(BLOCK).zip(blocks) {
                    let written = &mut pixels[..BLOCK.min(width - x)];
                    let pixels = read([x, y], written).unwrap_or(written);
                    dispatch(Spread { pixels, units, into: [first, second] });
                }
            },
        );
        let mut row = vec![0.0; 2 * columns.of_row()];
        for x in 0..width {
            let (block, place, lane) = (x / BLOCK, x % COLUMN, x / COLUMN % LANES);
            let at = 2 * (block * BLOCK + place * LANES) + lane;
            (row[at], row[at + LANES]) = (1.0, x as f32);
        }
        let [first, second] = values;
        [(first, units[0], row.clone()), (second, units[1], row)].map(|(values, unit, row)| Self {
            columns,
            unit,
            height,
            values,
            row,
        })
    }

    /// The features of eight pixels of a row in the picture: of those at the same place in the columns of a block.
    /// Beside the picture, they are zero.
    #[inline(always)]
    pub fn pixels(&self, y: usize, block: usize, place: usize) -> PixelFeatures<'_> {
        let pixels = block * COLUMN + place;
        let values = &self.values[(y * self.columns.of_row() + pixels * LANES) * POSITION..];
        PixelFeatures {
            values: &values[..POSITION * LANES],
            row: &self.row[2 * pixels * LANES..][..2 * LANES],
        }
    }
}

/// The features of eight pixels but the last one, which is that of their row.
#[derive(Clone, Copy)]
pub struct PixelFeatures<'a> {
    values: &'a [f32],
    row: &'a [f32],
}

impl PixelFeatures<'_> {
    /// A feature.
    #[inline(always)]
    pub fn get<F: Real>(&self, feature: usize) -> F {
        let lanes = match feature {
            0 => F::F32::load(self.row, 0),
            1..=POSITION => F::F32::load(self.values, (feature - 1) * LANES),
            _ => F::F32::load(self.row, LANES),
        };
        lanes.to_f64()
    }
}

/// Spreads the guides of both halves of the pixels of a block over lanes. Their closeness gets a unit.
struct Spread<'a> {
    pixels: &'a [[f32; OF_PIXEL]],
    units: [f32; 2],
    into: [&'a mut [f32; POSITION * BLOCK]; 2],
}

impl SimdKernel for Spread<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { pixels, units, into: [first, second] } = self;
        let numbers = pixels.as_flattened();
        for (half, into) in [first, second].into_iter().enumerate() {
            for (place, into) in into.as_chunks_mut::<{ POSITION * LANES }>().0.iter_mut().enumerate() {
                let mut guides = [L::F32::splat(0.0); LANES];
                for (lane, guides) in guides.iter_mut().enumerate() {
                    let at = (lane * COLUMN + place) * OF_PIXEL + half * OF_HALF;
                    // Beside the picture, they are zero.
                    if at < numbers.len() {
                        *guides = L::F32::load(numbers, at);
                    }
                }
                let mut guides = L::transpose(guides);
                guides[CLOSENESS] = finite_lanes(guides[CLOSENESS] * L::F32::splat(units[half]));
                for (guide, lanes) in guides.into_iter().enumerate().take(POSITION) {
                    lanes.store(into, guide * LANES);
                }
            }
        }
    }
}

/// The guides of the pixels of both halves, row by row.
pub fn guides_of(memory: &Memory, films: &[Film; 2]) -> Held<f32> {
    let [one, _] = films;
    let first = one.layers() - GUIDES;
    let mut guides = memory.unset(one.width as usize * one.height as usize * OF_PIXEL);
    let pixels = guides.as_chunks_mut::<OF_PIXEL>().0;
    pixels.par_iter_mut().with_min_len(1 << 10).enumerate().for_each(|(pixel, into)| {
        for (film, into) in films.iter().zip(into.as_chunks_mut::<OF_HALF>().0) {
            let layers = film.pixel(pixel);
            let [closeness, normal, albedo] = [0, 1, 2].map(|layer| layers[first + layer]);
            let guides = [albedo.x, albedo.y, albedo.z, normal.x, normal.y, normal.z, closeness.x, 0.0];
            *into = guides.map(finite);
        }
    });
    guides
}

/// By what closeness is multiplied to have the mean 1 where something is seen, in both halves.
fn units_of_closeness(pixels: &[[f32; OF_PIXEL]]) -> [f32; 2] {
    let [mut counts, mut sums] = [[0.0; 2]; 2];
    for pixel in pixels {
        for half in 0..2 {
            let near = f64::from(pixel[half * OF_HALF + CLOSENESS]);
            if near > 0.0 {
                counts[half] += 1.0;
                sums[half] += near;
            }
        }
    }
    [0, 1].map(|half| if sums[half] > 0.0 { (counts[half] / sums[half]) as f32 } else { 0.0 })
}

/// Albedos of thousands and surfaces at the camera would outweigh everything else.
fn finite(guide: f32) -> f32 {
    if guide.is_finite() { guide.clamp(-LARGEST, LARGEST) } else { 0.0 }
}

/// [`finite`] of lanes.
#[inline(always)]
fn finite_lanes<S: Single>(guide: S) -> S {
    let (largest, infinite) = (S::splat(LARGEST), S::splat(f32::INFINITY));
    S::select(guide.abs().lt(infinite), guide.max(-largest).min(largest), S::splat(0.0))
}

/// No picture has more pixels in a row.
const LARGEST: f32 = 1e6;
