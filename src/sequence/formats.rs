//! Decodes the settings of output formats.

use super::fields::Fields;
use super::node::Node;
use super::schema::Ask;
use super::values::{list, switch, text, whole};
use super::words::word;
use crate::base::units::parse_bytes;
use crate::encode::{
    ExrLayers, ExrSettings, Formats, GifSettings, JpegSettings, LoopCount, Mp4Settings, PngSettings,
    PpmSettings, Y4mSettings,
};
use serde_json::json;

/// Decodes the settings of all formats.
pub fn formats(fields: &mut Fields<'_>) -> Option<Formats> {
    let default = Formats::default();
    let png = fields.or("png", png, default.png);
    let jpeg = fields.or("jpeg", jpeg, default.jpeg);
    let ppm = fields.or("ppm", ppm, default.ppm);
    let exr = fields.or("exr", exr, default.exr);
    let gif = fields.or("gif", gif, default.gif);
    let apng = fields.or("apng", |node| loop_count(node, "`apng`"), default.apng);
    let webp = fields.or("webp", |node| loop_count(node, "`webp`"), default.webp);
    let y4m = fields.or("y4m", y4m, default.y4m);
    let mp4 = fields.or("mp4", mp4, default.mp4);
    Some(Formats {
        png: png?,
        jpeg: jpeg?,
        ppm: ppm?,
        exr: exr?,
        gif: gif?,
        apng: apng?,
        webp: webp?,
        y4m: y4m?,
        mp4: mp4?,
    })
}

fn png(node: Node<'_>) -> Option<PngSettings> {
    let mut fields = Fields::of(node, "`png`")?;
    let deep = fields.or("bits", bits, false);
    let metadata = fields.or("metadata", switch, true);
    fields.finish();
    Some(PngSettings { deep: deep?, metadata: metadata? })
}

/// Decodes 8 or 16. Returns true for 16.
fn bits(node: Node<'_>) -> Option<bool> {
    node.ask(|| Ask::plain(&json!({"enum": [8, 16]})));
    match node.text() {
        "8" => Some(false),
        "16" => Some(true),
        _ => {
            node.expected("8 or 16");
            None
        }
    }
}

fn jpeg(node: Node<'_>) -> Option<JpegSettings> {
    let quality = quality(node, "`jpeg`", JpegSettings::default().quality)?;
    Some(JpegSettings { quality })
}

fn ppm(node: Node<'_>) -> Option<PpmSettings> {
    let mut fields = Fields::of(node, "`ppm`")?;
    let ascii = fields.or("ascii", switch, false);
    fields.finish();
    Some(PpmSettings { ascii: ascii? })
}

fn mp4(node: Node<'_>) -> Option<Mp4Settings> {
    let quality = quality(node, "`mp4`", Mp4Settings::default().quality)?;
    Some(Mp4Settings { quality })
}

fn quality(node: Node<'_>, what: &'static str, default: u8) -> Option<u8> {
    let mut fields = Fields::of(node, what)?;
    let quality = fields.or("quality", whole(1..=100), u32::from(default));
    fields.finish();
    Some(quality? as u8)
}

fn exr(node: Node<'_>) -> Option<ExrSettings> {
    let mut fields = Fields::of(node, "`exr`")?;
    let precisions = [("Float", false), ("Half", true)];
    let half = fields.or("precision", |node| word(node, "precision", &precisions), false);
    let layers = fields.or("layers", exr_layers, ExrLayers::default());
    let metadata = fields.or("metadata", switch, true);
    fields.finish();
    Some(ExrSettings { half: half?, layers: layers?, metadata: metadata? })
}

#[derive(Clone, Copy)]
enum ExrLayer {
    Lights,
    Depth,
    Normal,
    Albedo,
    Samples,
}

fn exr_layers(node: Node<'_>) -> Option<ExrLayers> {
    let names = [
        ("Lights", ExrLayer::Lights),
        ("Depth", ExrLayer::Depth),
        ("Normal", ExrLayer::Normal),
        ("Albedo", ExrLayer::Albedo),
        ("Samples", ExrLayer::Samples),
    ];
    let mut layers = ExrLayers::default();
    for layer in list(node, "layers", |node| word(node, "layer", &names))? {
        match layer {
            ExrLayer::Lights => layers.lights = true,
            ExrLayer::Depth => layers.depth = true,
            ExrLayer::Normal => layers.normal = true,
            ExrLayer::Albedo => layers.albedo = true,
            ExrLayer::Samples => layers.samples = true,
        }
    }
    Some(layers)
}

fn gif(node: Node<'_>) -> Option<GifSettings> {
    let default = GifSettings::default();
    let mut fields = Fields::of(node, "`gif`")?;
    let plays = fields.renamed("loop_count", "plays", whole(1..=u16::MAX.into()));
    let colors = fields.or("colors", whole(2..=256), u32::from(default.colors));
    let dither = fields.or("dither", switch, default.dither);
    let max_size = fields.optional("max_size", size);
    fields.finish();
    let (plays, colors) = (plays?.map(|plays| plays as u16), colors? as u16);
    Some(GifSettings { loop_count: plays, colors, dither: dither?, max_size: max_size? })
}

/// `"5 MB"`.
fn size(node: Node<'_>) -> Option<u64> {
    let size = parse_bytes(&text(node)?);
    if size.is_none() {
        node.expected("a size such as \"5 MB\", \"800 kB\" or \"2 MiB\", at least 1 kB");
    }
    size
}

fn loop_count(node: Node<'_>, what: &'static str) -> Option<LoopCount> {
    let mut fields = Fields::of(node, what)?;
    let plays = fields.renamed("loop_count", "plays", whole(1..=u16::MAX.into()));
    fields.finish();
    Some(LoopCount(plays?.map(|plays| plays as u16)))
}

fn y4m(node: Node<'_>) -> Option<Y4mSettings> {
    let mut fields = Fields::of(node, "`y4m`")?;
    let chromas = [("C420", false), ("C444", true)];
    let full = fields.or("chroma", |node| word(node, "chroma", &chromas), false);
    fields.finish();
    Some(Y4mSettings { full_chroma: full? })
}
