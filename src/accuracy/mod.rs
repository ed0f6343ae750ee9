//! How far results are off, and what each step of accuracy costs.
//!
//! ```text
//! Sequence ──settings──▶ what is tried ──measure──▶ Measured ─┬─ findings ▶ plain words and advice
//!                                                            └─ report ▶ page, plots
//! ```

pub mod image_error;
pub mod plot;

use crate::base::clock;

mod budget;
mod chains;
mod change;
pub mod exact;
mod findings;
pub mod hard_cases;
mod layering;
pub mod measure;
mod precision;
pub mod report;
pub mod robustness;
mod settings;
mod settled;
mod statistics;
mod studio;

pub use crate::base::clock::{Clock, Took, timed};
pub use budget::{Budget, budget};
pub use chains::Chain;
pub use change::{Change, Effect};
pub use findings::{Advice, described, factor, percent, seconds};
pub use layering::Layering;
pub use measure::{Layer, Measured, Point, Request, Whole, measure};
pub use precision::{Precision, of_cells, wrong_answers};
pub use settings::{Axis, LeftOut, Setting, Settings};
pub use settled::{Settled, settled};
pub use statistics::{Bias, Concentration, Estimate, Spread};
