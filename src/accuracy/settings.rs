//! The settings to measure. Each differs from the file's own setting along one axis.

mod all;
mod axis;
mod curve;
mod experiment;
mod parts;
mod paths;
#[cfg(test)]
mod tests;
mod unfinished;

pub use axis::SettingAxis;
pub use experiment::{Experiment, LeftOut, SceneFacts, Scope, Setting, samples_of};
