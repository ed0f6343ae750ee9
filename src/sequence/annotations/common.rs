//! Fields that several kinds of annotations share.

use crate::annotate::{Annotation, AnnotationKind, Backdrop, Offset, PanelPlace, PanelPosition, Style};
use crate::base::math::{DVec2, DVec3};
use crate::drawing::Font;
use crate::encode::{Template, TemplateError};
use crate::sequence::colors::color;
use crate::sequence::fault::Fault;
use crate::sequence::fields::Fields;
use crate::sequence::font_files::font;
use crate::sequence::keys::keyed;
use crate::sequence::names::entries;
use crate::sequence::node::Node;
use crate::sequence::pose_columns::{TIMES, column};
use crate::sequence::pose_tracks::number_track;
use crate::sequence::poses::table;
use crate::sequence::suggest::{listed, shortened};
use crate::sequence::values::{between, each, file_path, number, one_of, positive, switch, text, tuple};
use crate::track::Animated;

/// The fields of every annotation.
pub struct Common {
    visible: Animated<bool>,
    opacity: Animated<f64>,
    style: Style,
    values: Vec<(String, Animated<f64>)>,
}

impl Common {
    /// The names of the numbers that texts may insert, and of those that the annotation knows by itself.
    pub fn names<'a>(&'a self, own: &[&'a str]) -> Vec<&'a str> {
        self.values.iter().map(|(name, _)| name.as_str()).chain(own.iter().copied()).collect()
    }

    /// An annotation with these fields.
    pub fn with(self, kind: AnnotationKind) -> Annotation {
        let Self { visible, opacity, style, values } = self;
        Annotation {
            visible,
            opacity,
            style,
            values: values.into_iter().map(|(_, value)| value).collect(),
            kind,
        }
    }
}

/// Decodes the fields of every annotation.
pub fn common(fields: &mut Fields<'_>) -> Option<Common> {
    common_over(fields, Style::default())
}

/// [`common`] with a default style of its own.
pub fn common_over(fields: &mut Fields<'_>, default: Style) -> Option<Common> {
    let visible = fields.or("visible", keyed(switch), true);
    let opacity = fields.or("opacity", keyed(between(0.0..=1.0)), 1.0);
    let color = fields.or("color", keyed(color), default.color);
    let size = fields.or("size", between(0.005..=0.5), default.size);
    let font = fields.or("font", font, Font::default());
    let backdrop = fields.or("backdrop", backdrop, default.backdrop);
    let line_width = fields.or("line_width", between(0.0005..=0.1), default.line_width);
    let values = fields.or("values", values, Vec::new());
    Some(Common {
        visible: visible?,
        opacity: opacity?,
        style: Style {
            color: color?,
            size: size?,
            font: font?,
            backdrop: backdrop?,
            line_width: line_width?,
        },
        values: values?,
    })
}

fn backdrop(node: Node<'_>) -> Option<Backdrop> {
    let node = node.as_word();
    node.ask_words("backdrop", ["None", "Halo", "Box"]);
    match (node.bare_word(), node.word()) {
        (Some("None"), _) => Some(Backdrop::None),
        (Some("Halo"), _) => Some(Backdrop::Halo),
        (Some("Box"), _) => Some(Backdrop::Box(None, 0.6)),
        (None, "Halo") => {
            let mut fields = Fields::of_or_only(node, "`Halo`", "color")?;
            let color = fields.required("color", keyed(color));
            fields.finish();
            color.map(Backdrop::HaloOf)
        }
        (None, "Box") => {
            let mut fields = Fields::of(node, "`Box`")?;
            let color = fields.optional("color", keyed(color));
            let opacity = fields.or("opacity", between(0.0..=1.0), 0.6);
            fields.finish();
            Some(Backdrop::Box(color?, opacity?))
        }
        _ => {
            node.expected("`None`, `Halo`, Halo(color), `Box` or Box(color: ..., opacity: ...)");
            None
        }
    }
}

/// Numbers over time with their names.
fn values(node: Node<'_>) -> Option<Vec<(String, Animated<f64>)>> {
    let entries = entries(node, "value")?;
    for entry in entries.iter().filter(|entry| Template::knows(&entry.name)) {
        let title = format!("`{{{}}}` already has a meaning in texts", entry.name);
        node.fault(Fault::new(entry.key.span(), title, "choose another name"));
    }
    let decoded: Vec<_> =
        entries.iter().map(|entry| Some((entry.name.clone(), number_over_time(entry.value)?))).collect();
    decoded.into_iter().collect()
}

/// A number, keys, or a column of a table.
pub fn number_over_time(node: Node<'_>) -> Option<Animated<f64>> {
    if !node.begins_with("Column") {
        return keyed(number)(node);
    }
    let mut fields = Fields::of(node, "`Column`")?;
    let mut place = node.span();
    let table = fields.required("file", |node| {
        place = node.span();
        table(node, &file_path(node)?)
    });
    let name = fields.required("column", column);
    let time = fields.optional("time", column);
    fields.finish();
    let (table, name, time) = (table?, name?, time?);
    let usual = || TIMES.into_iter().find(|name| table.has(name));
    let Some(time) = time.or_else(|| {
        usual().map(|name| crate::sequence::pose_columns::ColumnName {
            name: name.to_owned(),
            place: place.clone(),
        })
    }) else {
        let fault =
            Fault::new(place, "this table has no column of times `t` or `time`", "needs `time: \"name\"`");
        node.fault(fault.help(format!("its columns are {}", listed(table.names()))));
        return None;
    };
    match number_track(&table, &time, &name, node.file.clock.get()) {
        Ok(track) => Some(track),
        Err((place, error)) => {
            node.fault(Fault::new(place, "cannot use this column", error.to_string()));
            None
        }
    }
}

/// A text over time, with placeholders for values of these names.
pub fn template(names: &[&str]) -> impl Fn(Node<'_>) -> Option<Animated<Template>> {
    move |node| keyed(|node| one_template(node, names))(node)
}

fn one_template(node: Node<'_>, names: &[&str]) -> Option<Template> {
    let parsed = Template::with_values(&text(node)?, names);
    parsed.map_err(|error| report(node, &error)).ok()
}

fn report(node: Node<'_>, error: &TemplateError) {
    let fault = Fault::new(node.span(), error.to_string(), "cannot be written");
    node.fault(match error {
        TemplateError::Unknown(name, _) => fault
            .help(format!("numbers of your own: values: {{ \"{}\": [(0, 1), (2, 5)] }}", shortened(name))),
        _ => fault,
    });
}

/// A template that shows a text as it is.
pub fn plain(text: &str) -> Template {
    Template::parse(&text.replace('{', "{{").replace('}', "}}")).unwrap_or_default()
}

/// A place in the picture and the offset from there.
pub fn position(fields: &mut Fields<'_>, default: PanelPlace) -> Option<PanelPosition> {
    let place = fields.or("place", one_of("place", &PanelPlace::NAMED), default);
    let offset = offset(fields);
    Some(PanelPosition { place: place?, offset: offset? })
}

/// A distance in the picture: in its heights, or in pixels.
pub fn offset(fields: &mut Fields<'_>) -> Option<Offset> {
    fields.or("offset", one_offset, Offset::ZERO)
}

fn one_offset(node: Node<'_>) -> Option<Offset> {
    let what = "(right, up) in heights of the picture, or Pixels(right, up)";
    let parts = each(tuple(node, what)?, number)?;
    let vector = DVec2::from_array(parts);
    node.ask_words("offset", ["Pixels"]);
    match node.word() {
        "" => Some(Offset::Relative(vector)),
        "Pixels" => Some(Offset::Pixels(vector)),
        _ => {
            node.expected(what);
            None
        }
    }
}

/// Two numbers as a vector.
pub fn pair(node: Node<'_>) -> Option<DVec3> {
    let [x, y] = each(tuple(node, "two numbers (x, y)")?, number)?;
    Some(DVec3::new(x, y, 0.0))
}

/// A share of the picture, above 0 and up to 1.
pub fn share(node: Node<'_>) -> Option<f64> {
    positive(node).and_then(|_| between(0.0..=1.0)(node))
}
