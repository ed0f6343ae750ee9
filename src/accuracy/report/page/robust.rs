//! The cost of robust intersections on the scene's own rays, with a picture of the pixels that the cheap method gets
//! wrong.

use super::html::Html;
use crate::accuracy::measure::Measured;
use crate::accuracy::report::crops::data_address;
use crate::accuracy::robustness::{PixelError, Robustness};
use crate::base::units::{factor, percent};
use crate::encode::Picture;
use std::error::Error;

pub fn robustness(html: &mut Html, measured: &Measured) -> Result<(), Box<dyn Error>> {
    let Some(found) = &measured.robustness else { return Ok(()) };
    html.tag("h2", "What robustness costs in this scene");
    html.tag(
        "p",
        "Camera rays of this scene and rays that leave their hits are intersected with nearby shapes by four \
         methods: textbook formulas in f32 and in f64, stable formulas in f32, and Kinora's. A hit is wrong if it is \
         missed, invented, or off by a thousandth of its distance; arithmetic of 106 bits gives the true hits. Rays \
         that leave a surface start 0.001 away from it, except Kinora's. Times are of one test of one shape.",
    );
    let first = found.hits.first().map_or(1.0, |way| way.nanoseconds);
    let rows = found.hits.iter().map(|way| {
        let wrong = format!("{} of {}", way.wrong, way.rays);
        let time = format!("{:.0} ns", way.nanoseconds);
        (
            false,
            vec![way.method.to_owned(), wrong, time, format!("{} times", factor(way.nanoseconds / first))],
        )
    });
    html.table("list", &["method", "wrong hits", "time", "x"], rows);
    html.tag(
        "p",
        "Shadow rays must not hit the surface that they start on. Most renderers ignore hits that are closer than a \
         fixed offset. If it is too small, surfaces shadow themselves; if it is too large, shadows of nearby \
         surfaces are lost. Kinora moves the origin of rays by the bound of the rounding error, so there is no \
         offset to choose.",
    );
    let rows = found.starts.iter().map(|way| {
        let of = |count: u32| format!("{count} of {}", way.rays);
        let time = way.nanoseconds.map_or_else(|| "–".to_owned(), |time| format!("{time:.0} ns"));
        (false, vec![way.method.clone(), of(way.false_shadows), of(way.lost_shadows), time])
    });
    html.table("list", &["origin of shadow rays", "false shadows", "lost shadows", "time"], rows);
    html.raw(&format!("<figure class=\"map\"><img src=\"{}\" alt=\"wrong pixels\">", map(found)?));
    let caption = match found.wrong_pixels() {
        0.0 => "The cheap method (textbook formulas in f32, an offset of 0.001) gets no pixel wrong, because the \
                shapes of this scene are near the origin, of similar sizes and well separated."
            .to_owned(),
        share => format!(
            "The cheap method (textbook formulas in f32, an offset of 0.001) gets {} of the pixels wrong: red is a \
             wrong hit, orange a false shadow, blue a lost shadow.",
            percent(share)
        ),
    };
    html.tag("figcaption", &caption);
    html.raw("</figure>\n");
    Ok(())
}

/// The picture of wrong pixels, as a `data:` URL.
pub fn map(found: &Robustness) -> std::io::Result<String> {
    let color = |(shade, error): &(f32, Option<PixelError>)| match error {
        Some(PixelError::WrongHit) => [220, 30, 30],
        Some(PixelError::FalseShadow) => [240, 150, 20],
        Some(PixelError::LostShadow) => [40, 90, 230],
        None => [(40.0 + 150.0 * shade.clamp(0.0, 1.0)) as u8; 3],
    };
    data_address(&Picture::opaque(found.size.0, found.size.1, found.pixels.iter().flat_map(color).collect()))
}
