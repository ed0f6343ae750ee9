//! Changes that the command line makes to a sequence before it is rendered.

use crate::annotate::Annotation;
use crate::base::frame_set::MAX_FRAMES;
use crate::base::time::Rate;
use crate::encode::{Template, Tonemap};
use crate::sequence::Sequence;
use crate::sequence::quality::{Denoise, Integrator, NoiseTarget, SampleReuse};

/// The largest number of bounces in a draft.
const DRAFT_BOUNCES: u32 = 1;
/// The largest number of random samples per pixel in a draft.
const DRAFT_SAMPLES: u32 = 16;

/// Settings of the command line. An absent one leaves the file's setting.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overrides {
    pub size: Option<(u32, u32)>,
    pub rate: Option<Rate>,
    pub bounces: Option<u32>,
    pub antialias: Option<u32>,
    /// Also removes a target error of the file.
    pub samples: Option<u32>,
    /// The target error.
    pub noise: Option<f64>,
    /// The largest number of samples per pixel for the target error.
    pub max_samples: Option<u32>,
    /// If the file's integrator is of the same kind, it keeps its settings.
    pub integrator: Option<Integrator>,
    pub seed: Option<u32>,
    /// Gives each frame random numbers of its own.
    pub vary_noise: bool,
    /// Which samples frames share.
    pub reuse: Option<SampleReuse>,
    /// Whether frames with random samples are denoised.
    pub denoise: Option<Denoise>,
    /// Whether EXR files also hold what denoised frames were before.
    pub denoise_original: bool,
    pub tonemap: Option<Tonemap>,
    /// In stops. Replaces the keys of the file.
    pub exposure: Option<f64>,
    /// Makes the background transparent.
    pub transparent: bool,
    /// Written into every picture.
    pub caption: Option<Template>,
    /// The largest size of a GIF, in bytes.
    pub max_size: Option<u64>,
    /// Of JPEGs and videos, 1 to 100.
    pub encode_quality: Option<u8>,
    /// Whether PNGs have 16 bits.
    pub deep: Option<bool>,
    /// Writes PNGs and EXR files without metadata.
    pub no_metadata: bool,
    /// Lowers the settings that no other option gives.
    pub draft: bool,
}

/// The error for `--max-samples` without a target error.
const NO_NOISE: &str =
    "--max-samples needs a target error; add --noise, or write --samples for a fixed number of samples";

/// Applies the settings of the command line.
///
/// # Errors
/// If the rate gives too many frames, or `--max-samples` has no target error.
pub fn apply(mut sequence: Sequence, wanted: &Overrides) -> Result<Sequence, String> {
    if wanted.draft {
        let (width, height) = sequence.output.size;
        sequence.output.size = (width.div_ceil(2), height.div_ceil(2));
        sequence.quality.antialias = 1;
        sequence.quality.noise = None;
        sequence.quality.samples = sequence.quality.samples.min(DRAFT_SAMPLES);
        sequence.quality.bounces = sequence.quality.bounces.min(DRAFT_BOUNCES);
    }
    let Sequence { output, quality, .. } = &mut sequence;
    output.transparent |= wanted.transparent;
    if let Some(text) = &wanted.caption {
        // If the file has a caption, its place and style stay.
        output.caption = Some(match output.caption.take() {
            Some(own) => own.with_text(text.clone()),
            None => Annotation::caption(text.clone()),
        });
    }
    let formats = &mut output.formats;
    formats.gif.max_size = wanted.max_size.or(formats.gif.max_size);
    replace(&mut formats.jpeg.quality, wanted.encode_quality);
    replace(&mut formats.mp4.quality, wanted.encode_quality);
    replace(&mut formats.png.deep, wanted.deep);
    formats.png.metadata &= !wanted.no_metadata;
    formats.exr.metadata &= !wanted.no_metadata;
    formats.exr.layers.samples |= wanted.denoise_original;
    replace(&mut output.size, wanted.size);
    replace(&mut output.tonemap, wanted.tonemap);
    replace(&mut output.exposure, wanted.exposure.map(Into::into));
    replace(&mut quality.bounces, wanted.bounces);
    replace(&mut quality.antialias, wanted.antialias);
    if let Some(samples) = wanted.samples {
        (quality.samples, quality.noise) = (samples, None);
    }
    if let Some(error) = wanted.noise {
        let most = quality.noise.map_or(NoiseTarget::MOST, |own| own.most);
        quality.noise = Some(NoiseTarget { error, most });
    }
    match (&mut quality.noise, wanted.max_samples) {
        (Some(target), Some(most)) => target.most = most,
        (None, Some(_)) => return Err(NO_NOISE.to_owned()),
        (_, None) => {}
    }
    replace(&mut quality.seed, wanted.seed);
    quality.vary_noise |= wanted.vary_noise;
    replace(&mut quality.reuse, wanted.reuse);
    replace(&mut quality.denoise, wanted.denoise);
    let own = quality.integrator;
    replace(&mut quality.integrator, wanted.integrator.filter(|other| !own.same_kind(other)));
    if let Some(rate) = wanted.rate {
        let resampled = sequence.timeline.resampled(rate).filter(|t| t.frames as usize <= MAX_FRAMES);
        sequence.timeline = resampled
            .ok_or_else(|| format!("--fps {rate} gives more than {MAX_FRAMES} frames; write a lower rate"))?;
    }
    Ok(sequence)
}

