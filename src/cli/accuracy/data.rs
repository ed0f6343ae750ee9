//! Measurements as CSV and JSON for other programs.

use crate::accuracy::report::Origin;
use crate::accuracy::{ConfidenceInterval, Measured, Point};
use crate::cli::json::{line, object, rounded};
use serde_json::{Map, Value, json};
use std::path::Path;

/// The name and the value of a number of a point.
type Column = (&'static str, f64);

/// All numbers of a point.
fn columns(point: &Point) -> Vec<Column> {
    let mut all = vec![
        ("wall_s", point.wall.median),
        ("wall_lower_s", point.wall.lower),
        ("wall_upper_s", point.wall.upper),
        ("cpu_s", point.cpu.map_or(f64::NAN, |cpu| cpu.median)),
        ("cpu_lower_s", point.cpu.map_or(f64::NAN, |cpu| cpu.lower)),
        ("cpu_upper_s", point.cpu.map_or(f64::NAN, |cpu| cpu.upper)),
        ("rays", point.rays),
        ("samples", point.samples),
    ];
    let root = point.squared.root();
    all.extend(three(["rmse", "rmse_low", "rmse_high"], root));
    all.extend(three(["relmse", "relmse_low", "relmse_high"], point.relative));
    all.extend(three(["psnr", "psnr_low", "psnr_high"], point.psnr));
    all.extend(three(["flip", "flip_low", "flip_high"], point.flip));
    let bias = point.bias.0.root();
    all.extend([("bias", bias.mean), ("bias_low", bias.low), ("bias_high", bias.high)]);
    all.extend([("noise", point.variance.sqrt()), ("efficiency", point.efficiency())]);
    all.extend([
        ("worst_hundredth", point.concentration.worst_hundredth),
        ("nine_tenths", point.concentration.nine_tenths),
        ("largest_change", point.largest_change),
        ("capped", point.capped),
    ]);
    all
}

fn three(names: [&'static str; 3], estimate: ConfidenceInterval) -> [Column; 3] {
    let values = [estimate.mean, estimate.low, estimate.high];
    std::array::from_fn(|i| (names[i], values[i]))
}

/// A row for each point. Unknown and infinite values leave their cells empty.
pub fn csv(measured: &Measured) -> String {
    let mut text = String::from("axis,value,flags");
    columns(measured.own()).iter().for_each(|(name, _)| text += &format!(",{name}"));
    text.push('\n');
    for point in &measured.points {
        let setting = &point.setting;
        let value = quoted(&setting.value);
        text += &format!("{},{value},{}", setting.axis.name(), setting.flags);
        for (_, value) in columns(point) {
            text += &if value.is_finite() { format!(",{value:e}") } else { ",".to_owned() };
        }
        text.push('\n');
    }
    text
}

/// A cell, in quotes if its text holds a comma, a quote or a line break.
fn quoted(text: &str) -> String {
    match text.contains([',', '"', '\n']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_owned(),
    }
}

/// All measurements as one object.
pub fn json(measured: &Measured, origin: &Origin) -> String {
    let points = measured.points.iter().map(|point| {
        let setting = &point.setting;
        let mut object = object(json!({
            "axis": setting.axis.name(),
            "value": setting.value,
            "flags": setting.flags,
        }));
        object.extend(columns(point).into_iter().map(|(name, value)| (name.to_owned(), value.into())));
        object
    });
    let slopes = measured.slopes.iter().map(|(axis, slope)| {
        let value = json!({ "power": slope.mean, "low": slope.low, "high": slope.high });
        (axis.name().to_owned(), value)
    });
    let layers = measured.layers.iter().map(|layer| {
        let value = json!({ "share": layer.share, "error": layer.error, "of_worst": layer.of_worst });
        (layer.name.clone(), value)
    });
    let precision = measured.precision.iter().map(|way| {
        let value = json!({ "cases": way.cases, "failing": way.failing, "time": way.time });
        (way.method.to_owned(), value)
    });
    let chains = measured.chains.iter().map(|chain| json!({ "path": chain.path, "share": chain.share }));
    let left_out = measured.left_out.iter().map(|left| (left.what.to_owned(), left.why.as_str().into()));
    let mut all = overview(measured);
    all.extend(object(json!({
        "command": origin.command,
        "machine": origin.machine,
        "threads": measured.threads,
        "price_of_half_the_error": measured.price_of_half(),
        "slopes": slopes.collect::<Map<_, _>>(),
        "layers": layers.collect::<Map<_, _>>(),
        "precision": precision.collect::<Map<_, _>>(),
        "chains": chains.collect::<Vec<_>>(),
        "robustness": robustness(measured),
        "temporal": temporal(measured),
        "left_out": left_out.collect::<Map<_, _>>(),
        "points": points.collect::<Vec<_>>(),
    })));
    line(all) + "\n"
}

/// The error of the change to the next frame, as a fraction of the mean brightness.
fn temporal(measured: &Measured) -> Option<Value> {
    let found = measured.temporal.as_ref()?;
    let error = |squared: ConfidenceInterval| {
        let error = found.share(squared);
        json!({ "error": error.mean, "low": error.low, "high": error.high })
    };
    Some(json!({
        "frames": found.frames,
        "picture": error(found.picture),
        "same": error(found.same),
        "vary_noise": found.varied.map(error),
        "change": found.change.sqrt() / found.brightness,
    }))
}

/// The cost of robustness on the scene's own rays.
fn robustness(measured: &Measured) -> Option<Value> {
    let found = measured.robustness.as_ref()?;
    let hits = found.hits.iter().map(
        |way| json!({ "way": way.method, "rays": way.rays, "wrong": way.wrong, "median_ns": way.nanoseconds }),
    );
    let starts = found.starts.iter().map(|way| {
        json!({
            "way": way.method,
            "rays": way.rays,
            "false_shadows": way.false_shadows,
            "lost_shadows": way.lost_shadows,
            "median_ns": way.nanoseconds,
        })
    });
    Some(json!({
        "hits": hits.collect::<Vec<_>>(),
        "starts": starts.collect::<Vec<_>>(),
        "wrong_pixels": found.wrong_pixels(),
    }))
}

/// The line for the terminal.
pub fn summary(measured: &Measured, report: &Path) -> String {
    let mut summary = overview(measured);
    summary.insert("report".to_owned(), report.to_string_lossy().into());
    line(summary)
}

fn overview(measured: &Measured) -> Map<String, Value> {
    let size = |(width, height): (u32, u32)| format!("{width}x{height}");
    let advice = measured
        .advice()
        .into_iter()
        .map(|advice| json!({ "goal": advice.goal, "flags": advice.flags, "effect": advice.effect }));
    object(json!({
        "event": "accuracy",
        "name": measured.name,
        "frames": measured.frames,
        "size": size(measured.full_size),
        "measured_size": size(measured.size),
        "runs": measured.own().runs.len(),
        "reference_samples": measured.reference,
        "reference_error": measured.reference_error,
        "brightness": measured.brightness,
        "whole_film": {
            "frames": measured.total.frames,
            "traced": measured.total.films,
            "wall_s": measured.total.wall,
            "cpu_s": measured.total.cpu,
        },
        "took_s": rounded(measured.took.as_secs_f64()),
        "findings": measured.lines(),
        "advice": advice.collect::<Vec<_>>(),
    }))
}
