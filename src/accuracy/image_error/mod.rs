//! Error metrics of pictures.
//!
//! Linear radiance is compared with two references of independent noise, by squared errors. Displayed pictures are
//! compared by [`psnr`] and by FLIP, which predicts the visible difference.

mod flip;
mod kernel;
mod linear;
#[cfg(test)]
mod tests;

pub use flip::{Flip, PIXELS_PER_DEGREE};
pub use linear::{RELATIVE_FLOOR, ReferencePair, mean_squared_error, psnr};
