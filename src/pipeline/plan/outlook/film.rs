//! One film: what its samples cost, how far its error falls, and what follows for any quality.

use crate::base::clock::Took;
use crate::sequence::quality::{NoiseTarget, Quality};
use crate::trace::LEAST_SAMPLES;
use std::f64::consts::SQRT_2;

/// What a pilot has found of a film.
#[derive(Clone, Debug)]
pub struct PilotFilm {
    /// Its place among the films of the run.
    pub place: usize,
    pub pixels: f64,
    /// Moments at which it is traced.
    pub moments: u32,
    /// To put things in their places and build trees, once for each moment.
    pub prepare: Took,
    /// A sample of a pixel, on average; and the rays that it sends, that of the camera among them.
    pub sample: Took,
    pub rays: f64,
    /// None where samples stand on a grid.
    pub noise: Option<FilmNoise>,
}

/// How noisy a film is.
#[derive(Clone, Debug)]
pub struct FilmNoise {
    /// Samples of a pixel that what follows is about.
    pub samples: f64,
    pub blocks: Vec<BlockNoise>,
    /// The squared error falls as this power of samples.
    pub power: f64,
    /// Standard deviation of the sum of all blocks, as a share: of those that were tried, and of all of the film.
    pub spread: f64,
    pub whole_spread: f64,
}

/// A block of a film, as one of those that were tried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockNoise {
    /// What it adds to the film's squared error if samples were independent, as a share of the squared mean: as the last pass
    /// says, and as those before it say.
    pub squares: [f64; 2],
    /// Its share of the pixels.
    pub share: f64,
    /// What a sample of it costs, relative to the mean.
    pub cost: f64,
}

/// What a film is expected to take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmForecast {
    pub took: Took,
    /// Samples of a pixel, on average.
    pub samples: f64,
    /// Samples of all pixels, and rays of all kinds.
    pub camera: f64,
    pub rays: f64,
    /// Its error, of the worst of its frames; none where nothing is random.
    pub error: Option<f64>,
    /// Whether the limit of samples comes before the error that was asked for.
    pub missed: bool,
}

/// How the pilot may be wrong: from less work to more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Doubt(f64);

/// What samples cost in other parts of the film is known to about this share.
const COST: f64 = 0.07;

/// What the power of samples is known to.
const POWER: f64 = 0.05;

impl Doubt {
    pub const NONE: Self = Self(0.0);
    pub const ALL: [Self; 3] = [Self(-1.0), Self::NONE, Self(1.0)];
}

impl FilmForecast {
    pub const NOTHING: Self =
        Self { took: Took::ZERO, samples: 0.0, camera: 0.0, rays: 0.0, error: None, missed: false };

    /// A film that is so far on the way from this one to another.
    pub fn towards(&self, other: &Self, part: f64) -> Self {
        let mix = |a: f64, b: f64| a * (1.0 - part) + b * part;
        Self {
            took: self.took * (1.0 - part) + other.took * part,
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

    /// What it takes with this quality.
    pub fn forecast(&self, quality: &Quality, doubt: Doubt) -> FilmForecast {
        let Some(noise) = &self.noise else {
            let samples = f64::from(quality.antialias * quality.antialias);
            return self.with(samples, samples, 1.0, doubt);
        };
        match &quality.noise {
            None => {
                let samples = f64::from(quality.samples);
                let error = Some(noise.even(samples, doubt).sqrt());
                FilmForecast { error, ..self.with(samples, samples, 1.0, doubt) }
            }
            Some(target) => self.until(noise, target, doubt),
        }
    }

    /// What it takes to reach an error.
    fn until(&self, noise: &FilmNoise, target: &NoiseTarget, doubt: Doubt) -> FilmForecast {
        let Allocated { samples, work, most, square } = noise.allocated(target, doubt);
        // If things move, every round of samples looks at all moments again.
        let first = f64::from(LEAST_SAMPLES / 2);
        let rounds = if self.moments > 1 { 1.0 + libm::log2(most / first).max(0.0).ceil() } else { 1.0 };
        FilmForecast {
            error: Some(square.sqrt()),
            missed: square > target.error * target.error,
            ..self.with(samples, work, rounds, doubt)
        }
    }

    /// So many samples a pixel, in so many rounds; `work` is the same weighted by what they cost.
    fn with(&self, samples: f64, work: f64, rounds: f64, doubt: Doubt) -> FilmForecast {
        let seconds = self.sample * (work * self.pixels * (1.0 + COST * doubt.0));
        FilmForecast {
            took: self.prepare * rounds + seconds,
            samples,
            camera: samples * self.pixels,
            rays: work * self.pixels * self.rays,
            ..FilmForecast::NOTHING
        }
    }
}

/// How samples are spread over the blocks of a film.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Allocated {
    /// Mean over the pixels, and the same weighted by what blocks cost.
    samples: f64,
    work: f64,
    /// Of the block that has most.
    most: f64,
    /// The squared error that is left.
    square: f64,
}

impl FilmNoise {
    /// The squared error with so many samples in every pixel.
    fn even(&self, samples: f64, doubt: Doubt) -> f64 {
        let sum: f64 = self.blocks.iter().map(|block| block.square(0.5)).sum();
        sum * self.scale(doubt) * libm::pow(self.samples / samples, self.power_of(doubt))
    }

