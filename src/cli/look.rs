//! Options of commands that write pictures by themselves, about what is put into or left out of each.

use super::overrides::Overrides;
use super::values;
use crate::encode::Template;
use clap::Args;

#[derive(Args, Debug, PartialEq)]
pub struct Look {
    /// Leave the background out, in formats with transparency; others show `matte` there
    #[arg(long)]
    transparent: bool,

    /// Write this into every picture, such as "frame {frame}, {time} s"
    ///
    /// {frame}, {frames}, {time} and {name} stand for their values; line breaks count.
    #[arg(long, value_name = "TEXT", value_parser = values::caption)]
    caption: Option<Template>,

    /// Bits of a PNG's channels: 8 or 16 [default: as the sequence says]
    #[arg(long, value_name = "N", value_parser = values::bits)]
    bits: Option<bool>,
}

impl Look {
    /// What these options say besides others.
    pub fn with(&self, others: Overrides) -> Overrides {
        let Self { transparent, caption, bits } = self;
        Overrides { transparent: *transparent, caption: caption.clone(), deep: *bits, ..others }
    }
}
