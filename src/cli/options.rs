//! Options that all commands have which render.

use super::overrides::Overrides;
use super::progress::ProgressMode;
use super::values;
use crate::base::time::Rate;
use crate::encode::Tonemap;
use crate::sequence::quality::Integrator;
use clap::Args;
use std::num::NonZeroUsize;

/// How a sequence is rendered where that is not as its file says.
#[derive(Args, Debug, PartialEq)]
pub struct Options {
    /// Width and height in pixels, such as 1280x720 [default: as the sequence says]
    #[arg(short, long, value_name = "WxH", value_parser = values::size, allow_hyphen_values = true)]
    pub size: Option<(u32, u32)>,

    /// Frames per second: 24, 29.97 or 30000/1001 [default: as the sequence says]
    ///
    /// The animation keeps its duration in seconds.
    #[arg(short = 'r', long, value_name = "RATE", value_parser = values::rate, allow_hyphen_values = true)]
    pub fps: Option<Rate>,

    /// Threads to render with; the picture is the same with any [default: one per processor]
    #[arg(short, long, value_name = "N", value_parser = values::threads, allow_hyphen_values = true)]
    pub threads: Option<NonZeroUsize>,

    /// How light is followed: whitted or path [default: as the sequence says]
    #[arg(long, value_name = "NAME", value_parser = values::integrator)]
    pub integrator: Option<Integrator>,

    /// How often light goes from surface to surface, 0 to 1000 [default: as the sequence says]
    ///
    /// Light of 0 bounces comes straight from its source to the surface that is seen.
    #[arg(long, value_name = "N", value_parser = values::bounces, allow_hyphen_values = true)]
    pub bounces: Option<u32>,

    /// N×N samples per pixel where nothing is random, 1 to 64 [default: as the sequence says]
    #[arg(long, value_name = "N", value_parser = values::antialias, allow_hyphen_values = true)]
    pub antialias: Option<u32>,

    /// Random samples per pixel where something is [default: as the sequence says]
    ///
    /// Paths, area lights, rough surfaces, lenses and motion blur are drawn at random: four times
    /// the samples halve the noise.
    #[arg(long, value_name = "N", value_parser = values::samples, allow_hyphen_values = true, verbatim_doc_comment)]
    pub samples: Option<u32>,

    /// Error to reach where something is random: 0.01 for 1 % [default: as the sequence says]
    ///
    /// Every block of 8x8 pixels is sampled until its error, as a share of its brightness,
    /// is smaller. Smooth parts take fewer samples than difficult ones.
    #[arg(
        long, value_name = "ERROR", value_parser = values::noise, allow_hyphen_values = true,
        conflicts_with = "samples", verbatim_doc_comment
    )]
    pub noise: Option<f64>,

    /// Samples of a pixel that --noise may take at most [default: as the sequence says, or 4096]
    #[arg(long, value_name = "N", value_parser = values::samples, allow_hyphen_values = true)]
    pub max_samples: Option<u32>,

    /// Another number gives other noise [default: as the sequence says]
    #[arg(long, value_name = "N", value_parser = values::seed, allow_hyphen_values = true)]
    pub seed: Option<u32>,

    /// How radiance is displayed: srgb, none, reinhard or filmic [default: as the sequence says]
    #[arg(long, value_name = "MAP", value_parser = values::tonemap)]
    pub tonemap: Option<Tonemap>,

    /// Stops by which pictures are brightened, such as -1.5 [default: as the sequence says]
    #[arg(long, value_name = "STOPS", value_parser = values::exposure, allow_hyphen_values = true)]
    pub exposure: Option<f64>,

    /// A quick look: half the width and height, antialias 1, at most 16 samples and 1 bounce
    ///
    /// What --size, --antialias, --samples and --bounces say goes before it.
    #[arg(long)]
    pub draft: bool,

    /// Images and meshes may lie outside of the sequence's root
    ///
    /// That is the nearest folder above the sequence that holds one called `assets`, or else
    /// the sequence's own.
    #[arg(long, verbatim_doc_comment)]
    pub allow_outside: bool,

    /// Print nothing but errors.
    #[arg(short, long)]
    pub quiet: bool,

    /// How progress is told
    #[arg(long, value_enum, default_value_t, value_name = "HOW")]
    pub progress: ProgressMode,
}

impl Options {
    /// What they change in a sequence.
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
            tonemap: self.tonemap,
            exposure: self.exposure,
            draft: self.draft,
            ..Overrides::default()
        }
    }
}
