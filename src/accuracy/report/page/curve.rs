//! The settings along the curve of error against time: their pictures, costs and errors.

use super::html::{Html, escaped};
use crate::accuracy::findings::describe;
use crate::accuracy::measure::{Measured, Point};
use crate::accuracy::report::crops::crops;
use crate::accuracy::statistics::ConfidenceInterval;
use crate::base::units::{factor, percent, seconds};
use std::error::Error;

pub fn pictures(html: &mut Html, measured: &Measured) -> Result<(), Box<dyn Error>> {
    html.tag("h2", "What it looks like");
    html.tag(
        "p",
        "Enlarged crops from where the file's own setting is worst: the best settings at half, equal and double its \
         cost, and the reference. Below each crop is the visible error (FLIP): black is no difference, white is a \
         large one.",
    );
    html.raw("<div class=\"crops\">\n");
    for crop in crops(measured)? {
        html.raw(&format!("<figure><img src=\"{}\" alt=\"{}\">", crop.picture, escaped(&crop.title)));
        if let Some(difference) = crop.difference {
            html.raw(&format!("<img src=\"{difference}\" alt=\"difference\">"));
        }
        let (title, caption) = (escaped(&crop.title), escaped(&crop.caption));
        html.raw(&format!("<figcaption><b>{title}</b><br>{caption}</figcaption></figure>\n"));
    }
    html.raw("</div>\n");
    Ok(())
}

pub fn prices(html: &mut Html, measured: &Measured) {
    html.tag("h2", "Price list of samples");
    html.tag(
        "p",
        "Columns marked x are multiples of the file's own setting, which is the first row. Rows in bold are on the \
         Pareto front.",
    );
    let front = measured.pareto_front(Point::error);
    let head = [
        "setting",
        "time",
        "x",
        "error",
        "x",
        "samples",
        "relMSE",
        "PSNR",
        "FLIP",
        "bias",
        "efficiency",
        "wall",
        "rays",
    ];
    let curve = measured.points.iter().filter(|point| !point.setting.axis.has_baseline());
    let rows = curve.map(|point| {
        let best = front.iter().any(|other| std::ptr::eq(*other, point));
        (best, row(measured, point))
    });
    html.table("prices", &head, rows);
}

fn row(measured: &Measured, point: &Point) -> Vec<String> {
    let own = measured.own();
    let share = |estimate: ConfidenceInterval| estimate.root().map(|error| measured.share(error));
    let error = share(point.squared);
    let spread = (error.high - error.low) / 2.0;
    let error = match spread > 0.0 {
        true => format!("{} ± {}", percent(error.mean), percent(spread)),
        false => percent(error.mean),
    };
    let psnr = point.psnr.mean;
    vec![
        describe(point),
        seconds(point.time()),
        factor(point.time() / own.time()),
        error,
        if own.error() > 0.0 { factor(point.error() / own.error()) } else { "–".to_owned() },
        format!("{:.0}", point.samples),
        format!("{:.2e}", point.relative.mean),
        if psnr.is_finite() { format!("{psnr:.1}") } else { "∞".to_owned() },
        format!("{:.3}", point.flip.mean),
        measured.bias_text(point.bias),
        factor(point.efficiency() / own.efficiency()),
        seconds(point.wall.median),
        crate::base::units::count(point.rays.round() as u64),
    ]
}
