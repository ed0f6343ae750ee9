//! Frames of an earlier run that differ from this run's in their annotations alone: they are drawn again over the
//! picture that their PNGs hold, and nothing is traced.

use super::error::EncodeError;
use super::frame_bytes::DrawnPicture;
use super::job::EncodeJob;
use super::metadata::{self, TextEntry, find_noise};
use super::output::{Output, StillFormat};
use super::picture::Picture;
use super::png::{self, Seal};
use std::io;

impl EncodeJob {
    /// Whether the frame of an index needs no film, because its PNG holds it without annotations, and all other files
    /// are current or made from that PNG.
    pub(super) fn can_redraw(&self, index: usize) -> bool {
        let Some(source) = self.source() else { return false };
        let others = |output: &&Output| self.has_identity(output) && output.pattern() != Some(source);
        self.outputs.iter().filter(others).all(|output| self.is_current(output, index))
            && self.clean_picture(index).is_some()
    }

    /// The picture of a frame without annotations, from its PNG.
    fn clean_picture(&self, index: usize) -> Option<Picture> {
        let path = self.source()?.path(self.frames[index]);
        let wanted = self.clean_identity(StillFormat::Png, index)?;
        let mut bytes = png::read_bytes(&path, self.size).ok()?;
        let Seal::Intact(identity) = png::verify(&mut bytes) else { return None };
        let picture = png::decode_bytes(&bytes).ok()?;
        if (picture.width, picture.height) != self.size {
            return None;
        }
        // Without annotations, a frame is its own clean picture.
        if identity == wanted.to_string() {
            return Some(picture);
        }
        (png::clean_identity(&bytes)? == wanted).then(|| png::restore(&bytes, picture)).flatten()
    }

    /// Draws the annotations of a frame over the picture that its PNG holds, and encodes the file.
    ///
    /// # Errors
    /// If the PNG has changed since the run began.
    pub(super) fn redraw(&self, index: usize) -> Result<(Picture, Vec<u8>), EncodeError> {
        let path = self.source().map(|source| source.path(self.frames[index])).unwrap_or_default();
        let changed = || io::Error::new(io::ErrorKind::InvalidData, "it has changed since the run began");
        let clean = self.clean_picture(index).ok_or_else(|| EncodeError::read(&path, changed()))?;
        let drawn = DrawnPicture::new(self, index, clean);
        let entries = self.redrawn_metadata(index);
        let bytes = drawn.png(self, index, entries).map_err(|error| EncodeError::write(&path, error))?;
        Ok((drawn.picture, bytes))
    }

    /// The metadata of a frame that is drawn again: what this run writes, and the noise that sampling reached.
    fn redrawn_metadata(&self, index: usize) -> Vec<TextEntry> {
        let info = self.frame_info(index);
        let mut entries = metadata::frame_entries(&info, self.frame_keys.get(index));
        let noise = self.stored_metadata(info.frame).find_map(|stored| find_noise(&stored));
        entries.extend(noise.as_ref().map(metadata::noise_entry));
        entries
    }
}
