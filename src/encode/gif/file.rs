//! Writing a GIF file: header, loop count, and frames with their delays.

use super::delta::filler;
use super::timing::pieces;
use crate::encode::atomic::AtomicFile;
use crate::encode::error::EncodeError;
use gif::{DisposalMethod, Encoder, EncodingError, Frame, Repeat};
use std::io::{self, Seek};
use std::path::{Path, PathBuf};

/// A GIF file that is being written. It appears when it is committed, and not at all if it is dropped before.
pub struct GifFile {
    path: PathBuf,
    encoder: Encoder<AtomicFile>,
    /// The last frame, whose delay may still grow.
    pending: Option<PendingFrame>,
}

/// A complete file that is not committed yet. If it is dropped, it is removed.
pub struct FinishedGif {
    pub file: AtomicFile,
    /// Size in bytes.
    pub size: u64,
}

struct PendingFrame {
    frame: Frame<'static>,
    /// Centiseconds.
    delay: u64,
    /// The palette index at the top left of the whole picture.
    first_pixel: u8,
}

impl GifFile {
    /// Starts a file. `palette` holds RGB triples, and `loop_count` is `None` for an animation that plays forever.
    pub fn create(
        path: &Path,
        size: (u16, u16),
        palette: &[u8],
        loop_count: Option<u16>,
    ) -> Result<Self, EncodeError> {
        let fault = |e| EncodeError::write(path, into_io(e));
        let mut encoder = Encoder::new(AtomicFile::create(path)?, size.0, size.1, palette).map_err(fault)?;
        // The extension gives the number of repetitions. Without it, the animation plays once.
        match loop_count {
            None => encoder.set_repeat(Repeat::Infinite).map_err(fault)?,
            Some(0 | 1) => {}
            Some(count) => encoder.set_repeat(Repeat::Finite(count - 1)).map_err(fault)?,
        }
        Ok(Self { path: path.to_path_buf(), encoder, pending: None })
    }

    /// Adds a picture that is shown for `delay` centiseconds and whose first palette index is `first_pixel`. `frame` is
    /// its difference from the last picture. If it is None, the last picture is shown longer.
    pub fn push(
        &mut self,
        frame: Option<Frame<'static>>,
        delay: u64,
        first_pixel: u8,
    ) -> Result<(), EncodeError> {
        match (frame, &mut self.pending) {
            (None, Some(pending)) => pending.delay += delay,
            (None, None) => {}
            (Some(frame), _) => {
                self.write_pending()?;
                self.pending = Some(PendingFrame { frame, delay, first_pixel });
            }
        }
        Ok(())
    }

    /// Writes the last frame and the trailer.
    pub fn finish(mut self) -> Result<FinishedGif, EncodeError> {
        self.write_pending()?;
        let Self { path, encoder, .. } = self;
        let mut file = encoder.into_inner().map_err(|e| EncodeError::write(&path, into_io(e)))?;
        let size = file.stream_position().map_err(|e| EncodeError::write(&path, e))?;
        Ok(FinishedGif { file, size })
    }

    fn write_pending(&mut self) -> Result<(), EncodeError> {
        let Some(PendingFrame { mut frame, delay, first_pixel }) = self.pending.take() else { return Ok(()) };
        for piece in pieces(delay) {
            frame.delay = piece;
            let written = self.encoder.write_lzw_pre_encoded_frame(&frame);
            written.map_err(|e| EncodeError::write(&self.path, into_io(e)))?;
            // A frame that is cleared after its delay has to be repeated as a whole.
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
