//! How far results are off, and what each step of accuracy costs.
//!
//! ```text
//! Sequence ──settings──▶ what is tried ──measure──▶ Measured ─┬─ findings ▶ plain words and advice
//!                                                            └─ report ▶ page, plots
//! ```

mod budget;
mod clock;
pub mod exact;
mod findings;
pub mod hard_cases;
pub mod measure;
pub mod report;
mod settings;
mod statistics;
mod studio;

pub use budget::{Budget, budget};
pub use clock::{Took, processor_time, timed};
pub use findings::{Advice, described, factor, percent, seconds};
pub use measure::{Layer, Measured, Point, Request, measure};
pub use settings::{Axis, LeftOut, Setting, Settings};
pub use statistics::{Estimate, Spread};
