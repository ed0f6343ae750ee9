//! The result of a measurement.

use super::cost::SequenceCost;
use super::point::{Layer, Point};
use super::temporal::TemporalError;
use crate::accuracy::chains::Chain;
use crate::accuracy::precision::MethodSummary;
use crate::accuracy::robustness::Robustness;
use crate::accuracy::settings::{LeftOut, SettingAxis};
use crate::accuracy::statistics::ConfidenceInterval;
use std::time::Duration;

/// The result of a measurement.
#[derive(Clone, Debug)]
pub struct Measured {
    pub name: String,
    pub frames: Vec<u32>,
    /// The size of the file's pictures, and the size at which they were measured.
    pub full_size: (u32, u32),
    pub size: (u32, u32),
    pub threads: usize,
    pub random: bool,
    /// The cost of the whole sequence at the file's own setting.
    pub total: SequenceCost,
    /// The first is the file's own setting.
    pub points: Vec<Point>,
    pub left_out: Vec<LeftOut>,
    /// Samples per pixel of both references together.
    pub reference: u32,
    /// RMSE of the mean of both references.
    pub reference_error: f64,
    /// Mean of the reference over pixels and channels.
    pub brightness: f64,
    /// The displayed picture of the reference.
    pub wanted: Vec<[f32; 3]>,
    /// The power of the number of samples that the error is proportional to, by axis.
    pub slopes: Vec<(SettingAxis, ConfidenceInterval)>,
    pub layers: Vec<Layer>,
    /// The paths that cause most of the noise in the worst pixels.
    pub chains: Vec<Chain>,
    /// How wrong the change to the next frame is; `None` where that is not measured: see `Benchmark::temporal`.
    pub temporal: Option<TemporalError>,
    /// What robustness costs on the scene's own rays; `None` if the frame has no camera.
    pub robustness: Option<Robustness>,
    /// The summary of the hard cases, which is the same for all sequences.
    pub precision: Vec<MethodSummary>,
    pub took: Duration,
}
