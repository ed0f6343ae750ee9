//! Decodes `annotations`: one decoder per kind.

mod anchor;
mod axes;
mod common;
mod data;
mod label;
mod lines;
mod scene_names;

pub use label::caption;
pub use scene_names::SceneNames;

use super::Named;
use super::names::entries;
use super::node::Node;
use super::words::known_word;
use crate::annotate::Annotation;

/// Decodes the annotations of a sequence.
pub fn annotations(node: Node<'_>, scene: &SceneNames<'_>) -> Option<Vec<Named<Annotation>>> {
    let entries = entries(node, "annotation")?;
    let decoded: Vec<_> = entries
        .iter()
        .map(|entry| {
            let value = annotation(entry.value, scene)?;
            Some(Named { name: entry.name.clone(), value })
        })
        .collect();
    decoded.into_iter().collect()
}

const KINDS: [&str; 19] = [
    "Label",
    "Caption",
    "Card",
    "Clock",
    "Progress",
    "Image",
    "ColorBar",
    "Plot",
    "Line",
    "Arrow",
    "Polyline",
    "Trail",
    "Dimension",
    "Angle",
    "Axes",
    "Grid",
    "Triad",
    "ScaleBar",
    "Origin",
];

fn annotation(node: Node<'_>, scene: &SceneNames<'_>) -> Option<Annotation> {
    match known_word(node, "annotation", &KINDS)? {
        "Label" => label::label(node, scene),
        "Caption" => label::caption(node, None),
        "Card" => label::card(node),
        "Clock" => label::caption(node, Some("{time} s")),
        "Progress" => label::progress(node),
        "Image" => label::image(node),
        "ColorBar" => data::color_bar(node, scene),
        "Plot" => data::plot(node, scene),
        "Line" => lines::line(node, scene, false),
        "Arrow" => lines::line(node, scene, true),
        "Polyline" => lines::polyline(node),
        "Trail" => lines::trail(node, scene),
        "Dimension" => lines::dimension(node, scene),
        "Angle" => lines::angle(node, scene),
        "Axes" => axes::axes(node, scene),
        "Origin" => axes::origin(node, scene),
        "Grid" => axes::grid(node),
        "Triad" => axes::triad(node),
        _ => axes::scale_bar(node, scene),
    }
}
