//! The identity of a frame's file: a digest that is written into the file. If a complete file holds the identity that
//! this run would write, it need not be made again.
//!
//! The digest covers the frame's key, all settings that change the file's bytes, and Kinora's version. It is stored in
//! the file itself, because a separate file could be lost or become outdated.

use super::info::FrameInfo;
use super::job::EncodeJob;
use super::metadata;
use super::output::StillFormat;
use crate::base::digest::{Content, Digest, Digester};

/// Part of every identity, so that another version of Kinora makes other identities.
const PROGRAM: &str = concat!("Kinora ", env!("CARGO_PKG_VERSION"));

impl EncodeJob {
    /// The identity of a frame's file, by the frame's index in the job's list. `None` if the format cannot hold it, for
    /// PNGs without metadata, and for frames whose key is unknown.
    pub(super) fn identity(&self, format: StillFormat, index: usize) -> Option<Digest> {
        self.identity_of(format, index, true)
    }

    /// The identity that a frame's file has if nothing is drawn over it.
    pub(super) fn clean_identity(&self, format: StillFormat, index: usize) -> Option<Digest> {
        self.identity_of(format, index, false)
    }

    fn identity_of(&self, format: StillFormat, index: usize, annotated: bool) -> Option<Digest> {
        if !format.has_identity(&self.formats) {
            return None;
        }
        let (key, &frame) = (self.frame_keys.get(index)?, self.frames.get(index)?);
        let info = FrameInfo { sequence: &self.info, frame, rate: self.rate };
        let mut digester = Digester::new();
        PROGRAM.feed(&mut digester);
        match format {
            StillFormat::Exr => {
                "EXR".feed(&mut digester);
                // All layers are written under their names, dark ones included.
                let lights = self.formats.exr.layers.lights;
                let names = if lights { &self.info.layers[..] } else { &[] };
                (if lights { key.film } else { key.image_hash }).feed(&mut digester);
                // The derived debug text contains every field, so that a new setting cannot be forgotten.
                format!("{:?}", (self.formats.exr, names)).as_str().feed(&mut digester);
            }
            _ => {
                "PNG".feed(&mut digester);
                key.image_hash.feed(&mut digester);
                key.exposure.feed(&mut digester);
                let look = (self.tonemap, self.formats.png, self.transparent);
                format!("{look:?}").as_str().feed(&mut digester);
            }
        }
        if let Some(drawing) = self.drawing(index).filter(|_| annotated) {
            "annotations".feed(&mut digester);
            drawing.feed(&mut digester);
        }
        if self.writes_metadata(format) {
            let mut entries = metadata::frame_entries(&info, Some(key));
            // A renamed or longer sequence is no reason to make all frames again.
            entries.retain(|(keyword, _)| ![metadata::TITLE, metadata::FRAMES].contains(keyword));
            format!("{entries:?}").as_str().feed(&mut digester);
        }
        Some(digester.finish())
    }

    /// Whether files of this format hold metadata as text.
    pub(super) fn writes_metadata(&self, format: StillFormat) -> bool {
        match format {
            StillFormat::Png => self.formats.png.metadata,
            StillFormat::Exr => self.formats.exr.metadata,
            StillFormat::Jpeg | StillFormat::Ppm => false,
        }
    }
}
