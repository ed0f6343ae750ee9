//! Develops films into the pictures of the page.

use crate::drawing::Drawing;
use crate::encode::{Picture, ToneTable, Tonemap, png_bytes};
use crate::film::Film;
use std::io;

/// Develops films with one tone map.
pub struct Developer {
    tonemap: Tonemap,
    table: ToneTable,
}

impl Developer {
    pub fn new(tonemap: Tonemap) -> Self {
        Self { tonemap, table: ToneTable::new(tonemap) }
    }

    /// The same, or a new one for another tone map.
    pub fn of(known: Option<Self>, tonemap: Tonemap) -> Self {
        known.filter(|known| known.tonemap == tonemap).unwrap_or_else(|| Self::new(tonemap))
    }

    /// The picture of a film with what is drawn over it. Drawings have the full size, so a coarse film is enlarged for
    /// them by its stride.
    pub fn picture(&self, film: &Film, drawing: Option<&Drawing>, stride: u32, size: (u32, u32)) -> Picture {
        let picture = self.table.develop(film).0;
        let Some(drawing) = drawing else { return picture };
        let mut picture = if stride > 1 { enlarged(&picture, stride, size) } else { picture };
        drawing.draw(&mut picture);
        picture
    }
}

/// The picture as a PNG file.
pub fn png(picture: &Picture) -> io::Result<Vec<u8>> {
    png_bytes(picture)
}

/// A picture in which each pixel becomes a square of `stride` pixels.
fn enlarged(picture: &Picture, stride: u32, (width, height): (u32, u32)) -> Picture {
    let source = |x: u32, y: u32| (y / stride * picture.width + x / stride) as usize;
    let places = || (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let rgb = places().flat_map(|(x, y)| picture.rgb.as_chunks::<3>().0[source(x, y)]).collect();
    let alpha = picture.alpha.as_ref().map(|alpha| places().map(|(x, y)| alpha[source(x, y)]).collect());
    Picture { width, height, rgb, alpha }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coarse_pictures_are_enlarged() {
        let picture = Picture { width: 2, height: 1, rgb: vec![1, 2, 3, 4, 5, 6], alpha: Some(vec![7, 8]) };
        let large = enlarged(&picture, 2, (3, 2));
        assert_eq!(large.rgb, [[1, 2, 3, 1, 2, 3, 4, 5, 6]; 2].concat());
        assert_eq!(large.alpha, Some([[7, 7, 8]; 2].concat()));
    }
}
