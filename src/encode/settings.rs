//! Settings of the output formats.

use crate::base::color::Rgb;

/// The settings of all formats. Settings of formats that a run does not write have no effect.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Formats {
    pub png: PngSettings,
    pub jpeg: JpegSettings,
    pub ppm: PpmSettings,
    pub exr: ExrSettings,
    pub gif: GifSettings,
    pub apng: LoopCount,
    pub webp: LoopCount,
    pub y4m: Y4mSettings,
    pub mp4: Mp4Settings,
}

/// Settings of PNG files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PngSettings {
    /// 16 bits per channel instead of 8.
    pub deep: bool,
    /// Whether the file holds metadata as text.
    pub metadata: bool,
}

impl Default for PngSettings {
    fn default() -> Self {
        Self { deep: false, metadata: true }
    }
}

/// Settings of JPEG files.
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

/// Settings of PPM files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PpmSettings {
    /// Numbers as text (P3) instead of bytes (P6).
    pub ascii: bool,
}

/// Settings of EXR files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExrSettings {
    /// Colours as 16-bit floats instead of 32-bit floats.
    pub half: bool,
    /// Layers besides the picture.
    pub layers: ExrLayers,
    /// Whether the file holds metadata as text.
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
    /// One layer per light group.
    pub lights: bool,
    pub depth: bool,
    pub normal: bool,
    pub albedo: bool,
    /// The light before it was denoised.
    pub samples: bool,
}

impl ExrLayers {
    /// Whether the film has to record denoising features for them.
    pub fn need_features(self) -> bool {
        self.depth || self.normal || self.albedo
    }

    /// Whether any layer is requested.
    pub fn any(self) -> bool {
        self.lights || self.samples || self.need_features()
    }
}

/// Settings of GIFs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GifSettings {
    /// How often the animation plays; None means forever.
    pub loop_count: Option<u16>,
    /// Size of the palette, 2..=256.
    pub colors: u16,
    pub dither: bool,
    /// Maximum size of the file in bytes. Colours, pixels or frames are dropped until the file is small enough.
    pub max_size: Option<u64>,
}

impl Default for GifSettings {
    fn default() -> Self {
        Self { loop_count: None, colors: 256, dither: true, max_size: None }
    }
}

/// How often an animation plays; None means forever.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LoopCount(pub Option<u16>);

/// Settings of raw video.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Y4mSettings {
    /// Whether chroma is stored at every pixel (4:4:4) instead of every 2x2 pixels (4:2:0).
    pub full_chroma: bool,
}

/// Settings of MP4 files.
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

/// The default background of formats without alpha, as linear light: white.
pub const DEFAULT_BACKGROUND_COLOR: Rgb = Rgb::ONE;
