//! Plots of series of points on logarithmic axes, as SVG and as pixels.

mod scale;

use crate::drawing::FONT_FILE;
use crate::encode::Picture;
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

/// The size of a plot, in pixels.
const SIZE: (u32, u32) = (860, 500);
/// The font that plots are laid out with. Browsers use their own.
const FONT: &str = "sans-serif";
const INK: RGBColor = RGBColor(40, 44, 52);
const GRID: RGBColor = RGBColor(228, 230, 234);
const BEHIND: RGBColor = RGBColor(150, 154, 162);
/// Colours that most people with colour blindness can distinguish (Okabe and Ito 2008).
const COLORS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
];

/// Whether the font could be registered. Plots cannot be laid out without it.
static REGISTERED: LazyLock<bool> =
    LazyLock::new(|| register_font(FONT, FontStyle::Normal, FONT_FILE).is_ok());

/// A plot. All values are above zero.
#[derive(Clone, Debug)]
pub struct Plot {
    pub title: String,
    pub x: Scale,
    pub y: Scale,
    pub series: Vec<Series>,
    /// A wide grey line behind the series.
    pub behind: Vec<(f64, f64)>,
    /// A ring around a point, and its label in the legend.
    pub ring: Option<((f64, f64), &'static str)>,
    pub legend: Legend,
}

/// The label of an axis, and the format of its values.
#[derive(Clone, Copy, Debug)]
pub struct Scale {
    pub name: &'static str,
    pub label: fn(f64) -> String,
}

/// Points that are joined by a line.
#[derive(Clone, Debug)]
pub struct Series {
    pub name: String,
    /// The index of its colour, modulo the number of colours.
    pub color: usize,
    pub points: Vec<DataPoint>,
}

/// A point with an error bar from `low` to `high`, and its label.
#[derive(Clone, Debug)]
pub struct DataPoint {
    pub x: f64,
    pub y: f64,
    pub low: f64,
    pub high: f64,
    pub label: String,
}

/// The corner with the legend.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Legend {
    UpperLeft,
    #[default]
    UpperRight,
}

/// Why a plot could not be drawn.
#[derive(Debug)]
pub struct PlotError(String);

impl fmt::Display for PlotError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "cannot draw a plot: {}", self.0)
    }
}

impl Error for PlotError {}

impl Plot {
    /// The plot as SVG, for a page or a file.
    pub fn svg(&self) -> Result<String, PlotError> {
        let mut text = String::new();
        let area = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        self.draw(&area)?;
        drop(area);
        // A name for screen readers.
        Ok(text.replacen("<svg ", &format!("<svg role=\"img\" aria-label=\"{}\" ", self.title), 1))
    }

    /// The plot as a raster picture.
    pub fn image(&self) -> Result<Picture, PlotError> {
        let mut rgb = vec![0; (SIZE.0 * SIZE.1 * 3) as usize];
        let area = BitMapBackend::with_buffer(&mut rgb, SIZE).into_drawing_area();
        self.draw(&area)?;
        drop(area);
        Ok(Picture::opaque(SIZE.0, SIZE.1, rgb))
    }

    fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> Result<(), PlotError>
    where
        B::ErrorType: 'static,
    {
        if !*REGISTERED {
            return Err(PlotError("the font cannot be read".to_owned()));
        }
        self.drawn(area).map_err(|error| PlotError(error.to_string()))
    }

    fn drawn<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> Result<(), Box<dyn Error>>
    where
        B::ErrorType: 'static,
    {
        let points = || self.series.iter().flat_map(|curve| &curve.points);
        let (xs, ys) = (range(points().map(|point| point.x)), range(points().map(|point| point.y)));
        let (x_ticks, y_ticks) = (ticks(&xs), ticks(&ys));
        area.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(area)
            .caption(&self.title, text(20))
            .margin(14)
            .x_label_area_size(46)
            .y_label_area_size(78)
            .build_cartesian_2d(
                xs.log_scale().with_key_points(x_ticks.clone()),
                ys.clone().log_scale().with_key_points(y_ticks.clone()),
            )?;
        chart
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
        chart.draw_series(LineSeries::new(self.behind.iter().copied(), BEHIND.stroke_width(6)))?;
        self.series.iter().try_for_each(|curve| curve.draw(&mut chart, &ys))?;
        self.draw_ring(&mut chart)?;
        self.legend.draw(&mut chart)?;
        area.present()?;
        Ok(())
    }

