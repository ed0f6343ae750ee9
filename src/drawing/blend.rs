//! Ink on canvases.

use super::coverage::CoverageMask;
use super::layer::Layer;
use super::mark::{Drawing, Mark};
use super::path;
use zeno::Scratch;

/// What takes ink: a picture, or a layer.
pub trait Canvas {
    /// Width and height in pixels.
    fn size(&self) -> (u32, u32);

    /// Lays a colour, as display values in 0..=1, over the pixel of an index. `opacity` is above 0.
    fn blend(&mut self, pixel: usize, color: [f64; 3], opacity: f64);
}

impl Drawing {
    /// Draws all marks in their order.
    pub fn draw(&self, canvas: &mut impl Canvas) {
        let mut scratch = Scratch::new();
        self.marks.iter().for_each(|mark| mark.draw(canvas, &mut scratch));
    }
}

impl Mark {
    fn draw(&self, canvas: &mut impl Canvas, scratch: &mut Scratch) {
        let size = canvas.size();
        match self {
            Self::Fill { outlines, ink } => {
                lay(canvas, &path::fill(outlines, size, scratch), ink.opacity, |_| ink.color);
            }
            Self::Stroke { lines, width, ink } => {
                lay(canvas, &path::stroke(lines, *width, size, scratch), ink.opacity, |_| ink.color);
            }
            Self::Text(text) => {
                let line = text.placed();
                if let Some(halo) = text.halo {
                    let border = line.border(halo.width as f32, size, scratch);
                    lay(canvas, &border, halo.ink.opacity, |_| halo.ink.color);
                }
                lay(canvas, &line.letters(size), text.ink.opacity, |_| text.ink.color);
            }
            Self::Group { marks, opacity } => {
                let mut layer = Layer::new(size);
                marks.iter().for_each(|mark| mark.draw(&mut layer, scratch));
                layer.lay(canvas, *opacity);
            }
            Self::Steps { place: [left, top, width, height], colors, upwards, opacity } => {
                let (width, height) = ((*width).max(0) as usize, (*height).max(0) as usize);
                let values = vec![1.0; width * height];
                let covered = CoverageMask { left: *left, top: *top, width, height, values };
                let step = |index: usize| {
                    let (along, of) = match upwards {
                        true => (height - 1 - index / width, height),
                        false => (index % width, width),
                    };
                    // The colour at the middle of the pixel.
                    let step = (2 * along + 1) * colors.len() / (2 * of);
                    colors[step.min(colors.len() - 1)]
                };
                if !colors.is_empty() {
                    lay(canvas, &covered, *opacity, step);
                }
            }
            Self::Image { image, place, opacity } => {
                let (covered, colors) = image.scaled(*place, size);
                lay(canvas, &covered, *opacity, |index| colors[index]);
            }
        }
    }
}

/// Lays ink where a mark covers pixels of the canvas. `color` gets the index of a pixel of the coverage.
fn lay(canvas: &mut impl Canvas, covered: &CoverageMask, opacity: f64, color: impl Fn(usize) -> [f64; 3]) {
    let (width, height) = canvas.size();
    let within = |start: i64, length: usize, end: u32| {
        let first = (-start).clamp(0, length as i64) as usize;
        let last = (i64::from(end) - start).clamp(0, length as i64) as usize;
        first..last.max(first)
    };
    for y in within(covered.top, covered.height, height) {
        let row = (covered.top + y as i64) as usize * width as usize;
        for x in within(covered.left, covered.width, width) {
            let index = y * covered.width + x;
            let coverage = f64::from(covered.values[index]) * opacity;
            if coverage > 0.0 {
                canvas.blend(row + (covered.left + x as i64) as usize, color(index), coverage);
            }
        }
    }
}
