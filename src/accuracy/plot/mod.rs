//! Plots: curves of points on logarithmic axes, as SVG and as pixels.

mod scale;

use crate::encode::{FONT_FILE, Picture};
use plotters::coord::Shift;
use plotters::coord::ranged1d::Ranged;
use plotters::drawing::DrawingAreaErrorKind;
use plotters::prelude::*;
use plotters::style::register_font;
use scale::{range, ticks};
use std::error::Error;
use std::fmt;
use std::ops::Range;
use std::sync::LazyLock;

/// Pixels of a plot.
const SIZE: (u32, u32) = (860, 500);
/// The font that plots are laid out in. Browsers take their own.
const FONT: &str = "sans-serif";
const INK: RGBColor = RGBColor(40, 44, 52);
const GRID: RGBColor = RGBColor(228, 230, 234);
const BEHIND: RGBColor = RGBColor(150, 154, 162);
/// Told apart by most people who see colours differently (Okabe and Ito 2008).
const COLORS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
];

/// Whether the font is there. Without it plots could not be laid out.
static REGISTERED: LazyLock<bool> =
    LazyLock::new(|| register_font(FONT, FontStyle::Normal, FONT_FILE).is_ok());

/// What is drawn. Values are above zero.
#[derive(Clone, Debug)]
pub struct Plot {
    pub title: String,
    pub x: Scale,
    pub y: Scale,
    pub curves: Vec<Curve>,
    /// A wide grey line behind the curves.
    pub behind: Vec<(f64, f64)>,
    /// A ring around a point, and what it stands for.
    pub ring: Option<((f64, f64), &'static str)>,
    pub legend: Legend,
}

/// What stands at an axis, and how its values are written.
#[derive(Clone, Copy, Debug)]
pub struct Scale {
    pub name: &'static str,
    pub label: fn(f64) -> String,
}

/// Points that a line joins.
#[derive(Clone, Debug)]
pub struct Curve {
    pub name: String,
    /// Which of the colours it has; they begin again after the last.
    pub color: usize,
    pub spots: Vec<Spot>,
}

/// A point, how far from it the true value may be, and what is written at it.
#[derive(Clone, Debug)]
pub struct Spot {
    pub x: f64,
    pub y: f64,
    pub low: f64,
    pub high: f64,
    pub label: String,
}

/// The corner that tells which curve is which.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Legend {
    UpperLeft,
    #[default]
    UpperRight,
}

/// Why a plot could not be drawn.
#[derive(Debug)]
pub struct NoPlot(String);

impl fmt::Display for NoPlot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "cannot draw a plot: {}", self.0)
    }
}

impl Error for NoPlot {}

impl Plot {
    /// The plot as SVG, to stand in a page or a file.
    pub fn svg(&self) -> Result<String, NoPlot> {
        let mut text = String::new();
        let area = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        self.draw(&area)?;
        drop(area);
        // Fill the width that there is.
        Ok(text.replacen("<svg ", &format!("<svg role=\"img\" aria-label=\"{}\" ", self.title), 1))
    }

    /// The plot in pixels.
    pub fn image(&self) -> Result<Picture, NoPlot> {
        let mut rgb = vec![0; (SIZE.0 * SIZE.1 * 3) as usize];
        let area = BitMapBackend::with_buffer(&mut rgb, SIZE).into_drawing_area();
        self.draw(&area)?;
        drop(area);
        Ok(Picture::opaque(SIZE.0, SIZE.1, rgb))
    }

    fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> Result<(), NoPlot>
    where
        B::ErrorType: 'static,
    {
        if !*REGISTERED {
            return Err(NoPlot("its font cannot be read".to_owned()));
        }
        self.drawn(area).map_err(|error| NoPlot(error.to_string()))
    }

    fn drawn<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> Result<(), Box<dyn Error>>
    where
        B::ErrorType: 'static,
    {
        let spots = || self.curves.iter().flat_map(|curve| &curve.spots);
        let (xs, ys) = (range(spots().map(|spot| spot.x)), range(spots().map(|spot| spot.y)));
        let (x_ticks, y_ticks) = (ticks(&xs), ticks(&ys));
        area.fill(&WHITE)?;
        let mut plane = ChartBuilder::on(area)
            .caption(&self.title, text(20))
            .margin(14)
            .x_label_area_size(46)
            .y_label_area_size(78)
            .build_cartesian_2d(
                xs.log_scale().with_key_points(x_ticks.clone()),
                ys.clone().log_scale().with_key_points(y_ticks.clone()),
            )?;
        plane
            .configure_mesh()
            .bold_line_style(GRID)
            .light_line_style(TRANSPARENT)
            .axis_style(INK)
            .x_desc(self.x.name)
            .y_desc(self.y.name)
            .x_labels(x_ticks.len())
            .y_labels(y_ticks.len())
            .x_label_formatter(&|value| (self.x.label)(*value))
            .y_label_formatter(&|value| (self.y.label)(*value))
            .label_style(text(14))
            .axis_desc_style(text(15))
            .draw()?;
        plane.draw_series(LineSeries::new(self.behind.iter().copied(), BEHIND.stroke_width(6)))?;
        self.curves.iter().try_for_each(|curve| curve.draw(&mut plane, &ys))?;
        self.draw_ring(&mut plane)?;
        self.legend.draw(&mut plane)?;
        area.present()?;
        Ok(())
    }

