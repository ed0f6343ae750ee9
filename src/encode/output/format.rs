//! The formats of outputs and their extensions.

use crate::encode::settings::Formats;

/// Formats of the standard output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StreamFormat {
    /// Raw video.
    Y4m,
    /// Concatenated PPM files, as netpbm's programs read them.
    Ppm,
    /// Concatenated ASCII PPM files, P3.
    AsciiPpm,
    Png,
}

impl StreamFormat {
    /// The formats with their names on the command line.
    pub const NAMED: [(&str, Self); 4] =
        [("y4m", Self::Y4m), ("ppm", Self::Ppm), ("ppm-ascii", Self::AsciiPpm), ("png", Self::Png)];
}

/// Formats of single frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StillFormat {
    Png,
    Jpeg,
    /// Binary, P6.
    Ppm,
    /// OpenEXR with linear radiance.
    Exr,
}

/// Formats of animations and videos.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AnimationFormat {
    Gif,
    Apng,
    Webp,
    /// Raw video for other encoders.
    Y4m,
    /// H.264 in an MP4 container.
    Mp4,
}

impl StillFormat {
    /// Whether files of this format hold an identity, so that a later run can check whether they are current.
    pub fn has_identity(self, formats: &Formats) -> bool {
        match self {
            Self::Png => formats.png.metadata,
            Self::Exr => true,
            Self::Jpeg | Self::Ppm => false,
        }
    }
}

/// The extensions of stills.
pub const STILLS: [(&str, StillFormat); 5] = [
    ("png", StillFormat::Png),
    ("jpg", StillFormat::Jpeg),
    ("jpeg", StillFormat::Jpeg),
    ("ppm", StillFormat::Ppm),
    ("exr", StillFormat::Exr),
];

/// The extensions of animations.
pub const MOVING: [(&str, AnimationFormat); 5] = [
    ("gif", AnimationFormat::Gif),
    ("apng", AnimationFormat::Apng),
    ("webp", AnimationFormat::Webp),
    ("mp4", AnimationFormat::Mp4),
    ("y4m", AnimationFormat::Y4m),
];

/// Extensions of video formats that Kinora does not write.
pub const UNSUPPORTED_VIDEOS: [&str; 6] = ["mov", "mkv", "webm", "avi", "m4v", "ogv"];

/// The format of an extension in a table.
pub fn named<T: Copy>(table: &[(&str, T)], extension: &str) -> Option<T> {
    table.iter().find(|(name, _)| *name == extension).map(|(_, format)| *format)
}
