//! Measurements as a page to read, and as plots.

mod crops;
mod page;
mod plots;

pub use page::{Origin, page};
pub use plots::{Chart, charts};
