//! Measurements as an HTML page, and as plots.

mod crops;
mod page;
mod plots;

pub use page::{Origin, page};
pub use plots::{Chart, charts};
