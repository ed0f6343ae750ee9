//! A line with the length that it has in the world.

use super::anchor::Anchor;
use super::block::{MarkBlock, PanelPosition, width_of};
use super::painter::Painter;
use super::ticks::ticks;
use crate::appearance::texture::DataScale;
use crate::base::math::DVec2;
use crate::camera::Projection;

/// A scale, exact for orthographic cameras, and for perspective ones at a depth.
#[derive(Clone, Debug, PartialEq)]
pub struct ScaleBar {
    pub position: PanelPosition,
    /// Its length in world units; a round one if it is not given.
    pub length: Option<f64>,
    /// The point at whose depth a perspective camera has this scale.
    pub at: Option<Anchor>,
    pub unit: String,
}

/// The longest bar without a given length, relative to the width of the picture.
const LONGEST: f64 = 0.25;

impl ScaleBar {
    /// World units per pixel. None if nothing is in front of the camera at the depth.
    fn pixel(&self, painter: &Painter<'_>) -> Option<f64> {
        let view = painter.view;
        let half_height = match view.camera.projection {
            Projection::Orthographic { half_height } => half_height,
            Projection::Perspective { half_height } => {
                let depth = view.camera.project(self.at.as_ref()?.world(view, view.time)?).depth;
                half_height * depth
            }
        };
        (half_height > 0.0).then(|| 2.0 * half_height / view.height())
    }

    pub(super) fn paint(&self, painter: &mut Painter<'_>) {
        let Some(pixel) = self.pixel(painter) else { return };
        let (view, pen) = (painter.view, painter.pen.clone());
        let pen = &pen;
        let longest = LONGEST * view.width() * pixel;
        let round = || ticks(DataScale::Linear, [0.0, longest], 3).pop();
        let (length, number) = match (self.length, round()) {
            (Some(length), _) => (length, format!("{length}")),
            (None, Some(tick)) if tick.value > 0.0 => (tick.value, tick.label),
            _ => return,
        };
        let text = if self.unit.is_empty() { number } else { format!("{number} {}", self.unit) };
        let width = length / pixel;
        let letters = width_of(pen, &text);
        let whole = width.max(letters);
        let mut block = MarkBlock::default();
        block.text(pen, &text, DVec2::new(0.5 * (whole - letters), 0.0));
        let (left, top, down) = (0.5 * (whole - width), 1.4 * pen.size, 0.3 * pen.size);
        let end = |x: f64| vec![DVec2::new(x, top - down), DVec2::new(x, top + down)];
        let line = vec![DVec2::new(left, top), DVec2::new(left + width, top)];
        block.strokes(pen, vec![line, end(left), end(left + width)]);
        block.size = DVec2::new(whole, top + down);
        painter.put(block, self.position);
    }
}
