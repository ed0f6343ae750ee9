//! Time limits: as many samples as fit, settled once for all frames of a run.

mod budget;
mod settled;

pub use budget::{Budget, budget};
pub use settled::{Settled, settled};
