//! Annotations: labels, colour bars, axes and other marks that explain a frame.
//!
//! In: annotations over time, and the [`FrameView`] of a frame: its camera, its time and the places of its objects.
//! Out: a [`Drawing`](crate::drawing::Drawing) in pixels, which `encode` lays over the developed picture.
//! Uses: `base`, `drawing`, `track`, `camera`, `appearance`, and texts and facts about frames of `encode`.
//!
//! Annotations are not part of the film. So a frame's light is never traced again because an annotation changes, and
//! exposure and tone map do not change their colours.

mod anchor;
mod axes;
mod block;
mod card;
mod color_bar;
mod curve;
mod dimension;
mod label;
mod line;
mod painter;
mod panel;
mod plot;
mod scale_bar;
mod style;
#[cfg(test)]
mod tests;
mod ticks;
mod triad;
mod view;

pub use anchor::{Anchor, ObjectPoint};
pub use axes::{Axes, AxesBox, GridMark, MAX_LINES};
pub use block::{PanelPlace, PanelPosition};
pub use card::Card;
pub use color_bar::ColorBar;
pub use curve::{CurveMark, CurvePoints};
pub use dimension::{AngleArc, Dimension};
pub use label::{Behind, Label, Offset};
pub use line::{HeadStyle, LineMark};
pub use panel::{CaptionText, Logo, ProgressBar};
pub use plot::{LineChart, PlotSeries};
pub use scale_bar::ScaleBar;
pub use style::{Backdrop, Style};
pub use triad::Triad;
pub use view::{FrameView, PlacedObject};

use crate::base::time::Time;
use crate::base::units::counted;
use crate::drawing::Drawing;
use crate::encode::Template;
use crate::track::Animated;
use painter::Painter;
use style::Pen;

/// One annotation over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Annotation {
    pub visible: Animated<bool>,
    /// In 0..=1.
    pub opacity: Animated<f64>,
    pub style: Style,
    /// The numbers that its texts insert.
    pub values: Vec<Animated<f64>>,
    pub kind: AnnotationKind,
}

#[derive(Clone, Debug, PartialEq)]
pub enum AnnotationKind {
    Label(Label),
    Caption(CaptionText),
    Card(Card),
    ColorBar(ColorBar),
    Progress(ProgressBar),
    Image(Logo),
    Plot(LineChart),
    Line(LineMark),
    Curve(CurveMark),
    Dimension(Dimension),
    Angle(AngleArc),
    Axes(Axes),
    Grid(GridMark),
    Triad(Triad),
    ScaleBar(ScaleBar),
}

impl AnnotationKind {
    /// Whether rays decide what is visible of it.
    pub fn needs_rays(&self) -> bool {
        matches!(self, Self::Label(label) if label.behind != Behind::Show)
    }

    /// Whether it is a block at a place of the picture.
    fn is_block(&self) -> bool {
        match self {
            Self::Caption(_) | Self::ColorBar(_) | Self::Progress(_) | Self::Image(_) => true,
            Self::Plot(_) | Self::Triad(_) | Self::ScaleBar(_) => true,
            Self::Label(_) | Self::Card(_) | Self::Line(_) | Self::Curve(_) | Self::Dimension(_) => false,
            Self::Angle(_) | Self::Axes(_) | Self::Grid(_) => false,
        }
    }
}

impl Annotation {
    /// A caption with the usual style in the usual corner.
    pub fn caption(text: Template) -> Self {
        let position = PanelPosition { place: PanelPlace::BottomLeft, offset: Offset::ZERO };
        Self {
            visible: true.into(),
            opacity: 1.0.into(),
            style: Style::of_captions(),
            values: Vec::new(),
            kind: AnnotationKind::Caption(CaptionText { text: text.into(), position }),
        }
    }

    /// The same caption with another text. Other annotations stay as they are.
    pub fn with_text(mut self, text: Template) -> Self {
        if let AnnotationKind::Caption(caption) = &mut self.kind {
            caption.text = text.into();
        }
        self
    }

