//! What a frame's file is made of, as one number that is written into it: a file that holds the number that it would be
//! given now, and is whole, needs not be made again.
//!
//! The number is a digest of what the frame looks like, of all settings that change the file's bytes, and of Kinora's
//! version. It never lies beside the file, where it could stay behind or get lost.

use super::about::Shown;
use super::job::Job;
use super::output::Still;
use super::record;
use crate::base::digest::{Content, Digest, Digester};

/// What a frame looks like before it is developed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seen {
    /// Of its radiance.
    pub radiance: Digest,
    /// Of what all layers of its film hold, dark ones too.
    pub film: Digest,
    /// Factor of the displayed picture.
    pub exposure: f32,
    /// Whether its samples were drawn at random, so that it has a seed.
    pub random: bool,
}

/// A version that gives other bytes gives other numbers.
const PROGRAM: &str = concat!("Kinora ", env!("CARGO_PKG_VERSION"));

impl Job {
    /// The identity of a frame's file, by the frame's place in the job's list. Formats that have no room for it, and
    /// PNGs without metadata, have none; neither have frames of which nobody has told what they look like.
    pub(super) fn identity(&self, format: Still, index: usize) -> Option<Digest> {
        if !format.is_said(&self.formats) {
            return None;
        }
        let (seen, &frame) = (self.seen.get(index)?, self.frames.get(index)?);
        let shown = Shown { about: &self.about, frame, rate: self.rate };
        let mut digester = Digester::new();
        PROGRAM.feed(&mut digester);
        match format {
            Still::Exr => {
                "EXR".feed(&mut digester);
                // Layers of light are written whether they are lit or not, under their names.
                let lights = self.formats.exr.layers.lights;
                let names = if lights { &self.about.layers[..] } else { &[] };
                (if lights { seen.film } else { seen.radiance }).feed(&mut digester);
                // Settings are told as text, so that a new one cannot be forgotten.
                format!("{:?}", (self.formats.exr, names)).as_str().feed(&mut digester);
            }
            _ => {
                "PNG".feed(&mut digester);
                seen.radiance.feed(&mut digester);
                seen.exposure.feed(&mut digester);
                let caption = self.caption.as_ref().map(|c| (c.text.told(&shown), c.corner, c.size));
                let look = (self.tonemap, caption, self.formats.png, self.transparent);
                format!("{look:?}").as_str().feed(&mut digester);
            }
        }
        if self.tells(format) {
            let mut texts = record::facts(&shown, Some(seen));
            // Another name of the sequence's file is no reason to make all frames again, nor are frames that come after.
            texts.retain(|(keyword, _)| ![record::TITLE, record::FRAMES].contains(keyword));
            format!("{texts:?}").as_str().feed(&mut digester);
        }
        Some(digester.finish())
    }

    /// Whether files of this format tell in words what they show.
    pub(super) fn tells(&self, format: Still) -> bool {
        match format {
            Still::Png => self.formats.png.metadata,
            Still::Exr => self.formats.exr.metadata,
            Still::Jpeg | Still::Ppm => false,
        }
    }
}
