//! Time and error of one film, measured by a pilot, and the forecast for any quality.

use crate::base::clock::ElapsedTime;
use crate::film::denoise::samples_of_audit;
use crate::pipeline::plan::path_shares::FilmShare;
use crate::sequence::quality::{Denoise, NoiseTarget, Quality};
use crate::trace::{MIN_SAMPLES, allocation};

/// Measurements of a film.
#[derive(Clone, Debug)]
pub struct PilotFilm {
    /// Index among the films of the run.
    pub place: usize,
    pub pixels: f64,
    /// Number of moments at which the film is traced.
    pub moments: u32,
    /// Time to place objects and build trees, for all moments once.
    pub prepare: ElapsedTime,
    /// Mean time of one sample of a pixel, and the mean number of its rays, including the camera ray.
    pub sample: ElapsedTime,
    pub rays: f64,
    /// Time to denoise a pixel once; zero if frames are not denoised.
    pub filter: ElapsedTime,
    /// None if samples form a regular grid.
    pub noise: Option<FilmNoise>,
}

/// The noise of a film.
#[derive(Clone, Debug)]
pub struct FilmNoise {
    /// Samples per pixel at which the blocks were measured.
    pub samples: f64,
    pub blocks: Vec<BlockNoise>,
    /// The squared error falls with this power of the number of samples.
    pub power: f64,
    /// Relative standard deviation of the squared error, summed over the probed blocks (`spread`) and scaled to the
    /// whole film (`whole_spread`).
    pub spread: f64,
    pub whole_spread: f64,
}

/// Noise of one probed block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockNoise {
    /// Contribution to the film's squared error for independent samples, divided by the squared mean.
    pub squares: PassEstimates,
    /// The same mixed with those of the blocks around it.
    pub around: PassEstimates,
    /// The variance by which the sampler allocates samples: that of the worst frame, and of all.
    pub allocated: PassEstimates,
    /// Share of the pixels.
    pub share: f64,
    /// Cost of a sample relative to the mean.
    pub cost: f64,
}

/// What the last pass shows of a block, and what the passes before it show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassEstimates(pub [f64; 2]);

/// Forecast for one film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmForecast {
    pub took: ElapsedTime,
    /// The part of it that is not for paths: to prepare scenes and to denoise.
    pub besides: ElapsedTime,
    /// Mean samples per pixel.
    pub samples: f64,
    /// Camera samples of all pixels, and rays of all kinds.
    pub camera: f64,
    pub rays: f64,
    /// Error of the worst frame of the film. None if nothing is random.
    pub error: Option<f64>,
    /// Whether the limit of samples is reached before the target error.
    pub missed: bool,
}

/// Deviation of the pilot: -1 assumes less work, 1 more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uncertainty(f64);

/// Relative uncertainty of the cost of a sample in other parts of the film.
const COST: f64 = 0.07;

/// Uncertainty of the exponent.
const POWER: f64 = 0.05;

impl Uncertainty {
    pub const NONE: Self = Self(0.0);
    pub const ALL: [Self; 3] = [Self(-1.0), Self::NONE, Self(1.0)];

    /// The factor of the cost of samples.
    fn of_cost(self) -> f64 {
        1.0 + COST * self.0
    }
}

impl FilmForecast {
    pub const NOTHING: Self = Self {
        took: ElapsedTime::ZERO,
        besides: ElapsedTime::ZERO,
        samples: 0.0,
        camera: 0.0,
        rays: 0.0,
        error: None,
        missed: false,
    };

    /// The forecast if only a share of the film is traced, because other films share the rest.
    pub(super) fn traced(self, share: &FilmShare, uncertainty: Uncertainty) -> Self {
        let Self { took, besides, camera, rays, .. } = self;
        let rays = share.rays.map_or(rays * share.paths, |each| each * camera);
        let time = match share.time {
            Some(each) => each * (camera * uncertainty.of_cost()),
            None => (took - besides) * share.paths,
        };
        Self { took: besides + time, camera: camera * share.paths, rays, ..self }
    }

    /// The forecast with more time that is not for paths.
    fn and(self, more: ElapsedTime) -> Self {
        Self { took: self.took + more, besides: self.besides + more, ..self }
    }

