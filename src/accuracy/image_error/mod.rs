//! How far a picture is from what it should be, as numbers.
//!
//! Linear radiance is compared by squares, against two references whose noise is independent; displayed pictures by
//! [`psnr`] and by FLIP, which stands for what an eye sees.

mod flip;
mod kernel;
mod linear;
#[cfg(test)]
mod tests;

pub use flip::{Flip, PIXELS_PER_DEGREE};
pub use linear::{RELATIVE_FLOOR, References, mean_squared_error, psnr};
