//! What can be wrong with an image file.

use super::decode::LARGEST_SIDE;
use crate::files;
use std::fmt;
use std::io;

/// Why a file gives no image.
#[derive(Debug)]
pub enum ImageError {
    /// Its file, which may be no plain one or too large.
    Unreadable(io::Error),
    /// The picture in it.
    TooLarge(String),
    /// Not in a format that is read here.
    UnknownFormat,
    /// Begins like an image, but is none.
    Broken(String),
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
        match error {
            image::ImageError::Limits(_) => {
                let most = format!("it is more than {LARGEST_SIDE} pixels wide or high");
                Self::TooLarge(most)
            }
            image::ImageError::Unsupported(error)
                if matches!(error.kind(), image::error::UnsupportedErrorKind::Format(_)) =>
            {
                Self::UnknownFormat
            }
            error => Self::Broken(error.to_string()),
        }
    }
}

impl fmt::Display for ImageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable(error) => f.write_str(&files::why(error)),
            Self::TooLarge(how) => f.write_str(how),
            Self::UnknownFormat => f.write_str("it is no PNG, JPEG, BMP or HDR image"),
            Self::Broken(why) => write!(f, "it is damaged: {why}"),
        }
    }
}

impl std::error::Error for ImageError {}
