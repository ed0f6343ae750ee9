//! Parts of pictures that took equally long, large enough to see their pixels, with what an eye sees in them.

use crate::accuracy::findings::{described, factor, percent, seconds};
use crate::accuracy::measure::{Measured, Point};
use crate::accuracy::settings::Axis;
use crate::encode::{Picture, png_bytes};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::io;

/// Columns and rows of a part.
const PART: (usize, usize) = (72, 54);

/// A part of a picture and of its difference.
pub struct Crop {
    pub title: String,
    pub told: String,
    /// As `data:` addresses.
    pub picture: String,
    /// None of what the picture should be.
    pub difference: Option<String>,
}

/// Of the file's own setting, of others that take about as long or are next to it, and of what it should be.
pub fn crops(measured: &Measured) -> io::Result<Vec<Crop>> {
    let corner = worst(measured);
    let own = measured.own();
    let mut shown = vec![own];
    let axes = [Axis::Samples, Axis::Independent, Axis::Noise, Axis::Antialias];
    for axis in axes {
        let others = measured.on(axis).into_iter().filter(|point| !std::ptr::eq(*point, own));
        let far = |point: &&Point| libm::log(point.wall.median / own.wall.median).abs();
        // A grid has few neighbours; others are near or would show nothing.
        let near = others.min_by(|a, b| far(a).total_cmp(&far(b)));
        shown.extend(near.filter(|point| axis == Axis::Antialias || far(point) < libm::log(2.5)));
    }
    let mut all = Vec::new();
    for point in shown {
        all.push(Crop {
            title: described(point),
            told: format!(
                "{} ({} times), error {}, FLIP {:.3}",
                seconds(point.wall.median),
                factor(point.wall.median / own.wall.median),
                percent(measured.share(point.error())),
                point.flip.mean
            ),
            picture: address(measured, corner, |i| point.picture[i])?,
            difference: Some(address(measured, corner, |i| heat(point.flips[i]))?),
        });
    }
    all.push(Crop {
        title: "what it should be".to_owned(),
        told: format!("{} samples", measured.reference),
        picture: address(measured, corner, |i| measured.wanted[i])?,
        difference: None,
    });
    Ok(all)
}

/// Columns and rows of a part, no larger than the picture.
fn part(measured: &Measured) -> (usize, usize) {
    (PART.0.min(measured.size.0 as usize), PART.1.min(measured.size.1 as usize))
}

/// The top left corner of where the file's own setting looks worst, in the first frame.
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
    let bytes = png_bytes(&Picture::opaque(columns as u32, rows as u32, rgb))?;
    Ok(format!("data:image/png;base64,{}", STANDARD.encode(bytes)))
}

/// From black over purple and orange to white, as differences are usually shown (five colours of Matplotlib's magma).
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
