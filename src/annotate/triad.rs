//! The directions of the axes, which turn with the camera.

use super::block::{MarkBlock, PanelPosition, text_mark, width_of};
use super::painter::Painter;
use crate::base::color::Rgb;
use crate::base::math::{Basis, DVec2};
use crate::drawing::{Ink, Mark};

#[derive(Clone, Debug, PartialEq)]
pub struct Triad {
    pub position: PanelPosition,
    /// The length of an axis in heights of the picture.
    pub length: f64,
}

/// Red, green and blue for x, y and z, bright enough for dark pictures.
const COLORS: [Rgb; 3] = [Rgb::new(0.84, 0.06, 0.06), Rgb::new(0.07, 0.55, 0.07), Rgb::new(0.1, 0.22, 1.0)];
const NAMES: [&str; 3] = ["x", "y", "z"];

impl Triad {
    pub(super) fn paint(&self, painter: &mut Painter<'_>) {
        let (view, pen) = (painter.view, painter.pen.clone());
        let Basis { right, up, forward } = view.camera.basis;
        let length = self.length * view.height();
        // Letters stand beyond the ends.
        let reach = length + 0.9 * pen.size;
        let (middle, size) = (DVec2::splat(reach), DVec2::splat(2.0 * reach));
        let mut axes = [0, 1, 2].map(|axis| (axis, view.axes[axis].dot(forward)));
        // Those that point away are drawn first.
        axes.sort_by(|a, b| b.1.total_cmp(&a.1));
        let mut block = MarkBlock { marks: Vec::new(), size };
        for (axis, _) in axes {
            let direction = DVec2::new(view.axes[axis].dot(right), -view.axes[axis].dot(up));
            let end = middle + direction * length;
            let ink = Ink::new(COLORS[axis], 1.0);
            if let Some(halo) = pen.halo {
                let width = 2.0 * pen.width + 2.0 * pen.halo_width();
                block.marks.push(Mark::lines(vec![vec![middle, end]], width, halo.faded(0.6)));
            }
            block.marks.push(Mark::lines(vec![vec![middle, end]], 2.0 * pen.width, ink));
            let letter = middle + direction * (length + 0.5 * pen.size);
            let half = DVec2::new(width_of(&pen, NAMES[axis]), pen.size) * 0.5;
            block.marks.push(text_mark(&pen, NAMES[axis], letter - half));
        }
        painter.put(block, self.position);
    }
}
