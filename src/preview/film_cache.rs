//! Films of scenes that were shown, for frames and edits that come back to them.

use crate::base::digest::Digest;
use crate::trace::ProgressiveFilm;

/// Films by the digest of what they show, the latest last.
pub struct FilmCache {
    films: Vec<(Digest, ProgressiveFilm)>,
    budget: u64,
}

impl FilmCache {
    /// A cache of at most `budget` bytes, but for the latest film.
    pub fn new(budget: u64) -> Self {
        Self { films: Vec::new(), budget }
    }

    pub fn budget(&self) -> u64 {
        self.budget
    }

    /// Takes a film out of the cache.
    pub fn take(&mut self, key: Digest) -> Option<ProgressiveFilm> {
        let place = self.films.iter().position(|(other, _)| *other == key)?;
        Some(self.films.remove(place).1)
    }

    /// Keeps a film, and drops the oldest ones that have no room.
    pub fn put(&mut self, key: Digest, film: ProgressiveFilm) {
        self.films.retain(|(other, _)| *other != key);
        self.films.push((key, film));
        let mut bytes: u64 = self.films.iter().map(|(_, film)| film.bytes()).sum();
        while bytes > self.budget && self.films.len() > 1 {
            bytes -= self.films.remove(0).1.bytes();
        }
    }

    pub fn len(&self) -> usize {
        self.films.len()
    }
}