    /// The samples with which an error is reached, or with which pixels may have no more: blocks are given twice their
    /// samples by the rule of `trace::adaptive`, with errors that fall as the pilot says.
    ///
    /// Samples that go to where a pilot has found noise do not help where it has overlooked it. So errors are judged by
    /// other passes than samples are given, in part: the sampler itself finds out more on its way.
    fn allocated(&self, target: &NoiseTarget, doubt: Doubt) -> Allocated {
        let [a, b] = [0.25, 0.75].map(|part| self.allocated_by(part, target, doubt));
        Allocated {
            samples: (a.samples + b.samples) / 2.0,
            work: (a.work + b.work) / 2.0,
            most: a.most.max(b.most),
            square: (a.square + b.square) / 2.0,
        }
    }

    /// Samples are given by this part of the last pass, and errors are judged by the rest of it.
    fn allocated_by(&self, part: f64, target: &NoiseTarget, doubt: Doubt) -> Allocated {
        let goal = target.error * target.error;
        let mut samples = vec![LEAST_SAMPLES.min(target.most); self.blocks.len()];
        loop {
            let now = self.with(&samples, 1.0 - part, doubt);
            // Sampling goes on until the error is met by more than a standard deviation.
            let met = now.square * (1.0 + self.whole_spread) <= goal;
            if met || samples.iter().all(|&samples| samples >= target.most) {
                return now;
            }
            let wanted = self.wanted(&samples, part, target, self.scale(doubt) / goal);
            for (samples, _) in samples.iter_mut().zip(wanted).filter(|(_, wanted)| *wanted) {
                *samples = samples.saturating_mul(2).min(target.most);
            }
        }
    }

    /// Which blocks get more samples: those that have less than in proportion to the root of their variance over their cost.
    fn wanted(&self, samples: &[u32], part: f64, target: &NoiseTarget, unit: f64) -> Vec<bool> {
        let open: Vec<bool> = samples.iter().map(|&samples| samples < target.most).collect();
        let roots = self
            .blocks
            .iter()
            .map(|block| (block.square(part) * self.samples * block.cost * block.share).sqrt());
        let mut scale = unit * roots.sum::<f64>();
        loop {
            let wanted: Vec<bool> = (self.blocks.iter().zip(samples).zip(&open))
                .map(|((block, &samples), open)| {
                    let root = (block.square(part) * self.samples / block.cost / block.share).sqrt();
                    *open && scale * root >= SQRT_2 * f64::from(samples)
                })
                .collect();
            if wanted.contains(&true) {
                return wanted;
            }
            if !scale.is_finite() || scale == 0.0 {
                return open;
            }
            scale *= 1.25;
        }
    }

    fn with(&self, samples: &[u32], part: f64, doubt: Doubt) -> Allocated {
        let power = self.power_of(doubt);
        let mut all = Allocated { samples: 0.0, work: 0.0, most: 0.0, square: 0.0 };
        for (block, &samples) in self.blocks.iter().zip(samples) {
            let samples = f64::from(samples);
            all.samples += block.share * samples;
            all.work += block.share * block.cost * samples;
            all.most = all.most.max(samples);
            all.square += block.square(part) * libm::pow(self.samples / samples, power);
        }
        Allocated { square: all.square * self.scale(doubt), ..all }
    }

    /// The squared error that is told, as a share of that of independent samples: half way between that and what the
    /// power of the samples says ([`crate::trace`]); and by how much it may be wrong.
    fn scale(&self, doubt: Doubt) -> f64 {
        let gain = 1.0 / (libm::exp2(self.power_of(doubt)) - 1.0);
        (1.0 + gain) / 2.0 * libm::pow(1.0 + 2.0 * self.spread, doubt.0)
    }

    fn power_of(&self, doubt: Doubt) -> f64 {
        (self.power - POWER * doubt.0).clamp(1.0, 1.5)
    }
}

impl BlockNoise {
    /// By this part of the last pass, and the rest of those before it.
    fn square(&self, part: f64) -> f64 {
        part * self.squares[0] + (1.0 - part) * self.squares[1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two halves of a film, of which the second has nine times the squared error.
    fn film(power: f64) -> PilotFilm {
        let block = |square: f64| BlockNoise { squares: [square; 2], share: 0.5, cost: 1.0 };
        let blocks = vec![block(0.001), block(0.009)];
        let noise = FilmNoise { samples: 100.0, blocks, power, spread: 0.0, whole_spread: 0.0 };
        let (prepare, sample) = (Took { wall: 1.0, cpu: None }, Took { wall: 1e-6, cpu: None });
        PilotFilm { place: 0, pixels: 1e6, moments: 1, prepare, sample, rays: 1.0, noise: Some(noise) }
    }

    fn forecast(film: &PilotFilm, samples: u32, noise: Option<(f64, u32)>) -> FilmForecast {
        let noise = noise.map(|(error, most)| NoiseTarget { error, most });
        film.forecast(&Quality { samples, noise, ..Quality::default() }, Doubt::NONE)
    }

    #[test]
    fn four_times_the_samples_halve_the_error() {
        let found = [100, 400].map(|samples| forecast(&film(1.0), samples, None));
        assert!((found[0].error.unwrap_or(0.0) - 0.1).abs() < 1e-12, "{found:?}");
        assert!((found[1].error.unwrap_or(0.0) - 0.05).abs() < 1e-12, "{found:?}");
        assert!((found[1].took.wall - 401.0).abs() < 1e-9, "{found:?}");
    }

    /// The half with nine times the error has more samples than the other.
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
        let [low, mid, high] = Doubt::ALL.map(|doubt| film.forecast(&quality, doubt).took.wall);
        assert!(low < mid && mid < high);
    }
}
