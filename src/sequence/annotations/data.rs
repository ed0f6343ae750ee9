//! Decodes colour bars and plots.

use super::axes::range;
use super::common::{Common, common, number_over_time, plain, position, share, template};
use super::scene_names::SceneNames;
use crate::annotate::{Annotation, AnnotationKind, ColorBar, LineChart, PanelPlace, PlotSeries};
use crate::appearance::texture::{DataSource, DataTexture};
use crate::base::time::Time;
use crate::encode::Template;
use crate::sequence::colors::color;
use crate::sequence::fault::Fault;
use crate::sequence::fields::Fields;
use crate::sequence::keys::{key_time, keyed};
use crate::sequence::names::entries;
use crate::sequence::node::Node;
use crate::sequence::values::{each, switch, text, tuple, whole};
use crate::track::{Animated, Key};

pub fn color_bar(node: Node<'_>, scene: &SceneNames<'_>) -> Option<Annotation> {
    let mut fields = Fields::of(node, "a colour bar")?;
    let common = common(&mut fields);
    let of_object = fields.has("object");
    if of_object == fields.has("material") {
        let title = "a colour bar explains the numbers of an `object` or of a `material`";
        let label = if of_object { "one too many" } else { "needs one of them" };
        node.fault(Fault::new(node.head(), title, label));
        return None;
    }
    let source = match of_object {
        true => fields.required("object", |node| scene.data_of_object(node)),
        false => fields.required("material", |node| scene.data_of_material(node)),
    };
    let title = title(&mut fields, common.as_ref());
    let unit = fields.or("unit", text, String::new());
    let position = position(&mut fields, PanelPlace::Right);
    let upright = fields.or("vertical", switch, true);
    let length = fields.or("length", share, 0.5);
    let thickness = fields.or("thickness", share, 0.035);
    let ticks = fields.or("ticks", whole(1..=50), 6u32);
    fields.finish();
    let source = source?;
    let Some(range) = source.range else {
        node.fault(Fault::new(
            node.head(),
            "the numbers of this colour bar have no range",
            "nothing to show",
        ));
        return None;
    };
    let unit = unit?;
    let title = match title? {
        None => plain(&usual_title(&source, &unit)).into(),
        Some(title) if unit.is_empty() => title,
        Some(Animated::Constant(title)) => title.followed_by(&in_brackets(&unit)).into(),
        Some(Animated::Keyed(titles)) => {
            let with_unit =
                |key: Key<Template>| Key { value: key.value.followed_by(&in_brackets(&unit)), ..key };
            Animated::Keyed(titles.map(with_unit))
        }
    };
    let kind = AnnotationKind::ColorBar(ColorBar {
        range,
        scale: source.scale,
        map: source.map,
        title,
        position: position?,
        upright: upright?,
        length: length?,
        thickness: thickness?,
        ticks: ticks? as usize,
    });
    Some(common?.with(kind))
}

/// The name of data with its unit.
fn usual_title(source: &DataTexture, unit: &str) -> String {
    let name = match &source.source {
        DataSource::Coordinate(axis) => ["x", "y", "z"][*axis as usize % 3].to_owned(),
        DataSource::Array(key) => key.name.clone(),
    };
    if unit.is_empty() { name } else { name + &in_brackets(unit) }
}

fn in_brackets(unit: &str) -> String {
    format!(" ({unit})")
}

fn title(fields: &mut Fields<'_>, common: Option<&Common>) -> Option<Option<Animated<Template>>> {
    let names = common.map(|common| common.names(&[])).unwrap_or_default();
    fields.optional("title", template(&names))
}

pub fn plot(node: Node<'_>, scene: &SceneNames<'_>) -> Option<Annotation> {
    let mut fields = Fields::of(node, "a plot")?;
    let common = common(&mut fields);
    let whole = scene.timeline.map_or([0, 1].map(Time::from_integer), |timeline| {
        [Time::from_integer(0), timeline.rate.time_of(timeline.frames.max(2) - 1)]
    });
    let times = fields.or("times", times, whole);
    let series = fields.required("series", |node| series(node, times.unwrap_or(whole)));
    let title = title(&mut fields, common.as_ref());
    let position = position(&mut fields, PanelPlace::BottomLeft);
    let size = fields.or("area", |node| each(tuple(node, "two shares (width, height)")?, share), [0.3, 0.25]);
    let range = fields.optional("range", range);
    let grows = fields.or("grow", switch, false);
    fields.finish();
    let kind = AnnotationKind::Plot(LineChart {
        series: series?,
        title: title?.unwrap_or_else(|| Template::default().into()),
        position: position?,
        size: size?,
        times: times?,
        range: range?,
        grows: grows?,
    });
    Some(common?.with(kind))
}

/// The first and the last time.
fn times(node: Node<'_>) -> Option<[Time; 2]> {
    let times = each(tuple(node, "two times (first, last)")?, key_time)?;
    if times[0] < times[1] {
        return Some(times);
    }
    node.expected("two times (first, last), the first one before the second");
    None
}

/// Lines with their names.
fn series(node: Node<'_>, times: [Time; 2]) -> Option<Vec<PlotSeries>> {
    let entries = entries(node, "series")?;
    if entries.is_empty() {
        node.fault(Fault::new(node.span(), "a plot without a series shows nothing", "needs at least one"));
        return None;
    }
    let one = |node: Node<'_>, name: &str| {
        // A number over time, or one with a colour.
        let plain = node.begins_with("Column") || !node.opens_with('(');
        if plain {
            return Some(PlotSeries::new(name.to_owned(), number_over_time(node)?, None, times));
        }
        let mut fields = Fields::of(node, "a series")?;
        let value = fields.required("value", number_over_time);
        let color = fields.optional("color", keyed(color));
        let named = fields.or("name", text, name.to_owned());
        fields.finish();
        Some(PlotSeries::new(named?, value?, color?, times))
    };
    let decoded: Vec<_> = entries.iter().map(|entry| one(entry.value, &entry.name)).collect();
    decoded.into_iter().collect()
}
