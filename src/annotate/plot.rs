//! Line charts of numbers over time, with a marker at the current time.

use super::block::{MarkBlock, PanelPosition, width_of};
use super::curve::{FLATNESS, simplified};
use super::painter::Painter;
use super::style::Pen;
use super::ticks::{Tick, rounded_range, spaced_ticks, ticks};
use crate::appearance::texture::DataScale;
use crate::base::color::Rgb;
use crate::base::math::DVec2;
use crate::base::time::{Fraction, Time};
use crate::drawing::{Ink, Mark, Window};
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

/// Equal steps from the first time to the last at which series are evaluated besides at their keys.
const STEPS: i128 = 240;
/// Keys, those of all rounds of a loop, up to which values between keys are evaluated, too.
const MANY_KEYS: usize = 20_000;
/// Steps between two keys.
const STEPS_BETWEEN: i128 = 4;
/// Columns of which only the first, the last, the lowest and the highest point of a series are kept. More than a
/// picture's pixels would not be seen.
const COLUMNS: usize = 4096;

impl PlotSeries {
    pub fn new(name: String, value: Animated<f64>, color: Option<Animated<Rgb>>, times: [Time; 2]) -> Self {
        let span = times[1] - times[0];
        let steps = (0..=STEPS).map(|index| times[0] + span * Time::new(index, STEPS));
        let keys = match &value {
            Animated::Constant(_) => Vec::new(),
            Animated::Keyed(track) => track.key_times(times, MANY_KEYS),
        };
        let mut all: Vec<Time> = steps.chain(keys.iter().copied()).collect();
        if keys.len() < MANY_KEYS {
            for [from, to] in keys.array_windows() {
                all.extend((1..STEPS_BETWEEN).map(|k| *from + (*to - *from) * Time::new(k, STEPS_BETWEEN)));
            }
            // Just before a key, where a step has not happened yet.
            all.extend(keys.iter().map(|key| *key - span * Time::new(1, 1 << 20)));
        }
        all.retain(|time| (times[0]..=times[1]).contains(time));
        all.sort();
        all.dedup();
        let points = all.into_iter().map(|time| DVec2::new(seconds(time), value.at(time))).collect();
        let points = thinned(points, times.map(seconds), COLUMNS);
        Self { name, value, color, points }
    }
}