    /// The ring, with its line in the legend.
    fn draw_ring<'a, B: DrawingBackend + 'a, X: Along, Y: Along>(
        &self,
        plane: &mut Plane<'a, B, X, Y>,
    ) -> Result<(), Fault<B>> {
        let Some((at, name)) = self.ring else { return Ok(()) };
        plane
            .draw_series([Circle::new(at, 9, INK.stroke_width(2))])?
            .label(name)
            .legend(|(x, y)| Circle::new((x + 11, y), 6, INK.stroke_width(2)));
        Ok(())
    }
}

/// What curves are drawn on, its axes, and what may go wrong.
type Plane<'a, B, X, Y> = ChartContext<'a, B, Cartesian2d<X, Y>>;
type Fault<B> = DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>;

/// An axis of real numbers.
trait Along: Ranged<ValueType = f64> {}

impl<T: Ranged<ValueType = f64>> Along for T {}

impl Curve {
    /// Its line, the bars of its errors and its points with their labels; bars end where the axis does.
    fn draw<'a, B: DrawingBackend + 'a, X: Along, Y: Along>(
        &self,
        plane: &mut Plane<'a, B, X, Y>,
        ys: &Range<f64>,
    ) -> Result<(), Fault<B>> {
        let color = COLORS[self.color % COLORS.len()];
        let line = LineSeries::new(self.spots.iter().map(|spot| (spot.x, spot.y)), color.stroke_width(2));
        plane
            .draw_series(line)?
            .label(&self.name)
            .legend(move |(x, y)| PathElement::new(vec![(x, y), (x + 22, y)], color.stroke_width(3)));
        let reach = |y: f64| y.clamp(ys.start, ys.end);
        let bars = self.spots.iter().filter(|spot| spot.low < spot.high).map(|spot| {
            let ends = vec![(spot.x, reach(spot.low)), (spot.x, reach(spot.high))];
            PathElement::new(ends, color.stroke_width(1))
        });
        plane.draw_series(bars)?;
        let point = |spot: &Spot| Circle::new((spot.x, spot.y), 4, color.filled());
        plane.draw_series(self.spots.iter().map(point))?;
        let style = (FONT, 13).into_font().color(&color);
        plane.draw_series(self.spots.iter().map(|spot| {
            EmptyElement::at((spot.x, spot.y)) + Text::new(spot.label.clone(), (9, -17), style.clone())
        }))?;
        Ok(())
    }
}

impl Legend {
    fn draw<'a, B: DrawingBackend + 'a, X: Along, Y: Along>(
        self,
        plane: &mut Plane<'a, B, X, Y>,
    ) -> Result<(), Fault<B>> {
        let position = match self {
            Self::UpperLeft => SeriesLabelPosition::UpperLeft,
            Self::UpperRight => SeriesLabelPosition::UpperRight,
        };
        plane
            .configure_series_labels()
            .position(position)
            // Browsers lay text out a little wider.
            .margin(18)
            .background_style(WHITE.mix(0.85))
            .border_style(GRID)
            .label_font(text(14))
            .draw()
    }
}

/// Text of so many pixels.
fn text(size: i32) -> TextStyle<'static> {
    (FONT, size).into_font().color(&INK)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot() -> Plot {
        let spot = |x: f64, y: f64| Spot { x, y, low: y / 2.0, high: y * 2.0, label: format!("at {x}") };
        let curve = |name: &str, color| Curve {
            name: name.to_owned(),
            color,
            spots: vec![spot(1.0, 1.0), spot(100.0, 20.0)],
        };
        let scale = |name| Scale { name, label: |value| format!("{value:.0} units") };
        Plot {
            title: "How it grows".to_owned(),
            x: scale("workers"),
            y: scale("speed-up"),
            curves: vec![curve("first", 0), curve("second", COLORS.len() + 1)],
            behind: vec![(1.0, 1.0), (20.0, 20.0)],
            ring: Some(((1.0, 1.0), "the own one")),
            legend: Legend::UpperLeft,
        }
    }

    #[test]
    fn a_plot_says_what_it_shows() {
        let svg = plot().svg().expect("a plot");
        let words =
            ["How it grows", "workers", "speed-up", "first", "second", "the own one", "at 100", "10 units"];
        assert!(words.iter().all(|word| svg.contains(word)), "{svg}");
        assert!(svg.contains("#0072B2") && svg.contains("#D55E00"), "two colours: {svg}");
    }

    #[test]
    fn pixels_show_the_same_as_svg() {
        let image = plot().image().expect("a plot");
        assert_eq!((image.width, image.height), SIZE);
        let shown = |color: RGBColor| image.rgb.chunks(3).any(|pixel| pixel == [color.0, color.1, color.2]);
        assert!(shown(COLORS[0]) && shown(COLORS[1]) && shown(BEHIND) && !shown(COLORS[2]));
    }
}