    /// Interpolates linearly between two films.
    pub fn towards(&self, other: &Self, part: f64) -> Self {
        let mix = |a: f64, b: f64| a * (1.0 - part) + b * part;
        Self {
            took: self.took * (1.0 - part) + other.took * part,
            besides: self.besides * (1.0 - part) + other.besides * part,
            samples: mix(self.samples, other.samples),
            camera: mix(self.camera, other.camera),
            rays: mix(self.rays, other.rays),
            error: self.error.zip(other.error).map(|(a, b)| mix(a, b)),
            missed: if part < 0.5 { self.missed } else { other.missed },
        }
    }
}

impl PilotFilm {
    pub fn is_random(&self) -> bool {
        self.noise.is_some()
    }

    /// Forecast for this quality.
    pub fn forecast(&self, quality: &Quality, uncertainty: Uncertainty) -> FilmForecast {
        let Some(noise) = &self.noise else {
            let samples = f64::from(quality.antialias * quality.antialias);
            return self.with(samples, samples, 1.0, uncertainty);
        };
        match &quality.noise {
            None => {
                let samples = f64::from(quality.samples);
                let error = Some(noise.even(samples, uncertainty).sqrt());
                let drawn = samples + audits(quality, quality.samples);
                let rounds = self.rounds_of_parts(quality).max(1.0);
                self.filtered(FilmForecast { error, ..self.with(drawn, drawn, rounds, uncertainty) })
            }
            Some(target) => {
                // Samples alone, if the first round shows that the denoiser would take longer. Its audits are lost
                // then.
                let lost = audits(quality, MIN_SAMPLES.min(target.most));
                let parts = self.prepare * self.rounds_of_parts(quality);
                self.filtered(self.until(noise, (target, lost), uncertainty)).and(parts)
            }
        }
    }

    /// How often a denoised film of several moments visits all of them: once for each half and each audit.
    fn rounds_of_parts(&self, quality: &Quality) -> f64 {
        if self.moments > 1 && quality.denoise != Denoise::Off { 4.0 } else { 0.0 }
    }

    /// The forecast with the time of denoising the film once.
    fn filtered(&self, forecast: FilmForecast) -> FilmForecast {
        forecast.and(self.filter * self.pixels)
    }

    /// Forecast for a target error, with so many samples per pixel that have no part in it.
    fn until(
        &self,
        noise: &FilmNoise,
        (target, lost): (&NoiseTarget, f64),
        uncertainty: Uncertainty,
    ) -> FilmForecast {
        let Allocated { samples, work, most, square, missed } = noise.allocated(target, uncertainty);
        // If something moves, every round of samples visits all moments again.
        let first = f64::from(MIN_SAMPLES.min(target.most));
        let rounds = if self.moments > 1 { 1.0 + libm::log2(most / first).max(0.0).ceil() } else { 1.0 };
        FilmForecast {
            error: Some(square.sqrt()),
            missed,
            ..self.with(samples + lost, work + lost, rounds, uncertainty)
        }
    }

    /// Forecast for `samples` per pixel in `rounds`. `work` is the number of samples weighted by their cost.
    fn with(&self, samples: f64, work: f64, rounds: f64, uncertainty: Uncertainty) -> FilmForecast {
        let seconds = self.sample * (work * self.pixels * uncertainty.of_cost());
        FilmForecast {
            took: seconds,
            samples,
            camera: samples * self.pixels,
            rays: work * self.pixels * self.rays,
            ..FilmForecast::NOTHING
        }
        .and(self.prepare * rounds)
    }
}

/// How samples are distributed over the blocks of a film.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Allocated {
    /// Mean over the pixels, without and with the costs of blocks as weights.
    samples: f64,
    work: f64,
    /// Samples of the block with most samples.
    most: f64,
    /// Squared error, and whether it misses the target.
    square: f64,
    missed: bool,
}

/// The samples per pixel that show the error of a denoised picture.
fn audits(quality: &Quality, picture: u32) -> f64 {
    if quality.denoise == Denoise::Off { 0.0 } else { f64::from(2 * samples_of_audit(picture)) }
}

