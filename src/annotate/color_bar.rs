//! The colours of a map, with the numbers that they stand for.

use super::block::{MarkBlock, PanelPosition, width_of};
use super::painter::Painter;
use super::style::Pen;
use super::ticks::{Tick, spaced_ticks, ticks};
use crate::appearance::texture::{ColorMap, DataScale, SharedAsset};
use crate::base::math::DVec2;
use crate::drawing::{Ink, Mark};
use crate::encode::Template;
use crate::track::Animated;

/// The legend of a texture that shows numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct ColorBar {
    pub map: SharedAsset<ColorMap>,
    /// The numbers at the ends of the map.
    pub range: [f64; 2],
    pub scale: DataScale,
    pub title: Animated<Template>,
    pub position: PanelPosition,
    /// Whether it stands, with its low end at the bottom.
    pub upright: bool,
    /// Relative to the height of the picture if it stands, else to the width.
    pub length: f64,
    /// Relative to the height of the picture.
    pub thickness: f64,
    /// Ticks at most.
    pub ticks: usize,
}

/// Space between the bar, its ticks and their numbers, relative to the height of letters.
const GAP: f64 = 0.3;

impl ColorBar {
    pub(super) fn paint(&self, painter: &mut Painter<'_>) {
        let view = painter.view;
        let title = painter.expand(&self.title.at(view.time));
        let thickness = (self.thickness * view.height()).round().max(3.0);
        let whole = if self.upright { view.height() } else { view.width() };
        let length = (self.length * whole).round().max(8.0);
        let block = match self.upright {
            true => self.standing(&painter.pen, &title, DVec2::new(thickness, length)),
            false => self.lying(&painter.pen, &title, DVec2::new(length, thickness)),
        };
        painter.put(block, self.position);
    }

    fn colors(&self) -> Vec<[f64; 3]> {
        self.map.steps().iter().map(|color| Ink::new(*color, 1.0).color).collect()
    }

    /// A bar whose top left corner is at a point, with its frame.
    fn bar(&self, block: &mut MarkBlock, pen: &Pen, corner: DVec2, size: DVec2) {
        let frame = Mark::frame(corner, corner + size, pen.width, pen.ink);
        if let Some(halo) = pen.halo {
            let width = pen.width + 2.0 * pen.halo_width();
            block.marks.push(Mark::frame(corner, corner + size, width, halo.faded(0.6)));
        }
        block.marks.push(frame);
        let place = [corner.x as i64, corner.y as i64, size.x as i64, size.y as i64];
        block.marks.push(Mark::Steps { place, colors: self.colors(), upwards: self.upright, opacity: 1.0 });
    }

    /// Numbers to the right of the bar, and the title above.
    fn standing(&self, pen: &Pen, title: &str, size: DVec2) -> MarkBlock {
        let most = ((size.y / (1.4 * pen.size)) as usize).clamp(1, self.ticks);
        let ticks = ticks(self.scale, self.range, most);
        let gap = GAP * pen.size;
        let mut block = MarkBlock::default();
        let title_lines = title.lines().count() as f64;
        title.lines().enumerate().for_each(|(index, line)| {
            block.text(pen, line, DVec2::new(0.0, index as f64 * pen.size));
        });
        // Half a number sticks out above the bar.
        let top = (title_lines * pen.size + 0.5 * pen.size + gap).round();
        let inset = pen.width.ceil();
        let end = inset + size.x;
        let place = |tick: &Tick| top + (1.0 - tick.share) * size.y;
        block.strokes(pen, ticks.iter().map(|tick| tick_line([end, place(tick)], [gap, 0.0])).collect());
        // Over the halos of the ticks.
        self.bar(&mut block, pen, DVec2::new(inset, top), size);
        let mut width = width_of(pen, title);
        for tick in &ticks {
            let left = end + 2.0 * gap;
            block.text(pen, &tick.label, DVec2::new(left, place(tick) - 0.5 * pen.size));
            width = width.max(left + width_of(pen, &tick.label));
        }
        block.size = DVec2::new(width, top + size.y + 0.5 * pen.size);
        block
    }

    /// Numbers below the bar, and the title above.
    fn lying(&self, pen: &Pen, title: &str, size: DVec2) -> MarkBlock {
        let gap = GAP * pen.size;
        let extent = |label: &str| width_of(pen, label) + pen.size;
        let ticks = spaced_ticks((self.scale, self.range), self.ticks, size.x, extent);
        let mut block = MarkBlock::default();
        title.lines().enumerate().for_each(|(index, line)| {
            block.text(pen, line, DVec2::new(0.0, index as f64 * pen.size));
        });
        let out = |tick: Option<&Tick>, share: f64| {
            tick.map_or(0.0, |tick| 0.5 * width_of(pen, &tick.label) - (tick.share - share).abs() * size.x)
        };
        let left = out(ticks.first(), 0.0).max(pen.width).ceil();
        let right = out(ticks.last(), 1.0).max(pen.width).ceil();
        let top = (title.lines().count() as f64 * pen.size + gap).round();
        let end = top + size.y;
        let place = |tick: &Tick| left + tick.share * size.x;
        block.strokes(pen, ticks.iter().map(|tick| tick_line([place(tick), end], [0.0, gap])).collect());
        // Over the halos of the ticks.
        self.bar(&mut block, pen, DVec2::new(left, top), size);
        for tick in &ticks {
            let start = place(tick) - 0.5 * width_of(pen, &tick.label);
            block.text(pen, &tick.label, DVec2::new(start, end + 1.2 * gap));
        }
        let width = width_of(pen, title).max(left + size.x + right);
        block.size = DVec2::new(width, end + 1.2 * gap + pen.size);
        block
    }
}

fn tick_line(from: [f64; 2], by: [f64; 2]) -> Vec<DVec2> {
    let from = DVec2::from_array(from);
    vec![from, from + DVec2::from_array(by)]
}
