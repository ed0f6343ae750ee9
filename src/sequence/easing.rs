//! Decodes easings and Bézier curves.

use super::node::Node;
use super::values::{each, number, tuple};
use super::words::unknown;
use crate::track::Ease;

const ALL: &str = "easings are Linear, Smooth, Smoother, Step, CatmullRom, Ease, EaseIn, EaseOut, EaseInOut, \
    Bezier(x1, y1, x2, y2), and In, Out or InOut before Sine, Quad, Cubic, Quart, Quint, Expo, Circ, Back, \
    Elastic or Bounce";

/// Any easing.
pub fn ease(node: Node<'_>) -> Option<Ease> {
    if node.begins_with("Bezier") {
        return bezier(node);
    }
    let node = node.as_word();
    node.ask_words("easing", Ease::names());
    let Some(name) = node.bare_word().filter(|word| !matches!(*word, "true" | "false")) else {
        let quoted = node.is_text() && Ease::named(node.text().trim_matches('"')).is_some();
        let help = if quoted { "write it without quotes" } else { ALL };
        node.fault(node.mismatch("an easing such as Smooth").help(help));
        return None;
    };
    let ease = Ease::named(name);
    if ease.is_none() {
        let names: Vec<String> = Ease::names().chain(["Bezier".to_owned()]).collect();
        node.fault(unknown(node, "easing", name, names.iter().map(String::as_str)).help(ALL));
    }
    ease
}

/// An easing along a path. A path is a single motion, so `Step` and `CatmullRom` are refused.
pub fn path_ease(node: Node<'_>) -> Option<Ease> {
    let ease = ease(node)?;
    if matches!(ease, Ease::Step | Ease::CatmullRom) {
        node.expected("an easing other than `Step` and `CatmullRom`");
        return None;
    }
    Some(ease)
}

fn bezier(node: Node<'_>) -> Option<Ease> {
    let nodes = tuple(node, "Bezier(x1, y1, x2, y2)")?;
    let points = each(nodes, number)?;
    let [x1, _, x2, _] = nodes;
    let inside = [(x1, points[0]), (x2, points[2])].map(|(node, x)| {
        let inside = (0.0..=1.0).contains(&x);
        if !inside {
            node.fault(node.mismatch("an x from 0 to 1").help("the order is Bezier(x1, y1, x2, y2)"));
        }
        inside
    });
    (inside == [true; 2]).then_some(Ease::Bezier(points))
}
