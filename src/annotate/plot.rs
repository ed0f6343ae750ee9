//! Line charts of numbers over time, with a marker at the current time.

use super::block::{MarkBlock, PanelPosition, width_of};
use super::painter::Painter;
use super::style::Pen;
use super::ticks::{Tick, rounded_range, ticks};
use crate::appearance::texture::DataScale;
use crate::base::color::Rgb;
use crate::base::math::DVec2;
use crate::base::time::{Fraction, Time};
use crate::drawing::{Ink, Mark};
use crate::encode::Template;
use crate::track::Animated;

#[derive(Clone, Debug, PartialEq)]
pub struct LineChart {
    pub series: Vec<PlotSeries>,
    pub title: Animated<Template>,
    pub position: PanelPosition,
    /// Width and height of the chart without its numbers, relative to the width and the height of the picture.
    pub size: [f64; 2],
    /// The first and the last time that it shows.
    pub times: [Time; 2],
    /// The numbers at its bottom and its top; None for those of the series.
    pub range: Option<[f64; 2]>,
    /// Whether lines end at the current time.
    pub grows: bool,
}

/// A line of a chart.
#[derive(Clone, Debug, PartialEq)]
pub struct PlotSeries {
    /// Empty for none.
    pub name: String,
    pub value: Animated<f64>,
    pub color: Option<Animated<Rgb>>,
    /// Its values at all times that it shows, in seconds: keys, and steps between them.
    pub points: Vec<DVec2>,
}

/// Times between the first and the last at which series without many keys are drawn.
const STEPS: i128 = 240;
/// Keys from which no steps are needed between them.
const MANY_KEYS: usize = 64;

impl PlotSeries {
    pub fn new(name: String, value: Animated<f64>, color: Option<Animated<Rgb>>, times: [Time; 2]) -> Self {
        let span = times[1] - times[0];
        let step = |index: i128| times[0] + span * Time::new(index, STEPS);
        let keys = match &value {
            Animated::Constant(_) => Vec::new(),
            Animated::Keyed(track) => track.keys().iter().map(|key| key.time).collect(),
        };
        let steps = if keys.len() < MANY_KEYS { 0..STEPS + 1 } else { 0..0 };
        let mut all: Vec<Time> = steps.map(step).chain(keys).chain(times).collect();
        all.retain(|time| (times[0]..=times[1]).contains(time));
        all.sort();
        all.dedup();
        let points = all.into_iter().map(|time| DVec2::new(seconds(time), value.at(time))).collect();
        Self { name, value, color, points }
    }
}

/// A time in seconds, rounded once.
fn seconds(time: Time) -> f64 {
    Fraction::new(time, Time::from_integer(1)).value()
}

/// The rectangle of a chart and the numbers at its edges.
struct Chart {
    corner: DVec2,
    size: DVec2,
    times: [f64; 2],
    range: [f64; 2],
}

impl Chart {
    fn place(&self, point: DVec2) -> DVec2 {
        let share = |value, range| DataScale::Linear.share(value, range);
        let (x, y) = (share(point.x, self.times), share(point.y, self.range).clamp(0.0, 1.0));
        self.corner + DVec2::new(x, 1.0 - y) * self.size
    }
}

impl LineChart {
    /// The numbers at the bottom and the top.
    fn whole_range(&self, most: usize) -> [f64; 2] {
        self.range.unwrap_or_else(|| {
            let values = self.series.iter().flat_map(|series| series.points.iter().map(|point| point.y));
            let ends = |[low, high]: [f64; 2], value: f64| [low.min(value), high.max(value)];
            rounded_range(values.fold([f64::INFINITY, f64::NEG_INFINITY], ends), most)
        })
    }

