//! Error against time: a curve per setting.

use crate::accuracy::findings::{percent, seconds};
use crate::accuracy::measure::{Measured, Point};
use crate::accuracy::plot::{Curve, Legend, Plot, Scale, Spot};
use crate::accuracy::settings::Axis;
use crate::accuracy::statistics::Estimate;

/// A plot of a measurement.
#[derive(Clone, Debug)]
pub struct Chart {
    /// For the names of files.
    pub name: &'static str,
    /// What a reader should look for.
    pub caption: String,
    pub plot: Plot,
}

/// All plots of a measurement: those that have something to show.
pub fn charts(measured: &Measured) -> Vec<Chart> {
    let mut all = Vec::from(errors(measured));
    all.push(bounces(measured));
    all.retain(|chart| chart.plot.curves.iter().any(|curve| curve.spots.len() > 1));
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
    let Chart { name, plot, .. } = Chart::new(
        measured,
        "bounces",
        "What bounces change, against their time",
        ("difference, as a share of the mean brightness", ""),
        &[Axis::Bounces],
        |point| {
            let bias = point.bias.0.root().map(|bias| bias / measured.brightness);
            // What cannot be told from none has no place.
            if point.bias.is_certain() { bias } else { Estimate::default() }
        },
    );
    let caption = "Each point is a number of bounces, and by how much its picture differs from that with the file's own \
        number, without noise. What cannot be told from no difference has no place on a logarithmic axis.";
    Chart { name, caption: caption.to_owned(), plot: Plot { behind: Vec::new(), ring: None, ..plot } }
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
            Spot { x: point.time(), y: mean, low, high, label: point.setting.value.clone() }
        };
        let shown = |spot: &Spot| spot.y > 0.0 && spot.y.is_finite();
        let curve = |&axis: &Axis| {
            let mut on = measured.on(axis);
            match axis {
                Axis::Noise => {}
                Axis::Bounces => on.sort_by_key(|point| point.setting.quality.bounces),
                _ => on.sort_by(|a, b| a.samples.total_cmp(&b.samples)),
            }
            Curve {
                name: axis.name().to_owned(),
                color: color(axis),
                spots: on.into_iter().map(spot).filter(shown).collect(),
            }
        };
        let front = measured.front(|point| error(point).mean);
        let front = front.iter().map(|point| (point.time(), error(point).mean)).filter(|at| at.1 > 0.0);
        let own = measured.own();
        let own = (own.time(), error(own).mean);
        let label: fn(f64) -> String = if name == "flip" { |value| format!("{value:.3}") } else { percent };
        let plot = Plot {
            title: title.to_owned(),
            x: Scale { name: "processor time for a frame of the measured size", label: seconds },
            y: Scale { name: y, label },
            curves: axes.iter().map(curve).filter(|curve| !curve.spots.is_empty()).collect(),
            behind: front.collect(),
            ring: (own.1 > 0.0).then_some((own, "the file's own")),
            legend: Legend::UpperRight,
        };
        let caption = format!(
            "{meaning} Further left is faster, further down is better: what no other point beats in both lies on the \
            grey line. The ring is the file's own setting; numbers at points are settings."
        );
        Self { name, caption, plot }
    }
}

/// Those that are never in one plot may have the same.
fn color(axis: Axis) -> usize {
    match axis {
        Axis::Samples | Axis::Antialias => 0,
        Axis::Independent => 1,
        Axis::Noise => 2,
        Axis::Bounces => 3,
        Axis::Roulette | Axis::Integrator => 4,
        Axis::Layers | Axis::Parts | Axis::Remedies => 5,
    }
}
