//! In: a [`Sequence`](crate::sequence::Sequence), and the time that measuring may take.
//! Out: errors and costs of settings ([`Measured`]) with advice, a report and plots; the matrix of hard cases.
//! May use: `pipeline/` and the rooms before it.
//!
//! ```text
//! Sequence ──settings──▶ Experiment ──measure──▶ Measured ─┬─ findings ▶ plain words and advice
//!                                                         └─ report ▶ page, plots
//! ```

mod chains;
mod change;
mod findings;
pub mod hard_cases;
pub mod image_error;
mod layering;
pub mod measure;
pub mod plot;
mod precision;
mod renderer;
pub mod report;
pub mod robustness;
mod settings;
mod statistics;

pub use chains::Chain;
pub use change::{RemovableEffect, SceneChange};
pub use findings::{Advice, describe};
pub use layering::Layering;
pub use measure::{Layer, Measured, MeasurementRequest, Point, SequenceCost, TemporalError, measure};
pub use precision::{MethodSummary, method_summaries, wrong_answers};
pub use settings::{Experiment, LeftOut, Setting, SettingAxis};
pub use statistics::{Bias, Concentration, ConfidenceInterval, Quartiles};
