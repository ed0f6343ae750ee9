//! Measurements as tables for other programs.

use crate::accuracy::report::Origin;
use crate::accuracy::{Estimate, Measured, Point};
use crate::cli::json::{Object, list};
use std::path::Path;

/// A number of a point, under its name.
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
    all.extend([("bias", point.bias.max(0.0).sqrt()), ("efficiency", point.efficiency())]);
    all
}

fn three(names: [&'static str; 3], estimate: Estimate) -> [Column; 3] {
    let values = [estimate.mean, estimate.low, estimate.high];
    std::array::from_fn(|i| (names[i], values[i]))
}

/// A row for each point; what is unknown or infinite is left empty.
pub fn csv(measured: &Measured) -> String {
    let mut text = String::from("axis,value,flags");
    columns(measured.own()).iter().for_each(|(name, _)| text += &format!(",{name}"));
    text.push('\n');
    for point in &measured.points {
        let setting = &point.setting;
        text += &format!("{},{},{}", setting.axis.name(), setting.value, setting.flags);
        for (_, value) in columns(point) {
            text += &if value.is_finite() { format!(",{value:e}") } else { ",".to_owned() };
        }
        text.push('\n');
    }
    text
}

/// Everything, as one object.
pub fn json(measured: &Measured, origin: &Origin) -> String {
    let points = measured.points.iter().map(|point| {
        let setting = &point.setting;
        let object = Object::new()
            .text("axis", setting.axis.name())
            .text("value", &setting.value)
            .text("flags", &setting.flags);
        columns(point)
            .into_iter()
            .fold(object, |object, (name, value)| object.exact(name, Some(value)))
            .finish()
    });
    let slopes = measured.slopes.iter().fold(Object::new(), |object, (axis, slope)| {
        let of = Object::new()
            .exact("power", Some(slope.mean))
            .exact("low", Some(slope.low))
            .exact("high", Some(slope.high));
        object.object(axis.name(), of)
    });
    let layers = measured.layers.iter().fold(Object::new(), |object, layer| {
        object.object(
            &layer.name,
            Object::new().exact("share", Some(layer.share)).exact("error", Some(layer.error)),
        )
    });
    let precision = measured.precision.iter().fold(Object::new(), |object, way| {
        let of = Object::new()
            .whole("cases", way.cases.into())
            .whole("failing", way.failing.into())
            .exact("time", Some(way.time));
        object.object(way.way, of)
    });
    let left_out =
        measured.left_out.iter().fold(Object::new(), |object, left| object.text(left.what, &left.why));
    about(measured)
        .text("command", &origin.command)
        .text("machine", &origin.machine)
        .whole("threads", measured.threads as u64)
        .exact("price_of_half_the_error", measured.price_of_half())
        .object("slopes", slopes)
        .object("layers", layers)
        .object("precision", precision)
        .object("left_out", left_out)
        .raw("points", list(points))
        .finish()
        + "\n"
}

/// What the terminal hears.
pub fn summary(measured: &Measured, report: &Path) -> String {
    about(measured).text("report", &report.to_string_lossy()).finish()
}

fn about(measured: &Measured) -> Object {
    let size = |(width, height): (u32, u32)| format!("{width}x{height}");
    let advice = measured.advice().into_iter().map(|advice| {
        Object::new()
            .text("goal", &advice.goal)
            .text("flags", &advice.flags)
            .text("effect", &advice.effect)
            .finish()
    });
    Object::new()
        .text("event", "accuracy")
        .text("name", &measured.name)
        .raw("frames", list(measured.frames.iter().map(u32::to_string)))
        .text("size", &size(measured.full_size))
        .text("measured_size", &size(measured.size))
        .whole("runs", measured.runs.into())
        .whole("reference_samples", measured.reference.into())
        .exact("reference_error", Some(measured.reference_error))
        .exact("brightness", Some(measured.brightness))
        .real("took_s", Some(measured.took.as_secs_f64()))
        .texts("findings", measured.lines().into_iter())
        .raw("advice", list(advice))
}
