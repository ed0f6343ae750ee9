//! The time and the error to expect of a run, from a pilot: a few blocks of pixels of some of its films.
//!
//! ```text
//! Plan ──pilot──▶ PilotFilm: seconds per sample, squared error against samples ──forecast──▶ RunForecast of any quality
//! ```
//!
//! Films between two that were tried take what lies between them.

mod film;
mod passes;
mod pilot;
mod range;

pub use film::FilmForecast;
pub use pilot::{Patience, look_ahead};
pub use range::Range;

use crate::base::clock::Took;
use crate::sequence::quality::{MOST_SAMPLES, NoiseTarget, Quality};
use film::{Doubt, PilotFilm};

/// What a pilot knows of the films of a plan.
#[derive(Clone, Debug)]
pub struct Outlook {
    /// By their places among the films.
    pilots: Vec<PilotFilm>,
    /// Of each film of the plan, whether its samples are random.
    random: Vec<bool>,
    /// What the pilot took.
    pub spent: Took,
}

/// What a run is expected to take with some quality.
#[derive(Clone, Debug, PartialEq)]
pub struct RunForecast {
    /// Seconds that tracing takes.
    pub wall: Range,
    /// Of all processors together, where the system tells.
    pub cpu: Option<Range>,
    /// Of the worst film, as a share of the mean brightness; none where nothing is random.
    pub error: Option<Range>,
    /// Samples of all pixels, and rays of all kinds.
    pub camera: f64,
    pub rays: f64,
    /// Films that reach the limit of samples before they reach the error that was asked for.
    pub missed: usize,
    /// Each film, as it is most likely.
    pub films: Vec<FilmForecast>,
}

impl Outlook {
    /// What all films take with this quality.
    pub fn forecast(&self, quality: &Quality) -> RunForecast {
        let [low, films, high] = Doubt::ALL.map(|doubt| self.films(quality, doubt));
        let wall = |films: &[FilmForecast]| films.iter().map(|film| film.took.wall).sum::<f64>();
        let cpu = |films: &[FilmForecast]| films.iter().map(|film| film.took.cpu).sum::<Option<f64>>();
        let worst = |films: &[FilmForecast]| films.iter().filter_map(|film| film.error).reduce(f64::max);
        let range = |of: &dyn Fn(&[FilmForecast]) -> Option<f64>| {
            Some(Range::new(of(&low)?, of(&films)?, of(&high)?))
        };
        RunForecast {
            wall: Range::new(wall(&low), wall(&films), wall(&high)),
            cpu: range(&cpu),
            error: range(&worst),
            camera: films.iter().map(|film| film.camera).sum(),
            rays: films.iter().map(|film| film.rays).sum(),
            missed: films.iter().filter(|film| film.missed).count(),
            films,
        }
    }

    /// Whether samples of any film are random.
    pub fn is_random(&self) -> bool {
        self.random.contains(&true)
    }

    /// How many samples a pixel may have, so that tracing takes so many seconds: one at least. Where some films are random,
    /// it is their samples that are chosen; else it is a grid of as many along each side.
    pub fn fitting(&self, quality: &Quality, seconds: f64) -> Quality {
        let with = |samples: u32| match self.is_random() {
            true => Quality { samples, noise: None, ..*quality },
            false => Quality { antialias: samples, noise: None, ..*quality },
        };
        let most = if self.is_random() { MOST_SAMPLES } else { FINEST };
        let fits = |samples: u32| {
            let films = self.films(&with(samples), Doubt::NONE);
            films.iter().map(|film| film.took.wall).sum::<f64>() <= seconds
        };
        // The largest number that fits, by halves.
        let (mut low, mut high) = (1, most + 1);
        while high - low > 1 {
            let middle = low + (high - low) / 2;
            if fits(middle) { low = middle } else { high = middle }
        }
        with(low)
    }

    /// The least error of one or two digits that all films reach within so many seconds.
    pub fn error_within(&self, quality: &Quality, target: &NoiseTarget, seconds: f64) -> Option<f64> {
        round_errors().find(|&error| {
            let noise = Some(NoiseTarget { error, ..*target });
            let forecast = self.forecast(&Quality { noise, ..*quality });
            error > target.error && forecast.missed == 0 && forecast.wall.mid <= seconds
        })
    }

    /// Samples, as a power of two, with which no film misses its error.
    pub fn samples_for(&self, quality: &Quality, target: &NoiseTarget) -> Option<u32> {
        (0..=MOST_SAMPLES.ilog2()).map(|power| 1 << power).filter(|&most| most > target.most).find(|&most| {
            let noise = Some(NoiseTarget { most, ..*target });
            self.films(&Quality { noise, ..*quality }, Doubt::NONE).iter().all(|film| !film.missed)
        })
    }

    fn films(&self, quality: &Quality, doubt: Doubt) -> Vec<FilmForecast> {
        let of = |random: bool| -> Vec<(usize, FilmForecast)> {
            let alike = self.pilots.iter().filter(|pilot| pilot.is_random() == random);
            alike.map(|pilot| (pilot.place, pilot.forecast(quality, doubt))).collect()
        };
        let known = [of(false), of(true)];
        let film = |(place, &random): (usize, &bool)| between(&known[usize::from(random)], place);
        self.random.iter().enumerate().map(film).collect()
    }
}

/// Steps of a grid along each side of a pixel, at most.
const FINEST: u32 = 64;

/// Errors as people choose them, from 0.0001 to 1.
fn round_errors() -> impl Iterator<Item = f64> {
    const DIGITS: [f64; 9] = [1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0];
    let decades = [10_000.0, 1000.0, 100.0, 10.0].into_iter();
    decades.flat_map(|decade| DIGITS.map(|digit| digit / decade)).chain([1.0])
}

/// What lies between the films that are known: it changes evenly from one to the next.
fn between(known: &[(usize, FilmForecast)], place: usize) -> FilmForecast {
    let after = known.iter().position(|(other, _)| *other >= place).unwrap_or(known.len().saturating_sub(1));
    let Some((next, b)) = known.get(after) else { return FilmForecast::NOTHING };
    let (last, a) = &known[after.saturating_sub(usize::from(*next > place))];
    let width = next.saturating_sub(*last).max(1) as f64;
    a.towards(b, (place.saturating_sub(*last) as f64 / width).min(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn took(wall: f64) -> FilmForecast {
        FilmForecast { took: Took { wall, cpu: None }, ..FilmForecast::NOTHING }
    }

    #[test]
    fn films_between_pilots_take_what_lies_between() {
        let known = [(2, took(1.0)), (6, took(5.0))];
        let wall = [0, 2, 3, 5, 6, 9].map(|place| between(&known, place).took.wall);
        assert_eq!(wall, [1.0, 1.0, 2.0, 4.0, 5.0, 5.0]);
        assert_eq!(between(&[], 3), FilmForecast::NOTHING);
    }

    #[test]
    fn errors_are_round() {
        let errors: Vec<f64> = round_errors().collect();
        assert!(errors.is_sorted() && errors.contains(&0.08) && errors.contains(&0.025));
    }
}
