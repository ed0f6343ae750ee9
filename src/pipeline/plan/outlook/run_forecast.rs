//! Forecasts a run with any quality from the pilot's measurements.

use super::film::{FilmForecast, PilotFilm, Uncertainty};
use super::range::Range;
use crate::base::clock::ElapsedTime;
use crate::pipeline::plan::path_shares::{FilmShare, PathShares};
use crate::sequence::quality::{MAX_SAMPLES, NoiseTarget, Quality};

/// The pilot's measurements of a plan.
#[derive(Clone, Debug)]
pub struct Outlook {
    /// Sorted by their index among the films.
    pub(super) pilots: Vec<PilotFilm>,
    /// Whether the samples of each film are random.
    pub(super) random: Vec<bool>,
    /// What is traced for each film.
    pub(super) shares: PathShares,
    /// Time that the pilot took.
    pub spent: ElapsedTime,
}

/// Forecast of a run with one quality.
#[derive(Clone, Debug, PartialEq)]
pub struct RunForecast {
    /// Wall time of tracing in seconds.
    pub wall: Range,
    /// Processor time of all threads in seconds. None if the system does not measure it.
    pub cpu: Option<Range>,
    /// Error of the worst film as a share of the mean brightness. None if nothing is random.
    pub error: Option<Range>,
    /// Camera samples of all pixels, and rays of all kinds.
    pub camera: f64,
    pub rays: f64,
    /// Number of films that reach the limit of samples before the target error.
    pub missed: usize,
    /// The most likely forecast of each film.
    pub films: Vec<FilmForecast>,
}

impl Outlook {
    /// Forecast of all films with this quality.
    pub fn forecast(&self, quality: &Quality) -> RunForecast {
        let [low, films, high] = Uncertainty::ALL.map(|uncertainty| self.films(quality, uncertainty));
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

    /// The most likely wall time of tracing with this quality, in seconds.
    pub(super) fn wall(&self, quality: &Quality) -> f64 {
        self.films(quality, Uncertainty::NONE).iter().map(|film| film.took.wall).sum()
    }

    /// Whether any film has random samples.
    pub fn is_random(&self) -> bool {
        self.random.contains(&true)
    }

    /// The largest number of samples per pixel, at least 1, whose tracing takes at most `seconds`. Chooses the number
    /// of random samples if some film is random; otherwise, the grid size along each axis.
    pub fn fitting(&self, quality: &Quality, seconds: f64) -> Quality {
        let with = |samples: u32| match self.is_random() {
            true => Quality { samples, noise: None, ..*quality },
            false => Quality { antialias: samples, noise: None, ..*quality },
        };
        let most = if self.is_random() { MAX_SAMPLES } else { FINEST };
        let fits = |samples: u32| {
            let films = self.films(&with(samples), Uncertainty::NONE);
            films.iter().map(|film| film.took.wall).sum::<f64>() <= seconds
        };
        // Binary search for the largest number that fits.
        let (mut low, mut high) = (1, most + 1);
        while high - low > 1 {
            let middle = low + (high - low) / 2;
            if fits(middle) { low = middle } else { high = middle }
        }
        with(low)
    }

    /// The smallest error of one or two digits that all films reach within `seconds`.
    pub fn error_within(&self, quality: &Quality, target: &NoiseTarget, seconds: f64) -> Option<f64> {
        round_errors().find(|&error| {
            let noise = Some(NoiseTarget { error, ..*target });
            let forecast = self.forecast(&Quality { noise, ..*quality });
            error > target.error && forecast.missed == 0 && forecast.wall.mid <= seconds
        })
    }

    /// The smallest power of two as a limit of samples with which every film reaches its target error.
    pub fn samples_for(&self, quality: &Quality, target: &NoiseTarget) -> Option<u32> {
        (0..=MAX_SAMPLES.ilog2()).map(|power| 1 << power).filter(|&most| most > target.most).find(|&most| {
            let noise = Some(NoiseTarget { most, ..*target });
            self.films(&Quality { noise, ..*quality }, Uncertainty::NONE).iter().all(|film| !film.missed)
        })
    }

    fn films(&self, quality: &Quality, uncertainty: Uncertainty) -> Vec<FilmForecast> {
        let of = |random: bool| -> Vec<(usize, FilmForecast)> {
            let alike = self.pilots.iter().filter(|pilot| pilot.is_random() == random);
            alike.map(|pilot| (pilot.place, pilot.forecast(quality, uncertainty))).collect()
        };
        let known = [of(false), of(true)];
        let film = |((place, &random), share): ((usize, &bool), &FilmShare)| {
            between(&known[usize::from(random)], place).traced(share, uncertainty)
        };
        self.random.iter().enumerate().zip(&self.shares.films).map(film).collect()
    }
}

/// Maximum grid size of samples along each side of a pixel.
const FINEST: u32 = 64;

/// Round errors from 0.0001 to 1.
fn round_errors() -> impl Iterator<Item = f64> {
    const DIGITS: [f64; 9] = [1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0];
    let decades = [10_000.0, 1000.0, 100.0, 10.0].into_iter();
    decades.flat_map(|decade| DIGITS.map(|digit| digit / decade)).chain([1.0])
}

/// Interpolates between the known films.
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
        FilmForecast { took: ElapsedTime { wall, cpu: None }, ..FilmForecast::NOTHING }
    }

    #[test]
    fn films_between_pilots_take_what_lies_between() {
        let known = [(2, took(1.0)), (6, took(5.0))];
        let wall = [0, 2, 3, 5, 6, 9].map(|place| between(&known, place).took.wall);
        assert_eq!(wall, [1.0, 1.0, 2.0, 4.0, 5.0, 5.0]);
        assert_eq!(between(&[], 3), FilmForecast::NOTHING);
    }

    #[test]
    fn shared_paths_take_their_share_of_the_time() {
        let besides = ElapsedTime { wall: 1.0, cpu: None };
        let film = FilmForecast { camera: 100.0, rays: 400.0, besides, ..took(3.0) };
        let traced = |share: FilmShare| {
            let FilmForecast { took, camera, rays, .. } = film.traced(&share, Uncertainty::NONE);
            (took.wall, camera, rays)
        };
        let time = Some(ElapsedTime { wall: 0.015, cpu: None });
        let shared = FilmShare { paths: 0.25, rays: Some(2.0), time };
        assert_eq!(traced(shared), (2.5, 25.0, 200.0), "scenes are prepared as ever");
        assert_eq!(traced(FilmShare::of_paths(0.25)), (1.5, 25.0, 100.0));
        assert_eq!(traced(FilmShare::of_paths(1.5)), (4.0, 150.0, 600.0), "with samples of other frames");
        assert_eq!(FilmForecast::NOTHING.traced(&shared, Uncertainty::NONE).took.wall, 0.0);
    }

    #[test]
    fn errors_are_round() {
        let errors: Vec<f64> = round_errors().collect();
        assert!(errors.is_sorted() && errors.contains(&0.08) && errors.contains(&0.025));
    }
}
