//! Films of scenes that were shown, for frames and edits that come back to them.

use crate::base::digest::Digest;
use crate::trace::ProgressiveFilm;

/// Films by the digest of what they show, the latest last.
pub struct FilmCache {
    films: Vec<CachedFilm>,
    budget: u64,
}

struct CachedFilm {
    key: Digest,
    film: ProgressiveFilm,
    /// The version of the file that showed it last.
    generation: u64,
}

/// Versions of the file after which a film is dropped, if none of them showed it. Some, for edits that are undone.
const KEPT_GENERATIONS: u64 = 8;

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
        let place = self.films.iter().position(|cached| cached.key == key)?;
        Some(self.films.remove(place).film)
    }

    /// Keeps a film that a version of the file shows. Drops films of much earlier versions, and the oldest ones that have
    /// no room.
    pub fn put(&mut self, key: Digest, film: ProgressiveFilm, generation: u64) {
        self.films.retain(|cached| cached.key != key && cached.generation + KEPT_GENERATIONS >= generation);
        self.films.push(CachedFilm { key, film, generation });
        let mut bytes: u64 = self.films.iter().map(|cached| cached.film.bytes()).sum();
        while bytes > self.budget && self.films.len() > 1 {
            bytes -= self.films.remove(0).film.bytes();
        }
    }

    pub fn len(&self) -> usize {
        self.films.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::AovSet;
    use crate::film::filter::FilterSampler;
    use crate::sequence::quality::Quality;
    use crate::trace::TraceSettings;

    fn film() -> ProgressiveFilm {
        let quality = Quality::default();
        let filter = FilterSampler::new(quality.filter);
        ProgressiveFilm::new(
            &TraceSettings { size: (8, 8), quality, filter, aovs: AovSet::default(), first_sample: 0 },
            1,
            Vec::new(),
        )
    }

    #[test]
    fn old_films_are_dropped() {
        let mut cache = FilmCache::new(3 * film().bytes());
        let key = |number: u32| Digest::of(&number);
        (0..5).for_each(|number| cache.put(key(number), film(), 1));
        let kept: Vec<bool> = (0..5).map(|number| cache.take(key(number)).is_some()).collect();
        assert_eq!(kept, [false, false, true, true, true]);
        cache.put(key(1), film(), 1);
        cache.put(key(2), film(), 9);
        assert_eq!(cache.len(), 2);
        cache.put(key(3), film(), 10);
        assert_eq!((cache.len(), cache.take(key(1)).is_none()), (2, true));
    }
}
