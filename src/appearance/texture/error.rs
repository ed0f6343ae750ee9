//! What can be wrong with an image file.

use crate::base::files;
use image::ImageFormat;
use image::error::{ImageFormatHint, UnsupportedErrorKind};
use std::fmt;
use std::io;

/// Why a file gives no image.
#[derive(Debug)]
pub enum ImageError {
    /// Its file, which may be no plain one or too large.
    Unreadable(io::Error),
    /// The picture in it, in pixels, and how many of them are read.
    TooLarge { size: (u32, u32), most: String },
    /// More than the decoder may take of memory.
    TakesTooMuch,
    /// Not in a format that is read here.
    UnknownFormat,
    /// In a kind of a known format that is not read.
    UnknownKind(&'static str),
    /// Ends too early.
    Cut,
    /// Begins like an image of a format, but is none.
    Broken(&'static str),
    /// No pixels.
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
            Error::Limits(_) => Self::TakesTooMuch,
            Error::Unsupported(error) => match error.kind() {
                UnsupportedErrorKind::Format(_) => Self::UnknownFormat,
                _ => Self::UnknownKind(name(&error.format_hint())),
            },
            Error::IoError(_) => Self::Cut,
            Error::Decoding(error) => Self::Broken(name(&error.format_hint())),
            Error::Encoding(_) | Error::Parameter(_) => Self::Broken("image"),
        }
    }
}

/// A format as people call it.
fn name(hint: &ImageFormatHint) -> &'static str {
    match hint {
        ImageFormatHint::Exact(ImageFormat::Png) => "PNG",
        ImageFormatHint::Exact(ImageFormat::Jpeg) => "JPEG",
        ImageFormatHint::Exact(ImageFormat::Bmp) => "BMP",
        ImageFormatHint::Exact(ImageFormat::Hdr) => "HDR",
        _ => "image",
    }
}

impl fmt::Display for ImageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable(error) => f.write_str(&files::why(error)),
            Self::TooLarge { size: (width, height), most } => {
                write!(f, "it has {width}x{height} pixels; {most}")
            }
            Self::TakesTooMuch => f.write_str("it takes too much memory to decode"),
            Self::UnknownFormat => f.write_str("it is no PNG, JPEG, BMP or HDR image"),
            Self::UnknownKind(format) => {
                write!(f, "it is a kind of {format} that is not read; save it as a plain PNG")
            }
            Self::Cut => f.write_str("it is damaged: it ends before its picture does"),
            Self::Broken(format) => write!(f, "it is damaged: its {format} data cannot be decoded"),
            Self::Empty => f.write_str("it is damaged: it has no pixels"),
        }
    }
}

impl std::error::Error for ImageError {}
