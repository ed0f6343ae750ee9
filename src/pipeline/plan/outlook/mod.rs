//! Forecasts the time and the error of a run from a pilot, which traces a few patches of pixels of some films.
//!
//! ```text
//! Plan ──pilot──▶ PilotFilm: seconds per sample, squared error ──forecast──▶ RunForecast of any quality
//! ```
//!
//! Films between two probed films are interpolated.

mod film;
mod passes;
mod pilot;
mod range;
mod run_forecast;

pub use film::FilmForecast;
pub use pilot::{PilotTime, run_pilot};
pub use range::Range;
pub use run_forecast::{Outlook, RunForecast};