impl FilmNoise {
    /// Squared error if every pixel has this number of samples.
    fn even(&self, samples: f64, uncertainty: Uncertainty) -> f64 {
        let sum: f64 = self.blocks.iter().map(|block| block.squares.at(0.5)).sum();
        sum * self.scale(uncertainty) * libm::pow(self.samples / samples, self.power_of(uncertainty))
    }

    /// Allocates samples until the film reaches the target error or all pixels reach the limit. Blocks double their
    /// samples by the rule of `trace::adaptive`, and errors fall as the pilot measured.
    ///
    /// Samples that follow the noise which the pilot found miss the noise that it overlooked. Therefore the passes
    /// that judge the error differ in part from those that allocate samples. The sampler itself learns more while it
    /// runs.
    fn allocated(&self, target: &NoiseTarget, uncertainty: Uncertainty) -> Allocated {
        let [a, b] = [0.25, 0.75].map(|part| self.allocated_by(part, target, uncertainty));
        // One of them may reach the limit of samples everywhere by a single pixel.
        Allocated {
            samples: (a.samples * b.samples).sqrt(),
            work: (a.work * b.work).sqrt(),
            most: a.most.max(b.most),
            square: (a.square * b.square).sqrt(),
            missed: a.missed && b.missed,
        }
    }

    /// Allocates samples by `part` of the last pass, and judges errors by the rest.
    fn allocated_by(&self, part: f64, target: &NoiseTarget, uncertainty: Uncertainty) -> Allocated {
        let goal = target.error * target.error;
        let mut samples = vec![MIN_SAMPLES.min(target.most); self.blocks.len()];
        let mut is_first = true;
        loop {
            let now = self.with(&samples, 1.0 - part, uncertainty);
            // The sampler stops only when the error plus one standard deviation meets the target.
            let met = now.square * (1.0 + self.whole_spread) <= goal;
            let is_full = samples.iter().all(|&samples| samples >= target.most);
            if is_full || met && !is_first {
                return Allocated { missed: now.square > goal, ..now };
            }
            // No frame stops after its first round.
            let wanted = match met {
                true => vec![true; samples.len()],
                false => self.wanted((&samples, uncertainty), part, target),
            };
            is_first = false;
            for (samples, _) in samples.iter_mut().zip(wanted).filter(|(_, wanted)| *wanted) {
                *samples = samples.saturating_mul(2).min(target.most);
            }
        }
    }

    /// Selects the blocks that get more samples, as the sampler does: those with fewer samples than sqrt(variance /
    /// cost) in proportion.
    fn wanted(
        &self,
        (samples, uncertainty): (&[u32], Uncertainty),
        part: f64,
        target: &NoiseTarget,
    ) -> Vec<bool> {
        let mut errors = 0.0;
        let roots = self.blocks.iter().map(|block| {
            let square = block.around.at(part);
            let root = (block.allocated.at(part) / (block.cost * block.share)).sqrt();
            errors += if square > 0.0 { square * self.samples / root } else { 0.0 };
            root
        });
        let roots: Vec<f64> = roots.collect();
        let scale = self.scale(uncertainty) / (target.error * target.error) * errors;
        allocation::wanted(&roots, samples, target.most, scale)
    }

    fn with(&self, samples: &[u32], part: f64, uncertainty: Uncertainty) -> Allocated {
        let power = self.power_of(uncertainty);
        let mut decay = DecayTable::new(self.samples, power);
        let mut all = Allocated { samples: 0.0, work: 0.0, most: 0.0, square: 0.0, missed: false };
        for (block, &samples) in self.blocks.iter().zip(samples) {
            let fall = decay.at(samples);
            let samples = f64::from(samples);
            all.samples += block.share * samples;
            all.work += block.share * block.cost * samples;
            all.most = all.most.max(samples);
            all.square += block.squares.at(part) * fall;
        }
        Allocated { square: all.square * self.scale(uncertainty), ..all }
    }

    /// Ratio of the reported squared error to that of independent samples. The reported error is halfway between the
    /// error of independent samples and the error that the exponent predicts ([`crate::trace`]). Includes the
    /// uncertainty.
    fn scale(&self, uncertainty: Uncertainty) -> f64 {
        let gain = 1.0 / (libm::exp2(self.power_of(uncertainty)) - 1.0);
        (1.0 + gain) / 2.0 * libm::pow(1.0 + 2.0 * self.spread, uncertainty.0)
    }

