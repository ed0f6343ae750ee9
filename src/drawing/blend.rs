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
                lay(canvas, &path::fill(outlines, size, scratch), ink.opacity, |_, _| ink.color);
            }
            Self::Stroke { lines, width, ink } => {
                lay(canvas, &path::stroke(lines, *width, size, scratch), ink.opacity, |_, _| ink.color);
            }
            Self::Text(text) => {
                let line = text.placed();
                if let Some(halo) = text.halo {
                    let border = line.halo(halo.width as f32, size);
                    lay(canvas, &border, halo.ink.opacity, |_, _| halo.ink.color);
                }
                lay(canvas, &line.letters(size), text.ink.opacity, |_, _| text.ink.color);
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
                let of = if *upwards { height } else { width };
                // The colours at the middle of the pixels.
                let step =
                    |along: usize| colors[((2 * along + 1) * colors.len() / (2 * of)).min(colors.len() - 1)];
                if !colors.is_empty() {
                    let steps: Vec<_> = (0..of).map(step).collect();
                    let at = |x: usize, y: usize| if *upwards { steps[height - 1 - y] } else { steps[x] };
                    lay(canvas, &covered, *opacity, at);
                }
            }
            Self::Image { image, place, opacity } => {
                let (covered, colors) = image.scaled(*place, size);
                let width = covered.width;
                lay(canvas, &covered, *opacity, |x, y| colors[y * width + x]);
            }
        }
    }
}

/// Lays ink where a mark covers pixels of the canvas. `color` gets the place of a pixel in the coverage.
fn lay(
    canvas: &mut impl Canvas,
    covered: &CoverageMask,
    opacity: f64,
    color: impl Fn(usize, usize) -> [f64; 3],
) {
    let (width, height) = canvas.size();
    let within = |start: i64, length: usize, end: u32| {
        let first = (-start).clamp(0, length as i64) as usize;
        let last = (i64::from(end) - start).clamp(0, length as i64) as usize;
        first..last.max(first)
    };
    let columns = within(covered.left, covered.width, width);
    if columns.is_empty() {
        return;
    }
    let left = (covered.left + columns.start as i64) as usize;
    for y in within(covered.top, covered.height, height) {
        let first = (covered.top + y as i64) as usize * width as usize + left;
        let start = y * covered.width + columns.start;
        for (x, value) in covered.values[start..start + columns.len()].iter().enumerate() {
            let coverage = f64::from(*value) * opacity;
            if coverage > 0.0 {
                canvas.blend(first + x, color(columns.start + x, y), coverage);
            }
        }
    }
}
