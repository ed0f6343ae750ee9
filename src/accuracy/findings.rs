//! Conclusions from measurements in plain words, and recommended settings.

mod advice;
mod base;
mod curve;
mod fireflies;
mod parts;
mod robust;
mod summary;
mod temporal;
mod text;

pub use advice::Advice;
pub use base::CODES;
pub use text::describe;