fn replace<T>(value: &mut T, wanted: Option<T>) {
    if let Some(wanted) = wanted {
        *value = wanted;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::fixture::sequence;
    use crate::sequence::quality::PathSettings;

    fn rate(frames: i128, seconds: i128) -> Option<Rate> {
        Rate::new(frames, seconds)
    }

    #[test]
    fn no_options_change_nothing() {
        assert_eq!(apply(sequence(), &Overrides::default()), Ok(sequence()));
    }

    #[test]
    fn every_option_reaches_its_field() {
        let wanted = Overrides {
            size: Some((320, 200)),
            rate: rate(30000, 1001),
            bounces: Some(9),
            antialias: Some(4),
            samples: Some(100),
            noise: Some(0.05),
            max_samples: Some(999),
            integrator: Some(Integrator::Path(PathSettings::default())),
            seed: Some(7),
            vary_noise: true,
            reuse: Some(SampleReuse::Zoom),
            denoise: Some(Denoise::Auto),
            denoise_original: true,
            tonemap: Some(Tonemap::Filmic),
            exposure: Some(-0.5),
            transparent: true,
            caption: Template::parse("{frame}").ok(),
            max_size: Some(5000),
            encode_quality: Some(60),
            deep: Some(true),
            no_metadata: true,
            draft: false,
        };
        let found = apply(sequence(), &wanted).expect("a countable rate");
        assert_eq!(found.output.size, (320, 200));
        assert_eq!((found.quality.bounces, found.quality.antialias), (9, 4));
        assert_eq!((found.quality.samples, found.quality.seed), (100, 7));
        assert!(found.quality.vary_noise);
        assert_eq!(found.quality.reuse, SampleReuse::Zoom);
        assert_eq!(found.quality.noise, Some(NoiseTarget { error: 0.05, most: 999 }));
        let limit = Overrides { max_samples: Some(9), ..Overrides::default() };
        assert_eq!(apply(sequence(), &limit), Err(NO_NOISE.to_owned()));
        assert_eq!(found.quality.integrator, Integrator::Path(PathSettings::default()));
        assert_eq!((found.output.tonemap, found.output.exposure), (Tonemap::Filmic, (-0.5).into()));
        let formats = found.output.formats;
        assert!(found.output.transparent && found.output.caption.is_some());
        assert_eq!((formats.gif.max_size, formats.jpeg.quality, formats.mp4.quality), (Some(5000), 60, 60));
        assert_eq!((formats.png.deep, formats.png.metadata), (true, false));
        assert!(!formats.exr.metadata);
        // Three seconds hold 89.91 frames; the last one is begun.
        assert_eq!((found.timeline.frames, found.timeline.duration), (90, sequence().timeline.duration));
        assert_eq!(found.timeline.rate.to_string(), "30000/1001");
    }

    #[test]
    fn a_draft_lowers_settings_that_no_option_gives() {
        let draft = Overrides { draft: true, ..Overrides::default() };
        let found = apply(sequence(), &draft).expect("a draft");
        assert_eq!(found.output.size, (321, 181), "odd sizes round up, so none becomes zero");
        assert_eq!((found.quality.bounces, found.quality.antialias, found.quality.samples), (1, 1, 16));

        let found = apply(sequence(), &Overrides { size: Some((64, 48)), bounces: Some(3), ..draft });
        let found = found.expect("a draft");
        assert_eq!(found.output.size, (64, 48));
        assert_eq!((found.quality.bounces, found.quality.antialias), (3, 1));
    }

    #[test]
    fn a_draft_adds_no_work() {
        let mut plain = sequence();
        (plain.quality.bounces, plain.quality.samples) = (0, 4);
        let found = apply(plain, &Overrides { draft: true, ..Overrides::default() }).expect("a draft");
        assert_eq!((found.quality.bounces, found.quality.samples), (0, 4));
    }

    #[test]
    fn an_integrator_of_the_same_kind_keeps_its_settings() {
        let own = Integrator::Path(PathSettings { roulette: None, refractive_shadows: true });
        let mut sequence = sequence();
        sequence.quality.integrator = own;
        let with = |integrator| {
            let wanted = Overrides { integrator: Some(integrator), ..Overrides::default() };
            apply(sequence.clone(), &wanted).expect("a sequence").quality.integrator
        };
        assert_eq!(with(Integrator::Path(PathSettings::default())), own);
        assert_eq!(with(Integrator::Whitted), Integrator::Whitted);
    }

    #[test]
    fn rates_that_make_too_many_frames_are_refused() {
        for fps in [3_333_334, i128::from(u32::MAX)] {
            let wanted = Overrides { rate: rate(fps, 1), ..Overrides::default() };
            let message = apply(sequence(), &wanted).err();
            assert!(message.is_some_and(|message| message.contains(&format!("--fps {fps} gives"))));
        }
    }
}