    pub(super) fn paint(&self, painter: &mut Painter<'_>) {
        let (view, pen) = (painter.view, painter.pen.clone());
        let title = painter.expand(&self.title.at(view.time));
        let size = DVec2::new(self.size[0] * view.width(), self.size[1] * view.height()).round();
        let rows = ((size.y / (1.5 * pen.size)) as usize).clamp(1, 5);
        let range = self.whole_range(rows);
        let times = self.times.map(seconds);
        let upward = ticks(DataScale::Linear, range, rows + 1);
        let columns = ((size.x / (2.5 * pen.size)) as usize).clamp(1, 6);
        let onward = ticks(DataScale::Linear, times, columns);
        let widest = upward.iter().map(|tick| width_of(&pen, &tick.label)).fold(0.0, f64::max);
        let gap = 0.3 * pen.size;
        let lines = title.lines().count() as f64;
        let corner = DVec2::new(widest + 2.0 * gap, lines * pen.size + 0.5 * pen.size + gap).round();
        let chart = Chart { corner, size, times, range };
        let mut block = MarkBlock::default();
        if pen.panel.is_none() {
            let ink = pen.ink.contrast(0.45);
            block.marks.push(Mark::rectangle(corner, corner + size, ink));
        }
        title.lines().enumerate().for_each(|(index, line)| {
            block.text(&pen, line, DVec2::new(0.0, index as f64 * pen.size));
        });
        self.frame(&mut block, &pen, &chart, [&onward, &upward]);
        let right = self.curves(&mut block, &pen, &chart, view.time);
        let half_label = onward.last().map_or(0.0, |tick| 0.5 * width_of(&pen, &tick.label));
        block.size = DVec2::new(
            (corner.x + size.x + half_label.max(right)).max(width_of(&pen, &title)),
            corner.y + size.y + gap + pen.size,
        );
        painter.put(block, self.position);
    }

    /// Axes, lines at ticks, and numbers.
    fn frame(&self, block: &mut MarkBlock, pen: &Pen, chart: &Chart, [onward, upward]: [&[Tick]; 2]) {
        let Chart { corner, size, .. } = *chart;
        let end = corner + size;
        let gap = 0.3 * pen.size;
        let height = |tick: &Tick| end.y - tick.share * size.y;
        let along = |tick: &Tick| corner.x + tick.share * size.x;
        let rows = upward
            .iter()
            .map(|tick| vec![DVec2::new(corner.x, height(tick)), DVec2::new(end.x, height(tick))]);
        let columns =
            onward.iter().map(|tick| vec![DVec2::new(along(tick), corner.y), DVec2::new(along(tick), end.y)]);
        block.marks.push(Mark::lines(rows.chain(columns).collect(), 0.5 * pen.width, pen.ink.faded(0.3)));
        block.marks.push(Mark::lines(
            vec![vec![corner, DVec2::new(corner.x, end.y), end]],
            pen.width,
            pen.ink,
        ));
        for tick in upward {
            let left = corner.x - gap - width_of(pen, &tick.label);
            block.text(pen, &tick.label, DVec2::new(left, height(tick) - 0.5 * pen.size));
        }
        for tick in onward {
            let left = along(tick) - 0.5 * width_of(pen, &tick.label);
            block.text(pen, &tick.label, DVec2::new(left, end.y + gap));
        }
    }

    /// The lines, the marker, and the names of the lines at their ends. Returns how far names reach beyond the chart.
    fn curves(&self, block: &mut MarkBlock, pen: &Pen, chart: &Chart, time: Time) -> f64 {
        let now = seconds(time).clamp(chart.times[0], chart.times[1]);
        let mut right: f64 = 0.0;
        let marker = [chart.range[0], chart.range[1]].map(|value| chart.place(DVec2::new(now, value)));
        block.marks.push(Mark::lines(vec![marker.to_vec()], pen.width, pen.ink.faded(0.6)));
        for series in &self.series {
            let ink = series.color.as_ref().map_or(pen.ink, |color| Ink::new(color.at(time), 1.0));
            let current = DVec2::new(now, series.value.at(time));
            let mut points = series.points.clone();
            if self.grows {
                points.retain(|point| point.x < now);
                points.push(current);
            }
            let line: Vec<DVec2> = points.iter().map(|point| chart.place(*point)).collect();
            if line.len() > 1 {
                block.marks.push(Mark::lines(vec![line], 1.5 * pen.width, ink));
            }
            block.marks.push(Mark::disk(chart.place(current), 2.5 * pen.width, ink));
            if let Some(end) = series.points.last().filter(|_| !series.name.is_empty()) {
                let place = chart.place(*end) + DVec2::new(0.4 * pen.size, -0.5 * pen.size);
                block.text(&Pen { ink, ..pen.clone() }, &series.name, place);
                right = right.max(0.4 * pen.size + width_of(pen, &series.name));
            }
        }
        right
    }
}
