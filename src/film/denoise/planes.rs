//! Numbers of all pixels, several for each: channels of light, errors of candidates.
//!
//! The numbers of a row are interleaved by line: the first number of all its pixels, then the second one, and so on. So
//! neighbours in a row are neighbours in memory and lanes hold eight of them, and rows are written in parallel.

use super::super::Film;
use super::memory::{Held, Memory};
use rayon::prelude::*;
use std::ops::Range;

/// Rows are padded to a multiple of this many pixels: whole lanes, and whole columns of the regression.
pub const COLUMN: usize = 16;

/// The numbers of a picture: planes of one number for each pixel. The padding of their rows is for lanes alone.
pub struct Planes {
    pub width: usize,
    pub height: usize,
    /// The length of a row of a plane, with padding.
    pub stride: usize,
    /// The number of planes.
    pub count: usize,
    data: Held<f32>,
}

impl Planes {
    /// Zeros.
    pub fn zeros(memory: &Memory, (width, height): (usize, usize), count: usize) -> Self {
        let stride = width.next_multiple_of(COLUMN);
        Self { width, height, stride, count, data: memory.zeros(stride * height * count) }
    }

    /// Any numbers, all of which are to be overwritten, also in the padding.
    pub fn unset(memory: &Memory, (width, height): (usize, usize), count: usize) -> Self {
        let stride = width.next_multiple_of(COLUMN);
        let data = memory.unset(stride * height * count);
        Self { width, height, stride, count, data }
    }

    /// [`Planes::unset`] of the same size, where this one has its memory.
    pub fn unset_like(&self, count: usize) -> Self {
        Self::unset(self.memory(), self.size(), count)
    }

    /// Where these planes have their memory.
    pub fn memory(&self) -> &Memory {
        self.data.memory()
    }

    /// Layers of a film, of light or of AOVs: three channels each.
    pub fn of_film(memory: &Memory, film: &Film, layers: Range<usize>) -> Self {
        let size = (film.width as usize, film.height as usize);
        let mut planes = Self::unset(memory, size, 3 * layers.len());
        let lines = planes.par_lines_mut().enumerate();
        lines.for_each(|(y, line)| read_line(film, layers.clone(), y, line));
        planes
    }

    /// The channels of a layer, as planes of their own.
    pub fn layer(&self, layer: usize) -> Self {
        let mut planes = self.unset_like(3);
        planes.par_lines_mut().enumerate().for_each(|(y, line)| {
            for (channel, into) in self.channels(layer, y).into_iter().zip(line.chunks_exact_mut(self.stride))
            {
                into.copy_from_slice(channel);
            }
        });
        planes
    }

    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// A row of a plane, with padding.
    #[inline]
    pub fn row(&self, plane: usize, y: usize) -> &[f32] {
        &self.data[(y * self.count + plane) * self.stride..][..self.stride]
    }

    /// The channels of a layer of light in a row.
    pub fn channels(&self, layer: usize, y: usize) -> [&[f32]; 3] {
        [0, 1, 2].map(|channel| self.row(3 * layer + channel, y))
    }

    /// All planes of a row, for writing.
    pub fn line_mut(&mut self, y: usize) -> &mut [f32] {
        let of_row = self.count * self.stride;
        &mut self.data[y * of_row..][..of_row]
    }

    /// All planes of each row, for writing in turn.
    #[cfg(test)]
    pub fn lines_mut(&mut self) -> std::slice::ChunksMut<'_, f32> {
        self.data.chunks_mut((self.count * self.stride).max(1))
    }

    /// All planes of each row, for writing in parallel.
    pub fn par_lines_mut(&mut self) -> rayon::slice::ChunksMut<'_, f32> {
        self.data.par_chunks_mut((self.count * self.stride).max(1))
    }

    /// All planes of so many rows at a time, for writing.
    pub fn bands_mut(&mut self, rows: usize) -> std::slice::ChunksMut<'_, f32> {
        self.data.chunks_mut((rows * self.count * self.stride).max(1))
    }

    /// The light of a pixel.
    #[cfg(test)]
    pub fn light(&self, layer: usize, [x, y]: [usize; 2]) -> glam::Vec3 {
        glam::Vec3::from_array(self.channels(layer, y).map(|channel| channel[x]))
    }
}

/// Reads layers of a row of a film, three channels each. The padding becomes zero.
pub fn read_line(film: &Film, layers: Range<usize>, y: usize, line: &mut [f32]) {
    let (width, all, stride) = (film.width as usize, film.layers(), line.len() / (3 * layers.len()));
    let pixels = &film.data[y * width * all..][..width * all];
    for (layer, light) in layers.zip(line.chunks_exact_mut(3 * stride)) {
        let [red, green, blue] = channels_mut(light, stride);
        let into = red.iter_mut().zip(&mut *green).zip(&mut *blue);
        for (pixel, ((red, green), blue)) in pixels.chunks_exact(all).zip(into) {
            [*red, *green, *blue] = pixel[layer].to_array();
        }
        for channel in [red, green, blue] {
            channel[width..].fill(0.0);
        }
    }
}

/// The channels of a line of one layer.
pub fn channels(light: &[f32]) -> [&[f32]; 3] {
    let stride = light.len() / 3;
    [0, 1, 2].map(|channel| &light[channel * stride..][..stride])
}

/// The channels of a layer in a line, for writing.
pub fn channels_mut(light: &mut [f32], stride: usize) -> [&mut [f32]; 3] {
    let (red, rest) = light.split_at_mut(stride);
    let (green, blue) = rest.split_at_mut(stride);
    [red, green, blue]
}
