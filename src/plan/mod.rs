//! The plan: the whole timeline evaluated before anything is traced, as animation depends on time alone.
//!
//! ```text
//! Sequence, frames ──survey──▶ Survey: what each frame evaluates to
//! ```

mod survey;
#[cfg(test)]
mod tests;

pub use survey::{Survey, survey};