    /// Draws the ring, with its entry in the legend.
    fn draw_ring<'a, B: DrawingBackend + 'a, X: RealAxis, Y: RealAxis>(
        &self,
        chart: &mut PlotArea<'a, B, X, Y>,
    ) -> Result<(), DrawError<B>> {
        let Some((at, name)) = self.ring else { return Ok(()) };
        chart
            .draw_series([Circle::new(at, 9, INK.stroke_width(2))])?
            .label(name)
            .legend(|(x, y)| Circle::new((x + 11, y), 6, INK.stroke_width(2)));
        Ok(())
    }
}

/// The drawing context of a plot, and its errors.
type PlotArea<'a, B, X, Y> = ChartContext<'a, B, Cartesian2d<X, Y>>;
type DrawError<B> = DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>;

/// An axis of real numbers.
trait RealAxis: Ranged<ValueType = f64> {}

impl<T: Ranged<ValueType = f64>> RealAxis for T {}

impl Series {
    /// Draws the line, the error bars, which are clipped to the axis, and the points with their labels.
    fn draw<'a, B: DrawingBackend + 'a, X: RealAxis, Y: RealAxis>(
        &self,
        chart: &mut PlotArea<'a, B, X, Y>,
        ys: &Range<f64>,
    ) -> Result<(), DrawError<B>> {
        let color = COLORS[self.color % COLORS.len()];
        let line = LineSeries::new(self.points.iter().map(|point| (point.x, point.y)), color.stroke_width(2));
        chart
            .draw_series(line)?
            .label(&self.name)
            .legend(move |(x, y)| PathElement::new(vec![(x, y), (x + 22, y)], color.stroke_width(3)));
        let reach = |y: f64| y.clamp(ys.start, ys.end);
        let bars = self.points.iter().filter(|point| point.low < point.high).map(|point| {
            let ends = vec![(point.x, reach(point.low)), (point.x, reach(point.high))];
            PathElement::new(ends, color.stroke_width(1))
        });
        chart.draw_series(bars)?;
        let point = |point: &DataPoint| Circle::new((point.x, point.y), 4, color.filled());
        chart.draw_series(self.points.iter().map(point))?;
        let style = (FONT, 13).into_font().color(&color);
        chart.draw_series(self.points.iter().map(|point| {
            EmptyElement::at((point.x, point.y)) + Text::new(point.label.clone(), (9, -17), style.clone())
        }))?;
        Ok(())
    }
}

impl Legend {
    fn draw<'a, B: DrawingBackend + 'a, X: RealAxis, Y: RealAxis>(
        self,
        chart: &mut PlotArea<'a, B, X, Y>,
    ) -> Result<(), DrawError<B>> {
        let position = match self {
            Self::UpperLeft => SeriesLabelPosition::UpperLeft,
            Self::UpperRight => SeriesLabelPosition::UpperRight,
        };
        chart
            .configure_series_labels()
            .position(position)
            // Fonts of browsers may be a little wider.
            .margin(18)
            .background_style(WHITE.mix(0.85))
            .border_style(GRID)
            .label_font(text(14))
            .draw()
    }
}

/// Text of a size in pixels.
fn text(size: i32) -> TextStyle<'static> {
    (FONT, size).into_font().color(&INK)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot() -> Plot {
        let point =
            |x: f64, y: f64| DataPoint { x, y, low: y / 2.0, high: y * 2.0, label: format!("at {x}") };
        let curve = |name: &str, color| Series {
            name: name.to_owned(),
            color,
            points: vec![point(1.0, 1.0), point(100.0, 20.0)],
        };
        let scale = |name| Scale { name, label: |value| format!("{value:.0} units") };
        Plot {
            title: "How it grows".to_owned(),
            x: scale("workers"),
            y: scale("speed-up"),
            series: vec![curve("first", 0), curve("second", COLORS.len() + 1)],
            behind: vec![(1.0, 1.0), (20.0, 20.0)],
            ring: Some(((1.0, 1.0), "the own one")),
            legend: Legend::UpperLeft,
        }
    }

    #[test]
    fn plots_have_titles_and_labels() {
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