/// The first, the lowest, the highest and the last of the points in each of equally wide columns, in their order
/// (Jugel et al., *M4: A Visualization-Oriented Time Series Data Aggregation*, 2014).
fn thinned(points: Vec<DVec2>, [first, last]: [f64; 2], columns: usize) -> Vec<DVec2> {
    if points.len() <= 4 * columns {
        return points;
    }
    let column = |point: &DVec2| ((point.x - first) / (last - first) * columns as f64) as usize;
    let mut kept = Vec::with_capacity(4 * columns);
    for part in points.chunk_by(|a, b| column(a) == column(b)) {
        let indices = || 0..part.len();
        let lowest = indices().min_by(|a, b| part[*a].y.total_cmp(&part[*b].y));
        let highest = indices().max_by(|a, b| part[*a].y.total_cmp(&part[*b].y));
        let mut chosen = [Some(0), lowest, highest, part.len().checked_sub(1)];
        chosen.sort_unstable();
        let mut last = None;
        for index in chosen.into_iter().flatten() {
            if last.replace(index) != Some(index) {
                kept.push(part[index]);
            }
        }
    }
    kept
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
        let (x, y) = (share(point.x, self.times), share(point.y, self.range));
        self.corner + DVec2::new(x, 1.0 - y) * self.size
    }

    /// Whether a point is within the times and the range.
    fn shows(&self, point: DVec2) -> bool {
        (self.times[0]..=self.times[1]).contains(&point.x)
            && (self.range[0]..=self.range[1]).contains(&point.y)
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
        let extent = |label: &str| width_of(&pen, label) + 0.5 * pen.size;
        let onward = spaced_ticks((DataScale::Linear, times), 6, size.x, extent);
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
        let now = seconds(time);
        let mut right: f64 = 0.0;
        let marker = [chart.range[0], chart.range[1]].map(|value| DVec2::new(now, value));
        if marker.iter().all(|end| chart.shows(*end)) {
            let marker = marker.map(|end| chart.place(end)).to_vec();
            block.marks.push(Mark::lines(vec![marker], pen.width, pen.ink.faded(0.6)));
        }
        let frame = Window { min: chart.corner, max: chart.corner + chart.size };
        let mut names = Vec::new();
        for series in &self.series {
            let ink = series.color.as_ref().map_or(pen.ink, |color| Ink::new(color.at(time), 1.0));
            let current = DVec2::new(now, series.value.at(time));
            let mut points = series.points.clone();
            if self.grows && now < chart.times[1] {
                points.retain(|point| point.x < now);
                points.extend((now >= chart.times[0]).then_some(current));
            }
            let columns = (chart.size.x as usize).max(1);
            let points = thinned(points, chart.times, columns);
            // Cut off at the frame.
            let lines = frame.clip_line(points.iter().map(|point| chart.place(*point)));
            if !lines.is_empty() {
                let lines = lines.iter().map(|line| simplified(line, FLATNESS)).collect();
                block.marks.push(Mark::lines(lines, 1.5 * pen.width, ink));
            }
            if chart.shows(current) {
                block.marks.push(Mark::disk(chart.place(current), 2.5 * pen.width, ink));
            }
            if let Some(end) = series.points.last().filter(|_| !series.name.is_empty()) {
                let height = chart.place(*end).y.clamp(frame.min.y, frame.max.y);
                names.push((height - 0.5 * pen.size, &series.name, ink));
                right = right.max(0.4 * pen.size + width_of(pen, &series.name));
            }
        }
        // Names keep their order from top to bottom, and a line between them.
        names.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut lowest = f64::NEG_INFINITY;
        for (top, name, ink) in names {
            let top = top.max(lowest);
            lowest = top + pen.size;
            let place = DVec2::new(frame.max.x + 0.4 * pen.size, top);
            block.text(&Pen { ink, ..pen.clone() }, name, place);
        }
        right
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::track::{Ease, Key, Repeat, Track};

    fn series(keys: &[(i128, f64)], ease: Ease, repeat: Repeat, times: [i128; 2]) -> Vec<DVec2> {
        let key = |(time, value): &(i128, f64)| Key { time: Time::from_integer(*time), value: *value, ease };
        let track = Track::new(keys.iter().map(key).collect(), repeat, false).expect("ascending keys");
        let times = times.map(Time::from_integer);
        PlotSeries::new("a".into(), Animated::Keyed(track), None, times).points
    }

    /// The value of a line at a time.
    fn at(points: &[DVec2], time: f64) -> f64 {
        let next = points.partition_point(|point| point.x < time).clamp(1, points.len() - 1);
        let (a, b) = (points[next - 1], points[next]);
        a.y + (b.y - a.y) * (time - a.x) / (b.x - a.x)
    }

    #[test]
    fn lines_follow_loops_steps_and_many_keys() {
        let many: Vec<(i128, f64)> = (0..=100).map(|k| (k, (k % 7) as f64)).collect();
        let looped = series(&many, Ease::Linear, Repeat::Loop, [0, 200]);
        for k in 0..200 {
            assert_eq!(at(&looped, f64::from(k)), f64::from(k % 100 % 7), "{k}");
        }
        let steps = series(&many, Ease::Step, Repeat::Hold, [0, 100]);
        for k in 0..100 {
            assert_eq!(at(&steps, f64::from(k) + 0.999), f64::from(k % 7), "{k}");
        }
        let back = series(&[(0, 0.0), (3, 1.0)], Ease::Linear, Repeat::PingPong, [0, 12]);
        assert!((at(&back, 3.0) - 1.0).abs() < 1e-12 && (at(&back, 7.5) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn thinned_lines_keep_their_extremes() {
        let points: Vec<DVec2> = (0..100_000)
            .map(|k| DVec2::new(f64::from(k), if k == 31_007 { 9.0 } else { libm::sin(f64::from(k)) }))
            .collect();
        let kept = thinned(points.clone(), [0.0, 100_000.0], 100);
        assert!(kept.len() <= 400 && kept.is_sorted_by(|a, b| a.x < b.x));
        assert!(
            kept.contains(&points[31_007]) && kept.first() == points.first() && kept.last() == points.last()
        );
        assert_eq!(thinned(points.clone(), [0.0, 100_000.0], 50_000), points);
    }
}
