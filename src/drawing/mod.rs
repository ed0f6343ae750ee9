//! Text, lines, areas and images on pictures: annotations and captions.
//!
//! In: a [`Drawing`], which lists marks in pixels of a picture.
//! Out: ink, blended into a [`Canvas`].
//! May use: `base`.
//!
//! Every mark first becomes the coverage of pixels, then ink. Neither step depends on threads or on the processor:
//! coverage comes from additions, multiplications and functions of `libm`.

mod blend;
mod bitmap;
mod clip;
mod coverage;
mod curve;
mod font;
mod halo;
mod ink;
mod layer;
mod mark;
mod outline;
mod path;
mod shaping;
mod text;

pub use bitmap::Bitmap;
pub use blend::Canvas;
pub use clip::{Window, shares_inside};
pub use coverage::CoverageMask;
pub use font::{FONT_FILE, Font, FontError};
pub use ink::Ink;
pub use layer::Layer;
pub use mark::{Drawing, Halo, Line, Mark, TextMark};
pub use outline::{OUTLINE_UNITS, text_outlines};
pub use text::{Align, TextMask, text_width};
