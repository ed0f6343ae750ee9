//! How each format is written.

use crate::base::color::Rgb;

/// The settings of all formats; those that a run does not write do not count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Formats {
    pub png: PngSettings,
    pub jpeg: JpegSettings,
    pub ppm: PpmSettings,
    pub exr: ExrSettings,
    pub gif: GifSettings,
    pub apng: Plays,
    pub webp: Plays,
    pub y4m: Y4mSettings,
    pub mp4: Mp4Settings,
}

/// How PNG files are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PngSettings {
    /// 16 bits a channel, or 8.
    pub deep: bool,
    /// Whether the file tells in text what it shows.
    pub metadata: bool,
}

impl Default for PngSettings {
    fn default() -> Self {
        Self { deep: false, metadata: true }
    }
}

/// How JPEG files are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JpegSettings {
    /// 1..=100.
    pub quality: u8,
}

impl Default for JpegSettings {
    fn default() -> Self {
        Self { quality: 90 }
    }
}

/// How PPM files are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PpmSettings {
    /// Numbers as text (P3), instead of bytes (P6).
    pub ascii: bool,
}

/// How EXR files are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExrSettings {
    /// Colours as 16-bit floats instead of 32.
    pub half: bool,
    /// What the files hold besides the picture.
    pub layers: ExrLayers,
    /// Whether the file tells in words what it shows.
    pub metadata: bool,
}

impl Default for ExrSettings {
    fn default() -> Self {
        Self { half: false, layers: ExrLayers::default(), metadata: true }
    }
}

/// Layers of an EXR file besides the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExrLayers {
    /// The light of all that is keyed alike.
    pub lights: bool,
    pub depth: bool,
    pub normal: bool,
    pub albedo: bool,
}

impl ExrLayers {
    /// Whether tracing has to record more than light for them.
    pub fn call_for_guides(self) -> bool {
        self.depth || self.normal || self.albedo
    }

    /// Whether there are any.
    pub fn any(self) -> bool {
        self.lights || self.call_for_guides()
    }
}

/// How GIFs are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GifSettings {
    /// How often the animation plays; for ever if absent.
    pub plays: Option<u16>,
    /// Size of the palette, 2..=256.
    pub colors: u16,
    pub dither: bool,
    /// Bytes that the file may have at most: it loses colours, pixels or frames until it has no more.
    pub max_size: Option<u64>,
}

impl Default for GifSettings {
    fn default() -> Self {
        Self { plays: None, colors: 256, dither: true, max_size: None }
    }
}

/// How often an animation plays; for ever if absent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Plays(pub Option<u16>);

/// How raw video is written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Y4mSettings {
    /// Whether colour is kept at every pixel, instead of for squares of four.
    pub full_chroma: bool,
}

/// How MP4 files are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mp4Settings {
    /// 1..=100.
    pub quality: u8,
}

impl Default for Mp4Settings {
    fn default() -> Self {
        Self { quality: 75 }
    }
}

/// What pictures without alpha show where the background is left out, as linear light: a page's white.
pub const MATTE: Rgb = Rgb::ONE;
