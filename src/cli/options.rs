//! Options of all commands that render.

use super::overrides::Overrides;
use super::progress::ProgressMode;
use super::values;
use crate::base::time::Rate;
use crate::encode::Tonemap;
use crate::sequence::quality::{Denoise, Integrator, SampleReuse};
use clap::Args;
use std::num::NonZeroUsize;

/// Options that replace settings of the sequence file, and options of the process.
#[derive(Args, Debug, PartialEq)]
pub struct RenderOptions {
    /// Width and height in pixels, such as 1280x720 [default: as in the sequence]
    #[arg(short, long, value_name = "WxH", value_parser = values::size, allow_hyphen_values = true)]
    pub size: Option<(u32, u32)>,

    /// Frames per second: 24, 29.97 or 30000/1001 [default: as in the sequence]
    ///
    /// The animation keeps its duration in seconds.
    #[arg(short = 'r', long, value_name = "RATE", value_parser = values::rate, allow_hyphen_values = true)]
    pub fps: Option<Rate>,

    /// Number of threads; it does not change the pictures [default: one per processor]
    #[arg(short, long, value_name = "N", value_parser = values::threads, allow_hyphen_values = true)]
    pub threads: Option<NonZeroUsize>,

    /// Light transport algorithm: whitted or path [default: as in the sequence]
    #[arg(long, value_name = "NAME", value_parser = values::integrator)]
    pub integrator: Option<Integrator>,

    /// Largest number of light bounces between surfaces, 0 to 1000 [default: as in the sequence]
    ///
    /// With 0 bounces, direct light only.
    #[arg(long, value_name = "N", value_parser = values::bounces, allow_hyphen_values = true)]
    pub bounces: Option<u32>,

    /// NxN samples per pixel where nothing is random, 1 to 64 [default: as in the sequence]
    #[arg(long, value_name = "N", value_parser = values::antialias, allow_hyphen_values = true)]
    pub antialias: Option<u32>,

    /// Samples per pixel where something is random [default: as in the sequence]
    ///
    /// Paths, area lights, rough surfaces, lenses and motion blur are random. Four times the
    /// samples halve the noise.
    #[arg(long, value_name = "N", value_parser = values::samples, allow_hyphen_values = true, verbatim_doc_comment)]
    pub samples: Option<u32>,

    /// Target error where something is random: 0.01 for 1 % [default: as in the sequence]
    ///
    /// Adds samples where they lower the error of the frame most, until it is below the
    /// target. The error is the root of the mean squared error of all pixels, relative to the
    /// mean brightness.
    #[arg(
        long, value_name = "ERROR", value_parser = values::noise, allow_hyphen_values = true,
        conflicts_with = "samples", verbatim_doc_comment
    )]
    pub noise: Option<f64>,

    /// Which frames share samples: zoom or off [default: as in the sequence]
    ///
    /// zoom: frames of one scene whose camera stays in its place, zooms and turns. Each direction
    /// is traced once. Pictures change within their error.
    #[arg(long, value_name = "NAME", value_parser = values::reuse, verbatim_doc_comment)]
    pub reuse: Option<SampleReuse>,

    /// Denoise frames where something is random, and measure the error that is left
    ///
    /// Filters each part of the picture where that is estimated to lower its error, and prints
    /// the error of the result. --noise adds samples until that error is below the target.
    ///
    /// auto: with the samples of up to two frames before and after. They are traced even if they
    /// are not rendered. Posters and filmstrips, and frames with --noise, use their own alone.
    /// alone: each frame with its own samples alone.
    #[arg(
        long, value_name = "MODE", value_parser = values::denoise, num_args = 0..=1, require_equals = true,
        default_missing_value = "auto", conflicts_with = "no_denoise", verbatim_doc_comment
    )]
    pub denoise: Option<Denoise>,

    /// Also keep what denoised frames were before, as the layer `samples` of EXR files
    #[arg(long)]
    pub denoise_original: bool,

    /// Keep frames as they are sampled, whatever the sequence says
    #[arg(long)]
    pub no_denoise: bool,

    /// Maximum samples per pixel for --noise [default: as in the sequence, or 4096]
    #[arg(long, value_name = "N", value_parser = values::samples, allow_hyphen_values = true)]
    pub max_samples: Option<u32>,

    /// Seed of the random numbers; another seed gives other noise [default: as in the sequence]
    #[arg(long, value_name = "N", value_parser = values::seed, allow_hyphen_values = true)]
    pub seed: Option<u32>,

    /// Give each frame noise of its own, instead of noise that stays in its place
    ///
    /// Frames with random samples then share no films, paths or samples.
    #[arg(long)]
    pub vary_noise: bool,

    /// Tone map: srgb, none, reinhard or filmic [default: as in the sequence]
    #[arg(long, value_name = "MAP", value_parser = values::tonemap)]
    pub tonemap: Option<Tonemap>,

    /// Exposure in stops, such as -1.5; +1 doubles the brightness [default: as in the sequence]
    #[arg(long, value_name = "STOPS", value_parser = values::exposure, allow_hyphen_values = true)]
    pub exposure: Option<f64>,

    /// Fast preview: half the width and height, antialias 1, at most 16 samples and 1 bounce
    ///
    /// --size, --antialias, --samples and --bounces override these values.
    #[arg(long)]
    pub draft: bool,

    /// Allow images and meshes outside of the sequence's root folder
    ///
    /// The root is the nearest folder above the sequence that holds a folder `assets`. If there
    /// is no such folder, it is the folder of the sequence.
    #[arg(long, verbatim_doc_comment)]
    pub allow_outside: bool,

    /// Print errors only
    #[arg(short, long)]
    pub quiet: bool,

    /// How to report progress
    #[arg(long, value_enum, default_value_t, value_name = "MODE")]
    pub progress: ProgressMode,
}

impl RenderOptions {
    /// The settings of the sequence that they replace.
    pub fn overrides(&self) -> Overrides {
        Overrides {
            size: self.size,
            rate: self.fps,
            bounces: self.bounces,
            antialias: self.antialias,
            samples: self.samples,
            noise: self.noise,
            max_samples: self.max_samples,
            integrator: self.integrator,
            seed: self.seed,
            vary_noise: self.vary_noise,
            reuse: self.reuse,
            denoise: self.denoise.or(self.no_denoise.then_some(Denoise::Off)),
            denoise_original: self.denoise_original,
            tonemap: self.tonemap,
            exposure: self.exposure,
            draft: self.draft,
            ..Overrides::default()
        }
    }
}
