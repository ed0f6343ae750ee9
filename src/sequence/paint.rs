//! Decodes paint: a colour, an image, data, or a pattern of two paints.

use super::colors::{color, color_or};
use super::data::scalar;
use super::fields::Fields;
use super::image::image;
use super::keys::keyed;
use super::node::{Node, NodeContent};
use super::suggest::shortened;
use super::transform::turn;
use super::values::{each, not_negative, number, one_of, switch, tuple, unit_vector, vector, whole};
use super::words::Variants;
use crate::appearance::texture::{
    ColorChannel, ColorEncoding, Image, ImageTextureTracks, Pattern, PatternTextureTracks, SharedAsset,
    TextureFilter, TextureMappingTracks, TextureSpace, TextureTracks, Wrap,
};
use crate::base::color::Rgb;
use crate::base::math::DVec3;

/// Decodes a colour over time, or any other paint.
pub fn paint(node: Node<'_>) -> Option<TextureTracks> {
    if node.is_text() && node.text().contains('.') {
        let fault = node.mismatch("a colour, or another paint");
        node.fault(fault.help(format!("an image is written Image({})", shortened(node.text()))));
        return None;
    }
    let table: &Variants<'_, TextureTracks> = &[
        ("Image", image_paint),
        ("VertexColor", vertex_color),
        ("Scalar", scalar),
        ("Checker", |node| pattern(node, "`Checker`", |_| Some(Pattern::Checker))),
        ("Stripes", |node| pattern(node, "`Stripes`", |_| Some(Pattern::Stripes))),
        ("Waves", |node| pattern(node, "`Waves`", |_| Some(Pattern::Waves))),
        ("Dots", |node| pattern(node, "`Dots`", |_| Some(Pattern::Dots))),
        ("Islands", |node| pattern(node, "`Islands`", |_| Some(Pattern::Islands))),
        ("Gradient", |node| pattern(node, "`Gradient`", gradient)),
        ("Noise", |node| pattern(node, "`Noise`", noise)),
        ("Marble", |node| pattern(node, "`Marble`", marble)),
    ];
    color_or(node, "paint", table)
}

/// Decodes the encoding of an image.
pub fn encoding(node: Node<'_>) -> Option<ColorEncoding> {
    one_of("encoding", &[("Srgb", ColorEncoding::Srgb), ("Linear", ColorEncoding::Linear)])(node)
}

fn vertex_color(node: Node<'_>) -> Option<TextureTracks> {
    Fields::of(node, "`VertexColor`")?.finish();
    Some(TextureTracks::VertexColor)
}

/// `Image("file.png")`, or with more fields.
fn image_paint(node: Node<'_>) -> Option<TextureTracks> {
    image_fields(Fields::of_or_only(node, "`Image`", "file")?, ColorEncoding::Srgb)
}

/// An image without further fields.
pub fn plain_image(image: SharedAsset<Image>) -> TextureTracks {
    TextureTracks::Image(Box::new(ImageTextureTracks {
        image,
        wrap: None,
        axis_wraps: None,
        filter: TextureFilter::default(),
        channel: None,
        tint: Rgb::ONE.into(),
        alpha: true,
        mapping: TextureMappingTracks::default(),
    }))
}

/// The fields of an image whose numbers are by default in this encoding. Reports unknown fields.
pub fn image_fields(mut fields: Fields<'_>, default: ColorEncoding) -> Option<TextureTracks> {
    let wraps = &[("Repeat", Wrap::Repeat), ("Mirror", Wrap::Mirror), ("Clamp", Wrap::Clamp)];
    let filters = &[("Bilinear", TextureFilter::Bilinear), ("Nearest", TextureFilter::Nearest)];
    let channels = &[("R", ColorChannel::R), ("G", ColorChannel::G), ("B", ColorChannel::B)];
    let encoding = fields.or("encoding", encoding, default);
    let image = fields.required("file", image(encoding.unwrap_or(default)));
    let wrap = fields.optional("wrap", one_of("wrap", wraps));
    let filter = fields.or("filter", one_of("filter", filters), TextureFilter::Bilinear);
    let channel = fields.optional("channel", one_of("channel", channels));
    let tint = fields.or("tint", keyed(color), Rgb::ONE);
    let alpha = fields.or("alpha", switch, true);
    let placement = placement(&mut fields);
    fields.finish();
    encoding?;
    Some(TextureTracks::Image(Box::new(ImageTextureTracks {
        image: image?,
        wrap: wrap?,
        axis_wraps: None,
        filter: filter?,
        channel: channel?,
        tint: tint?,
        alpha: alpha?,
        mapping: placement?,
    })))
}

