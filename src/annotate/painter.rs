//! The state while the annotations of a frame are drawn one after the other.

use super::Annotation;
use super::block::{MarkBlock, PanelPosition, stroke, text_mark, width_of};
use super::style::Pen;
use super::view::FrameView;
use crate::base::math::DVec2;
use crate::drawing::Mark;
use crate::encode::Template;

/// Space between blocks and the edges of the picture, and around boxes, relative to the height of letters.
const MARGIN: f64 = 0.6;
/// Space between the letters and the edge of their box.
pub const PADDING: f64 = 0.35;

/// Space between the marks of a block and the edge of the picture, in pixels.
pub fn space_around(pen: &Pen) -> f64 {
    (MARGIN + if pen.panel.is_some() { PADDING } else { 0.0 }) * pen.size
}

/// A rectangle: its top left corner and its size.
pub type PixelBox = [DVec2; 2];

/// Whether two rectangles have a point in common besides their edges.
pub fn touch([corner, size]: PixelBox, [other, extent]: PixelBox) -> bool {
    let (behind, before) = (corner.cmpge(other + extent), (corner + size).cmple(other));
    !(behind | before).any()
}

/// The annotations of a frame so far.
pub struct Painter<'a> {
    pub view: &'a FrameView<'a>,
    pub pen: Pen,
    /// The numbers that the texts of the current annotation insert.
    pub values: Vec<f64>,
    marks: Vec<Mark>,
    /// The first mark of the current annotation, and its opacity.
    first: usize,
    opacity: f64,
    /// The rectangles of texts and blocks.
    taken: Vec<PixelBox>,
    /// The rectangles of blocks.
    blocks: Vec<PixelBox>,
    /// The rectangles of all blocks of the frame, of those that are drawn later, too. Labels avoid them.
    reserved: Vec<PixelBox>,
}

impl<'a> Painter<'a> {
    pub fn new(view: &'a FrameView<'a>) -> Self {
        let pen = Pen::new(&super::Style::default(), view.time, view.height());
        Self {
            view,
            pen,
            values: Vec::new(),
            marks: Vec::new(),
            first: 0,
            opacity: 1.0,
            taken: Vec::new(),
            blocks: Vec::new(),
            reserved: Vec::new(),
        }
    }

    /// Draws an annotation with an opacity.
    pub fn paint(&mut self, (annotation, opacity): &(&Annotation, f64)) {
        self.begin(annotation, *opacity);
        annotation.paint(self);
    }

    /// Keeps labels away from the blocks of another painter.
    pub fn reserve(&mut self, other: Self) {
        self.reserved = other.blocks;
    }

    /// Begins an annotation.
    fn begin(&mut self, annotation: &Annotation, opacity: f64) {
        self.fade();
        (self.first, self.opacity) = (self.marks.len(), opacity);
        self.pen = Pen::new(&annotation.style, self.view.time, self.view.height());
        self.values = annotation.values.iter().map(|value| value.at(self.view.time)).collect();
    }

    pub fn finish(mut self) -> Vec<Mark> {
        self.fade();
        self.marks
    }

    /// Applies the opacity of the last annotation to its marks.
    fn fade(&mut self) {
        if self.opacity < 1.0 && self.marks.len() > self.first {
            let marks = self.marks.split_off(self.first);
            self.marks.push(Mark::Group { marks, opacity: self.opacity });
        }
    }

    /// Fades the current annotation more.
    pub fn fade_by(&mut self, part: f64) {
        self.opacity *= part;
    }

    /// A text with its placeholders filled in.
    pub fn expand(&self, template: &Template) -> String {
        template.expand_with(&self.view.info, &self.values)
    }

    pub fn push(&mut self, mark: Mark) {
        self.marks.push(mark);
    }

    /// Adds lines, over a halo if the pen has one.
    pub fn strokes(&mut self, lines: Vec<Vec<DVec2>>) {
        stroke(&mut self.marks, &self.pen, lines);
    }

    /// Adds a line of text around a point: `align` is 0 to its left top, 1 to its right bottom.
    pub fn text_around(&mut self, text: &str, at: DVec2, align: DVec2) {
        let size = DVec2::new(width_of(&self.pen, text), self.pen.size);
        let corner = at - align * size;
        self.taken.push([corner, size]);
        self.marks.push(text_mark(&self.pen, text, corner));
    }

    /// Whether a line of text around a point would lie within the picture and on no other text.
    pub fn has_room_for(&self, text: &str, at: DVec2, align: DVec2) -> bool {
        let size = DVec2::new(width_of(&self.pen, text), self.pen.size);
        let corner = at - align * size;
        self.is_free([corner, size]) && self.view.shows(corner) && self.view.shows(corner + size)
    }

    /// Whether a rectangle touches no text and no block so far.
    pub fn is_free(&self, rectangle: PixelBox) -> bool {
        !self.taken.iter().any(|other| touch(rectangle, *other))
    }

    /// Whether a label has room in a rectangle: it touches no text so far and no block of the frame.
    pub fn is_free_for_labels(&self, rectangle: PixelBox) -> bool {
        self.is_free(rectangle) && !self.reserved.iter().any(|block| touch(rectangle, *block))
    }

    /// Takes a rectangle.
    pub fn take(&mut self, rectangle: PixelBox) {
        self.taken.push(rectangle);
    }

    /// The box behind a rectangle, if the pen has one: with padding.
    pub fn panel(&mut self, [corner, size]: PixelBox) {
        if let Some(ink) = self.pen.panel {
            let padding = DVec2::splat(PADDING * self.pen.size);
            self.marks.push(Mark::rectangle(corner - padding, corner + size + padding, ink));
        }
    }

    /// Puts a block at its position in the picture, or beside the blocks that are there already.
    pub fn put(&mut self, block: MarkBlock, PanelPosition { place, offset }: PanelPosition) {
        let margin = MARGIN * self.pen.size;
        let shares = place.shares();
        let padding = if self.pen.panel.is_some() { PADDING * self.pen.size } else { 0.0 };
        let outer = block.size + 2.0 * padding;
        let whole = DVec2::new(self.view.width(), self.view.height());
        let free = whole - outer - 2.0 * margin;
        let offset = offset.pixels(self.view.height());
        let mut corner = (DVec2::splat(margin) + shares * free + offset).round();
        // Away from the edge, past the blocks that are there. Every round passes at least one of them.
        while let Some([other, extent]) = self.blocks.iter().find(|block| touch([corner, outer], **block)) {
            let beyond = match shares.y {
                1.0 => other.y - outer.y - 0.5 * margin,
                _ => other.y + extent.y + 0.5 * margin,
            };
            corner.y = beyond.round();
        }
        let inner = corner + padding.round();
        self.panel([inner, block.size]);
        self.blocks.push([corner, outer]);
        self.taken.push([corner, outer]);
        self.marks.extend(block.moved(inner));
    }
}
