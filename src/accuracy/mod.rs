//! How far results are off, and what each step of accuracy costs.
//!
//! ```text
//! Sequence ──settings──▶ what is tried ──measure──▶ Measured ─┬─ findings ▶ plain words and advice
//!                                                            └─ report ▶ page, plots
//! ```

use crate::clock;

mod budget;
pub mod exact;
mod findings;
pub mod hard_cases;
mod layering;
pub mod measure;
mod precision;
pub mod report;
mod settings;
mod settled;
mod statistics;
mod studio;

pub use crate::clock::{Clock, Took, timed};
pub use budget::{Budget, budget};
pub use findings::{Advice, described, factor, percent, seconds};
pub use layering::Layering;
pub use measure::{Layer, Measured, Point, Request, measure};
pub use precision::Precision;
pub use settings::{Axis, LeftOut, Setting, Settings};
pub use settled::{Settled, settled};
pub use statistics::{Estimate, Spread};
