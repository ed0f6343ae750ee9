//! Convergence, film layers, hard cases, and the method of measurement.

use super::html::Html;
use super::origin::Origin;
use crate::accuracy::measure::Measured;
use crate::accuracy::settings::SettingAxis;
use crate::accuracy::statistics::ConfidenceInterval;
use crate::base::units::{factor, percent};

pub fn convergence(html: &mut Html, measured: &Measured) {
    if measured.slopes.is_empty() {
        return;
    }
    html.tag("h2", "How fast the error falls");
    html.tag(
        "p",
        "The error falls as a power of the number of samples. For independent samples the power is -0.5: four times \
         the samples, half the error. Evenly distributed samples converge faster if the light is smooth.",
    );
    html.raw(
        "<table><tr><th>samples</th><th>power</th><th>interval</th><th>half the error takes</th></tr>\n",
    );
    for (axis, slope) in &measured.slopes {
        html.raw("<tr>");
        html.tag("td", axis.name());
        html.tag("td", &format!("{:.3}", slope.mean));
        html.tag("td", &format!("{:.3} to {:.3}", slope.low, slope.high));
        html.tag("td", &format!("{} times the samples", factor(libm::exp2(-1.0 / slope.mean))));
        html.raw("</tr>\n");
    }
    html.raw("</table>\n");
}

/// The error of the change from one frame to the next.
pub fn temporal(html: &mut Html, measured: &Measured) {
    let Some(found) = &measured.temporal else { return };
    let [before, after] = found.frames;
    html.tag("h2", &format!("From frame {before} to {after}"));
    html.tag(
        "p",
        "What flickers is not the error of a picture but the error of the change from one frame to the next. Frames \
         have the same random numbers unless vary_noise is set. So where nothing changes, noise stays in its place, \
         and where something does, the errors of both frames may partly cancel. With vary_noise, each frame has noise \
         of its own: it flickers, but in motion the eye takes the mean of several frames.",
    );
    let change = match found.varied {
        Some(_) => "the change, same random numbers",
        None => "the change",
    };
    let size = ConfidenceInterval::of(&[found.change]);
    let mut rows = vec![("one picture", found.picture), (change, found.same)];
    rows.extend(found.varied.map(|varied| ("the change, vary_noise", varied)));
    rows.push(("size of the change itself", size));
    let rows = rows.into_iter().map(|(of, squared)| (false, vec![of.to_owned(), found.error_text(squared)]));
    html.table("list", &["of", "error, of the mean brightness"], rows);
}

pub fn layers(html: &mut Html, measured: &Measured) {
    if measured.layers.len() < 2 {
        return;
    }
    html.tag("h2", "Layers of light");
    html.tag(
        "p",
        "Lights with different keys have film layers of their own. The table shows how bright and how noisy each \
         layer is at the file's own setting.",
    );
    html.raw(
        "<table><tr><th>layer</th><th>share of the brightness</th><th>its own error</th>\
         <th>share of the error in the worst 1 % of the pixels</th></tr>\n",
    );
    for layer in &measured.layers {
        html.raw("<tr>");
        html.tag("td", &layer.name);
        html.tag("td", &percent(layer.share));
        html.tag("td", &percent(layer.error));
        html.tag("td", &percent(layer.of_worst));
        html.raw("</tr>\n");
    }
    html.raw("</table>\n");
}

/// The summary of the hard cases, which is the same for all sequences.
pub fn hard_cases(html: &mut Html, measured: &Measured) {
    html.tag("h2", "Hard cases of numerics");
    html.tag("p", &measured.hard_cases().unwrap_or_default());
    html.tag(
        "p",
        "Kinora computes intersections with 64-bit numbers (f64) and numerically stable formulas. Most renderers use \
         32-bit numbers (f32). The table compares four methods on the hard cases of Kinora's tests. An answer is \
         wrong if it differs in kind, such as a ray that passes through a crack. The table is the same for all \
         sequences; kinora accuracy --hard-cases lists the cases.",
    );
    let rows = measured.precision.iter().map(|way| {
        let wrong = format!("{} of {}", way.failing, way.cases);
        (false, vec![way.method.to_owned(), wrong, format!("{} times", factor(way.time))])
    });
    html.table("list", &["method", "cases with wrong answers", "time"], rows);
}

pub fn settings(html: &mut Html, measured: &Measured) {
    html.tag("h2", "Measured settings");
    let tried = SettingAxis::ALL
        .into_iter()
        .filter(|axis| measured.points.iter().any(|point| point.setting.axis == *axis));
    html.list(tried.map(|axis| (axis.name().to_owned(), axis.meaning().to_owned())));
    if !measured.left_out.is_empty() {
        html.tag("p", "Left out:");
        html.list(measured.left_out.iter().map(|left| (left.what.to_owned(), left.why.clone())));
    }
}

pub fn how(html: &mut Html, measured: &Measured, origin: &Origin) {
    let runs = match measured.random {
        true => "4 to 16 renders of each setting with different random numbers, in turn",
        false => "several renders of each setting, in turn, to measure the time; their pictures are the same",
    };
    let frames = measured.frames.iter().map(u32::to_string).collect::<Vec<_>>().join(", ");
    let (width, height) = measured.size;
    let (full_width, full_height) = measured.full_size;
    html.list([
        ("command".to_owned(), origin.command.clone()),
        ("machine".to_owned(), format!("{}, {} threads", origin.machine, measured.threads)),
        ("frames".to_owned(), frames),
        (
            "size".to_owned(),
            format!(
                "{width} x {height} pixels (in the file: {full_width} x {full_height}). Errors hardly depend on the \
                 size; times are proportional to the number of pixels"
            ),
        ),
        ("renders".to_owned(), runs.to_owned()),
        (
            "reference".to_owned(),
            format!(
                "two renders with {} samples a pixel together; their own error is {}",
                measured.reference,
                percent(measured.share(measured.reference_error))
            ),
        ),
        ("times".to_owned(), "of rendering a frame, without loading and writing files".to_owned()),
    ]);
}
