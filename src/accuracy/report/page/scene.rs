//! The costs of the parts of a scene, and its fireflies.

use super::html::Html;
use crate::accuracy::findings::{CODES, describe};
use crate::accuracy::measure::{Measured, Point};
use crate::accuracy::report::crops::errors;
use crate::accuracy::settings::SettingAxis;
use crate::base::units::{factor, percent, seconds};
use std::error::Error;

/// The costs of effects, lights, objects, and settings of light paths.
pub fn parts(html: &mut Html, measured: &Measured) {
    html.tag("h2", "Price list of this scene");
    let own = measured.baseline(&measured.points[measured.points.len() - 1]);
    html.tag(
        "p",
        &format!(
            "Each row is one change to the scene or its settings, with everything else as in the file, at {:.0} \
             samples a pixel: the time of a frame with the change and without, and by how much the picture changes. \
             The most expensive parts come first.",
            own.samples
        ),
    );
    let head = ["change", "time with it", "time as it is", "x", "difference", "largest, on the display"];
    let parts = measured.parts();
    let rows = parts.iter().map(|point| row(measured, point));
    html.table("list", &head, rows);
    let axes = [SettingAxis::Integrator, SettingAxis::Bounces, SettingAxis::Roulette, SettingAxis::Layers];
    let others = axes.into_iter().flat_map(|axis| measured.on(axis));
    html.table("list", &head, others.map(|point| row(measured, point)));
    html.tag(
        "p",
        "Shadows cannot be switched off: their rays are part of the cost of each light. Textures are replaced by \
         grey. The difference between the integrators is light that Whitted ray tracing does not follow.",
    );
}

fn row(measured: &Measured, point: &Point) -> (bool, Vec<String>) {
    let baseline = measured.baseline(point);
    let cells = vec![
        describe(point),
        seconds(point.time()),
        seconds(baseline.time()),
        factor(point.time() / baseline.time()),
        measured.bias_text(point.bias),
        format!("{:.0}/255", CODES * point.largest_change),
    ];
    (std::ptr::eq(point, baseline), cells)
}

pub fn fireflies(html: &mut Html, measured: &Measured) -> Result<(), Box<dyn Error>> {
    if !measured.random {
        return Ok(());
    }
    html.tag("h2", "Fireflies and noise");
    let direct = measured.chains.first().is_some_and(|chain| chain.direct);
    let kind = match measured.own().concentration.is_heavy() {
        true if direct => {
            "Most of the error is at edges of directly visible lights. Only more samples or larger pictures smooth \
             them."
        }
        true => "Most of the error is fireflies: single pixels that a rare path makes far too bright.",
        false => "The error is distributed over the picture, as expected of plain noise.",
    };
    html.tag("p", &format!("At the file's own setting, {}. {kind}", measured.concentration()));
    html.raw(&format!(
        "<figure class=\"map\"><img src=\"{}\" alt=\"error of each pixel\">",
        errors(measured)?
    ));
    html.tag(
        "figcaption",
        "The error of each pixel over all runs, relative to the mean brightness, on a logarithmic scale: black is 1 \
         % or less, white is 10 times the mean brightness or more.",
    );
    html.raw("</figure>\n");
    if !measured.chains.is_empty() {
        html.tag(
            "p",
            "The paths that cause most of the noise in the worst pixels, from the camera to a light. A simplified \
             path tracer records about two thousand paths from each of the worst pixels; shares are of their \
             variance.",
        );
        let rows =
            measured.chains.iter().map(|chain| (false, vec![chain.path.clone(), percent(chain.share)]));
        html.table("list", &["path", "share of the noise"], rows);
    }
    let remedies = measured.remedies();
    if remedies.is_empty() {
        return Ok(());
    }
    html.tag("p", &format!("Remedies, measured with {} samples a pixel:", remedies[0].samples));
    let head = ["in the file", "noise", "time", "bias", "error of noise and bias together"];
    let rows = remedies.iter().map(|point| {
        let time = point.time() / measured.baseline(point).time();
        let cells = vec![
            describe(point),
            format!("{} times", factor(measured.noise_left(point))),
            format!("{} times", factor(time)),
            measured.bias_text(point.bias),
            percent(measured.share(measured.with_remedy(point))),
        ];
        (false, cells)
    });
    html.table("list", &head, rows);
    Ok(())
}
