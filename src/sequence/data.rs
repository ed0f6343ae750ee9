//! Decodes `Scalar`: numbers of a surface as the colours of a map.

use super::colors::color;
use super::fault::Fault;
use super::fields::Fields;
use super::node::Node;
use super::values::{each, is_number, list, number, one_of, switch, text, tuple, whole};
use super::words::word;
use crate::appearance::texture::color_map::DEFAULT_STEPS;
use crate::appearance::texture::{
    ColorMap, DataScale, DataSource, DataTexture, NamedMap, SharedAsset, TextureTracks,
};
use crate::base::color::{Rgb, hex_color};
use crate::geometry::mesh::{ArrayKey, Centering, Component};

/// `Scalar("pressure")`, or with more fields.
pub fn scalar(node: Node<'_>) -> Option<TextureTracks> {
    let mut fields = Fields::of_or_only(node, "`Scalar`", "of")?;
    let source = source(&mut fields);
    let map = fields.or("map", map, ListedMap::Named(NamedMap::Viridis));
    let reverse = fields.or("reverse", switch, false);
    let steps = fields.or("steps", whole(2..=DEFAULT_STEPS), DEFAULT_STEPS);
    let scale = fields.or("scale", one_of("scale", SCALES), DataScale::Linear);
    let range = fields.optional("range", |node| range(node, scale.unwrap_or_default()));
    let missing = fields.or("nan", color, hex_color("#888888").unwrap_or(Rgb::ONE));
    fields.finish();
    let (range, steps) = (range?.flatten(), steps?);
    let map = match map? {
        ListedMap::Named(map) => ColorMap::named(map, steps),
        ListedMap::Colors(colors) => ColorMap::between(&colors, steps),
    };
    Some(TextureTracks::Data(Box::new(DataTexture {
        source: source?,
        scale: scale?,
        range,
        auto: range.is_none(),
        map: SharedAsset::new(if reverse? { map.reversed() } else { map }),
        missing: missing?,
    })))
}

const SCALES: &[(&str, DataScale)] = &[("Linear", DataScale::Linear), ("Log", DataScale::Log)];

const AXES: &[(&str, u32)] = &[("X", 0), ("Y", 1), ("Z", 2)];

/// A map as a file gives it.
enum ListedMap {
    Named(NamedMap),
    Colors(Vec<Rgb>),
}

const MAPS: &[(&str, NamedMap)] = &[
    ("Viridis", NamedMap::Viridis),
    ("Magma", NamedMap::Magma),
    ("Inferno", NamedMap::Inferno),
    ("Plasma", NamedMap::Plasma),
    ("Cividis", NamedMap::Cividis),
    ("Turbo", NamedMap::Turbo),
    ("Coolwarm", NamedMap::Coolwarm),
    ("Grey", NamedMap::Grey),
];

fn map(node: Node<'_>) -> Option<ListedMap> {
    if !node.opens_with('[') {
        return word(node, "colour map", MAPS).map(ListedMap::Named);
    }
    let colors = list(node, "colours", color)?;
    if colors.len() < 2 {
        node.expected("a colour map such as Viridis, or a list of at least two colours");
        return None;
    }
    Some(ListedMap::Colors(colors))
}

/// A coordinate, or the name of a mesh's data with its own fields.
fn source(fields: &mut Fields<'_>) -> Option<DataSource> {
    let of = fields.required("of", |node| {
        if node.is_text() {
            return text(node).map(ArrayKey::whole).map(DataSource::Array);
        }
        node.ask_words("coordinate", AXES.iter().map(|(axis, _)| axis));
        let Some(name) = node.bare_word().filter(|name| !AXES.iter().any(|(axis, _)| axis == name)) else {
            return word(node, "coordinate", AXES).map(DataSource::Coordinate);
        };
        let fault = node.mismatch("the name of a mesh's data in quotes, or the coordinate X, Y or Z");
        node.fault(fault.help(format!("write \"{}\"", super::suggest::shortened(name))));
        None
    });
    let component = fields.optional("component", component);
    let centerings = &[("Points", Centering::Points), ("Cells", Centering::Cells)];
    let centering = fields.optional("data", one_of("kind of data", centerings));
    match (of?, component?, centering?) {
        (DataSource::Array(key), component, centering) => {
            let component = component.unwrap_or(Component::Whole);
            Some(DataSource::Array(ArrayKey { centering, component, ..key }))
        }
        (coordinate, None, None) => Some(coordinate),
        _ => {
            let name = if fields.has("component") { "component" } else { "data" };
            let title = format!("a coordinate has no `{name}`");
            fields.node().fault(Fault::new(fields.place(name), title, "only for data of a mesh"));
            None
        }
    }
}

fn component(node: Node<'_>) -> Option<Component> {
    const NAMES: &[(&str, Component)] = &[
        ("Magnitude", Component::Whole),
        ("X", Component::Index(0)),
        ("Y", Component::Index(1)),
        ("Z", Component::Index(2)),
    ];
    match is_number(node) {
        true => whole(0..=u32::MAX)(node).map(Component::Index),
        false => word(node, "component", NAMES),
    }
}

/// The ends of the range; `Some(None)` for `Auto`.
fn range(node: Node<'_>, scale: DataScale) -> Option<Option<[f64; 2]>> {
    node.ask_words("range", ["Auto"]);
    if !node.word().is_empty() {
        return word(node, "range", &[("Auto", None)]);
    }
    let [min, max] = each(tuple(node, "two numbers (lowest, highest), or Auto")?, number)?;
    if min >= max {
        let found = format!("{min:?} is not below {max:?}");
        let fault = Fault::expected(node.span(), "a lower and a higher number (lowest, highest)", found);
        node.fault(fault.help("`reverse: true` turns the colours around"));
        return None;
    }
    if !scale.has(min) {
        let fault = Fault::expected(node.span(), "two numbers above 0", format!("found {min:?}"));
        node.fault(fault.help("the logarithmic scale begins above 0"));
        return None;
    }
    Some(Some([min, max]))
}