    /// What is cut off if a caption has more lines than pictures of this height have room for.
    pub fn overflow(&self, height: u32) -> Option<String> {
        let AnnotationKind::Caption(caption) = &self.kind else { return None };
        let pen = Pen::new(&self.style, Time::from_integer(0), height.into());
        let [lines, room] = caption.lines_and_room(&pen, height.into());
        let lines = (lines > room).then(|| counted(lines, "line"))?;
        Some(format!("{lines}; pictures {height} pixels high have room for {room}, and the rest is cut off"))
    }

    /// The letters of its texts that its font lacks. `name` is the name of the sequence.
    pub fn missing_glyphs(&self, name: &str) -> Vec<char> {
        let (templates, texts): (Vec<&Animated<Template>>, Vec<&str>) = match &self.kind {
            AnnotationKind::Label(label) => (vec![&label.text], Vec::new()),
            AnnotationKind::Caption(caption) => (vec![&caption.text], Vec::new()),
            AnnotationKind::Card(card) => (vec![&card.title, &card.text], Vec::new()),
            AnnotationKind::ColorBar(bar) => (vec![&bar.title], Vec::new()),
            AnnotationKind::Plot(plot) => {
                (vec![&plot.title], plot.series.iter().map(|series| series.name.as_str()).collect())
            }
            AnnotationKind::Dimension(dimension) => (vec![&dimension.text], Vec::new()),
            AnnotationKind::Angle(angle) => (vec![&angle.text], Vec::new()),
            AnnotationKind::Axes(axes) => (Vec::new(), axes.titles.iter().map(String::as_str).collect()),
            AnnotationKind::ScaleBar(bar) => (Vec::new(), vec![&bar.unit]),
            AnnotationKind::Progress(_)
            | AnnotationKind::Image(_)
            | AnnotationKind::Line(_)
            | AnnotationKind::Curve(_)
            | AnnotationKind::Grid(_)
            | AnnotationKind::Triad(_) => (Vec::new(), Vec::new()),
        };
        let font = &self.style.font;
        let of_templates = templates
            .into_iter()
            .flat_map(|text| text.values())
            .flat_map(|text| text.missing_glyphs(name, font));
        let mut missing = Vec::new();
        for letter in of_templates.chain(texts.into_iter().flat_map(|text| font.missing_glyphs(text))) {
            if !missing.contains(&letter) {
                missing.push(letter);
            }
        }
        missing
    }

    fn paint(&self, painter: &mut Painter<'_>) {
        match &self.kind {
            AnnotationKind::Label(label) => label.paint(painter),
            AnnotationKind::Caption(caption) => caption.paint(painter),
            AnnotationKind::Card(card) => card.paint(painter),
            AnnotationKind::ColorBar(bar) => bar.paint(painter),
            AnnotationKind::Progress(progress) => progress.paint(painter),
            AnnotationKind::Image(logo) => logo.paint(painter),
            AnnotationKind::Plot(plot) => plot.paint(painter),
            AnnotationKind::Line(line) => line.paint(painter),
            AnnotationKind::Curve(curve) => curve.paint(painter),
            AnnotationKind::Dimension(dimension) => dimension.paint(painter),
            AnnotationKind::Angle(angle) => angle.paint(painter),
            AnnotationKind::Axes(axes) => axes.paint(painter),
            AnnotationKind::Grid(grid) => grid.paint(painter),
            AnnotationKind::Triad(triad) => triad.paint(painter),
            AnnotationKind::ScaleBar(bar) => bar.paint(painter),
        }
    }
}

/// What annotations draw over a frame, in their order.
pub fn drawing(annotations: &[Annotation], view: &FrameView<'_>) -> Drawing {
    let shown: Vec<(&Annotation, f64)> = annotations
        .iter()
        .filter(|annotation| annotation.visible.at(view.time))
        .map(|annotation| (annotation, annotation.opacity.at(view.time)))
        .filter(|(_, opacity)| *opacity > 0.0)
        .collect();
    let mut painter = Painter::new(view);
    // Labels leave room for blocks that are drawn after them. The places of blocks depend on other blocks only.
    if shown.iter().any(|(annotation, _)| matches!(annotation.kind, AnnotationKind::Label(_))) {
        let mut blocks = Painter::new(view);
        shown.iter().filter(|shown| shown.0.kind.is_block()).for_each(|shown| blocks.paint(shown));
        painter.reserve(blocks);
    }
    shown.iter().for_each(|shown| painter.paint(shown));
    Drawing { marks: painter.finish() }
}
