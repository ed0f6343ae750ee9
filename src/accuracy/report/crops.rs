//! Enlarged crops of pictures at similar cost, with maps of their visible error.

use crate::accuracy::findings::describe;
use crate::accuracy::measure::{Measured, Point};
use crate::base::units::{factor, percent, seconds};
use crate::encode::{Picture, png_bytes};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::io;

/// Columns and rows of a crop, in pixels.
const PART: (usize, usize) = (72, 54);

/// A crop of a picture and of its error map.
pub struct Crop {
    pub title: String,
    pub caption: String,
    /// As a `data:` URL.
    pub picture: String,
    /// `None` for the reference.
    pub difference: Option<String>,
}

/// Crops of the file's own setting, of the best settings at half, equal and double its cost, and of the reference.
pub fn crops(measured: &Measured) -> io::Result<Vec<Crop>> {
    let corner = worst(measured);
    let own = measured.own();
    let mut shown = vec![own];
    for cost in [0.5, 1.0, 2.0] {
        let far = |point: &&Point| libm::fabs(libm::log2(point.time() / own.time() / cost));
        let others = measured.points.iter().filter(|point| {
            !point.setting.axis.has_baseline() && !shown.iter().any(|shown| std::ptr::eq(*shown, *point))
        });
        // A larger range for grids, because they have few steps.
        let reach = if measured.random { 0.4 } else { 1.5 };
        let near = others.filter(|point| far(point) < reach);
        shown.extend(near.min_by(|a, b| a.error().total_cmp(&b.error())));
    }
    shown.sort_by(|a, b| a.time().total_cmp(&b.time()));
    let mut all = Vec::new();
    for point in shown {
        all.push(Crop {
            title: match std::ptr::eq(point, own) {
                true => format!("{}, the file's own", describe(point)),
                false => describe(point),
            },
            caption: format!(
                "{} times the cost ({} a frame at this size), error {}, FLIP {:.3}",
                factor(point.time() / own.time()),
                seconds(point.time()),
                percent(measured.share(point.error())),
                point.flip.mean
            ),
            picture: address(measured, corner, |i| point.picture[i])?,
            difference: Some(address(measured, corner, |i| heat(point.flips[i]))?),
        });
    }
    all.push(Crop {
        title: "reference".to_owned(),
        caption: format!("{} samples", measured.reference),
        picture: address(measured, corner, |i| measured.wanted[i])?,
        difference: None,
    });
    Ok(all)
}

/// Columns and rows of a crop, limited to the picture.
fn part(measured: &Measured) -> (usize, usize) {
    (PART.0.min(measured.size.0 as usize), PART.1.min(measured.size.1 as usize))
}

/// The top left corner of the crop where the file's own setting looks worst, in the first frame.
fn worst(measured: &Measured) -> (usize, usize) {
    let (width, height) = (measured.size.0 as usize, measured.size.1 as usize);
    let (columns, rows) = part(measured);
    let flips = &measured.own().flips;
    let sum = |&(left, top): &(usize, usize)| -> f32 {
        let rows = (top..top + rows).step_by(2);
        rows.map(|y| flips[y * width + left..][..columns].iter().sum::<f32>()).sum()
    };
    let corners = (0..=height - rows).step_by(9);
    let corners = corners.flat_map(|top| (0..=width - columns).step_by(9).map(move |left| (left, top)));
    corners.max_by(|a, b| sum(a).total_cmp(&sum(b))).unwrap_or_default()
}

fn address(
    measured: &Measured,
    (left, top): (usize, usize),
    pixel: impl Fn(usize) -> [f32; 3],
) -> io::Result<String> {
    let (columns, rows) = part(measured);
    let width = measured.size.0 as usize;
    let places = (top..top + rows).flat_map(|y| (left..left + columns).map(move |x| y * width + x));
    let code = |value: f32| (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
    let rgb = places.flat_map(|place| pixel(place).map(code)).collect();
    data_address(&Picture::opaque(columns as u32, rows as u32, rgb))
}

/// The error of each pixel at the file's own setting, as a `data:` URL.
pub fn errors(measured: &Measured) -> io::Result<String> {
    let (width, height) = (measured.size.0 as usize, measured.size.1 as usize);
    let shade = |error: &f32| {
        let share = measured.share(f64::from(error.max(0.0)).sqrt());
        // From a hundredth of the mean brightness to ten times that.
        heat(((libm::log10(share) + 2.0) / 3.0) as f32)
    };
    let code = |value: f32| (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
    let first = measured.own().errors.iter().take(width * height);
    let rgb = first.flat_map(|error| shade(error).map(code)).collect();
    data_address(&Picture::opaque(width as u32, height as u32, rgb))
}

/// A picture as a `data:` URL.
pub fn data_address(picture: &Picture) -> io::Result<String> {
    Ok(format!("data:image/png;base64,{}", STANDARD.encode(png_bytes(picture)?)))
}

/// A colour map from black through purple and orange to white: five colours of Matplotlib's magma.
fn heat(value: f32) -> [f32; 3] {
    const STOPS: [[f32; 3]; 5] = [
        [0.0, 0.0, 0.016],
        [0.317, 0.071, 0.486],
        [0.718, 0.216, 0.475],
        [0.988, 0.537, 0.38],
        [0.988, 0.992, 0.749],
    ];
    let at = value.clamp(0.0, 1.0) * (STOPS.len() - 1) as f32;
    let below = (at as usize).min(STOPS.len() - 2);
    let part = at - below as f32;
    std::array::from_fn(|i| STOPS[below][i] * (1.0 - part) + STOPS[below + 1][i] * part)
}
