//! Error against time, on logarithmic axes: a curve per setting, as SVG and as pixels.

use super::scale::{range, ticks};
use crate::accuracy::findings::{percent, seconds};
use crate::accuracy::measure::{Measured, Point};
use crate::accuracy::settings::Axis;
use crate::accuracy::statistics::Estimate;
use crate::encode::{FONT_FILE, Picture};
use plotters::coord::Shift;
use plotters::coord::ranged1d::Ranged;
use plotters::drawing::DrawingAreaErrorKind;
use plotters::prelude::*;
use plotters::style::register_font;
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
const FRONT: RGBColor = RGBColor(150, 154, 162);
/// Told apart by most people who see colours differently (Okabe and Ito 2008).
const COLORS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(0, 114, 178),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
];

/// Whether the font is there. Without it plots could not be laid out.
static REGISTERED: LazyLock<bool> =
    LazyLock::new(|| register_font(FONT, FontStyle::Normal, FONT_FILE).is_ok());

/// A plot: what it shows, and where its curves run.
#[derive(Clone, Debug)]
pub struct Chart {
    /// For the names of files.
    pub name: &'static str,
    pub title: String,
    /// What a reader should look for.
    pub caption: String,
    x: &'static str,
    y: &'static str,
    curves: Vec<Curve>,
    own: Option<(f64, f64)>,
    front: Vec<(f64, f64)>,
    is_share: bool,
}

#[derive(Clone, Debug)]
struct Curve {
    axis: Axis,
    spots: Vec<Spot>,
}

#[derive(Clone, Debug)]
struct Spot {
    x: f64,
    y: f64,
    low: f64,
    high: f64,
    label: String,
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

/// All plots of a measurement: those that have something to show.
pub fn charts(measured: &Measured) -> Vec<Chart> {
    let mut all = Vec::from(errors(measured));
    all.push(bounces(measured));
    all.retain(|chart| chart.curves.iter().any(|curve| curve.spots.len() > 1));
    all
}

/// The errors of all that takes samples, as three ways to measure them see them.
fn errors(measured: &Measured) -> [Chart; 3] {
    let brightness = measured.brightness;
    let axes = [Axis::Samples, Axis::Independent, Axis::Noise, Axis::Antialias];
    [
        Chart::new(
            measured,
            "error",
            "Error of the light against time",
            (
                "RMSE, as a share of the mean brightness",
                "How far the light of a pixel is from what it should be, typically; 5 % would be a twentieth of the picture's \
                 mean brightness.",
            ),
            &axes,
            move |point| point.squared.root().map(|error| error / brightness),
        ),
        Chart::new(
            measured,
            "relative",
            "Error relative to each pixel against time",
            (
                "root of relMSE",
                "The same as a share of each pixel's own brightness, so that dark parts count as much as bright ones.",
            ),
            &axes,
            |point| point.relative.root(),
        ),
        Chart::new(
            measured,
            "flip",
            "What an eye sees against time",
            (
                "FLIP",
                "How different the displayed picture looks to someone who flips between it and what it should be: 0 is no \
                 difference.",
            ),
            &axes,
            |point| point.flip,
        ),
    ]
}

/// What is left out with fewer bounces.
fn bounces(measured: &Measured) -> Chart {
    let chart = Chart::new(
        measured,
        "bounces",
        "What each bounce adds, against its time",
        ("light left out, as a share of the mean brightness", ""),
        &[Axis::Bounces],
        |point| {
            let bias = point.bias.max(0.0).sqrt() / measured.brightness;
            Estimate { mean: bias, low: bias, high: bias }
        },
    );
    let caption = "Each point is a number of bounces; its error is what shorter chains of reflections leave out, without \
        noise. Points without any error left stand nowhere on a logarithmic axis.";
    Chart { caption: caption.to_owned(), front: Vec::new(), own: None, ..chart }
}

impl Chart {
    fn new(
        measured: &Measured,
        name: &'static str,
        title: &str,
        (y, meaning): (&'static str, &str),
        axes: &[Axis],
        error: impl Fn(&Point) -> Estimate,
    ) -> Self {
        let spot = |point: &Point| {
            let Estimate { mean, low, high } = error(point);
            Spot { x: point.wall.median, y: mean, low, high, label: point.setting.value.clone() }
        };
        let shown = |spot: &Spot| spot.y > 0.0 && spot.y.is_finite();
        let curve = |&axis: &Axis| {
            let mut on = measured.on(axis);
            match axis {
                Axis::Noise => {}
                Axis::Bounces => on.sort_by_key(|point| point.setting.quality.bounces),
                _ => on.sort_by(|a, b| a.samples.total_cmp(&b.samples)),
            }
            Curve { axis, spots: on.into_iter().map(spot).filter(shown).collect() }
        };
        let front = measured.front(|point| error(point).mean);
        let front = front.iter().map(|point| (point.wall.median, error(point).mean)).filter(|at| at.1 > 0.0);
        let own = measured.own();
        let own = (own.wall.median, error(own).mean);
        Self {
            name,
            title: title.to_owned(),
            caption: format!(
                "{meaning} Further left is faster, further down is better: what no other point beats in both lies on the \
                grey line. The ring is the file's own setting; numbers at points are settings."
            ),
            x: "time for a frame",
            y,
            curves: axes.iter().map(curve).filter(|curve| !curve.spots.is_empty()).collect(),
            own: (own.1 > 0.0).then_some(own),
            front: front.collect(),
            is_share: name != "flip",
        }
    }

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
        let is_share = self.is_share;
        let share = move |value: &f64| if is_share { percent(*value) } else { format!("{value:.3}") };
        plane
            .configure_mesh()
            .bold_line_style(GRID)
            .light_line_style(TRANSPARENT)
            .axis_style(INK)
            .x_desc(self.x)
            .y_desc(self.y)
            .x_labels(x_ticks.len())
            .y_labels(y_ticks.len())
            .x_label_formatter(&|value| seconds(*value))
            .y_label_formatter(&share)
            .label_style(text(14))
            .axis_desc_style(text(15))
            .draw()?;
        plane.draw_series(LineSeries::new(self.front.iter().copied(), FRONT.stroke_width(6)))?;
        self.curves.iter().try_for_each(|curve| curve.draw(&mut plane, &ys))?;
        self.draw_own(&mut plane)?;
        legend(&mut plane)?;
        area.present()?;
        Ok(())
    }

    /// The ring around the file's own setting.
    fn draw_own<'a, B: DrawingBackend + 'a, X: Along, Y: Along>(
        &self,
        plane: &mut Plane<'a, B, X, Y>,
    ) -> Result<(), Fault<B>> {
        let Some(own) = self.own else { return Ok(()) };
        plane
            .draw_series([Circle::new(own, 9, INK.stroke_width(2))])?
            .label("the file's own")
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
        let color = COLORS[self.axis as usize];
        let line = LineSeries::new(self.spots.iter().map(|spot| (spot.x, spot.y)), color.stroke_width(2));
        plane
            .draw_series(line)?
            .label(self.axis.name())
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

/// Which curve is which.
fn legend<'a, B: DrawingBackend + 'a, X: Along, Y: Along>(
    plane: &mut Plane<'a, B, X, Y>,
) -> Result<(), Fault<B>> {
    plane
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        // Browsers lay text out a little wider.
        .margin(18)
        .background_style(WHITE.mix(0.85))
        .border_style(GRID)
        .label_font(text(14))
        .draw()
}

/// Text of so many pixels.
fn text(size: i32) -> TextStyle<'static> {
    (FONT, size).into_font().color(&INK)
}
