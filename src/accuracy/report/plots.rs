//! Plots of error against time, with a curve per axis.

use crate::accuracy::measure::{Measured, Point};
use crate::accuracy::plot::{DataPoint, Legend, Plot, Scale, Series};
use crate::accuracy::settings::SettingAxis;
use crate::accuracy::statistics::ConfidenceInterval;
use crate::base::units::{percent, seconds};

/// A plot of a measurement.
#[derive(Clone, Debug)]
pub struct Chart {
    /// The name for files.
    pub name: &'static str,
    /// What a reader should look for.
    pub caption: String,
    pub plot: Plot,
}

/// All plots of a measurement that have a curve of at least two points.
pub fn charts(measured: &Measured) -> Vec<Chart> {
    let mut all = Vec::from(errors(measured));
    all.push(bounces(measured));
    all.retain(|chart| chart.plot.series.iter().any(|curve| curve.points.len() > 1));
    all
}

/// The errors of settings that are compared with the reference, by three metrics.
fn errors(measured: &Measured) -> [Chart; 3] {
    let brightness = measured.brightness;
    let axes = [SettingAxis::Samples, SettingAxis::Independent, SettingAxis::Noise, SettingAxis::Antialias];
    [
        Chart::new(
            measured,
            "error",
            "Error of the light against time",
            (
                "RMSE, as a share of the mean brightness",
                "The typical difference of a pixel's light from the true value; 5 % is a twentieth of the picture's \
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
                "The same relative to each pixel's own brightness, so that dark parts count as much as bright ones.",
            ),
            &axes,
            |point| point.relative.root(),
        ),
        Chart::new(
            measured,
            "flip",
            "Visible error against time",
            (
                "FLIP",
                "How different the displayed picture looks to a person who flips between it and the reference: 0 is no \
                 difference.",
            ),
            &axes,
            |point| point.flip,
        ),
    ]
}

/// The light that fewer bounces omit.
fn bounces(measured: &Measured) -> Chart {
    let Chart { name, plot, .. } = Chart::new(
        measured,
        "bounces",
        "Effect of bounces against time",
        ("difference, as a share of the mean brightness", ""),
        &[SettingAxis::Bounces],
        |point| {
            let bias = point.bias.0.root().map(|bias| bias / measured.brightness);
            // Differences that are not significant are not plotted.
            if point.bias.is_certain() { bias } else { ConfidenceInterval::default() }
        },
    );
    let caption = "Each point is a number of bounces, and the difference of its picture from that with the file's own \
        number, without noise. Differences that are not significant are not plotted.";
    Chart { name, caption: caption.to_owned(), plot: Plot { behind: Vec::new(), ring: None, ..plot } }
}

impl Chart {
    fn new(
        measured: &Measured,
        name: &'static str,
        title: &str,
        (y, meaning): (&'static str, &str),
        axes: &[SettingAxis],
        error: impl Fn(&Point) -> ConfidenceInterval,
    ) -> Self {
        let spot = |point: &Point| {
            let ConfidenceInterval { mean, low, high } = error(point);
            DataPoint { x: point.time(), y: mean, low, high, label: point.setting.value.clone() }
        };
        let shown = |spot: &DataPoint| spot.y > 0.0 && spot.y.is_finite();
        let curve = |&axis: &SettingAxis| {
            let mut on = measured.on(axis);
            match axis {
                SettingAxis::Noise => {}
                SettingAxis::Bounces => on.sort_by_key(|point| point.setting.quality.bounces),
                _ => on.sort_by(|a, b| a.samples.total_cmp(&b.samples)),
            }
            Series {
                name: axis.name().to_owned(),
                color: color(axis),
                points: on.into_iter().map(spot).filter(shown).collect(),
            }
        };
        let front = measured.pareto_front(|point| error(point).mean);
        let front = front.iter().map(|point| (point.time(), error(point).mean)).filter(|at| at.1 > 0.0);
        let own = measured.own();
        let own = (own.time(), error(own).mean);
        let label: fn(f64) -> String = if name == "flip" { |value| format!("{value:.3}") } else { percent };
        let plot = Plot {
            title: title.to_owned(),
            x: Scale { name: "processor time for a frame of the measured size", label: seconds },
            y: Scale { name: y, label },
            series: axes.iter().map(curve).filter(|curve| !curve.points.is_empty()).collect(),
            behind: front.collect(),
            ring: (own.1 > 0.0).then_some((own, "the file's own")),
            legend: Legend::UpperRight,
        };
        let caption = format!(
            "{meaning} Further left is faster, further down is better. The grey line is the Pareto front: no other \
            point is better in both. The ring is the file's own setting; numbers at points are settings."
        );
        Self { name, caption, plot }
    }
}

/// The colour index of an axis. Axes that never share a plot may share a colour.
fn color(axis: SettingAxis) -> usize {
    match axis {
        SettingAxis::Samples | SettingAxis::Antialias => 0,
        SettingAxis::Independent => 1,
        SettingAxis::Noise => 2,
        SettingAxis::Bounces => 3,
        SettingAxis::Roulette | SettingAxis::Integrator => 4,
        SettingAxis::Layers | SettingAxis::Parts | SettingAxis::Remedies => 5,
    }
}
