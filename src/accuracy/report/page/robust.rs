//! What robustness costs on the scene's own rays, with the pixels that the cheap way makes wrong.

use super::html::Html;
use crate::accuracy::findings::{factor, percent};
use crate::accuracy::measure::Measured;
use crate::accuracy::report::crops::data_address;
use crate::accuracy::robustness::{Blemish, Robustness};
use crate::encode::Picture;
use std::error::Error;

pub fn robustness(html: &mut Html, measured: &Measured) -> Result<(), Box<dyn Error>> {
    let Some(found) = &measured.robustness else { return Ok(()) };
    html.tag("h2", "What robustness costs in this scene");
    html.tag(
        "p",
        "The rays of this scene, from the camera and on from what they hit, against the shapes that they come near: by \
         formulas of textbooks in f32 and in f64, by stable formulas in f32, and by Kinora. A hit is wrong if it is \
         missed, invented, or off by a thousandth of its distance; numbers of 106 bits say what is right. Rays that go on from \
         a surface begin 0.001 away from it, except Kinora's. Times are of one test of one shape.",
    );
    let first = found.hits.first().map_or(1.0, |way| way.nanoseconds);
    let rows = found.hits.iter().map(|way| {
        let wrong = format!("{} of {}", way.wrong, way.rays);
        let time = format!("{:.0} ns", way.nanoseconds);
        (false, vec![way.way.to_owned(), wrong, time, format!("{} times", factor(way.nanoseconds / first))])
    });
    html.table("list", &["how hits are found", "wrong hits", "time", "x"], rows);
    html.tag(
        "p",
        "Rays to lights must not hit the surface that they start from. The usual way ignores whatever is nearer than a fixed \
         offset; too small, and surfaces shadow themselves; too large, and shadows of what is near are lost. Kinora starts \
         rays where the bound of the rounding error ends, and has no offset to choose.",
    );
    let rows = found.starts.iter().map(|way| {
        let of = |count: u32| format!("{count} of {}", way.rays);
        let time = way.nanoseconds.map_or_else(|| "–".to_owned(), |time| format!("{time:.0} ns"));
        (false, vec![way.way.clone(), of(way.false_shadows), of(way.lost_shadows), time])
    });
    html.table("list", &["how rays start", "false shadows", "lost shadows", "time"], rows);
    html.raw(&format!("<figure class=\"map\"><img src=\"{}\" alt=\"wrong pixels\">", map(found)?));
    let caption = match found.wrong_pixels() {
        0.0 => "No pixel is wrong by the cheap way (textbook formulas in f32, an offset of 0.001): this scene has its \
                shapes near the origin, of like sizes and well apart."
            .to_owned(),
        share => format!(
            "{} of the pixels are wrong by the cheap way (textbook formulas in f32, an offset of 0.001): red is a wrong hit, \
             orange a false shadow, blue a lost one.",
            percent(share)
        ),
    };
    html.tag("figcaption", &caption);
    html.raw("</figure>\n");
    Ok(())
}

/// The picture of wrong pixels, as a `data:` address.
pub fn map(found: &Robustness) -> std::io::Result<String> {
    let color = |(shade, blemish): &(f32, Option<Blemish>)| match blemish {
        Some(Blemish::WrongHit) => [220, 30, 30],
        Some(Blemish::FalseShadow) => [240, 150, 20],
        Some(Blemish::LostShadow) => [40, 90, 230],
        None => [(40.0 + 150.0 * shade.clamp(0.0, 1.0)) as u8; 3],
    };
    data_address(&Picture::opaque(found.size.0, found.size.1, found.pixels.iter().flat_map(color).collect()))
}
