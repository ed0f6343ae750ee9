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
        let value = quoted(&setting.value);
        text += &format!("{},{value},{}", setting.axis.name(), setting.flags);
        for (_, value) in columns(point) {
            text += &if value.is_finite() { format!(",{value:e}") } else { ",".to_owned() };
        }
        text.push('\n');
    }
    text
}

/// A cell of a table: names may hold commas and quotes.
fn quoted(text: &str) -> String {
    match text.contains([',', '"', '\n']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_owned(),
    }
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
            Object::new()
                .exact("share", Some(layer.share))
                .exact("error", Some(layer.error))
                .exact("of_worst", Some(layer.of_worst)),
        )
    });
    let precision = measured.precision.iter().fold(Object::new(), |object, way| {
        let of = Object::new()
            .whole("cases", way.cases.into())
            .whole("failing", way.failing.into())
            .exact("time", Some(way.time));
        object.object(way.way, of)
    });
    let chains = measured.chains.iter();
    let chains = chains
        .map(|chain| Object::new().text("path", &chain.path).exact("share", Some(chain.share)).finish());
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
        .raw("chains", list(chains))
        .raw("robustness", robustness(measured))
        .object("left_out", left_out)
        .raw("points", list(points))
        .finish()
        + "\n"
}

/// What robustness costs on the scene's own rays.
fn robustness(measured: &Measured) -> String {
    let Some(found) = &measured.robustness else { return "null".to_owned() };
    let hits = found.hits.iter().map(|way| {
        let object = Object::new().text("way", way.way).whole("rays", way.rays.into());
        object.whole("wrong", way.wrong.into()).exact("median_ns", Some(way.nanoseconds)).finish()
    });
    let starts = found.starts.iter().map(|way| {
        let object = Object::new().text("way", &way.way).whole("rays", way.rays.into());
        let object = object.whole("false_shadows", way.false_shadows.into());
        object.whole("lost_shadows", way.lost_shadows.into()).exact("median_ns", way.nanoseconds).finish()
    });
    Object::new()
        .raw("hits", list(hits))
        .raw("starts", list(starts))
        .exact("wrong_pixels", Some(found.wrong_pixels()))
        .finish()
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
    let whole = Object::new()
        .whole("frames", measured.whole.frames.into())
        .whole("traced", measured.whole.films as u64)
        .exact("wall_s", Some(measured.whole.wall))
        .exact("cpu_s", measured.whole.cpu);
    Object::new()
        .text("event", "accuracy")
        .text("name", &measured.name)
        .raw("frames", list(measured.frames.iter().map(u32::to_string)))
        .text("size", &size(measured.full_size))
        .text("measured_size", &size(measured.size))
        .whole("runs", measured.own().runs.len() as u64)
        .whole("reference_samples", measured.reference.into())
        .exact("reference_error", Some(measured.reference_error))
        .exact("brightness", Some(measured.brightness))
        .object("whole_film", whole)
        .real("took_s", Some(measured.took.as_secs_f64()))
        .texts("findings", measured.lines().into_iter())
        .raw("advice", list(advice))
}