/// A pattern of the paints `a` and `b`. `kind` decodes the pattern's own fields.
fn pattern<'s>(
    node: Node<'s>,
    what: &'static str,
    kind: impl FnOnce(&mut Fields<'s>) -> Option<Pattern>,
) -> Option<TextureTracks> {
    let mut fields = Fields::of(node, what)?;
    let first = fields.or("a", paint, Rgb::ZERO);
    let second = fields.or("b", paint, Rgb::ONE);
    let spaces = &[("Object", TextureSpace::Object), ("Uv", TextureSpace::Uv)];
    let space = fields.or("space", one_of("space", spaces), TextureSpace::Object);
    let placement = placement(&mut fields);
    let pattern = kind(&mut fields);
    fields.finish();
    Some(TextureTracks::Pattern(Box::new(PatternTextureTracks {
        pattern: pattern?,
        space: space?,
        mapping: placement?,
        first: first?,
        second: second?,
    })))
}

fn gradient(fields: &mut Fields<'_>) -> Option<Pattern> {
    Some(Pattern::Gradient { axis: fields.or("axis", unit_vector, DVec3::Y)? })
}

fn noise(fields: &mut Fields<'_>) -> Option<Pattern> {
    let (octaves, seed) = (octaves(fields), seed(fields));
    Some(Pattern::Noise { octaves: octaves?, seed: seed? })
}

fn marble(fields: &mut Fields<'_>) -> Option<Pattern> {
    let (octaves, seed) = (octaves(fields), seed(fields));
    let turbulence = fields.or("turbulence", not_negative, 1.0);
    Some(Pattern::Marble { octaves: octaves?, seed: seed?, turbulence: turbulence? })
}

/// Finer octaves would not be visible.
const MAX_OCTAVES: u32 = 16;

fn octaves(fields: &mut Fields<'_>) -> Option<u32> {
    fields.or("octaves", whole(1..=MAX_OCTAVES), 4u32)
}

fn seed(fields: &mut Fields<'_>) -> Option<u32> {
    fields.or("seed", whole(0..=u32::MAX), 0u32)
}

/// Decodes the placement of a pattern or an image.
fn placement(fields: &mut Fields<'_>) -> Option<TextureMappingTracks> {
    let default = TextureMappingTracks::default();
    let offset = fields.or("offset", keyed(offset), default.offset);
    let rotation = fields.or("rotation", turn(DVec3::Z), default.rotation);
    let scale = fields.or("scale", keyed(scale), default.scale);
    Some(TextureMappingTracks { offset: offset?, rotation: rotation?, scale: scale?, first: None })
}

fn offset(node: Node<'_>) -> Option<DVec3> {
    two_or_three(node, 0.0)
}

/// One factor, or one for each axis.
fn scale(node: Node<'_>) -> Option<DVec3> {
    let factors =
        if node.opens_with('(') { two_or_three(node, 1.0)? } else { number(node).map(DVec3::splat)? };
    if factors.abs().min_element() >= SMALLEST {
        return Some(factors);
    }
    node.fault(node.mismatch("a scale other than 0").label("leaves nothing to see"));
    None
}

/// The minimum absolute value of a factor, so that reciprocals do not overflow.
const SMALLEST: f64 = 1e-30;

