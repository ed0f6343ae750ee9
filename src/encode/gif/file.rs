//! The GIF file: header, loop count, frames with their delays.

use super::delta::filler;
use super::timing::pieces;
use crate::encode::atomic::Aside;
use crate::encode::error::EncodeError;
use gif::{DisposalMethod, Encoder, EncodingError, Frame, Repeat};
use std::io::{self, Seek};
use std::path::{Path, PathBuf};

/// A GIF in the making. It appears when it is finished, and not at all if it is dropped before.
pub struct GifFile {
    path: PathBuf,
    encoder: Encoder<Aside>,
    /// The last frame, whose delay may still grow.
    held: Option<Held>,
}

/// A file that only has to be put in its place. Dropped instead, it vanishes.
pub struct Finished {
    pub file: Aside,
    /// Bytes.
    pub size: u64,
}

struct Held {
    frame: Frame<'static>,
    /// Centiseconds.
    delay: u64,
    /// The palette index at the top left of the whole picture.
    first_pixel: u8,
}

impl GifFile {
    /// Starts a file; `palette` is RGB after RGB, `plays` as often as the animation is to play (none: for ever).
    pub fn create(
        path: &Path,
        size: (u16, u16),
        palette: &[u8],
        plays: Option<u16>,
    ) -> Result<Self, EncodeError> {
        let fault = |e| EncodeError::write(path, into_io(e));
        let mut encoder = Encoder::new(Aside::create(path)?, size.0, size.1, palette).map_err(fault)?;
        // The extension counts what comes after the first play; without it there is just that one.
        match plays {
            None => encoder.set_repeat(Repeat::Infinite).map_err(fault)?,
            Some(0 | 1) => {}
            Some(plays) => encoder.set_repeat(Repeat::Finite(plays - 1)).map_err(fault)?,
        }
        Ok(Self { path: path.to_path_buf(), encoder, held: None })
    }

    /// Adds `delay` centiseconds of a picture that starts with the index `first_pixel`. `frame` is its
    /// difference from the last one; none if there is no difference, so that the last one just stays longer.
    pub fn push(
        &mut self,
        frame: Option<Frame<'static>>,
        delay: u64,
        first_pixel: u8,
    ) -> Result<(), EncodeError> {
        match (frame, &mut self.held) {
            (None, Some(held)) => held.delay += delay,
            (None, None) => {}
            (Some(frame), _) => {
                self.write_held()?;
                self.held = Some(Held { frame, delay, first_pixel });
            }
        }
        Ok(())
    }

    /// Writes the last frame and the end.
    pub fn finish(mut self) -> Result<Finished, EncodeError> {
        self.write_held()?;
        let Self { path, encoder, .. } = self;
        let mut file = encoder.into_inner().map_err(|e| EncodeError::write(&path, into_io(e)))?;
        let size = file.stream_position().map_err(|e| EncodeError::write(&path, e))?;
        Ok(Finished { file, size })
    }

    fn write_held(&mut self) -> Result<(), EncodeError> {
        let Some(Held { mut frame, delay, first_pixel }) = self.held.take() else { return Ok(()) };
        for piece in pieces(delay) {
            frame.delay = piece;
            let written = self.encoder.write_lzw_pre_encoded_frame(&frame);
            written.map_err(|e| EncodeError::write(&self.path, into_io(e)))?;
            // What vanishes at its end comes again.
            if frame.dispose == DisposalMethod::Keep {
                frame = filler(first_pixel);
            }
        }
        Ok(())
    }
}

fn into_io(error: EncodingError) -> io::Error {
    match error {
        EncodingError::Io(error) => error,
        other => io::Error::other(other),
    }
}