    fn power_of(&self, uncertainty: Uncertainty) -> f64 {
        (self.power - POWER * uncertainty.0).clamp(1.0, 1.5)
    }
}

/// How squared errors fall beyond the samples of the pilot. Blocks have few different numbers of samples, so those that
/// were computed are kept.
struct DecayTable {
    samples: f64,
    power: f64,
    found: Vec<(u32, f64)>,
}

impl DecayTable {
    fn new(samples: f64, power: f64) -> Self {
        Self { samples, power, found: Vec::new() }
    }

    /// The squared error with so many samples per pixel, as a share of that with the pilot's.
    fn at(&mut self, samples: u32) -> f64 {
        if let Some((_, fall)) = self.found.iter().find(|(known, _)| *known == samples) {
            return *fall;
        }
        let fall = libm::pow(self.samples / f64::from(samples), self.power);
        self.found.push((samples, fall));
        fall
    }
}

impl PassEstimates {
    /// Mixes what the last pass shows, weighted by `part`, with what the passes before it show.
    fn at(&self, part: f64) -> f64 {
        let Self([last, before]) = self;
        part * last + (1.0 - part) * before
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A film of two halves. The second has nine times the squared error of the first.
    fn film(power: f64) -> PilotFilm {
        let block = |square: f64| {
            let [squares, around, allocated] = [PassEstimates([square; 2]); 3];
            BlockNoise { squares, around, allocated, share: 0.5, cost: 1.0 }
        };
        let blocks = vec![block(0.001), block(0.009)];
        let noise = FilmNoise { samples: 100.0, blocks, power, spread: 0.0, whole_spread: 0.0 };
        let (prepare, sample) = (ElapsedTime { wall: 1.0, cpu: None }, ElapsedTime { wall: 1e-6, cpu: None });
        let filter = ElapsedTime::ZERO;
        PilotFilm {
            place: 0,
            pixels: 1e6,
            moments: 1,
            prepare,
            sample,
            rays: 1.0,
            filter,
            noise: Some(noise),
        }
    }

    fn forecast(film: &PilotFilm, samples: u32, noise: Option<(f64, u32)>) -> FilmForecast {
        let noise = noise.map(|(error, most)| NoiseTarget { error, most });
        film.forecast(&Quality { samples, noise, ..Quality::default() }, Uncertainty::NONE)
    }

    #[test]
    fn four_times_the_samples_halve_the_error() {
        let found = [100, 400].map(|samples| forecast(&film(1.0), samples, None));
        assert!((found[0].error.unwrap_or(0.0) - 0.1).abs() < 1e-12, "{found:?}");
        assert!((found[1].error.unwrap_or(0.0) - 0.05).abs() < 1e-12, "{found:?}");
        assert!((found[1].took.wall - 401.0).abs() < 1e-9, "{found:?}");
    }

    /// The half with nine times the squared error gets more samples.
    #[test]
    fn an_error_takes_less_than_even_samples() {
        let found = forecast(&film(1.0), 1, Some((0.1, 1 << 20)));
        assert!(found.error.is_some_and(|error| error <= 0.1) && !found.missed, "{found:?}");
        assert!(found.samples < 128.0, "{found:?}");
        let even = forecast(&film(1.0), found.samples as u32, None);
        assert!(found.error < even.error);
    }

    #[test]
    fn a_limit_of_samples_is_missed() {
        let found = forecast(&film(1.0), 1, Some((0.01, 4096)));
        assert!(found.missed && found.samples == 4096.0, "{found:?}");
        let alike = forecast(&film(1.0), 4096, None);
        assert!((found.error.unwrap_or(0.0) - alike.error.unwrap_or(1.0)).abs() < 1e-12);
    }

    #[test]
    fn doubt_is_more_and_less_work() {
        let film = film(1.2);
        let quality =
            Quality { noise: Some(NoiseTarget { error: 0.02, most: 1 << 20 }), ..Quality::default() };
        let [low, mid, high] =
            Uncertainty::ALL.map(|uncertainty| film.forecast(&quality, uncertainty).took.wall);
        assert!(low < mid && mid < high);
    }
}