/// `(x, y)` or `(x, y, z)`. The shorter form gets the given `z`.
fn two_or_three(node: Node<'_>, z: f64) -> Option<DVec3> {
    match node.content()? {
        NodeContent::Tuple(items) if node.word().is_empty() && items.len() == 2 => {
            each(tuple(node, "two numbers (x, y)")?, number).map(|[x, y]| DVec3::new(x, y, z))
        }
        NodeContent::Tuple(items) if items.len() == 3 => vector(node),
        _ => {
            node.expected("two or three numbers (x, y) or (x, y, z)");
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::appearance::texture::{Image, Texture, TextureEvalContext};
    use crate::base::files::Root;
    use crate::base::time::Time;
    use crate::sequence::Faults;
    use crate::sequence::expand::source::{Source, Sources};
    use crate::sequence::source_file::File;
    use std::path::Path;

    fn read(text: &str) -> Result<TextureTracks, String> {
        let file = File::new(text, Path::new("tests/bad/images"), Root::of(Path::new("")), false);
        let paint = paint(file.root());
        let faults = file.into_faults();
        paint.filter(|_| faults.is_empty()).ok_or_else(|| {
            let source = Source { name: "test.ron".to_owned(), text: text.to_owned(), ..Source::default() };
            Faults::new(Sources::new(source), faults).to_string()
        })
    }

    fn at_start(text: &str) -> Texture {
        read(text).unwrap_or_else(|faults| panic!("{faults}")).at(Time::from_integer(0))
    }

    fn color(text: &str, x: f64, y: f64) -> Rgb {
        let point = DVec3::new(x, y, 0.0).into();
        let (uv, color) = ([x, y], Rgb::X.into());
        let context = TextureEvalContext { uv, point, color, ..TextureEvalContext::nowhere() };
        at_start(text).at(&context, true).color.into()
    }

    #[test]
    fn colors_are_paints() {
        for text in
            ["(1, 0.5, 0)", "0.5", "\"#888\"", "Srgb(1, 2, 3)", "Linear8(0, 0, 0)", "Track(keys: [(0, 1)])"]
        {
            assert!(at_start(text).constant().is_some(), "{text}");
        }
        assert_eq!(color("[(0, 1), (1, 0)]", 0.0, 0.0), Rgb::ONE);
        assert_eq!(color("VertexColor", 0.0, 0.0), Rgb::X);
    }

    #[test]
    fn patterns_are_placed_and_nested() {
        let text = "Checker(a: Stripes(a: (1, 0, 0), b: (0, 1, 0), scale: 0.5), b: 0.25, scale: (2, 2), offset: (1, 0))";
        assert_eq!(color(text, 1.25, 0.5), Rgb::X);
        assert_eq!(color(text, 1.75, 0.5), Rgb::Y);
        assert_eq!(color(text, 3.5, 0.5), Rgb::splat(0.25));
        assert_eq!(color("Gradient()", 0.0, 0.25), Rgb::splat(0.25));
        assert_eq!(color("Gradient(rotation: 90, space: Uv)", -0.25, 0.0), Rgb::splat(0.25));
        assert_eq!(color("Gradient(axis: (0, 0, 2), rotation: Euler(x: -90))", 0.0, 0.25), Rgb::splat(0.25));
        for text in [
            "Waves",
            "Dots()",
            "Islands",
            "Noise(octaves: 1, seed: 7)",
            "Marble(turbulence: 2, offset: [(0, (0, 0)), (1, (1, 0, 0))])",
        ] {
            assert!(at_start(text).constant().is_none(), "{text}");
        }
    }

    #[test]
    fn images_are_read_once_per_encoding() {
        let tracks =
            read("Checker(a: Image(\"2x2.png\"), b: Image(file: \"2x2.png\", channel: G, wrap: Clamp))");
        let Ok(TextureTracks::Pattern(pattern)) = tracks else { panic!("a pattern: {tracks:?}") };
        let (TextureTracks::Image(one), TextureTracks::Image(other)) = (pattern.first, pattern.second) else {
            panic!("two images")
        };
        assert_eq!(one.image, other.image);
        assert_eq!((one.wrap, other.wrap, other.channel), (None, Some(Wrap::Clamp), Some(ColorChannel::G)));
        let linear = read("Image(file: \"2x2.png\", encoding: Linear, filter: Nearest, scale: 0.5)");
        let Ok(TextureTracks::Image(linear)) = linear else { panic!("an image: {linear:?}") };
        assert_ne!(one.image, linear.image);
        let bottom_right = Image::texel(&linear.image, 1, 1);
        assert_eq!(bottom_right, Rgb::splat(60.0 / 255.0));
        let context = TextureEvalContext { uv: [0.4, 0.6], ..TextureEvalContext::nowhere() };
        let seen = Texture::Image(linear.at(Time::from_integer(0))).at(&context, true);
        assert_eq!(Rgb::from(seen.color), bottom_right, "twice as small, so it is seen twice");
    }

    #[test]
    fn faults_are_reported() {
        for (text, message) in [
            ("Chekcer(a: 1)", "there is no paint `Chekcer`"),
            ("Chekcer(a: 1)", "did you mean `Checker`?"),
            ("red", "besides colours there are `Image`, `VertexColor`"),
            ("Image(\"none.png\")", "cannot read the image \"none.png\""),
            ("Image(\"none.png\")", "there is no such file"),
            ("Image(file: \"2x2.png\", wrap: Mirrored)", "there is no wrap `Mirrored`"),
            ("Image(file: \"2x2.png\", wrap: \"Clamp\")", "`wrap`: expected `Repeat`, `Mirror` or `Clamp`"),
            ("Image(file: \"2x2.png\", channel: A)", "there is no channel `A`"),
            ("Image(wrap: Clamp)", "`Image` has no `file`"),
            ("Image(2)", "`file`: expected text in quotes"),
            ("Checker(scale: 0)", "`scale`: expected a scale other than 0"),
            ("Checker(scale: [(0, 1), (1, (1, 0))])", "`scale`: expected a scale other than 0"),
            ("Checker(offset: 1)", "`offset`: expected two or three numbers (x, y) or (x, y, z)"),
            ("Checker(a: Dots(b: -1))", "`b`: expected a number of 0 or more"),
            ("Noise(octaves: 17)", "`octaves`: expected a whole number from 1 to 16"),
            ("[(0, Image(\"2x2.png\"))]", "expected a colour"),
        ] {
            let faults = read(text).expect_err(text);
            assert!(faults.contains(message), "{faults}");
        }
    }
}
