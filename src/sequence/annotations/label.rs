//! Decodes text, progress and images.

use super::anchor::anchor;
use super::common::{common, common_over, offset, plain, position, share, template};
use super::scene_names::SceneNames;
use crate::annotate::{
    Annotation, AnnotationKind, Backdrop, Behind, CaptionText, Card, Label, Logo, PanelPlace, PanelPosition,
    ProgressBar, Style,
};
use crate::appearance::texture::{ColorEncoding, Image};
use crate::base::color::{Rgb, linear_to_srgb};
use crate::drawing::Bitmap;
use crate::encode::Template;
use crate::sequence::colors::color;
use crate::sequence::fault::Fault;
use crate::sequence::fields::Fields;
use crate::sequence::image::image as image_file;
use crate::sequence::keys::keyed;
use crate::sequence::node::Node;
use crate::sequence::values::{one_of, switch};
use crate::track::Animated;

pub fn label(node: Node<'_>, scene: &SceneNames<'_>) -> Option<Annotation> {
    let mut fields = Fields::of(node, "a label")?;
    let common = common(&mut fields);
    let names = common.as_ref().map(|common| common.names(&[])).unwrap_or_default();
    let text = fields.required("text", template(&names));
    let at = fields.required("at", anchor(scene));
    let offset = offset(&mut fields);
    let leader = fields.or("leader", switch, false);
    let places = &[("Hide", Behind::Hide), ("Fade", Behind::Fade), ("Show", Behind::Show)];
    let behind = fields.or("behind", one_of("choice", places), Behind::default());
    let avoid = fields.or("avoid", switch, true);
    fields.finish();
    let kind = AnnotationKind::Label(Label {
        text: text?,
        at: at?,
        offset: offset?,
        leader: leader?,
        behind: behind?,
        avoid: avoid?,
    });
    Some(common?.with(kind))
}

/// A caption, or a clock with its usual text.
pub fn caption(node: Node<'_>, usual: Option<&str>) -> Option<Annotation> {
    let what = if usual.is_some() { "a clock" } else { "a caption" };
    let mut fields = match node.is_text() {
        true => Fields::only(node, what, "text"),
        false => Fields::of_or_only(node, what, "text")?,
    };
    let common = common_over(&mut fields, Style::of_captions());
    let names = common.as_ref().map(|common| common.names(&[])).unwrap_or_default();
    let text: Option<Animated<Template>> = match usual {
        Some(usual) => {
            let usual = Template::parse(usual).unwrap_or_else(|_| plain(usual));
            fields.or("text", template(&names), usual)
        }
        None => fields.required("text", template(&names)),
    };
    let place = fields.renamed("place", "corner", one_of("place", &PanelPlace::NAMED));
    let offset = offset(&mut fields);
    fields.finish();
    let default = if usual.is_some() { PanelPlace::TopRight } else { PanelPlace::BottomLeft };
    let position = PanelPosition { place: place?.unwrap_or(default), offset: offset? };
    Some(common?.with(AnnotationKind::Caption(CaptionText { text: text?, position })))
}

pub fn card(node: Node<'_>) -> Option<Annotation> {
    let mut fields = Fields::of_or_only(node, "a card", "title")?;
    let style = Style { backdrop: Backdrop::None, ..Style::default() };
    let common = common_over(&mut fields, style);
    let names = common.as_ref().map(|common| common.names(&[])).unwrap_or_default();
    let title = fields.required("title", template(&names));
    let text = fields.or("text", template(&names), Template::default());
    let background = fields.or("background", keyed(color), Rgb::ZERO);
    fields.finish();
    let kind = AnnotationKind::Card(Card { title: title?, text: text?, background: background? });
    Some(common?.with(kind))
}

pub fn progress(node: Node<'_>) -> Option<Annotation> {
    let mut fields = Fields::of(node, "`Progress`")?;
    let common = common(&mut fields);
    let position = position(&mut fields, PanelPlace::Bottom);
    let length = fields.or("length", share, 0.9);
    let thickness = fields.or("thickness", share, 0.012);
    fields.finish();
    let kind = ProgressBar { position: position?, length: length?, thickness: thickness? };
    Some(common?.with(AnnotationKind::Progress(kind)))
}

pub fn image(node: Node<'_>) -> Option<Annotation> {
    let mut fields = Fields::of_or_only(node, "`Image`", "file")?;
    let common = common(&mut fields);
    let image = fields.required("file", |node| {
        let image = image_file(ColorEncoding::Srgb)(node)?;
        let bitmap = bitmap(&image);
        if bitmap.is_none() {
            node.fault(Fault::new(node.span(), "this image has no pixels", "cannot be shown"));
        }
        bitmap
    });
    let position = position(&mut fields, PanelPlace::BottomRight);
    let height = fields.or("height", share, 0.12);
    fields.finish();
    let kind = Logo { image: image?, position: position?, height: height? };
    Some(common?.with(AnnotationKind::Image(kind)))
}

/// An image as display codes.
fn bitmap(image: &Image) -> Option<Bitmap> {
    let (width, height) = (image.width(), image.height());
    let code = |linear: f32| (linear_to_srgb(f64::from(linear).clamp(0.0, 1.0)) * 255.0 + 0.5) as u8;
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let pixel = |(x, y): (u32, u32)| {
        let [r, g, b] = image.texel(x, y).to_array().map(code);
        [r, g, b, (image.alpha(x, y) * 255.0 + 0.5) as u8]
    };
    Bitmap::new(width as usize, height as usize, places.map(pixel).collect())
}
