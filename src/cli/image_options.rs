//! Options about the contents and the format of each picture.

use super::overrides::Overrides;
use super::values;
use crate::encode::Template;
use clap::Args;

#[derive(Args, Debug, PartialEq)]
pub struct ImageOptions {
    /// Make the background transparent; formats without alpha show `background_color` there
    #[arg(long)]
    transparent: bool,

    /// Write this text into every picture, such as "frame {frame}, {time} s"
    ///
    /// {frame}, {frames}, {time} and {name} are replaced by their values. The text may have
    /// several lines.
    #[arg(long, value_name = "TEXT", value_parser = values::caption, verbatim_doc_comment)]
    caption: Option<Template>,

    /// Bits per channel of PNGs: 8 or 16 [default: as in the sequence]
    #[arg(long, value_name = "N", value_parser = values::bits)]
    bits: Option<bool>,
}

impl ImageOptions {
    /// Adds these options to others.
    pub fn with(&self, others: Overrides) -> Overrides {
        let Self { transparent, caption, bits } = self;
        Overrides { transparent: *transparent, caption: caption.clone(), deep: *bits, ..others }
    }
}
