//! Layers: marks apart from the picture, to be laid over it as a whole.

use super::blend::Canvas;

/// The side of a tile in pixels.
const TILE: usize = 16;

/// A layer in the size of a picture. Memory is used where something is drawn.
pub struct Layer {
    size: (u32, u32),
    /// Rows of tiles of pixels: display values premultiplied by alpha, and alpha.
    tiles: Vec<Option<Box<[[f64; 4]; TILE * TILE]>>>,
}

impl Layer {
    pub fn new(size: (u32, u32)) -> Self {
        let [columns, rows] = [size.0, size.1].map(|side| (side as usize).div_ceil(TILE));
        Self { size, tiles: vec![None; columns * rows] }
    }

    /// The tile of a pixel, and the pixel's place in it.
    fn place(&self, pixel: usize) -> (usize, usize) {
        let width = self.size.0 as usize;
        let (x, y) = (pixel % width, pixel / width);
        (y / TILE * width.div_ceil(TILE) + x / TILE, y % TILE * TILE + x % TILE)
    }

    /// Red, green, blue and alpha of a pixel: display values premultiplied by alpha, and alpha.
    pub fn pixel(&self, pixel: usize) -> [f64; 4] {
        let (tile, place) = self.place(pixel);
        self.tiles[tile].as_ref().map_or([0.0; 4], |tile| tile[place])
    }

    /// Lays the whole layer over a canvas of the same size.
    pub fn lay(&self, canvas: &mut impl Canvas, opacity: f64) {
        let (width, height) = (self.size.0 as usize, self.size.1 as usize);
        let columns = width.div_ceil(TILE);
        for (index, tile) in self.tiles.iter().enumerate() {
            let Some(tile) = tile else { continue };
            let (left, top) = (index % columns * TILE, index / columns * TILE);
            for (place, [r, g, b, alpha]) in tile.iter().enumerate() {
                let (x, y) = (left + place % TILE, top + place / TILE);
                if *alpha > 0.0 && x < width && y < height {
                    let color = [r, g, b].map(|part| (part / alpha).min(1.0));
                    canvas.blend(y * width + x, color, alpha * opacity);
                }
            }
        }
    }
}

impl Canvas for Layer {
    fn size(&self) -> (u32, u32) {
        self.size
    }

    fn blend(&mut self, pixel: usize, [r, g, b]: [f64; 3], opacity: f64) {
        let over = |below: f64, above: f64| above * opacity + below * (1.0 - opacity);
        let (tile, place) = self.place(pixel);
        let tile = self.tiles[tile].get_or_insert_with(|| Box::new([[0.0; 4]; TILE * TILE]));
        let [below_r, below_g, below_b, alpha] = tile[place];
        tile[place] = [over(below_r, r), over(below_g, g), over(below_b, b), over(alpha, 1.0)];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::DVec2;
    use crate::drawing::{Drawing, Ink, Mark};

    /// A layer over a layer.
    fn drawn(marks: Vec<Mark>) -> Layer {
        let mut layer = Layer::new((40, 20));
        Drawing { marks }.draw(&mut layer);
        layer
    }

    #[test]
    fn a_group_fades_as_a_whole() {
        let ink = |color, opacity| Ink { color, opacity };
        let square = |at: f64, ink| Mark::rectangle(DVec2::splat(at), DVec2::splat(at + 10.0), ink);
        let marks = vec![square(2.0, ink([0.0; 3], 1.0)), square(6.0, ink([1.0; 3], 1.0))];
        let group = drawn(vec![Mark::Group { marks, opacity: 0.5 }]);
        let at = |x: usize, y: usize| group.pixel(y * 40 + x);
        assert_eq!(at(3, 3), [0.0, 0.0, 0.0, 0.5]);
        // The first square does not show through the second one.
        assert_eq!(at(8, 8), [0.5, 0.5, 0.5, 0.5]);
        assert_eq!(at(30, 17), [0.0; 4]);
    }
}
