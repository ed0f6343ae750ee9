//! Errors of image files.

use crate::base::files;
use image::ImageFormat;
use image::error::{ImageFormatHint, UnsupportedErrorKind};
use std::fmt;
use std::io;

/// Why a file cannot be read as an image.
#[derive(Debug)]
pub enum ImageError {
    /// The file cannot be read: it is missing, too large, or not a regular file.
    Unreadable(io::Error),
    /// The size in pixels exceeds the limit, which is a text.
    TooLarge { size: (u32, u32), limit: String },
    /// Decoding takes more memory than allowed.
    OutOfMemory,
    /// The format is unknown.
    UnknownFormat,
    /// The format is known, but not this variant of it.
    UnsupportedVariant(&'static str),
    /// The file is truncated.
    Truncated,
    /// The file begins like an image of a format, but its data is corrupt.
    Corrupt(&'static str),
    /// The image has no pixels.
    Empty,
}

impl ImageError {
    pub fn is_missing(&self) -> bool {
        matches!(self, Self::Unreadable(error) if error.kind() == io::ErrorKind::NotFound)
    }
}

impl From<io::Error> for ImageError {
    fn from(error: io::Error) -> Self {
        Self::Unreadable(error)
    }
}

impl From<image::ImageError> for ImageError {
    fn from(error: image::ImageError) -> Self {
        use image::ImageError as Error;
        match error {
            Error::Limits(_) => Self::OutOfMemory,
            Error::Unsupported(error) => match error.kind() {
                UnsupportedErrorKind::Format(_) => Self::UnknownFormat,
                _ => Self::UnsupportedVariant(name(&error.format_hint())),
            },
            Error::IoError(_) => Self::Truncated,
            Error::Decoding(error) => Self::Corrupt(name(&error.format_hint())),
            Error::Encoding(_) | Error::Parameter(_) => Self::Corrupt("image"),
        }
    }
}

/// The common name of a format.
fn name(hint: &ImageFormatHint) -> &'static str {
    match hint {
        ImageFormatHint::Exact(ImageFormat::Png) => "PNG",
        ImageFormatHint::Exact(ImageFormat::Jpeg) => "JPEG",
        ImageFormatHint::Exact(ImageFormat::Bmp) => "BMP",
        ImageFormatHint::Exact(ImageFormat::Hdr) => "HDR",
        ImageFormatHint::Exact(ImageFormat::OpenExr) => "EXR",
        _ => "image",
    }
}

impl fmt::Display for ImageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable(error) => f.write_str(&files::describe(error)),
            Self::TooLarge { size: (width, height), limit } => {
                write!(f, "it has {width}x{height} pixels; {limit}")
            }
            Self::OutOfMemory => f.write_str("it takes too much memory to decode"),
            Self::UnknownFormat => f.write_str("it is not a PNG, JPEG, BMP, HDR or EXR image"),
            Self::UnsupportedVariant(format) => {
                write!(f, "this kind of {format} file is not supported; save it as a plain PNG")
            }
            Self::Truncated => f.write_str("it is damaged: the file is truncated"),
            Self::Corrupt("EXR") => f.write_str(
                "its EXR data cannot be decoded: it is damaged, or has no layer of R, G and B without a name, \
                 or is compressed by DWAA or DWAB",
            ),
            Self::Corrupt(format) => write!(f, "it is damaged: its {format} data cannot be decoded"),
            Self::Empty => f.write_str("it is damaged: it has no pixels"),
        }
    }
}

impl std::error::Error for ImageError {}
